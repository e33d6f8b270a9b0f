/* Room on the heap. */
#include "room.h"

#include <stdlib.h>

#include "instance.h"

/* Room for an instance, all 0; NULL without memory. */
Instance *make_room(void)
{
    return calloc(1, sizeof(Instance));
}

void free_room(Instance *instance)
{
    free(instance);
}

/* Room for arrays, all 0; NULL without memory. */
void *take_room(Instance *instance, size_t size)
{
    return calloc(1, size);
}

void give_back(void *arrays)
{
    free(arrays);
}
