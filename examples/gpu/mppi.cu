/* mppi.cu - a cart swings up its pole, and the hand of an iiwa goes round a pillar: by thousands of
   simulated motions a tick, which call the code that rbd-codegen wrote for each robot (mppi.h).

       mppi [SAMPLES]            prints a table of the motions; 512 samples if it is not said
       mppi SAMPLES times        prints how long a tick takes

   SPDX-License-Identifier: MIT */
#include "cart_pole_code.cuh"
#include "iiwa_code.cuh"

#include "mppi.h"
#include "../larger.h"

#include <chrono>

/* The cart's motor is too weak to push the pole up at once. State: q, v; control: the force on the cart. */
struct swing_up {
    enum { NX = 4, NU = 1, KNOTS = 60 };
    float state[NX];

    static constexpr float dt = 0.02f;

    RBD_HD float limit(int) const { return 10; }
    RBD_HD float spread(int) const { return 4; }

    /* The pole hangs at an angle of 0. */
    RBD_HD float end(const float *x) const {
        const float high = 1 + cosf(x[1]);
        return 5 * high + 0.5f * x[0] * x[0] + 0.05f * (x[2] * x[2] + x[3] * x[3]);
    }

    RBD_HD float step(float *x, const float *u) const {
        const float tau[2] = {u[0], 0};
        float a[2];
        cart_pole::fd(x, x + 2, tau, a);
        for (int k = 0; k < 2; ++k) x[2 + k] += dt * a[k];
        for (int k = 0; k < 2; ++k) x[k] += dt * x[2 + k];
        return end(x);
    }
};

/* The hand goes to a target; on the straight way stands a pillar. Controls: torques beyond those that hold
   the arm. */
struct reach {
    enum { NX = 14, NU = 7, KNOTS = 30 };
    float state[NX];
    float held[NU];

    static constexpr float dt = 0.01f;

    RBD_HD float limit(int j) const { return j < 4 ? 40.0f : j < 5 ? 8.0f : j < 6 ? 4.0f : 0.2f; }
    RBD_HD float spread(int j) const { return 0.15f * limit(j); }

    /* Of the joints, N m s/rad. */
    RBD_HD static float damper(int j) { return j < 4 ? 2.0f : j < 6 ? 0.3f : 0.01f; }

    RBD_HD static void hand(const float *q, float *p) {
        float R[9];
        iiwa::pose_lbr_iiwa_link_7(q, R, p);
        for (int k = 0; k < 3; ++k) p[k] += 0.1f * R[3 * k + 2];
    }

    RBD_HD static float away(const float *p) {
        const float x = p[0] - 0.5f, y = p[1] - 0.4f, z = p[2] - 0.5f;
        return sqrtf(x * x + y * y + z * z);
    }

    /* From the axis of the pillar, whose radius is 0.12 m. */
    RBD_HD static float from_pillar(const float *p) {
        const float x = p[0] - 0.5f;
        return sqrtf(x * x + p[1] * p[1]);
    }

    RBD_HD float end(const float *x) const {
        float p[3];
        float slow = 0;
        hand(x, p);
        for (int k = 0; k < 7; ++k) slow += x[7 + k] * x[7 + k];
        return 30 * away(p) + 0.05f * slow + (from_pillar(p) < 0.14f ? 100.0f : 0.0f);
    }

    RBD_HD float step(float *x, const float *u) const {
        float tau[7], a[7];
        for (int k = 0; k < 7; ++k) tau[k] = held[k] + u[k] - damper(k) * x[7 + k];
        iiwa::fd(x, x + 7, tau, a);
        for (int k = 0; k < 7; ++k) x[7 + k] += dt * a[k];
        for (int k = 0; k < 7; ++k) x[k] += dt * x[7 + k];
        return end(x);
    }
};

enum { TICKS = 200 };

/* A robot that follows its controller, and the time that this takes. */
template <class P> struct run {
    P now;
    mppi<P> controller;
    float u[P::NU];
    double seconds = 0;

    run(const P &start, int samples, float temperature) : now(start), controller(samples, temperature) {}

    void tick() {
        const auto begin = std::chrono::steady_clock::now();
        controller.control(now, u);
        seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        now.step(now.state, u);
    }
};

/* Where the arm is, the torques that hold it there. */
static void hold(reach *arm) {
    const float still[7] = {};
    iiwa::id(arm->state, still, still, arm->held);
}

int main(int count, char **arguments) {
    const int samples = count > 1 ? atoi(arguments[1]) : 512;
    const bool timed = count > 2;
    if (samples < MPPI_CHUNKS) {
        fprintf(stderr, "mppi [SAMPLES [times]]: %d samples at least\n", MPPI_CHUNKS);
        return 2;
    }
    run<swing_up> cart({{0, 0, 0, 0}}, samples, 2);
    run<reach> arm({{-0.8f, 0.8f, 0, -1.4f, 0, 0.9f, 0}, {}}, samples, 2);
    float upright = 0, near = 0, nearest = 1;

    if (!timed) puts("tick,cart m,angle rad,force N,x m,y m,z m,away m");
    for (int tick = 0; tick < TICKS; ++tick) {
        float p[3];
        hold(&arm.now);
        cart.tick();
        arm.tick();
        reach::hand(arm.now.state, p);
        nearest = fminf(nearest, reach::from_pillar(p));
        if (tick >= TICKS / 4 * 3) {
            upright = largerf(upright, fabsf(cart.now.state[1] - 3.14159265f));
            near = largerf(near, reach::away(p));
        }
        if (timed) continue;
        printf("%d,%.3f,%.3f,%.2f,%.3f,%.3f,%.3f,%.3f\n", tick, cart.now.state[0], cart.now.state[1],
               cart.u[0], p[0], p[1], p[2], reach::away(p));
    }
    const bool right = fabsf(upright) < 0.2f && near < 0.03f && nearest > 0.12f;
    fprintf(stderr, "the pole stands in the last quarter, to 0.2 rad: %s\n", upright < 0.2f ? "yes" : "no");
    fprintf(stderr, "the hand is at the target, to 30 mm: %s; it went round the pillar: %s\n",
            near < 0.03f ? "yes" : "no", nearest > 0.12f ? "yes" : "no");
    if (timed)
        fprintf(stderr, "%d samples: a tick takes %.0f us (cart, 60 knots), %.0f us (iiwa, 30 knots)\n",
                samples, cart.seconds / TICKS * 1e6, arm.seconds / TICKS * 1e6);
    return right ? EXIT_SUCCESS : EXIT_FAILURE;
}
