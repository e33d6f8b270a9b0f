/* Preloaded into a host: freed memory is never used again and reads as an object with one owner, so that what is released twice
crashes each time, not by chance. */
#include <malloc.h>
#include <stddef.h>

void free(void *block)
{
    size_t words = block ? malloc_usable_size(block) / sizeof(size_t) : 0;
    for (size_t i = 0; i < words; i++) ((volatile size_t *)block)[i] = 1;
}
