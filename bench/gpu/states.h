/* states.h - random states, made where they are needed: a number follows from its place alone.
   SPDX-License-Identifier: MIT */
#ifndef RBD_BENCH_STATES_H
#define RBD_BENCH_STATES_H

#include <cmath>
#include <cstdint>

#ifndef RBD_HD /* that of generated code: of the host and the device */
#define RBD_HD inline
#endif

/* Uniform in -range ... range; `array` tells one array's numbers from another's. */
template <class S> RBD_HD S random_number(uint32_t array, uint64_t state, uint32_t component, S range) {
    uint64_t h =
        state * 0x9e3779b97f4a7c15u + component * 0xc2b2ae3d27d4eb4fu + (array + 1) * 0x165667b19e3779f9u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    const int32_t number = (int32_t)((h ^ (h >> 31)) >> 40) - (1 << 23);
    return (S)number * (range / (S)(1 << 23));
}

/* Component k of configuration q: angles of -3 ... 3 rad; after a floating base's place its unit
   quaternion. */
template <class S> RBD_HD S random_position(bool floating, uint64_t state, int k) {
    if (!floating || k < 3 || k > 6) return random_number(0, state, (uint32_t)k, (S)3);
    S part[4];
    S squares = 0;
    for (int j = 0; j < 4; ++j) {
        part[j] = random_number(0, state, (uint32_t)(3 + j), (S)1);
        squares += part[j] * part[j];
    }
    return part[k - 3] / (S)sqrt(squares);
}

/* Component k of argument `array` of a call: q, then v, then accelerations or torques. */
template <class S> RBD_HD S random_component(int array, bool floating, uint64_t state, int k) {
    return array == 0 ? random_position<S>(floating, state, k)
                      : random_number(array, state, (uint32_t)k, (S)(array == 1 ? 2 : 10));
}
#endif
