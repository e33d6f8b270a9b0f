/* Room for an instance and its arrays: on the heap, see room.c, or static, see room_in_c.c. */
#ifndef ROOM_H
#define ROOM_H

#include <stddef.h>

#include "messages.h"

enum { STATES_HELD = 3 }; /* in the arrays of a tether: `state`, `before` and `spare` */

Instance *make_room(void);
void free_room(Instance *instance);
void *take_room(Instance *instance, size_t size);
void give_back(void *arrays);
#if KERNELS_IN_C
unsigned char *memory_of(Instance *instance);
#endif

#endif
