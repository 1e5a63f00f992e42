/* falling.cu - a thousand HyQs, each a little different, drop on four feet and stand: rbd_contact_step on a
   GPU, one robot a thread, all steps in one launch. The same steps on the host say whether it is right.

       nvcc -O3 -arch=sm_90 -I. examples/gpu/falling.cu -o falling
       g++ -x c++ -O2 -I. examples/gpu/falling.cu -o falling       # without a GPU: the kernel is a loop
       ./falling [robots [steps [threads in a block [blocks]]]]

   Two things decide the speed on a GPU; docs/gpu.md has the figures. A step is half a megabyte of
   instructions, which warps that drift apart fetch each for itself: so blocks are large, and their warps wait
   for each other at each step. And a thread's memory is 18 kB: so there are no more threads than the
   multiprocessors hold at once, and a thread has several robots, one after the other. */
#include "../larger.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __CUDACC__
#define BOTH __host__ __device__
#ifdef __CUDA_ARCH__
#define MEET() __syncthreads() /* all warps of the block wait here for the last */
#else
#define MEET()
#endif
#else /* the words of CUDA that are used here, for the host alone */
#define BOTH
#define MEET()
#define __global__ static
#define __launch_bounds__(...)
static struct {
    unsigned x;
} threadIdx, blockIdx, blockDim, gridDim;
#endif
#include <chrono>

#define RBD_REAL float
#define RBD_STATIC   /* code of a GPU lies in the file that calls it */
#define RBD_NO_BUILD /* the model is a table, which host and GPU have both */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "rbd_contact.h"
#include "models/hyq_model.h"

#ifndef FALLING_THREADS /* in a block: with 168 registers each, all that a multiprocessor has */
#define FALLING_THREADS 384
#endif

enum { FEET = 4, BASE = 6, LEGS = HYQ_NV - BASE, BOUNDED = 0, IDLE = 1 };

/* A robot's state and what became of it. */
typedef struct robot {
    float q[HYQ_NQ], v[HYQ_NV];
    int status;
} robot;

/* The memory of one robot: on a GPU it is local memory, which the hardware interleaves. */
typedef struct memory {
    rbd_work *w;
    rbd_contact_set *c;
    alignas(64) unsigned char work[HYQ_WORK_SIZE];
    alignas(64) unsigned char set[RBD_CONTACT_SET_SIZE(HYQ_NV, FEET, BOUNDED)];
} memory;

BOTH static rbd_status begin(memory *at) {
    rbd_contact foot[FEET] = {};
    rbd_status status = rbd_work_init(&hyq_model, at->work, sizeof at->work, &at->w);

    for (int k = 0; k < FEET; ++k) {
        foot[k].body1 = HYQ_BODY_LF_LOWERLEG + k;
        foot[k].body2 = -1;
        foot[k].point[0] = 0.33;
        foot[k].friction = 0.7;
    }

    if (status) return status;
    return rbd_contact_set_init(&hyq_model, at->w, foot, FEET, NULL, 0, NULL, at->set, sizeof at->set, &at->c,
                                NULL);
}

/* The angle of a leg's joint in the squat: hip out 0, hip 0.7, knee -1.4 rad; hind legs are mirrored. */
BOTH static float squat(int joint) {
    const float angle = joint < 4 ? 0 : joint < 8 ? 0.7f : -1.4f;
    return joint % 4 < 2 ? angle : -angle;
}

/* So many steps of dt. Springs and dampers in the legs hold the squat. */
BOTH static void fall(robot *r, rbd_contact_set *c, int steps, float dt) {
    const float stiffness = 300, damper = 10; /* N m/rad, N m s/rad */
    float tau[HYQ_NV] = {}, damping[HYQ_NV] = {};

    for (int k = 0; k < LEGS; ++k) damping[BASE + k] = damper + dt * stiffness / 2;
    if (!r->status) rbd_contact_reset(c);

    for (int s = 0; s < steps; ++s) {
        MEET();
        if (r->status) continue;

        for (int k = 0; k < LEGS; ++k) tau[BASE + k] = stiffness * (squat(k) - r->q[BASE + 1 + k]);
        r->status = rbd_contact_step(&hyq_model, c, r->q, r->v, tau, NULL, damping, dt, r->q, r->v);
    }
}

