/* usual.c - the calls of calls.h as the host compiles them: C, SIMD, with symbols. */
#define RBD_REAL float
#define RBD_IMPLEMENTATION
#define HERE static
#include "calls.h"

#define FUNCTION(name, size) \
    int usual_##name(const state *s, rbd_real *out); \
    int usual_##name(const state *s, rbd_real *out) { return name(&hyq_model, s, out); }
EACH_CALL(FUNCTION)
