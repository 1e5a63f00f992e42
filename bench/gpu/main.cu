/* main.cu - runs the measurements of all files that were linked; each prints rows of CSV.
   SPDX-License-Identifier: MIT */
#include "kernel.h"

struct alignas(16) four {
    float x[4];
};

/* Sixteen bytes a thread: with four the card cannot start threads fast enough. */
RBD_KERNEL copy(int n, const four *from, four *to) { RBD_EACH_STATE(i, n) to[i] = from[i]; }

/* A layout for fill: one number a state. */
struct numbers {
    static RBD_HD float *at(float *x, int, int, int i) { return x + i; }
};

/* How fast the memory is: a gigabyte read and a gigabyte written. */
static void measure_copy(const options &o) {
    const int n = (int)std::min<size_t>((size_t)1 << 28, memory_pool::get().capacity() / 16);
    memory_pool::get().reset();
    float *from = (float *)memory_pool::get().take((size_t)n * 4);
    float *to = (float *)memory_pool::get().take((size_t)n * 4);
    launch(fill<numbers, float>, n, from, 1, n, 1, false);
    const double seconds = median_seconds(o.groups, o.least_seconds,
                                          [&](int) { launch(copy, n / 4, (const four *)from, (four *)to); });
    print_row("device", "copy", "rows", n, 0, true, seconds, 8);
}

int main(int argc, char **argv) {
    const options o(argc, argv);
    int wrong = 0;
    if (o.profile) memory_pool::most() = (size_t)8 << 30;
    if (o.wants("copy") && !o.profile) measure_copy(o);
    for (const measurement *m = measurement::first(); m; m = m->next)
        if (o.wants(m->algorithm)) wrong += !m->run(o);
    return wrong != 0;
}
