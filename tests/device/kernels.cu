/* kernels.cu - rbd.h and its companions as code of a GPU, one state a thread. That nvcc compiles it, and
   clang without CUDA's headers and libraries, is half of the test. A compiler of C++ alone is told to be one
   for a GPU: then the kernels are loops, and main compares them with usual.c. */
#include "../larger.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#if defined __NVCC__
#define INDEX (blockIdx.x * blockDim.x + threadIdx.x)
#elif defined __CUDA__ || defined __HIP__
#define __global__ __attribute__((global))
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))
extern "C" { /* roots are instructions */
__device__ inline float sqrtf(float x) noexcept { return __builtin_elementwise_sqrt(x); }
__device__ inline double sqrt(double x) noexcept { return __builtin_elementwise_sqrt(x); }
}
#ifdef __HIP__
#define INDEX __builtin_amdgcn_workitem_id_x()
#else
#define INDEX __nvvm_read_ptx_sreg_tid_x()
#endif
#else
#define __CUDACC__
#define __global__ static
#define __host__
#define __device__
static unsigned INDEX;
#define LOOPS
#endif

#define RBD_REAL float
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#define HERE __host__ __device__ static
#include "calls.h"

#ifdef ONLY /* one kernel, for a compiler that takes long */
#undef EACH_CALL
#define EACH_CALL(CALL) CALL(ONLY, 0)
#endif

#define KERNEL(name, size) KERNEL_OF(name)
#define KERNEL_OF(name) \
    __global__ void name##_kernel(int n, const rbd_model *m, const state *s, float *out, int *status) { \
        const unsigned i = INDEX; \
        if (i < (unsigned)n) status[i] = name(m, &s[i], &out[i * LARGEST]); \
    }
EACH_CALL(KERNEL)

/* The table of a model is the GPU's too. */
__global__ void table_kernel(const state *s, float *out, int *status) {
    const unsigned i = INDEX;
    status[i] = inverse_dynamics(&hyq_model, &s[i], &out[i * LARGEST]);
}

#ifdef LOOPS
enum { STATES = 50 };
static state states[STATES];
static float results[STATES * LARGEST];
static int statuses[STATES];

static float number(unsigned *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (float)(*seed >> 8) / 8388608.0f - 1;
}

/* In a squat whose feet are about on the ground; every third in the air, and one turns many times. */
static void make_states(void) {
    unsigned seed = 1;
    for (int i = 0; i < STATES; ++i) {
        state *s = &states[i];
        for (int k = 0; k < NV; ++k) s->v[k] = number(&seed);
        for (int k = 0; k < NV; ++k) s->x[k] = 20 * number(&seed);
        for (int k = 7; k < NQ; ++k) {
            const float squat = k < 11 ? 0 : k < 15 ? 0.7f : -1.4f;
            s->q[k] = ((k - 7) % 4 < 2 ? squat : -squat) + 0.1f * number(&seed);
        }
        s->q[2] = i % 3 ? 0.51f : 2;
        for (int k = 3; k < 6; ++k) s->q[k] = 0.05f * number(&seed);
        s->q[6] = sqrtf(1 - s->q[3] * s->q[3] - s->q[4] * s->q[4] - s->q[5] * s->q[5]);
    }
    states[1].q[8] += 12000; /* an angle beyond the sine's limit */
}

/* Tells whether n results are the same, to the rounding of float, as those of the usual call. */
static int same(const char *name, int n, int (*usual)(const state *, float *)) {
    static float expected[LARGEST];
    double most = 0;
    int wrong = 0, moves = 0;

    for (int i = 0; i < STATES; ++i) {
        const float *y = &results[i * LARGEST];
        double scale = 0, error = 0;

        wrong += usual(&states[i], expected) != RBD_OK || statuses[i] != RBD_OK;
        for (int k = 0; k < n; ++k) {
            const double d = fabs((double)y[k] - expected[k]);
            scale = larger(scale, fabs(expected[k]));
            error = larger(error, d);
        }
        most = larger(most, error / scale);
        moves += i > 0 && memcmp(y, results, sizeof(float) * (size_t)n) != 0;
    }

    wrong += !(most < 2e-4) || moves < STATES - 1;
    printf("%-17s %4d results of %d states: %.1e%s\n", name, n, STATES, most, wrong ? "   WRONG" : "");
    return !wrong;
}

/* Tells whether feet push in many states: a third is in the air, and some lift off. */
static int pushes(void) {
    int pushing = 0;
    for (int i = 0; i < STATES; ++i) {
        const float *impulse = &results[i * LARGEST + NQ + NV];
        pushing += impulse[2] + impulse[5] + impulse[8] + impulse[11] > 0;
    }
    return pushing > STATES / 3 && pushing < STATES;
}

/* The model, as one built at run time in memory that host and GPU see. */
static const rbd_model *built(void) {
    static unsigned char memory_of_model[RBD_MODEL_SIZE(HYQ_NB)];
    const rbd_model *m = NULL;
    rbd_body bodies[HYQ_NB];
    for (int i = 0; i < HYQ_NB; ++i) rbd_describe(&hyq_model, i, &bodies[i]);
    rbd_model_build(bodies, HYQ_NB, memory_of_model, sizeof memory_of_model, &m, NULL);
    return m;
}

#define DECLARE(name, size) extern "C" int usual_##name(const state *s, float *out);
EACH_CALL(DECLARE)

int main(void) {
    const rbd_model *const m = built();
    int right = m != NULL;

    make_states();
#define COMPARE(name, size) \
    for (INDEX = 0; m && INDEX < STATES; ++INDEX) name##_kernel(STATES, m, states, results, statuses); \
    right &= same(#name, size, usual_##name);
    EACH_CALL(COMPARE)
    right &= pushes();

    for (INDEX = 0; INDEX < STATES; ++INDEX) table_kernel(states, results, statuses);
    right &= same("table", NV, usual_inverse_dynamics);
    return !right;
}
#endif