/* Numbers of all robots: component k of robot i is x[k * n + i], so that neighbours in a warp are neighbours
   in memory. */
BOTH static void get(robot *r, int n, int i, const float *q, const float *v) {
    for (int k = 0; k < HYQ_NQ; ++k) r->q[k] = q[(size_t)k * n + i];
    for (int k = 0; k < HYQ_NV; ++k) r->v[k] = v[(size_t)k * n + i];
}

BOTH static void put(const robot *r, int n, int i, float *q, float *v) {
    for (int k = 0; k < HYQ_NQ; ++k) q[(size_t)k * n + i] = r->q[k];
    for (int k = 0; k < HYQ_NV; ++k) v[(size_t)k * n + i] = r->v[k];
}

/* A thread's memory is made ready once, for all its robots and steps. All threads of a block take as many
   robots, since they wait for each other: those beyond the last are idle. */
__global__ void __launch_bounds__(FALLING_THREADS)
    fall_kernel(int n, int steps, float dt, float *q, float *v, int *status) {
    const int own = (int)(blockIdx.x * blockDim.x + threadIdx.x), all = (int)(gridDim.x * blockDim.x);
    memory at;
    robot r;
    const rbd_status ready = begin(&at);

    for (int first = 0; first < n; first += all) {
        const int i = first + own;

        r.status = i < n ? (int)ready : (int)IDLE;
        if (i < n) get(&r, n, i, q, v);
        fall(&r, at.c, steps, dt);
        if (i >= n) continue;
        put(&r, n, i, q, v);
        status[i] = r.status;
    }
}

/* ---- the host ---- */

#ifdef __CUDACC__
static void check(cudaError_t error) {
    if (error == cudaSuccess) return;
    fprintf(stderr, "%s\n", cudaGetErrorString(error));
    exit(EXIT_FAILURE);
}

/* An array of the host on the device. */
template <class T> static T *to_device(const T *x, size_t n) {
    void *p = NULL;
    check(cudaMalloc(&p, n * sizeof(T)));
    check(cudaMemcpy(p, x, n * sizeof(T), cudaMemcpyHostToDevice));
    return (T *)p;
}

template <class T> static void to_host(T *x, T *on_device, size_t n) {
    check(cudaMemcpy(x, on_device, n * sizeof(T), cudaMemcpyDeviceToHost));
    check(cudaFree(on_device));
}

/* Returns the seconds that the launch took, without copies. */
static double run(int blocks, int threads, int n, int steps, float dt, float *q, float *v, int *status) {
    float *const own_q = to_device(q, (size_t)n * HYQ_NQ), *const own_v = to_device(v, (size_t)n * HYQ_NV);
    int *const own_status = to_device(status, (size_t)n);
    const auto began = std::chrono::steady_clock::now();

    fall_kernel<<<blocks, threads>>>(n, steps, dt, own_q, own_v, own_status);
    check(cudaGetLastError());
    check(cudaDeviceSynchronize());

    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    to_host(q, own_q, (size_t)n * HYQ_NQ);
    to_host(v, own_v, (size_t)n * HYQ_NV);
    to_host(status, own_status, (size_t)n);
    return took.count();
}

static int multiprocessors(void) {
    cudaDeviceProp p;
    check(cudaGetDeviceProperties(&p, 0));
    return p.multiProcessorCount;
}

