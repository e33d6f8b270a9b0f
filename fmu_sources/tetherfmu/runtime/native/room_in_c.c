/* Room for an instance whose kernels are C: the memory of the kernels, with the instance and two places for its arrays in
it. An address of the kernels is a place in this memory. After instantiation only saved states use the heap. */
#include "room.h"

#include <stdlib.h>
#include <string.h>

#include "instance.h"
#include "kernels.h"

enum { ALIGNED = 16 };
#define WHOLE(size) (((size) + ALIGNED - 1) / ALIGNED * ALIGNED)

enum { PLACES = 2 }; /* for the arrays in use, and for a start or a saved state that may be refused */
static const size_t INSTANCE_AT = WHOLE(FREE_AT), ARRAYS_AT = WHOLE(FREE_AT) + WHOLE(sizeof(Instance));
static const size_t PLACE = WHOLE(
    sizeof(Arrays) +
    sizeof(double) * (PLAN_SIZE + STATES_HELD * MOST_STATE(MAX_SEGMENTS) + MOST_OTHERS(MAX_SEGMENTS) + VALUES));

Instance *make_room(void)
{
    unsigned char *memory = calloc(1, ARRAYS_AT + PLACES * PLACE);
    if (!memory) return NULL;
    memcpy(memory + DATA_AT, DATA, sizeof DATA);
    return (Instance *)(void *)(memory + INSTANCE_AT);
}

unsigned char *memory_of(Instance *instance)
{
    return (unsigned char *)instance - INSTANCE_AT;
}

void free_room(Instance *instance)
{
    free(memory_of(instance));
}

/* The place without the arrays of the instance; NULL if it is too small. */
void *take_room(Instance *instance, size_t size)
{
    unsigned char *first = memory_of(instance) + ARRAYS_AT;
    unsigned char *place = (unsigned char *)instance->arrays == first ? first + PLACE : first;
    return size <= PLACE ? memset(place, 0, size) : NULL;
}

void give_back(void *arrays)
{
    (void)arrays;
}
