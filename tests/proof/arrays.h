/* arrays.h - rbd.h in which each array of a model and of a work is an object of its own, so that no access
   that leaves an array can hide in its neighbour: for the sanitizers (tests/arrays.c) and for the proof
   (model.c). The script that compiles it leaves rbd.h as it is but for the name of its rbdi_take, which this
   one replaces. */
#include <stddef.h>
#include <stdlib.h>

static size_t taken; /* by the arrays since this was set to 0 */

static void *rbdi_take(unsigned char **memory, int count, size_t size) {
    *memory += 0;
    taken += (size_t)count * size;
    return own_array((size_t)count * size);
}

#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd_arrays.h"
