/* The C++ of docs/gpu.md, without a GPU: test.sh makes guide_N.h of its blocks, with launches as calls. The
   rollout is the same in each layout; torques are those of a kernel's one thread.
   SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* What is CUDA's in the guide. */
typedef void *cudaStream_t;
#define __global__ static
static struct {
    unsigned x;
} threadIdx, blockIdx, blockDim;

static int cudaMallocManaged(void **memory, size_t size) {
    *memory = malloc(size);
    return *memory == NULL;
}

#include "guide_1.h"
#include "guide_2.h"

#include "guide_3.h"
#include "guide_4.h"

enum { N = 3, JOINTS = 7, PLACES = 32 * JOINTS };

/* Where number k of state i is, in an array of each layout. */
static int at_rows(int i, int k) { return JOINTS * i + k; }
static int at_blocks(int i, int k) { return 32 * k + i; }
static int at_columns(int i, int k) { return N * k + i; }

/* Component k of state i of some array. */
static float number(int i, int k, int array) { return sinf((float)(1 + i + 5 * k + 11 * array)); }

template <class L> static void roll(int (*place)(int, int), float *end) {
    float q[PLACES] = {}, v[PLACES] = {}, tau[PLACES] = {}, q_end[PLACES] = {};
    for (int i = 0; i < N; ++i)
        for (int k = 0; k < JOINTS; ++k) {
            q[place(i, k)] = number(i, k, 0);
            v[place(i, k)] = number(i, k, 1);
            tau[place(i, k)] = number(i, k, 2);
        }
    rollout<L>(N, 10, 1e-3f, q, v, tau, q_end);
    for (int i = 0; i < N; ++i)
        for (int k = 0; k < JOINTS; ++k) end[JOINTS * i + k] = q_end[place(i, k)];
}

static float difference(const float *a, const float *b, int n) {
    float most = 0;
    for (int k = 0; k < n; ++k)
        if (!(fabsf(a[k] - b[k]) <= most)) most = fabsf(a[k] - b[k]);
    return most;
}

static int failed(const char *what, bool right) {
    if (!right) printf("FAILED: %s\n", what);
    return !right;
}

/* Ten steps from q with v differ from q + 0.01 v by half of the acceleration's 0.01^2 and a little. */
static int rollouts(void) {
    float rows[N * JOINTS], other[N * JOINTS], straight[N * JOINTS];
    int failures = 0;
    roll<rbd::rows>(at_rows, rows);
    roll<rbd::blocks>(at_blocks, other);
    failures += failed("rows and blocks", difference(rows, other, N * JOINTS) < 1e-6f);
    roll<rbd::columns>(at_columns, other);
    failures += failed("rows and columns", difference(rows, other, N * JOINTS) < 1e-6f);
    for (int i = 0; i < N; ++i)
        for (int k = 0; k < JOINTS; ++k) straight[JOINTS * i + k] = number(i, k, 0) + 0.01f * number(i, k, 1);
    const float moved = difference(rows, straight, N * JOINTS);
    return failures + failed("a rollout falls", moved > 1e-6f && moved < 1);
}

/* The kernel of accelerate is called as a function of the host. */
static int accelerations(void) {
    float q[JOINTS] = {}, v[JOINTS] = {}, tau[JOINTS] = {}, a[JOINTS];
    int status = 1;
    a[1] = NAN;
    q[1] = 0.5f;
    accelerate(1, q, v, tau, a, &status, NULL);
    return failed("a falling arm", status == 0 && fabsf(a[1]) > 0.1f);
}

/* A chain of rods of 1 m and 1 kg about y: the first joint bears a torque of 9.81 (0.5 + 1.5 + ... + 6.5) N m
   where they lie in the horizontal. */
static int torques_of_rods(void) {
    const float expected = 9.81f * 24.5f;
    rbd_body bodies[JOINTS] = {};
    float q[JOINTS] = {}, tau[JOINTS] = {};
    for (int k = 0; k < JOINTS; ++k) {
        bodies[k].parent = k - 1;
        bodies[k].type = RBD_REVOLUTE;
        bodies[k].axis[1] = 1;
        if (k) bodies[k].position[0] = 1;
        bodies[k].mass = 1;
        bodies[k].com[0] = 0.5f;
        bodies[k].inertia[0] = bodies[k].inertia[3] = bodies[k].inertia[5] = 1.f / 12;
    }
    const rbd_model *m = arm(bodies);
    if (!m) return failed("an arm is built", false);
    torques(m, q, tau);
    return failed("torques of an arm", fabsf(fabsf(tau[0]) - expected) < 1e-3f * expected);
}

int main(void) { return rollouts() + accelerations() + torques_of_rods() ? EXIT_FAILURE : EXIT_SUCCESS; }
