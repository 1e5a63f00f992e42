/* grid.cu - times two kernels of GRiD (A2R-Lab, github.com/A2R-Lab/GRiD) on random states, without copies:
   those of a grid.cuh that its generator wrote. Compares them first with code of rbd-codegen in double, of
   the same URDF file. GRiD has a block a state, as in its own benchmark, or as many blocks as the card
   holds at once; the faster counts. SPDX-License-Identifier: MIT */
#include "grid.cuh"

#include "../../tests/larger.h"
#include "device.h"
#include "report.h"
#include "states.h"

#include REFERENCE_HEADER

#include <cmath>

typedef grid::robotModel<float> grid_model;

enum { NV = grid::NUM_JOINTS, MATRIX = NV * NV };

static const float gravity = 9.81f;

struct inverse_dynamics {
    enum { SIZE = NV, BYTES = 4 * (4 * NV), SHARED = 4 * grid::ID_DYNAMIC_SHARED_MEM_COUNT };
    static const char *name() { return "id"; }

    static void (*kernel())(float *, const float *, int, const float *, const grid_model *, float, int) {
        return grid::inverse_dynamics_kernel<float>;
    }

    static void launch(int blocks, int n, float *tau, const float *state, const float *a,
                       const grid_model *model) {
        kernel()<<<blocks, grid::SUGGESTED_THREADS, SHARED>>>(tau, state, 3 * NV, a, model, gravity, n);
    }

    static void expect(const double (*x)[NV], double *tau) { REFERENCE(id)(x[0], x[1], x[2], tau); }
};

struct gradient {
    enum {
        SIZE = 2 * MATRIX,
        BYTES = 4 * (3 * NV + SIZE),
        SHARED = 4 * grid::FD_DU_DYNAMIC_SHARED_MEM_COUNT
    };
    static const char *name() { return "fd_derivatives"; }

    static void (*kernel())(float *, const float *, int, const grid_model *, float, int) {
        return grid::forward_dynamics_gradient_kernel<float>;
    }

    static void launch(int blocks, int n, float *da, const float *state, const float *,
                       const grid_model *model) {
        kernel()<<<blocks, grid::SUGGESTED_THREADS, SHARED>>>(da, state, 3 * NV, model, gravity, n);
    }

    /* da_dq, then da_dv, each column after column */
    static void expect(const double (*x)[NV], double *da) {
        double a[NV], da_dq[MATRIX], da_dv[MATRIX], inverse[MATRIX];
        REFERENCE(fd_derivatives)(x[0], x[1], x[2], a, da_dq, da_dv, inverse);
        for (int row = 0; row < NV; ++row)
            for (int column = 0; column < NV; ++column) {
                da[column * NV + row] = da_dq[row * NV + column];
                da[MATRIX + column * NV + row] = da_dv[row * NV + column];
            }
    }
};

/* Rows of `arrays` random vectors each, beginning with the argument `first` of a call. */
static float *random_rows(int n, int arrays, int first) {
    std::vector<float> rows;
    for (int i = 0; i < n; ++i)
        for (int array = first; array < first + arrays; ++array)
            for (int k = 0; k < NV; ++k)
                rows.push_back(random_component<float>(array, false, (uint64_t)i, k));
    float *device = (float *)device_allocate(rows.size() * sizeof(float));
    to_device(device, rows.data(), rows.size() * sizeof(float));
    return device;
}

template <class Call> double error_of_state(int i, const float *result) {
    double x[3][NV];
    double expected[Call::SIZE];
    double largest = 1e-30;
    double error = 0;
    for (int array = 0; array < 3; ++array)
        for (int k = 0; k < NV; ++k)
            x[array][k] = (double)random_component<float>(array, false, (uint64_t)i, k);
    Call::expect(x, expected);
    for (int k = 0; k < Call::SIZE; ++k) {
        const double difference = std::fabs((double)result[k] - expected[k]);
        largest = larger(largest, std::fabs(expected[k]));
        error = larger(error, difference);
    }
    return error / largest;
}

/* Blocks of the kernel that the card holds at once. */
template <class Call> int resident_blocks() {
    int each = 0;
    cudaDeviceProp card;
    CHECK(cudaGetDeviceProperties(&card, 0));
    CHECK(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&each, Call::kernel(), grid::SUGGESTED_THREADS,
                                                        Call::SHARED));
    return each * card.multiProcessorCount;
}

/* True if right. */
template <class Call>
bool run(const options &o, const float *state, const float *a, const grid_model *model) {
    enum { CHECKED = 1000 };
    const int resident = resident_blocks<Call>();
    float *result = (float *)device_allocate((size_t)o.most_states * Call::SIZE * sizeof(float));
    std::vector<float> host((size_t)CHECKED * Call::SIZE);
    double error = 0;
    device_poison(result, host.size() * sizeof(float));
    Call::launch(CHECKED, CHECKED, result, state, a, model);
    CHECK(cudaGetLastError());
    device_wait();
    to_host(host.data(), result, host.size() * sizeof(float));
    for (int i = 0; i < CHECKED; ++i) {
        const double own = error_of_state<Call>(i, &host[(size_t)i * Call::SIZE]);
        error = larger(error, own);
    }
    const bool right = error < 1e-2;
    for (int n = o.least_states; n <= o.most_states; n *= 4) {
        double seconds = 1e30;
        for (int blocks : {n, std::min(n, resident)})
            seconds = std::min(seconds, median_seconds(o.groups, o.least_seconds, [&](int) {
                                   Call::launch(blocks, n, result, state, a, model);
                               }));
        CHECK(cudaGetLastError());
        print_row("grid", Call::name(), "rows", n, error, right, seconds, Call::BYTES);
    }
    device_free(result);
    return right;
}

int main(int argc, char **argv) {
    options o(argc, argv);
    o.most_states = std::min(o.most_states, 1 << 20);
    const grid_model *model = grid::init_robotModel<float>();
    const float *state = random_rows(o.most_states, 3, 0);
    const float *a = random_rows(o.most_states, 1, 2);
    const bool torques = run<inverse_dynamics>(o, state, a, model);
    const bool derivatives = run<gradient>(o, state, a, model);
    return torques && derivatives ? 0 : 1;
}
