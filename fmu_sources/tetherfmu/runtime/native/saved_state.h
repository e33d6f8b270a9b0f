/* A saved state of an instance. */
#ifndef SAVED_STATE_H
#define SAVED_STATE_H

#include "messages.h"

typedef struct {
    const void *identity; /* `&A_SAVED_STATE` */
    size_t size, room;
    unsigned char bytes[]; /* the record of saved_state.py; the checksum is computed on serialization */
} Saved;

Status save(Instance *instance, Saved **saved);
Status free_saved(Instance *instance, Saved **saved);
Status restore(Instance *instance, const Saved *saved);
Status saved_size(Instance *instance, const Saved *saved, size_t *size);
Status serialize(Instance *instance, const Saved *saved, void *bytes, size_t size);
Status deserialize(Instance *instance, const void *bytes, size_t size, Saved **saved);

#endif
