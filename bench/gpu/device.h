/* device.h - the calls of the CUDA runtime that the bench makes, on top of those of the examples. Compiled
   without CUDA, memory is the host's and kernels are loops: so the programs are tested anywhere.
   SPDX-License-Identifier: MIT */
#ifndef RBD_BENCH_DEVICE_H
#define RBD_BENCH_DEVICE_H

#include "../../examples/gpu/device.h"

#include <algorithm>
#include <chrono>
#include <vector>

#ifdef __CUDACC__
/* Bytes that one allocation may have: three quarters of what is free. */
inline size_t device_memory() {
    size_t available = 0;
    size_t all = 0;
    CHECK(cudaMemGetInfo(&available, &all));
    return available / 4 * 3;
}

class stopwatch {
    cudaEvent_t begin, end;

  public:
    stopwatch() {
        CHECK(cudaEventCreate(&begin));
        CHECK(cudaEventCreate(&end));
    }

    ~stopwatch() {
        cudaEventDestroy(begin);
        cudaEventDestroy(end);
    }

    void start() { CHECK(cudaEventRecord(begin)); }

    double seconds() {
        float milliseconds = 0;
        CHECK(cudaEventRecord(end));
        CHECK(cudaEventSynchronize(end));
        CHECK(cudaEventElapsedTime(&milliseconds, begin, end));
        return milliseconds * 1e-3;
    }
};
#else
inline size_t device_memory() { return (size_t)64 << 20; }

class stopwatch {
    std::chrono::steady_clock::time_point begin;

  public:
    void start() { begin = std::chrono::steady_clock::now(); }
    double seconds() {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
};
#endif

/* Bytes of 0xff: floats of them are NaN, so a result that nobody wrote is seen. */
inline void device_poison(void *memory, size_t bytes) { device_fill(memory, 0xff, bytes); }

/* Median seconds of one call of work(repetition): groups of calls of at least `least` seconds each. */
template <class Work> double median_seconds(int groups, double least, Work work) {
    stopwatch watch;
    int call = 0;
    work(call++);
    device_wait();
    watch.start();
    work(call++);
    const double once = std::max(watch.seconds(), 1e-7);
    const int calls = std::max(1, (int)std::min(least / once, 1000.0));
    std::vector<double> each;
    for (int group = 0; group < groups; ++group) {
        watch.start();
        for (int k = 0; k < calls; ++k) work(call++);
        each.push_back(watch.seconds() / calls);
    }
    std::nth_element(each.begin(), each.begin() + groups / 2, each.end());
    return each[(size_t)groups / 2];
}
#endif