static void print_device(void) {
    cudaDeviceProp p;
    cudaFuncAttributes f;
    check(cudaGetDeviceProperties(&p, 0));
    check(cudaFuncGetAttributes(&f, fall_kernel));
    printf("%s, %d multiprocessors; %d registers, %zu bytes of local memory a thread\n", p.name,
           p.multiProcessorCount, f.numRegs, f.localSizeBytes);
}
#else
static double run(int blocks, int threads, int n, int steps, float dt, float *q, float *v, int *status) {
    const auto began = std::chrono::steady_clock::now();

    gridDim.x = (unsigned)blocks;
    blockDim.x = (unsigned)threads;
    for (blockIdx.x = 0; blockIdx.x < gridDim.x; ++blockIdx.x)
        for (threadIdx.x = 0; threadIdx.x < blockDim.x; ++threadIdx.x)
            fall_kernel(n, steps, dt, q, v, status);

    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

static int multiprocessors(void) { return 1; }

static void print_device(void) { printf("no GPU: a loop on the host\n"); }
#endif

/* A number in -1 .. 1 that looks like chance. */
static float spread(int i, int k) { return (float)((i * 97 + k * 31) % 1009) / 504.5f - 1; }

/* Robot i: squatting, its feet a few centimetres above the ground. */
static robot start(int i) {
    robot r = {};
    for (int k = 0; k < HYQ_NV; ++k) r.v[k] = 0.1f * spread(i, k);
    for (int k = 0; k < LEGS; ++k) r.q[BASE + 1 + k] = squat(k) + 0.1f * spread(i, 20 + k);
    for (int k = 0; k < 3; ++k) r.q[HYQ_Q_ROOT_QX + k] = 0.03f * spread(i, 40 + k);
    r.q[HYQ_Q_ROOT_QW] = 1;
    r.q[HYQ_Q_ROOT_Z] = 0.62f + 0.03f * spread(i, 50);
    return r;
}

static float difference(const robot *a, const robot *b) {
    float most = 0;
    for (int k = 0; k < HYQ_NQ; ++k) most = largerf(most, fabsf(a->q[k] - b->q[k]));
    return most;
}

/* Compares some robots with the same steps on the host, in the mean and at most. */
static void compare(int n, int every, int steps, float dt, const float *q, const float *v, double *mean,
                    double *most) {
    static memory at;
    int compared = 0;

    *mean = *most = 0;
    for (int i = 0; i < n; i += every, ++compared) {
        robot r, host = start(i);
        float d;

        get(&r, n, i, q, v);
        host.status = begin(&at);
        fall(&host, at.c, steps, dt);
        d = difference(&r, &host);
        *mean += d;
        *most = larger(*most, d);
    }
    *mean /= compared;
}

/* Threads of a block: few robots are spread over all multiprocessors, a warp of 32 at least. */
static int usual_threads(int n) {
    const int share = (n + multiprocessors() - 1) / multiprocessors(), warps = (share + 31) / 32;
    return 32 * warps < FALLING_THREADS ? 32 * warps : FALLING_THREADS;
}

/* Blocks: one on each multiprocessor, or fewer if there are no more robots. */
static int usual_blocks(int n, int threads) {
    const int needed = (n + threads - 1) / threads;
    return needed < multiprocessors() ? needed : multiprocessors();
}

int main(int argc, char **argv) {
    const int n = argc > 1 ? atoi(argv[1]) : 1000, steps = argc > 2 ? atoi(argv[2]) : 1000;
    const int threads = argc > 3 ? atoi(argv[3]) : usual_threads(n);
    const int blocks = argc > 4 ? atoi(argv[4]) : usual_blocks(n, threads);
    const float dt = 1e-3f;
    float *const q = (float *)calloc((size_t)n * HYQ_NQ, sizeof *q);
    float *const v = (float *)calloc((size_t)n * HYQ_NV, sizeof *v);
    int *const status = (int *)calloc((size_t)n, sizeof *status);
    int failed = 0, fallen = 0;
    double mean, most;

    print_device();
    for (int i = 0; i < n; ++i) {
        const robot r = start(i);
        put(&r, n, i, q, v);
    }

    run(blocks, threads, n, 0, dt, q, v, status); /* what is done once only: memory, code */
    const double took = run(blocks, threads, n, steps, dt, q, v, status);

    for (int i = 0; i < n; ++i) {
        const float height = q[(size_t)HYQ_Q_ROOT_Z * n + i];
        failed += status[i] != RBD_OK;
        fallen += !(height > 0.4f && height < 0.7f);
    }
    compare(n, n > 100 ? n / 100 : 1, steps, dt, q, v, &mean, &most);

    printf("%d robots, %d steps of %g s, %d blocks of %d threads: %.3g s, %.4g steps/s\n", n, steps, dt,
           blocks, threads, took, (double)n * steps / took);
    printf("%d failed, %d do not stand; q differs from the host's by %.1e in the mean, %.1e at most\n",
           failed, fallen, mean, most);
    return failed || fallen || !(most < 1e-4) ? EXIT_FAILURE : EXIT_SUCCESS;
}
