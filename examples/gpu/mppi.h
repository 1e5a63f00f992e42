/* mppi.h - model predictive path integral control (Williams, Aldrich, Theodorou 2017) on a GPU, or by
   loops without one.

   Each tick tries many sequences of controls, the plan with noise, each simulated by one thread; the new
   plan is their mean with weights exp(-cost / temperature). A problem is a struct that kernels get by
   value:

       enum { NX, NU, KNOTS };                                 numbers of the state and of controls; knots
       float state[NX];                                        where the plan begins
       RBD_HD float limit(int j) const, spread(int j) const;   largest control j, the noise's deviation
       RBD_HD float step(float *x, const float *u) const;      moves x by one knot; returns what that costs
       RBD_HD float end(const float *x) const;                 cost of the last state

   Include it behind generated code, whose macros it uses. SPDX-License-Identifier: MIT */
#ifndef MPPI_H
#define MPPI_H

#include "device.h"

#include <math.h>

enum { MPPI_CHUNKS = 64 }; /* parts of a sum over all samples */

/* Noise of variance 1: the sum of three uniform numbers, which follow from where they are used. */
RBD_HD float mppi_noise(unsigned tick, unsigned sample, unsigned place) {
    unsigned long long h =
        tick * 0x9e3779b97f4a7c15ull + sample * 0xc2b2ae3d27d4eb4full + place * 0x165667b19e3779f9ull;
    h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93ull;
    h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93ull;
    const int sum = (int)(h & 0xfffff) + (int)(h >> 20 & 0xfffff) + (int)(h >> 40 & 0xfffff);
    return (float)(sum - 3 * (1 << 19)) * (1.0f / (1 << 19));
}

/* Control j of a knot in a sample; sample 0 is the plan itself. */
template <class P>
RBD_HD float mppi_control(const P &problem, const float *plan, unsigned tick, int sample, int knot, int j) {
    const int place = knot * P::NU + j;
    const float limit = problem.limit(j);
    const float noise = sample == 0 ? 0 : mppi_noise(tick, (unsigned)sample, (unsigned)place);
    const float u = plan[place] + problem.spread(j) * noise;
    return u > limit ? limit : u < -limit ? -limit : u;
}

/* The cost of each sample. One thread simulates its whole motion. */
template <class P> RBD_KERNEL mppi_sample(int n, P problem, unsigned tick, const float *plan, float *cost) {
    RBD_EACH_STATE(i, n) {
        float x[P::NX], u[P::NU];
        float sum = 0;
        for (int k = 0; k < P::NX; ++k) x[k] = problem.state[k];
        for (int knot = 0; knot < P::KNOTS; ++knot) {
            for (int j = 0; j < P::NU; ++j) u[j] = mppi_control(problem, plan, tick, i, knot, j);
            sum += problem.step(x, u);
        }
        cost[i] = sum + problem.end(x);
    }
}

/* The least cost of each chunk of n samples: every sample whose number is that of the chunk, modulo the
   chunks. */
template <class P> RBD_KERNEL mppi_least(int chunks, int n, const float *cost, float *least) {
    RBD_EACH_STATE(chunk, chunks) {
        float lowest = cost[chunk];
        for (int i = chunk; i < n; i += MPPI_CHUNKS) lowest = fminf(lowest, cost[i]);
        least[chunk] = lowest;
    }
}

/* For a chunk and a place in the plan: the weighted sum of the controls; for the place behind the last: of
   the weights. */
template <class P>
RBD_KERNEL mppi_sum(int all, P problem, unsigned tick, int n, float temperature, const float *plan,
                    const float *cost, const float *least, float *sums) {
    RBD_EACH_STATE(thread, all) {
        const int chunk = thread % MPPI_CHUNKS, place = thread / MPPI_CHUNKS;
        const int knot = place / P::NU, j = place % P::NU;
        float lowest = least[0], sum = 0;
        for (int k = 1; k < MPPI_CHUNKS; ++k) lowest = fminf(lowest, least[k]);
        for (int i = chunk; i < n; i += MPPI_CHUNKS) {
            const float weight = expf((lowest - cost[i]) / temperature);
            if (weight > 1e-6f)
                sum += weight * (knot == P::KNOTS ? 1 : mppi_control(problem, plan, tick, i, knot, j));
        }
        sums[thread] = sum;
    }
}

/* The plan of the next tick, which begins one knot later, behind the controls of now. */
template <class P> RBD_KERNEL mppi_mean(int places, const float *sums, float *plan, float *now) {
    RBD_EACH_STATE(place, places) {
        float sum = 0, weights = 0;
        for (int k = 0; k < MPPI_CHUNKS; ++k) {
            sum += sums[place * MPPI_CHUNKS + k];
            weights += sums[P::NU * P::KNOTS * MPPI_CHUNKS + k];
        }
        const float u = sum / weights;
        if (place < P::NU)
            now[place] = u;
        else
            plan[place - P::NU] = u;
        if (place >= P::NU * (P::KNOTS - 1)) plan[place] = u;
    }
}

/* A plan and the memory for so many samples, on the device. */
template <class P> class mppi {
    enum { PLACES = P::NU * P::KNOTS, SUMS = (PLACES + 1) * MPPI_CHUNKS };
    int samples;
    float temperature;
    unsigned tick;
    float *plan, *now, *cost, *least, *sums;

  public:
    mppi(int of_samples, float of_weights) : samples(of_samples), temperature(of_weights), tick(0) {
        const size_t numbers = PLACES + P::NU + MPPI_CHUNKS + SUMS + (size_t)samples;
        plan = (float *)device_allocate(numbers * sizeof(float));
        device_fill(plan, 0, numbers * sizeof(float));
        now = plan + PLACES;
        least = now + P::NU;
        sums = least + MPPI_CHUNKS;
        cost = sums + SUMS;
    }

    ~mppi() { device_free(plan); }
    mppi(const mppi &) = delete;
    mppi &operator=(const mppi &) = delete;

    /* The controls of this tick: NU numbers. */
    void control(const P &problem, float *u) {
        ++tick;
        launch(mppi_sample<P>, samples, problem, tick, plan, cost);
        launch(mppi_least<P>, MPPI_CHUNKS, samples, cost, least);
        launch(mppi_sum<P>, SUMS, problem, tick, samples, temperature, plan, cost, least, sums);
        launch(mppi_mean<P>, PLACES, sums, plan, now);
        to_host(u, now, P::NU * sizeof(float));
    }
};
#endif
