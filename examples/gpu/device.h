/* device.h - the few calls of CUDA's runtime that a program makes around its kernels. Without CUDA, memory
   is the host's and a kernel of generated code's macros is a loop, so that the same file runs anywhere.
   SPDX-License-Identifier: MIT */
#ifndef DEVICE_H
#define DEVICE_H

#include <cstdio>
#include <cstdlib>
#include <cstring>

#ifdef __CUDACC__
#define CHECK(call) device_check(call, #call, __FILE__, __LINE__)

inline void device_check(cudaError_t error, const char *call, const char *file, int line) {
    if (error == cudaSuccess) return;
    std::fprintf(stderr, "%s:%d: %s: %s\n", file, line, call, cudaGetErrorString(error));
    std::exit(3);
}

inline void *device_allocate(size_t bytes) {
    void *memory = nullptr;
    CHECK(cudaMalloc(&memory, bytes));
    return memory;
}

inline void device_free(void *memory) { CHECK(cudaFree(memory)); }
inline void device_wait() { CHECK(cudaDeviceSynchronize()); }
inline void device_fill(void *memory, int byte, size_t bytes) { CHECK(cudaMemset(memory, byte, bytes)); }

inline void to_host(void *host, const void *device, size_t bytes) {
    CHECK(cudaMemcpy(host, device, bytes, cudaMemcpyDeviceToHost));
}

inline void to_device(void *device, const void *host, size_t bytes) {
    CHECK(cudaMemcpy(device, host, bytes, cudaMemcpyHostToDevice));
}

/* kernel(n, arguments...) with a thread for each of n. */
template <class... Formal, class... Actual>
void launch(void (*kernel)(int, Formal...), int n, Actual... arguments) {
    const int threads = 128;
    kernel<<<(n + threads - 1) / threads, threads>>>(n, arguments...);
    CHECK(cudaGetLastError());
}
#else
inline void *device_allocate(size_t bytes) {
    void *memory = std::malloc(bytes);
    if (memory) return memory;
    std::fprintf(stderr, "no memory\n");
    std::exit(3);
}

inline void device_free(void *memory) { std::free(memory); }
inline void device_wait() {}
inline void device_fill(void *memory, int byte, size_t bytes) { std::memset(memory, byte, bytes); }
inline void to_host(void *host, const void *device, size_t bytes) { std::memcpy(host, device, bytes); }
inline void to_device(void *device, const void *host, size_t bytes) { std::memcpy(device, host, bytes); }

template <class... Formal, class... Actual>
void launch(void (*kernel)(int, Formal...), int n, Actual... arguments) {
    kernel(n, arguments...);
}
#endif
#endif
