/* cuda_check.h - the kernels of generated code on a host, in all layouts, against the same functions in C:
   the same statements, so the same bits where products and sums are not fused. cuda_main.py writes
   the tables. */
#ifndef CUDA_CHECK_H
#define CUDA_CHECK_H

#include "../larger.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

/* stance: of each state, where the function takes one. */
template <class scalar> struct checked {
    const char *name;
    int has_status, inputs, results, sizes[12];
    int (*in_c)(const int *stance, const scalar *const *x, scalar *const *y);
    void (*kernels[3])(int n, const int *stance, const scalar *const *x, scalar *const *y, int *status);
};

/* States: more than two blocks and no multiple of one; random ones, then a NaN, angles beyond the limit. */
enum { RANDOM = 66, IS_NAN = RANDOM, BEYOND, INFINITE, STATES, ROOM = 96, GUARD = 8 };
enum { STANCES = 3 }; /* a last one that there is not */
static const double untouched = 12345;

static double draw(uint64_t *seed) { /* -2 to 2 */
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return double(int32_t(*seed >> 32)) / 1073741824;
}

template <class scalar> std::vector<scalar> states_of(int size, int argument, uint64_t *seed) {
    std::vector<scalar> x(size_t(STATES * size));
    for (scalar &y : x) y = scalar(draw(seed));
    if (argument > 0) return x;
    x[size_t(IS_NAN * size + size - 1)] = scalar(std::nan(""));
    x[size_t(BEYOND * size + size - 1)] = scalar(sizeof(scalar) == 4 ? 1.1e4 : 1.1e6);
    x[size_t(INFINITE * size + size / 2)] = -scalar(HUGE_VAL);
    return x;
}

/* Where component k of state i is. */
static size_t place(int layout, int size, int i, int k) {
    if (layout == 0) return size_t(i * size + k);
    if (layout == 1) return size_t((i / 32 * size + k) * 32 + i % 32);
    return size_t(k * STATES + i);
}

/* To the bit without fused operations; with them, which C and C++ may place differently, to rounding. */
template <class scalar> bool is_same(scalar x, scalar y, scalar largest) {
    if (std::isnan(x) || std::isnan(y)) return std::isnan(x) && std::isnan(y);
#if defined FP_FAST_FMA || defined FP_FAST_FMAF
    return std::fabs(x - y) <= (sizeof(scalar) == 4 ? scalar(2e-3) : scalar(1e-10)) * (1 + largest);
#else
    (void)largest;
    return x == y;
#endif
}

/* Compares state i; returns whether it is as in C. */
template <class scalar>
bool is_right(const checked<scalar> &f, int layout, int i, const std::vector<scalar> *states,
              const int *stance, const std::vector<scalar> *found, int status) {
    const scalar *x[6] = {};
    std::vector<scalar> results[6];
    scalar *y[6] = {};
    for (int k = 0; k < f.inputs; k++) x[k] = &states[k][size_t(i * f.sizes[k])];
    for (int k = 0; k < f.results; k++) {
        results[k].assign(size_t(f.sizes[f.inputs + k]), scalar(untouched));
        y[k] = results[k].data();
    }
    const int expected = f.in_c(&stance[i], x, y);
    bool right = expected == status;
    for (int k = 0; k < f.results; k++) {
        const int size = f.sizes[f.inputs + k];
        scalar largest = 0;
        for (scalar z : results[k])
            if (!std::isnan(z)) largest = scalar(larger(double(largest), double(std::fabs(z))));
        for (int j = 0; j < size; j++)
            right = right && is_same(found[k][place(layout, size, i, j)], y[k][j], largest);
    }
    if (!right)
        std::printf("%s, layout %d: state %d is wrong, status %d and in C %d\n", f.name, layout, i, status,
                    expected);
    return right;
}

/* Memory that belongs to no state is as it was. */
template <class scalar>
int written_beyond(const char *name, int layout, int size, const std::vector<scalar> &x) {
    std::vector<char> is_own(x.size(), 0);
    for (int i = 0; i < STATES; i++)
        for (int k = 0; k < size; k++) is_own[place(layout, size, i, k)] = 1;
    for (size_t k = 0; k < x.size(); k++)
        if (!is_own[k] && x[k] != scalar(untouched))
            return std::printf("%s, layout %d: writes beyond\n", name, layout), 1;
    return 0;
}

template <class scalar> int check_layout(const checked<scalar> &f, int layout) {
    uint64_t seed = 1;
    std::vector<scalar> states[6], given[6], found[6];
    const scalar *x[6] = {};
    scalar *y[6] = {};
    int stance[STATES], status[STATES + 1] = {}, failures = 0;
    for (int i = 0; i < STATES; i++) stance[i] = i % (STANCES + 1);
    for (int k = 0; k < f.inputs; k++) {
        states[k] = states_of<scalar>(f.sizes[k], k, &seed);
        given[k].assign(size_t(ROOM * f.sizes[k]), scalar(std::nan("")));
        for (int i = 0; i < STATES; i++)
            for (int j = 0; j < f.sizes[k]; j++)
                given[k][place(layout, f.sizes[k], i, j)] = states[k][size_t(i * f.sizes[k] + j)];
        x[k] = given[k].data();
    }
    for (int k = 0; k < f.results; k++) {
        found[k].assign(size_t(ROOM * f.sizes[f.inputs + k] + GUARD), scalar(untouched));
        y[k] = found[k].data();
    }
    f.kernels[layout](STATES, stance, x, y, status);
    for (int i = 0; i < STATES; i++) failures += !is_right(f, layout, i, states, stance, found, status[i]);
    for (int k = 0; k < f.results; k++)
        failures += written_beyond(f.name, layout, f.sizes[f.inputs + k], found[k]);
    return failures;
}

template <class scalar, size_t n> int check_all(const checked<scalar> (&functions)[n]) {
    int failures = 0;
    for (const checked<scalar> &f : functions)
        for (int layout = 0; layout < 3; layout++) failures += check_layout(f, layout);
    return failures;
}

#endif
