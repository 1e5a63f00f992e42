/* test_estimate.c - rbd_estimate.h: external torques, friction and payload, against simulated truths, and the
   estimate against the conditions of its optimum. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "rbd_estimate.h"

#include "models/hyq.h"
#include "models/iiwa.h"
#include "suites.h"
#include "support.h"

enum { ARM = IIWA_NV, HAND = IIWA_NB - 1 };

/* ---- a payload, as ten parameters ---- */

typedef struct thing {
    double mass, com[3], inertia[6];
} thing;

static const thing box = {2.5, {0.02, -0.03, 0.11}, {0.012, 0, 0.001, 0.010, 0, 0.006}};

static void parameters_of(const thing *t, double pi[10]) {
    const double m = t->mass, *c = t->com, *I = t->inertia;
    const double cc = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
    pi[0] = m;
    for (int k = 0; k < 3; k++) pi[1 + k] = m * c[k];
    for (int i = 0, k = 0; i < 3; i++)
        for (int j = i; j < 3; j++, k++) pi[4 + k] = I[k] + m * ((i == j ? cc : 0) - c[i] * c[j]);
}

/* ---- an observer beside its own formula ---- */

/* p = M v and C'v - g of a state, by the matrices. */
static void momentum(const robot *r, const double *q, const double *v, double *p, double *rate) {
    static double M[MAX_V * MAX_V], C[MAX_V * MAX_V];
    static rbd_derivatives *d;
    double g[MAX_V];
    void *memory = malloc(rbd_derivatives_size(r->m));

    ck_assert_int_eq(rbd_derivatives_init(r->m, r->w, memory, rbd_derivatives_size(r->m), &d), RBD_OK);
    ck_assert_int_eq(rbd_crba(r->m, r->w, q, M), RBD_OK);
    ck_assert_int_eq(rbd_coriolis(r->m, d, q, v, C), RBD_OK);
    ck_assert_int_eq(rbd_gravity_torque(r->m, r->w, q, g), RBD_OK);
    multiply(M, v, r->nv, r->nv, p);
    for (int i = 0; i < r->nv; i++) {
        rate[i] = -g[i];
        for (int k = 0; k < r->nv; k++) rate[i] += C[k * r->nv + i] * v[k];
    }
    free(memory);
}

/* A run of an observer on made-up motions: in each tick the motors' torques are such that `outside` acts. */
typedef struct run {
    const robot *r;
    rbd_observer *observer;
    void *memory;
    rbd_observer_options options;
    uint64_t seed;
    double dt, q[MAX_Q], v[MAX_V], p[MAX_V], rate[MAX_V]; /* of the last tick */
    double tau[MAX_V], outside[MAX_V], felt[MAX_V], band[MAX_V];
} run;

static void run_begin(run *x, const robot *r, double gain, double dt, const double *q) {
    memset(x, 0, sizeof *x);
    x->r = r;
    x->options.gain = gain;
    x->dt = dt;
    x->seed = 5;
    memcpy(x->q, q, (size_t)r->nq * sizeof *q);
    x->memory = malloc(RBD_OBSERVER_SIZE((size_t)r->nv));
}

static void run_init(run *x) {
    ck_assert_uint_eq(rbd_observer_size(x->r->m), RBD_OBSERVER_SIZE((size_t)x->r->nv));
    ck_assert_int_eq(
        rbd_observer_init(x->r->m, &x->options, x->memory, rbd_observer_size(x->r->m), &x->observer, NULL),
        RBD_OK);
    momentum(x->r, x->q, x->v, x->p, x->rate);
    ck_assert_int_eq(
        rbd_observer_step(x->r->m, x->r->w, x->observer, x->q, x->v, x->tau, x->dt, x->felt, x->band, NULL),
        RBD_OK);
    ck_assert(largest(x->felt, x->r->nv) <= 0);
}

/* Goes on to a state with velocity v: tau = dp/dt - mean of C'v - g - outside + friction. */
static void run_tick(run *x, const double *v, const double *friction) {
    double p[MAX_V], rate[MAX_V];
    const int nv = x->r->nv;

    memcpy(x->v, v, (size_t)nv * sizeof *v);
    ck_assert_int_eq(rbd_integrate(x->r->m, x->q, v, x->dt, x->q), RBD_OK);
    momentum(x->r, x->q, v, p, rate);
    for (int i = 0; i < nv; i++) {
        x->tau[i] = (p[i] - x->p[i]) / x->dt - (rate[i] + x->rate[i]) / 2 - x->outside[i];
        if (friction) x->tau[i] += friction[i];
        x->p[i] = p[i];
        x->rate[i] = rate[i];
    }
    ck_assert_int_eq(
        rbd_observer_step(x->r->m, x->r->w, x->observer, x->q, v, x->tau, x->dt, x->felt, x->band, NULL),
        RBD_OK);
}

/* Each dof's r follows the torque as the filter does, for all types of joints. */
static void check_filter(const robot *r, const state *s, int number) {
    run x;
    double v[MAX_V], expected[MAX_V] = {0};
    run_begin(&x, r, 50, 0.01, s->q);
    memcpy(x.v, s->v, sizeof x.v);
    run_init(&x);
    for (int tick = 0; tick < 5; tick++) {
        for (int i = 0; i < r->nv; i++) {
            v[i] = uniform(&x.seed, -1, 1);
            x.outside[i] = uniform(&x.seed, -10, 10);
            expected[i] += 0.5 / 1.5 * (x.outside[i] - expected[i]); /* gain dt = 0.5 */
        }
        run_tick(&x, v, NULL);
        for (int i = 0; i < r->nv; i++) { /* rounding is that of p / dt */
            const double off = fabs(x.felt[i] - expected[i]), size = 10 + fabs(x.tau[i]) + fabs(x.p[i]) * 50;
            ck_assert_msg(off <= 1e-11 * (size + largest(x.p, r->nv) * 50 + largest(x.rate, r->nv)),
                          "%s %d: dof %d, tick %d: off by %g", r->name, number, i, tick, off);
        }
    }
    free(x.memory);
}

START_TEST(felt_torques_follow_as_a_filter) {
    for_random_trees(100, check_filter);
    for_random_states(2, check_filter);
}
END_TEST

/* gain dt = 5, at rest, 1 N m on each joint: r = 1 - 6^-n. */
START_TEST(any_gain_is_stable) {
    robot r = robot_build("iiwa", iiwa_bodies, IIWA_NB);
    const double q[ARM] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}, v[ARM] = {0};
    double share = 1;
    run x;
    run_begin(&x, &r, 5000, 1e-3, q);
    run_init(&x);
    for (int i = 0; i < ARM; i++) x.outside[i] = 1;
    for (int tick = 0; tick < 30; tick++) {
        share /= 6;
        run_tick(&x, v, NULL);
        for (int i = 0; i < ARM; i++) ck_assert(fabs(x.felt[i] - (1 - share)) < 1e-12);
    }
    ck_assert_int_eq(rbd_observer_reset(x.observer), RBD_OK);
    run_tick(&x, v, NULL);
    ck_assert(largest(x.felt, ARM) <= 0);
    run_tick(&x, v, NULL);
    for (int i = 0; i < ARM; i++) ck_assert(fabs(x.felt[i] - 5. / 6) < 1e-12);
    free(x.memory);
    robot_free(&r);
}
END_TEST

/* A wrench on the trunk of a robot that falls, with legs that swing: it is what the base's six dofs feel. */
START_TEST(a_floating_base_feels_a_wrench) {
    robot r = robot_build("hyq", hyq_bodies, HYQ_NB);
    const double dt = 1e-4;
    double q[MAX_Q], v[MAX_V] = {0}, tau[MAX_V] = {0}, a[MAX_V], felt[MAX_V], f_ext[6 * MAX_BODIES] = {0},
                     expected[MAX_V] = {0};
    const double wrench[6] = {3, -5, 2, 40, 10, -30};
    rbd_observer_options options = {.gain = 300};
    rbd_observer *o;
    void *memory = malloc(rbd_observer_size(r.m));

    memcpy(f_ext, wrench, sizeof wrench);
    memcpy(expected, wrench, sizeof wrench);
    ck_assert_int_eq(rbd_observer_init(r.m, &options, memory, rbd_observer_size(r.m), &o, NULL), RBD_OK);
    ck_assert_int_eq(rbd_neutral(r.m, q), RBD_OK);
    for (int i = 0; i < r.nv; i++) v[i] = sin(i);
    ck_assert_int_eq(rbd_observer_step(r.m, r.w, o, q, v, tau, dt, felt, NULL, NULL), RBD_OK);
    for (int tick = 0; tick < 1000; tick++) {
        for (int i = 6; i < r.nv; i++) tau[i] = 10 * sin(0.01 * tick + i);
        ck_assert_int_eq(rbd_aba(r.m, r.w, q, v, tau, f_ext, a), RBD_OK);
        ck_assert_int_eq(rbd_step(r.m, q, v, a, dt, q, v), RBD_OK);
        ck_assert_int_eq(rbd_observer_step(r.m, r.w, o, q, v, tau, dt, felt, NULL, NULL), RBD_OK);
    }
    for (int i = 0; i < r.nv; i++)
        ck_assert_msg(fabs(felt[i] - expected[i]) < 0.4, "dof %d: %g, not %g", i, felt[i], expected[i]);
    free(memory);
    robot_free(&r);
}
END_TEST

/* Friction that is known to a share of 0.2, at rest anything below it: r is off by no more than the band. */
START_TEST(the_band_has_what_friction_hides) {
    robot r = robot_build("iiwa", iiwa_bodies, IIWA_NB);
    const double q[ARM] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
    rbd_joint_friction known[ARM];
    double v[ARM], friction[ARM], expected[ARM] = {0}, nearest = 0;
    run x;
    run_begin(&x, &r, 100, 1e-3, q);
    for (int i = 0; i < ARM; i++) known[i] = (rbd_joint_friction){1 + i, 0.5 * i, 0.3 - 0.1 * i};
    x.options.friction = known;
    x.options.share = 0.2;
    run_init(&x);
    for (int tick = 0; tick < 2000; tick++) {
        for (int i = 0; i < ARM; i++) {
            const double before = x.v[i], wrong = uniform(&x.seed, -0.2, 0.2);
            const double phase = sin(0.01 * tick + i), slow = 0.02;
            const double side = (phase > 0.3) - (phase < -0.3);
            double dry;
            v[i] = side * (0.5 + 0.1 * i) + (side > 0 || side < 0 ? 0 : 0.01);
            dry = fabs(v[i]) > slow && fabs(before) > slow && v[i] * before > 0
                      ? (1 + wrong) * side
                      : (tick / 300 % 2 ? 1 : -1) * 1.2; /* at rest, or on the way there */
            friction[i] = known[i].coulomb * dry + known[i].viscous * (1 + wrong) * v[i] + known[i].offset;
            x.outside[i] = 5 * sin(0.003 * tick);
            expected[i] += 0.1 / 1.1 * (x.outside[i] - expected[i]);
        }
        run_tick(&x, v, friction);
        for (int i = 0; i < ARM; i++) {
            const double off = fabs(x.felt[i] - expected[i]);
            ck_assert_msg(off <= x.band[i] + 1e-9, "dof %d, tick %d: off by %g of %g", i, tick, off,
                          x.band[i]);
            if (tick > 100) nearest = larger(nearest, off / x.band[i]);
        }
    }
    ck_assert_msg(nearest > 0.95, "the band is too wide: %g", nearest);
    free(x.memory);
    robot_free(&r);
}
END_TEST

/* Moving, with friction that is known exactly, the band is `least`, and the offset is not felt. */
START_TEST(a_known_friction_is_not_felt) {
    robot r = robot_build("iiwa", iiwa_bodies, IIWA_NB);
    const double q[ARM] = {0}, v[ARM] = {1, -1, 1, -1, 1, -1, 1};
    const double friction[ARM] = {3, -3, 3, -3, 3, -3, 3}; /* 0.5 + 2 + 0.5, and -0.5 - 2 - 0.5 */
    rbd_joint_friction known[ARM];
    run x;
    run_begin(&x, &r, 100, 1e-2, q);
    for (int i = 0; i < ARM; i++) known[i] = (rbd_joint_friction){2, 0.5, i % 2 ? -0.5 : 0.5};
    x.options.friction = known;
    x.options.least = 0.25;
    memcpy(x.v, v, sizeof v);
    run_init(&x);
    for (int tick = 0; tick < 60; tick++) run_tick(&x, v, friction);
    ck_assert_msg(largest(x.felt, ARM) < 1e-8, "%g", largest(x.felt, ARM));
    for (int i = 0; i < ARM; i++) ck_assert(fabs(x.band[i] - 0.25) < 1e-12);
    free(x.memory);
    robot_free(&r);
}
END_TEST

/* A motion that comes back, and the same torque from outside again and again: r does too. */
START_TEST(an_observer_does_not_drift) {
    robot r = robot_build("iiwa", iiwa_bodies, IIWA_NB);
    enum { PERIOD = 200, TICKS = 100000 / PART_OF_TREES };
    static double q[PERIOD][ARM], v[PERIOD][ARM], tau[PERIOD][ARM], first[PERIOD][ARM];
    double p[2][ARM], rate[2][ARM], felt[ARM], worst = 0;
    const double dt = 1e-3;
    run x;
    for (int k = 0; k < PERIOD; k++)
        for (int i = 0; i < ARM; i++) {
            const double angle = 2 * 3.14159265358979 * k / PERIOD;
            q[k][i] = 0.3 * sin(angle + i);
            v[k][i] = cos(angle + i);
        }
    for (int k = 0; k < PERIOD; k++) {
        const int before = (k + PERIOD - 1) % PERIOD;
        momentum(&r, q[before], v[before], p[0], rate[0]);
        momentum(&r, q[k], v[k], p[1], rate[1]);
        for (int i = 0; i < ARM; i++)
            tau[k][i] = (p[1][i] - p[0][i]) / dt - (rate[0][i] + rate[1][i]) / 2 - 10 * sin(k);
    }
    run_begin(&x, &r, 40, dt, q[0]);
    run_init(&x);
    for (int tick = 0; tick < TICKS; tick++) {
        const int k = tick % PERIOD;
        ck_assert_int_eq(rbd_observer_step(r.m, r.w, x.observer, q[k], v[k], tau[k], dt, felt, NULL, NULL),
                         RBD_OK);
        if (tick / PERIOD == 5) memcpy(first[k], felt, sizeof felt);
        for (int i = 0; i < ARM && tick / PERIOD > 5; i++)
            worst = larger(worst, fabs(felt[i] - first[k][i]) / (tick / PERIOD < 20 ? 1e6 : 1));
    }
    ck_assert_msg(worst < 1e-9, "%g", worst);
    free(x.memory);
    robot_free(&r);
}
END_TEST

/* ---- an estimate on made-up motions ---- */

static const double coulomb[ARM] = {3, 4, 2, 2.5, 1, 0.8, 0.4}, viscous[ARM] = {1, 1.5, .8, 1, .4, .3, .1},
                    offset[ARM] = {.1, -.2, .05, .1, 0, -.05, .02};

/* Noise of torques, of velocities and of accelerations. */
typedef struct noises {
    double tau, v, a;
} noises;

/* Two models of a robot, without and with the payload, and an estimate. */
typedef struct learner {
    robot bare, loaded;
    rbd_derivatives *d;
    rbd_estimate *e;
    void *memory[2];
    uint64_t seed;
} learner;

static void learner_begin(learner *x, const rbd_body *bodies, int nb, int body, const thing *load,
                          const rbd_estimate_options *options) {
    x->bare = robot_build("bare", bodies, nb);
    x->loaded = robot_build("loaded", bodies, nb);
    x->seed = 11;
    if (load)
        ck_assert_int_eq(rbd_add_payload(x->loaded.memory[0], body, load->mass, load->com, load->inertia),
                         RBD_OK);
    x->memory[0] = malloc(rbd_derivatives_size(x->bare.m));
    x->memory[1] = malloc(RBD_ESTIMATE_SIZE((size_t)x->bare.nv));
    ck_assert_int_eq(
        rbd_derivatives_init(x->bare.m, x->bare.w, x->memory[0], rbd_derivatives_size(x->bare.m), &x->d),
        RBD_OK);
    ck_assert_uint_eq(rbd_estimate_size(x->bare.m), RBD_ESTIMATE_SIZE((size_t)x->bare.nv));
    ck_assert_int_eq(
        rbd_estimate_init(x->bare.m, body, options, x->memory[1], rbd_estimate_size(x->bare.m), &x->e, NULL),
        RBD_OK);
}

static void learner_end(learner *x) {
    robot_free(&x->bare);
    robot_free(&x->loaded);
    free(x->memory[0]);
    free(x->memory[1]);
}

static double gauss(uint64_t *seed) {
    double sum = 0;
    for (int i = 0; i < 12; i++) sum += uniform(seed, -0.5, 0.5);
    return sum;
}

/* The plan of an arm, in which every joint swings at frequencies of its own; exact. */
static void plan(double t, double *q, double *v, double *a) {
    for (int k = 0; k < ARM; k++) {
        const double f = 1.1 + 0.37 * k, g = 2.3 - 0.19 * k;
        q[k] = 0.6 * sin(f * t + k) + 0.3 * cos(g * t);
        v[k] = 0.6 * f * cos(f * t + k) - 0.3 * g * sin(g * t);
        a[k] = -0.6 * f * f * sin(f * t + k) - 0.3 * g * g * cos(g * t);
    }
}

/* The sample at time t, with the payload or without, and with noise. */
static void sample(learner *x, double t, int loaded, noises n, double *q, double *v, double *a, double *tau) {
    const robot *r = loaded ? &x->loaded : &x->bare;
    plan(t, q, v, a);
    ck_assert_int_eq(rbd_rnea(r->m, r->w, q, v, a, NULL, tau), RBD_OK);
    for (int i = 0; i < ARM; i++) {
        tau[i] += coulomb[i] * (v[i] > 0 ? 1 : -1) + viscous[i] * v[i] + offset[i] + n.tau * gauss(&x->seed);
        v[i] += n.v * gauss(&x->seed);
        a[i] += n.a * gauss(&x->seed);
    }
}

static void learn(learner *x, double t, int loaded, noises n) {
    double q[ARM], v[ARM], a[ARM], tau[ARM];
    sample(x, t, loaded, n, q, v, a, tau);
    ck_assert_int_eq(rbd_estimate_add(x->bare.m, x->d, x->e, q, v, a, tau, NULL), RBD_OK);
}

/* The estimate, whose payload must be one that a body can have, and whose friction is not negative. */
static void improve(learner *x, double pi[10], rbd_joint_friction *friction) {
    ck_assert_int_eq(rbd_estimate_solve(x->e, pi, friction, NULL), RBD_OK);
    ck_assert_int_eq(rbd_check_parameters(pi), RBD_OK);
    for (int k = 0; k < 10; k++) ck_assert(isfinite(pi[k]));
    for (int i = 0; i < x->bare.nv; i++) {
        ck_assert(friction[i].coulomb >= 0 && friction[i].viscous >= 0 && isfinite(friction[i].offset));
        ck_assert(isfinite(friction[i].coulomb) && isfinite(friction[i].viscous));
    }
}

/* The largest error of a friction. */
static double friction_error(const rbd_joint_friction *f) {
    double worst = 0;
    for (int i = 0; i < ARM; i++) {
        worst = larger(worst, fabs(f[i].coulomb - coulomb[i]));
        worst = larger(worst, fabs(f[i].viscous - viscous[i]));
        worst = larger(worst, fabs(f[i].offset - offset[i]));
    }
    return worst;
}

/* 2.5 kg are found, and taken away; each tick is physical. */
START_TEST(a_payload_and_friction_are_found) {
    const double noise[ARM] = {0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01};
    const rbd_estimate_options options = {.noise = noise};
    const noises none = {0, 0, 0};
    double want[10], pi[10];
    rbd_joint_friction f[ARM];
    learner x;
    parameters_of(&box, want);
    learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, &options);
    for (int k = 0; k < 300; k++) {
        learn(&x, 0.01 * k, 1, none);
        improve(&x, pi, f);
    }
    for (int k = 0; k < 10; k++)
        ck_assert_msg(fabs(pi[k] - want[k]) < 1e-6, "pi[%d]: %g", k, pi[k] - want[k]);
    ck_assert_msg(friction_error(f) < 1e-5, "%g", friction_error(f));

    ck_assert_int_eq(rbd_estimate_grip(x.e), RBD_OK);
    for (int k = 300; k < 600; k++) {
        learn(&x, 0.01 * k, 0, none);
        improve(&x, pi, f);
    }
    for (int k = 0; k < 10; k++) ck_assert_msg(fabs(pi[k]) < 1e-4, "pi[%d]: %g", k, pi[k]);
    ck_assert_msg(friction_error(f) < 1e-3, "%g", friction_error(f));
    learner_end(&x);
}
END_TEST

/* Noise of torques, and of all that is measured, at the usual sizes; then the payload is taken away. */
START_TEST(noise_costs_what_it_must) {
    double noise[ARM], pi[10];
    rbd_joint_friction f[ARM];
    const rbd_estimate_options options = {.noise = noise};
    for (int i = 0; i < ARM; i++) noise[i] = 0.3;
    for (int trial = 0; trial < 2; trial++) {
        const noises n = {0.3, trial ? 0.005 : 0, trial ? 0.5 : 0};
        double misfit;
        learner x;
        learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, &options);
        for (int k = 0; k < 1000; k++) {
            learn(&x, 0.01 * k, 1, n);
            improve(&x, pi, f);
            if (k == 299) ck_assert_msg(fabs(pi[0] - 2.5) < (trial ? 0.1 : 0.03), "%g kg", pi[0]);
        }
        ck_assert(fabs(pi[0] - 2.5) < (trial ? 0.05 : 0.02));
        ck_assert(friction_error(f) < (trial ? 0.5 : 0.2));
        ck_assert_int_eq(rbd_estimate_solve(x.e, NULL, NULL, &misfit), RBD_OK);
        ck_assert_msg(trial ? misfit > 2 : fabs(misfit - 1) < 0.05, "%g", misfit);
        ck_assert_int_eq(rbd_estimate_grip(x.e), RBD_OK);
        for (int k = 1000; k < 1500; k++) {
            learn(&x, 0.01 * k, 0, n);
            improve(&x, pi, f);
        }
        ck_assert_msg(pi[0] < 0.02, "%g kg in an empty hand", pi[0]);
        learner_end(&x);
    }
}
END_TEST

/* Deviations say how far estimates are off: of 30 draws of the noise. What is not known has those of the
   options. */
START_TEST(deviations_are_those_of_the_errors) {
    enum { DRAWS = 30 };
    double noise[ARM], want[10], pi[10], deviation[10], ratio[10] = {0}, of_friction = 0;
    rbd_joint_friction f[ARM], df[ARM];
    const rbd_estimate_options options = {.noise = noise, .forgetting = 1, .mass = 4, .friction = 50};
    learner x;
    parameters_of(&box, want);
    for (int i = 0; i < ARM; i++) noise[i] = 0.1 * (1 + i);
    for (int draw = 0; draw < DRAWS; draw++) {
        learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, &options);
        x.seed += (uint64_t)draw;
        ck_assert_int_eq(rbd_estimate_deviations(x.e, deviation, df), RBD_OK);
        ck_assert(fabs(deviation[0] - 4) < 1e-12 && fabs(df[3].coulomb - 50) < 1e-10);
        for (int k = 0; k < 400; k++) {
            double q[ARM], v[ARM], a[ARM], tau[ARM];
            sample(&x, 0.02 * k, 1, (noises){0, 0, 0}, q, v, a, tau);
            for (int i = 0; i < ARM; i++) tau[i] += noise[i] * gauss(&x.seed);
            ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, q, v, a, tau, NULL), RBD_OK);
        }
        improve(&x, pi, f);
        ck_assert_int_eq(rbd_estimate_deviations(x.e, deviation, df), RBD_OK);
        for (int k = 0; k < 10; k++) ratio[k] += pow((pi[k] - want[k]) / deviation[k], 2) / DRAWS;
        for (int i = 0; i < ARM; i++)
            of_friction += pow((f[i].viscous - viscous[i]) / df[i].viscous, 2) / DRAWS / ARM / 2;
        for (int i = 0; i < ARM; i++)
            of_friction += pow((f[i].offset - offset[i]) / df[i].offset, 2) / DRAWS / ARM / 2;
        learner_end(&x);
    }
    for (int k = 0; k < 10; k++) ck_assert_msg(ratio[k] > 0.4 && ratio[k] < 2, "pi[%d]: %g", k, ratio[k]);
    ck_assert_msg(of_friction > 0.7 && of_friction < 1.4, "friction: %g", of_friction);
}
END_TEST

/* ---- the optimum ---- */

/* x = A^-1 x by Gauss's elimination, A n x n, positive definite. */
static void solve_dense(double *A, int n, double *x) {
    for (int k = 0; k < n; k++)
        for (int i = k + 1; i < n; i++) {
            const double factor = A[i * n + k] / A[k * n + k];
            for (int j = k; j < n; j++) A[i * n + j] -= factor * A[k * n + j];
            x[i] -= factor * x[k];
        }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++) x[k] -= A[k * n + j] * x[j];
        x[k] /= A[k * n + k];
    }
}

/* log det of the pseudo-inertia of ten parameters. */
static double log_det(const double pi[10]) {
    const double S = (pi[4] + pi[7] + pi[9]) / 2;
    double P[4][4] = {{S - pi[4], -pi[5], -pi[6], pi[1]},
                      {-pi[5], S - pi[7], -pi[8], pi[2]},
                      {-pi[6], -pi[8], S - pi[9], pi[3]},
                      {pi[1], pi[2], pi[3], pi[0]}},
           sum = 0;
    for (int k = 0; k < 4; k++) {
        sum += log(P[k][k]);
        for (int i = k + 1; i < 4; i++)
            for (int j = 3; j >= k; j--) P[i][j] -= P[i][k] / P[k][k] * P[k][j];
    }
    return sum;
}

enum { ALL = 10 + 3 * ARM };

/* Normal equations of all rows over their noise: payload, then friction of each joint. */
typedef struct normal {
    double A[ALL * ALL], b[ALL];
} normal;

static void normal_add(normal *n, const learner *x, const double *q, const double *v, const double *a,
                       const double *tau, double noise) {
    static double Y[ARM * 10 * IIWA_NB];
    double known[ARM], row[ALL];
    ck_assert_int_eq(rbd_regressor(x->bare.m, x->d, q, v, a, Y), RBD_OK);
    ck_assert_int_eq(rbd_rnea(x->bare.m, x->bare.w, q, v, a, NULL, known), RBD_OK);
    for (int i = 0; i < ARM; i++) {
        if (fabs(v[i]) <= 0.03) continue;
        memset(row, 0, sizeof row);
        for (int k = 0; k < 10; k++) row[k] = Y[(i * IIWA_NB + HAND) * 10 + k];
        row[10 + 3 * i] = 1;
        row[11 + 3 * i] = v[i] > 0 ? 1 : -1;
        row[12 + 3 * i] = v[i];
        for (int k = 0; k < ALL; k++) {
            n->b[k] += row[k] * (tau[i] - known[i]) / noise / noise;
            for (int l = 0; l < ALL; l++) n->A[k * ALL + l] += row[k] * row[l] / noise / noise;
        }
    }
}

/* What the estimate minimises over pi, with the best friction: half the sum of squares, less a constant, the
   prior of the default options, and 0.01 of the barrier where that without it is no body. */
static double objective(const normal *n, const double pi[10], int barrier) {
    static double F[3 * ARM * 3 * ARM];
    double f[3 * ARM], right[3 * ARM], sum = 0;
    const double S = (pi[4] + pi[7] + pi[9]) / 2;
    const double p[10] = {(S - pi[4]) / 0.2,
                          pi[5] / 0.2,
                          pi[6] / 0.2,
                          (S - pi[7]) / 0.2,
                          pi[8] / 0.2,
                          (S - pi[9]) / 0.2,
                          pi[1],
                          pi[2],
                          pi[3],
                          pi[0] / 5};
    for (int k = 0; k < 3 * ARM; k++) {
        right[k] = n->b[10 + k];
        for (int j = 0; j < 10; j++) right[k] -= n->A[(10 + k) * ALL + j] * pi[j];
        f[k] = right[k];
        for (int l = 0; l < 3 * ARM; l++) F[k * 3 * ARM + l] = n->A[(10 + k) * ALL + 10 + l];
    }
    solve_dense(F, 3 * ARM, f);
    for (int k = 0; k < 3 * ARM; k++) sum -= right[k] * f[k] / 2;
    for (int k = 0; k < 10; k++) {
        sum += p[k] * p[k] / 2 - n->b[k] * pi[k];
        for (int j = 0; j < 10; j++) sum += pi[k] * n->A[k * ALL + j] * pi[j] / 2;
    }
    return sum - (barrier ? 0.01 * log_det(pi) : 0);
}

/* Few and noisy samples: where the optimum without the barrier is no body, ours is, and it is the least of
   the objective on all sides. */
START_TEST(the_estimate_is_the_optimum) {
    double noise[ARM], pi[10], free_pi[ALL];
    rbd_joint_friction f[ARM];
    int impossible = 0, barrier;
    const rbd_estimate_options options = {.noise = noise, .forgetting = 1};
    for (int i = 0; i < ARM; i++) noise[i] = 0.3;
    for (int trial = 0; trial < 12; trial++) {
        static normal n, copy;
        double least;
        learner x;
        memset(&n, 0, sizeof n);
        learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, &options);
        x.seed += (uint64_t)trial;
        for (int k = 0; k < 60; k++) {
            double q[ARM], v[ARM], a[ARM], tau[ARM];
            sample(&x, 0.05 * k + trial, 1, (noises){0.3, 0.02, trial % 2 ? 1 : 0}, q, v, a, tau);
            ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, q, v, a, tau, NULL), RBD_OK);
            normal_add(&n, &x, q, v, a, tau, 0.3);
        }
        improve(&x, pi, f);
        copy = n;
        memcpy(free_pi, n.b, sizeof free_pi);
        solve_dense(copy.A, ALL, free_pi);
        barrier = rbd_check_parameters(free_pi) != RBD_OK;
        impossible += barrier;

        least = objective(&n, pi, barrier);
        for (int k = 0; k < 10; k++)
            for (int side = -1; side <= 1; side += 2) {
                double moved[10], step = 1e-4 * (k == 0 ? 1 : k < 4 ? 0.1 : 0.01) * side, value;
                memcpy(moved, pi, sizeof moved);
                moved[k] += step;
                value = objective(&n, moved, barrier);
                ck_assert_msg(isnan(value) || value > least - 1e-9 * fabs(least), "trial %d: pi[%d]: %g",
                              trial, k, value - least);
            }
        learner_end(&x);
    }
    ck_assert_msg(impossible >= 3, "the unconstrained estimate was a body in all but %d", impossible);
}
END_TEST

/* No sample: the prior p^2 / 2 less 0.01 log det P is least where each entry of the diagonal is 0.1, in units
   of the options; so that is known to the last round's step, squared. */
START_TEST(an_untold_payload_is_a_tenth_of_the_options) {
    const rbd_estimate_options options[2] = {{.mass = 4, .reach = 0.5}, {.mass = 0.3, .reach = 2}};
    for (int i = 0; i < 2; i++) {
        const double m = 0.1 * options[i].mass, I = 2 * m * options[i].reach * options[i].reach;
        const double want[10] = {m, 0, 0, 0, I, 0, 0, I, 0, I};
        double pi[10];
        learner x;

        learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, NULL, &options[i]);
        ck_assert_int_eq(rbd_estimate_solve(x.e, pi, NULL, NULL), RBD_OK);
        for (int k = 0; k < 10; k++)
            ck_assert_msg(fabs(pi[k] - want[k]) < 1e-6 * (k == 0 ? m : I), "pi[%d]: %g, not %g", k, pi[k],
                          want[k]);
        learner_end(&x);
    }
}
END_TEST

/* ---- all types of joints, floating bases ---- */

/* From samples at random states, with friction where there is some, the torques of another state follow. */
static void check_prediction(const robot *r, const state *s, int number) {
    uint64_t seed = 100 + (uint64_t)number;
    const int body = below(&seed, r->nb);
    double noise[MAX_V], q[MAX_Q], v[MAX_V], a[MAX_V], tau[MAX_V], pi[10], found[MAX_V];
    rbd_joint_friction f[MAX_V], truth[MAX_V] = {{0, 0, 0}};
    const rbd_estimate_options options = {.noise = noise, .forgetting = 1, .slow = 1e-6, .reach = 1};
    rbd_body load = {.mass = 0};
    learner x;
    if (r->m->frame[body].link < 0) return;

    for (int i = 0; i < r->nv; i++) {
        noise[i] = 1e-2;
        truth[i] = (rbd_joint_friction){uniform(&seed, 0, 2), uniform(&seed, 0, 2), uniform(&seed, -1, 1)};
        if (r->bodies[rbd_dof_body(r->m, i)].type == RBD_FLOATING) truth[i] = (rbd_joint_friction){0, 0, 0};
    }
    learner_begin(&x, r->bodies, r->nb, body, &box, &options);
    rbd_set_gravity(x.bare.w, s->gravity);
    rbd_set_gravity(x.loaded.w, s->gravity);
    for (int k = 0; k < 60; k++) {
        ck_assert_int_eq(rbd_random(r->m, &seed, q), RBD_OK);
        for (int i = 0; i < r->nv; i++) v[i] = uniform(&seed, -2, 2);
        for (int i = 0; i < r->nv; i++) a[i] = uniform(&seed, -5, 5);
        RUN(rbd_rnea(x.loaded.m, x.loaded.w, q, v, a, NULL, tau));
        for (int i = 0; i < r->nv; i++)
            tau[i] += truth[i].coulomb * (v[i] > 0 ? 1 : -1) + truth[i].viscous * v[i] + truth[i].offset;
        if (k < 59) RUN(rbd_estimate_add(x.bare.m, x.d, x.e, q, v, a, tau, NULL));
    }
    improve(&x, pi, f);

    ck_assert_int_eq(rbd_set_parameters(&load, pi), RBD_OK);
    RUN(rbd_add_payload(x.bare.memory[0], body, load.mass, load.com, load.inertia));
    RUN(rbd_rnea(x.bare.m, x.bare.w, q, v, a, NULL, found));
    for (int i = 0; i < r->nv; i++)
        found[i] += f[i].coulomb * (v[i] > 0 ? 1 : -1) + f[i].viscous * v[i] + f[i].offset;
    expect_close("prediction", r, number, found, tau, r->nv, 1e-4);
    learner_end(&x);
}

START_TEST(all_types_of_joints_learn) {
    for_random_trees(40, check_prediction);
    for_random_states(1, check_prediction);
}
END_TEST

/* A robot in flight with a payload on its trunk, from the six rows of the base alone: the joints are left
   out, and have no friction then. */
START_TEST(a_floating_base_weighs_its_payload) {
    unsigned char left_out[HYQ_NV] = {0};
    double pi[10], want[10], q[HYQ_NQ], v[HYQ_NV], a[HYQ_NV], tau[HYQ_NV];
    rbd_joint_friction f[HYQ_NV];
    const rbd_estimate_options options = {.left_out = left_out, .mass = 20};
    uint64_t seed = 3;
    learner x;
    memset(left_out + 6, 1, sizeof left_out - 6);
    parameters_of(&box, want);
    learner_begin(&x, hyq_bodies, HYQ_NB, 0, &box, &options);
    for (int k = 0; k < 200; k++) {
        ck_assert_int_eq(rbd_random(x.bare.m, &seed, q), RBD_OK);
        for (int i = 0; i < HYQ_NV; i++) v[i] = i < 6 && k == 0 ? 0 : uniform(&seed, -2, 2);
        for (int i = 0; i < HYQ_NV; i++) a[i] = uniform(&seed, -5, 5);
        ck_assert_int_eq(rbd_rnea(x.loaded.m, x.loaded.w, q, v, a, NULL, tau), RBD_OK);
        for (int i = 6; i < HYQ_NV; i++) tau[i] = 1e6 * uniform(&seed, -1, 1); /* unknown */
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, q, v, a, tau, NULL), RBD_OK);
        improve(&x, pi, f);
    }
    for (int k = 0; k < 10; k++)
        ck_assert_msg(fabs(pi[k] - want[k]) < 1e-4, "pi[%d]: %g, not %g", k, pi[k], want[k]);
    for (int i = 0; i < HYQ_NV; i++)
        ck_assert(f[i].coulomb <= 0 && f[i].viscous <= 0 && fabs(f[i].offset) <= 0);
    learner_end(&x);
}
END_TEST

/* ---- changes of the payload, and little to learn from ---- */

START_TEST(a_released_hand_is_empty) {
    double noise[ARM], pi[10], deviation[10], before[10], want[10];
    rbd_joint_friction f[ARM], sure[ARM], surer[ARM];
    const rbd_estimate_options options = {.noise = noise, .forgetting = 1};
    const noises some = {0.3, 0, 0};
    learner x;
    for (int i = 0; i < ARM; i++) noise[i] = 0.3;
    parameters_of(&box, want);
    learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, &options);
    for (int k = 0; k < 300; k++) learn(&x, 0.01 * k, 1, some);
    improve(&x, pi, f);
    ck_assert_int_eq(rbd_estimate_deviations(x.e, before, sure), RBD_OK);

    /* friction stays known, to the same deviation; the payload is 0 */
    ck_assert_int_eq(rbd_estimate_release(x.e), RBD_OK);
    ck_assert_int_eq(rbd_estimate_deviations(x.e, deviation, surer), RBD_OK);
    for (int k = 0; k < 10; k++) ck_assert(deviation[k] <= 0);
    for (int i = 0; i < ARM; i++) {
        ck_assert(fabs(surer[i].coulomb - sure[i].coulomb) < 1e-5 * sure[i].coulomb);
        ck_assert(fabs(surer[i].offset - sure[i].offset) < 1e-5 * sure[i].offset);
    }
    for (int k = 300; k < 600; k++) learn(&x, 0.01 * k, 0, some);
    improve(&x, pi, f);
    for (int k = 0; k < 10; k++) ck_assert(fabs(pi[k]) <= 0);
    ck_assert(friction_error(f) < 0.2);

    /* unknown again */
    ck_assert_int_eq(rbd_estimate_grip(x.e), RBD_OK);
    ck_assert_int_eq(rbd_estimate_deviations(x.e, deviation, surer), RBD_OK);
    ck_assert(fabs(deviation[0] - 5) < 1e-9);
    for (int k = 600; k < 700; k++) {
        learn(&x, 0.01 * k, 1, some);
        improve(&x, pi, f);
    }
    ck_assert_msg(fabs(pi[0] - 2.5) < 0.1, "%g", pi[0]);
    learner_end(&x);
}
END_TEST

/* A grip or release closes the estimate by itself: nobody need have asked for it before. */
START_TEST(a_grip_needs_no_solve_before) {
    const noises none = {0, 0, 0};
    for (int released = 0; released < 2; released++) {
        double pi[10];
        rbd_joint_friction f[ARM];
        learner x;
        learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, NULL);
        for (int k = 0; k < 300; k++) learn(&x, 0.01 * k, 1, none);

        ck_assert_int_eq(released ? rbd_estimate_release(x.e) : rbd_estimate_grip(x.e), RBD_OK);
        ck_assert_int_eq(rbd_estimate_solve(x.e, pi, f, NULL), RBD_OK);
        ck_assert_msg(friction_error(f) < 1e-3, "%g", friction_error(f));
        learner_end(&x);
    }
}
END_TEST

START_TEST(friction_can_be_learnt_alone) {
    double pi[10];
    rbd_joint_friction f[ARM];
    learner x;
    learner_begin(&x, iiwa_bodies, IIWA_NB, -1, NULL, NULL);
    for (int k = 0; k < 300; k++) learn(&x, 0.01 * k, 0, (noises){0, 0, 0});
    improve(&x, pi, f);
    ck_assert(friction_error(f) < 1e-4);
    ck_assert(largest(pi, 10) <= 0);
    ck_assert_int_eq(rbd_estimate_grip(x.e), RBD_ERR_INDEX);
    ck_assert_int_eq(rbd_estimate_release(x.e), RBD_ERR_INDEX);
    learner_end(&x);
}
END_TEST

/* At rest nothing is told, and nothing forgotten; one joint that turns at a steady speed tells little. All of
   it is physical, and the deviations say how little is known. */
START_TEST(little_motion_is_no_harm) {
    double q[ARM] = {0.1, 0.8, 0.3, -0.4, 0.5, 0.6, 0.7}, v[ARM] = {0}, a[ARM] = {0}, tau[ARM] = {0}, pi[10],
           deviation[10], misfit;
    rbd_joint_friction f[ARM], df[ARM];
    const noises none = {0, 0, 0};
    learner x;
    learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, NULL);
    for (int k = 0; k < 2000; k++) {
        for (int i = 0; i < ARM; i++) v[i] = 0.02 * sin(k + i); /* below `slow` */
        for (int i = 0; i < ARM; i++) tau[i] = 100 * sin(k * i);
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, q, v, a, tau, NULL), RBD_OK);
        improve(&x, pi, f);
    }
    ck_assert_int_eq(rbd_estimate_deviations(x.e, deviation, df), RBD_OK);
    ck_assert(fabs(deviation[0] - 5) < 1e-9 && pi[0] < 1);
    ck_assert_int_eq(rbd_estimate_solve(x.e, NULL, NULL, &misfit), RBD_OK);
    ck_assert(misfit <= 0);

    for (int k = 0; k < 20000; k++) {
        for (int i = 0; i < ARM; i++) v[i] = i == 6 ? 0.5 : 0;
        ck_assert_int_eq(rbd_rnea(x.loaded.m, x.loaded.w, q, v, a, NULL, tau), RBD_OK);
        tau[6] += coulomb[6] + 0.5 * viscous[6] + offset[6];
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, q, v, a, tau, NULL), RBD_OK);
        improve(&x, pi, f);
    }
    ck_assert_int_eq(rbd_estimate_deviations(x.e, deviation, df), RBD_OK);
    ck_assert_msg(deviation[0] > 1, "%g", deviation[0]);

    for (int k = 0; k < 500; k++) learn(&x, 0.01 * k, 1, none);
    improve(&x, pi, f);
    ck_assert(fabs(pi[0] - 2.5) < 1e-3);
    for (int k = 0; k < 1000; k++) {
        for (int i = 0; i < ARM; i++) v[i] = 0;
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, q, v, a, tau, NULL), RBD_OK);
    }
    improve(&x, pi, f);
    ck_assert(fabs(pi[0] - 2.5) < 1e-3);
    learner_end(&x);
}
END_TEST

START_TEST(an_estimate_does_not_drift) {
    enum { PERIOD = 500, TICKS = 100000 / PART_OF_TREES };
    static double q[PERIOD][ARM], v[PERIOD][ARM], a[PERIOD][ARM], tau[PERIOD][ARM];
    double pi[10], want[10], worst = 0, worst_friction = 0;
    rbd_joint_friction f[ARM];
    learner x;
    parameters_of(&box, want);
    learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, NULL);
    for (int k = 0; k < PERIOD; k++) sample(&x, 0.02 * k, 1, (noises){0, 0, 0}, q[k], v[k], a[k], tau[k]);
    for (int tick = 0; tick < TICKS; tick++) {
        const int k = tick % PERIOD;
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, q[k], v[k], a[k], tau[k], NULL), RBD_OK);
        improve(&x, pi, f);
        if (tick < 1000) continue;
        for (int j = 0; j < 10; j++) worst = larger(worst, fabs(pi[j] - want[j]));
        worst_friction = larger(worst_friction, friction_error(f));
    }
    ck_assert_msg(worst < 1e-4 && worst_friction < 1e-3, "%g, %g", worst, worst_friction);
    learner_end(&x);
}
END_TEST

/* ---- bad input ---- */

/* The fault, and its text. */
static void expect_fault(rbd_status status, rbd_status expected, const rbd_estimate_fault *fault,
                         const char *text) {
    char found[100];
    rbd_estimate_text(status, fault, found, sizeof found);
    ck_assert_int_eq(status, expected);
    ck_assert_str_eq(found, text);
}

START_TEST(errors_of_the_observer_have_their_names) {
    robot r = robot_build("iiwa", iiwa_bodies, IIWA_NB), other = robot_build("hyq", hyq_bodies, HYQ_NB);
    static unsigned char memory[2][RBD_OBSERVER_SIZE(ARM)];
    rbd_joint_friction friction[ARM] = {{0, 0, 0}};
    rbd_observer_options good = {.gain = 40, .friction = friction}, o;
    rbd_observer *x, *twin;
    rbd_estimate_fault fault;
    double q[ARM] = {0}, v[ARM] = {0}, tau[ARM] = {0}, felt[2][ARM], band[ARM];
    const double bad[2] = {NAN, INFINITY};
#define INIT(observer, k) rbd_observer_init(r.m, &o, memory[k], sizeof memory[k], observer, &fault)
#define STEP(dt) rbd_observer_step(r.m, r.w, x, q, v, tau, dt, felt[0], band, &fault)
#define REFUSE_OPTION(name, value, expected) \
    do { \
        o = good; \
        o.name = value; \
        expect_fault(INIT(&x, 0), RBD_ERR_RANGE, &fault, expected); \
        ck_assert_ptr_null(x); \
    } while (0)

    REFUSE_OPTION(gain, 0, "gain: out of range");
    REFUSE_OPTION(gain, -1, "gain: out of range");
    REFUSE_OPTION(gain, 1e10, "gain: out of range");
    REFUSE_OPTION(gain, (double)NAN, "gain: out of range");
    REFUSE_OPTION(slow, -1, "slow: out of range");
    REFUSE_OPTION(share, 1.5, "share: out of range");
    REFUSE_OPTION(least, (double)INFINITY, "least: out of range");
    friction[3].coulomb = -1;
    REFUSE_OPTION(share, 0.1, "coulomb[3]: out of range");
    friction[3] = (rbd_joint_friction){0, (double)NAN, 0};
    REFUSE_OPTION(share, 0.1, "viscous[3]: out of range");
    friction[3] = (rbd_joint_friction){0, 0, (double)INFINITY};
    REFUSE_OPTION(share, 0.1, "offset[3]: out of range");
    friction[3].offset = 0;

    o = good;
    ck_assert_int_eq(rbd_observer_init(NULL, &o, memory[0], sizeof memory[0], &x, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_observer_init(r.m, NULL, memory[0], sizeof memory[0], &x, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_observer_init(r.m, &o, NULL, sizeof memory[0], &x, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_observer_init(r.m, &o, memory[0], sizeof memory[0], NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_observer_init(r.m, &o, memory[0], RBD_OBSERVER_SIZE(ARM) - 1, &x, NULL),
                     RBD_ERR_MEMORY);
    ck_assert_int_eq(rbd_observer_reset(NULL), RBD_ERR_NULL);
    ck_assert_uint_eq(rbd_observer_size(NULL), 0);

    /* what is refused leaves no trace: a twin that never saw it goes the same way, to the bit */
    ck_assert_int_eq(INIT(&x, 0), RBD_OK);
    ck_assert_int_eq(INIT(&twin, 1), RBD_OK);
    for (int tick = 0; tick < 5; tick++) {
        for (int i = 0; i < ARM; i++) v[i] = sin(tick + i);
        for (int i = 0; i < ARM; i++) q[i] += 0.01 * v[i];
        for (int i = 0; i < ARM; i++) tau[i] = cos(tick + i);
        for (int k = 0; k < 2; k++) {
            double kept;
            kept = q[2], q[2] = bad[k];
            expect_fault(STEP(0.01), RBD_ERR_NAN, &fault, "q[2]: not finite");
            q[2] = kept, kept = v[0], v[0] = bad[k];
            expect_fault(STEP(0.01), RBD_ERR_NAN, &fault, "v[0]: not finite");
            v[0] = kept, kept = tau[6], tau[6] = bad[k];
            expect_fault(STEP(0.01), RBD_ERR_NAN, &fault, "tau[6]: not finite");
            tau[6] = kept;
            expect_fault(STEP(k ? 0 : -1), RBD_ERR_RANGE, &fault, "dt: out of range");
            expect_fault(STEP(bad[k]), RBD_ERR_RANGE, &fault, "dt: out of range");
            kept = v[1], v[1] = 1e200;
            ck_assert_int_eq(STEP(0.01), RBD_ERR_NAN); /* it overflows */
            ck_assert_str_eq(fault.field, "v");
            v[1] = kept;
            friction[5].coulomb = bad[k];
            expect_fault(STEP(0.01), RBD_ERR_RANGE, &fault, "coulomb[5]: out of range");
            friction[5].coulomb = 0;
        }
        ck_assert_int_eq(rbd_observer_step(r.m, r.w, NULL, q, v, tau, 0.01, NULL, NULL, NULL), RBD_ERR_NULL);
        ck_assert_int_eq(rbd_observer_step(r.m, r.w, x, NULL, v, tau, 0.01, NULL, NULL, NULL), RBD_ERR_NULL);
        ck_assert_int_eq(rbd_observer_step(r.m, r.w, x, q, NULL, tau, 0.01, NULL, NULL, NULL), RBD_ERR_NULL);
        ck_assert_int_eq(rbd_observer_step(r.m, r.w, x, q, v, NULL, 0.01, NULL, NULL, NULL), RBD_ERR_NULL);
        ck_assert_int_eq(rbd_observer_step(r.m, other.w, x, q, v, tau, 0.01, NULL, NULL, NULL), RBD_ERR_WORK);
        ck_assert_int_eq(rbd_observer_step(other.m, other.w, x, q, v, tau, 0.01, NULL, NULL, NULL),
                         RBD_ERR_WORK);
        ck_assert_int_eq(STEP(0.01), RBD_OK);
        ck_assert_ptr_null(fault.field);
        ck_assert_int_eq(rbd_observer_step(r.m, r.w, twin, q, v, tau, 0.01, felt[1], NULL, NULL), RBD_OK);
        ck_assert(memcmp(felt[0], felt[1], sizeof felt[0]) == 0);
    }
    robot_free(&r);
    robot_free(&other);
}
END_TEST

START_TEST(errors_of_the_estimate_have_their_names) {
    double noise[ARM] = {1, 1, 1, 1, 1, 1, 1}, pi[2][10];
    rbd_estimate_options good = {.noise = noise}, o;
    static unsigned char memory[RBD_ESTIMATE_SIZE(ARM)];
    rbd_joint_friction f[2][ARM];
    rbd_estimate_fault fault;
    rbd_estimate *e;
    learner x, twin;
    robot other = robot_build("hyq", hyq_bodies, HYQ_NB);
    learner_begin(&x, iiwa_bodies, IIWA_NB, HAND, &box, NULL);
    learner_begin(&twin, iiwa_bodies, IIWA_NB, HAND, &box, NULL);
#define INIT_ESTIMATE(body) rbd_estimate_init(x.bare.m, body, &o, memory, sizeof memory, &e, &fault)
#define REFUSE(name, value) \
    do { \
        o = good; \
        o.name = value; \
        expect_fault(INIT_ESTIMATE(HAND), RBD_ERR_RANGE, &fault, #name ": out of range"); \
        ck_assert_ptr_null(e); \
    } while (0)

    REFUSE(mass, -1);
    REFUSE(mass, 1e-12);
    REFUSE(mass, 1e12);
    REFUSE(reach, (double)NAN);
    REFUSE(friction, (double)INFINITY);
    REFUSE(slow, -0.1);
    REFUSE(forgetting, 1.1);
    REFUSE(forgetting, 0.1);
    o = good;
    noise[2] = 0;
    expect_fault(INIT_ESTIMATE(HAND), RBD_ERR_RANGE, &fault, "noise[2]: out of range");
    noise[2] = (double)NAN;
    expect_fault(INIT_ESTIMATE(HAND), RBD_ERR_RANGE, &fault, "noise[2]: out of range");
    noise[2] = 1;
    expect_fault(INIT_ESTIMATE(IIWA_NB), RBD_ERR_INDEX, &fault, "body: no such body");
    expect_fault(INIT_ESTIMATE(-2), RBD_ERR_INDEX, &fault, "body: no such body");
    ck_assert_int_eq(rbd_estimate_init(NULL, 0, NULL, memory, sizeof memory, &e, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_estimate_init(x.bare.m, 0, NULL, NULL, sizeof memory, &e, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_estimate_init(x.bare.m, 0, NULL, memory, sizeof memory, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_estimate_init(x.bare.m, 0, NULL, memory, sizeof memory - 1, &e, NULL),
                     RBD_ERR_MEMORY);
    ck_assert_int_eq(rbd_estimate_solve(NULL, NULL, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_estimate_deviations(NULL, NULL, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_estimate_grip(NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_estimate_release(NULL), RBD_ERR_NULL);
    ck_assert_uint_eq(rbd_estimate_size(NULL), 0);

    /* what is refused leaves no trace */
    for (int k = 0; k < 50; k++) {
        double in[4][ARM];
        const char *const names[4] = {"q", "v", "a", "tau"};
        sample(&x, 0.05 * k, 1, (noises){0.1, 0, 0}, in[0], in[1], in[2], in[3]);
        for (int j = 0; j < 4; j++) {
            const double kept = in[j][j];
            char text[40];
            snprintf(text, sizeof text, "%s[%d]: not finite", names[j], j);
            in[j][j] = k % 2 ? NAN : INFINITY;
            expect_fault(rbd_estimate_add(x.bare.m, x.d, x.e, in[0], in[1], in[2], in[3], &fault),
                         RBD_ERR_NAN, &fault, text);
            in[j][j] = kept;
        }
        const double kept = in[3][6];
        in[3][6] = 1e100;
        expect_fault(rbd_estimate_add(x.bare.m, x.d, x.e, in[0], in[1], in[2], in[3], &fault), RBD_ERR_RANGE,
                     &fault, "tau[6]: out of range");
        in[3][6] = kept;
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, NULL, in[1], in[2], in[3], NULL), RBD_ERR_NULL);
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, in[0], NULL, in[2], in[3], NULL), RBD_ERR_NULL);
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, in[0], in[1], NULL, in[3], NULL), RBD_ERR_NULL);
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, in[0], in[1], in[2], NULL, NULL), RBD_ERR_NULL);
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, NULL, in[0], in[1], in[2], in[3], NULL),
                         RBD_ERR_NULL);
        ck_assert_int_eq(rbd_estimate_add(other.m, x.d, x.e, in[0], in[1], in[2], in[3], NULL), RBD_ERR_WORK);
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, in[0], in[1], in[2], in[3], &fault), RBD_OK);
        ck_assert_ptr_null(fault.field);
        ck_assert_int_eq(rbd_estimate_add(twin.bare.m, twin.d, twin.e, in[0], in[1], in[2], in[3], NULL),
                         RBD_OK);
        improve(&x, pi[0], f[0]);
        improve(&twin, pi[1], f[1]);
        ck_assert(memcmp(pi[0], pi[1], sizeof pi[0]) == 0 && memcmp(f[0], f[1], sizeof f[0]) == 0);
    }
    learner_end(&x);
    learner_end(&twin);
    robot_free(&other);
}
END_TEST

/* Arrays of a robot that floats, nq = nv + 1: behind the last entry of each stands one that is refused. */
START_TEST(no_entry_behind_an_array_is_read) {
    enum { NV = HYQ_NV, NQ = HYQ_NQ };
    double q[NQ + 1], v[NV + 1], a[NV + 1], tau[NV + 1], noise[NV + 1];
    rbd_joint_friction friction[NV + 1];
    const rbd_observer_options watched = {.gain = 10, .friction = friction};
    const rbd_estimate_options options = {.noise = noise};
    static unsigned char memory[RBD_OBSERVER_SIZE(NV)], more[RBD_ESTIMATE_SIZE(NV)];
    rbd_estimate_fault fault;
    rbd_observer *o;
    rbd_estimate *e;
    learner x;

    learner_begin(&x, hyq_bodies, HYQ_NB, 0, NULL, NULL);
    ck_assert_int_eq(rbd_neutral(x.bare.m, q), RBD_OK);
    for (int i = 0; i < NV; i++) {
        v[i] = a[i] = tau[i] = 0.5;
        noise[i] = 1;
        friction[i] = (rbd_joint_friction){1, 1, 1};
    }
    q[NQ] = v[NV] = a[NV] = tau[NV] = noise[NV] = friction[NV].coulomb = NAN;

    ck_assert_int_eq(rbd_observer_init(x.bare.m, &watched, memory, sizeof memory, &o, &fault), RBD_OK);
    ck_assert_int_eq(rbd_observer_step(x.bare.m, x.bare.w, o, q, v, tau, 0.01, NULL, NULL, &fault), RBD_OK);
    ck_assert_int_eq(rbd_estimate_init(x.bare.m, 0, &options, more, sizeof more, &e, &fault), RBD_OK);
    ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, e, q, v, a, tau, &fault), RBD_OK);
    learner_end(&x);
}
END_TEST

/* A slide on a stand that is fixed to the world; masses or none. */
static void learn_on_a_stand(learner *x, int kinematic, unsigned char memory[4][20000]) {
    const double mass = kinematic ? 0 : 2;
    const rbd_body bodies[2] = {{.name = "stand", .parent = -1, .type = RBD_FIXED},
                                {.name = "slide",
                                 .joint = "slide",
                                 .parent = 0,
                                 .type = RBD_PRISMATIC,
                                 .axis = {1, 0, 0},
                                 .mass = mass}};
    const rbd_estimate_options options = {.forgetting = 1};
    robot *r = &x->bare;
    ck_assert_int_eq(
        (kinematic ? rbd_model_build_kinematic : rbd_model_build)(bodies, 2, memory[0], 20000, &r->m, NULL),
        RBD_OK);
    ck_assert_int_eq(rbd_work_init(r->m, memory[1], 20000, &r->w), RBD_OK);
    ck_assert_int_eq(rbd_derivatives_init(r->m, r->w, memory[2], 20000, &x->d), RBD_OK);
    ck_assert_int_eq(rbd_estimate_init(r->m, 0, &options, memory[3], 20000, &x->e, NULL), RBD_OK);
}

/* No torque tells what a body of the world carries: it stays unknown. Friction is found, 3 + 0.5 |v|
   less 0.25. Results that are not wanted need no arrays. */
START_TEST(a_payload_of_the_world_is_not_felt) {
    static unsigned char memory[4][20000];
    double pi[10], deviation[10];
    rbd_joint_friction f, df, again;
    learner x;
    learn_on_a_stand(&x, 0, memory);
    for (int k = 0; k < 400; k++) {
        const double q = 0, v = sin(k), a = cos(3 * k), side = v > 0 ? 1 : -1,
                     tau = 2 * a + 3 * side + 0.5 * v - 0.25;
        ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, &q, &v, &a, &tau, NULL), RBD_OK);
    }
    ck_assert_int_eq(rbd_estimate_solve(x.e, pi, &f, NULL), RBD_OK);
    ck_assert_double_eq_tol(pi[0], 0.5, 1e-6);
    ck_assert(fabs(f.coulomb - 3) < 1e-4 && fabs(f.viscous - 0.5) < 1e-4 && fabs(f.offset + 0.25) < 1e-4);

    ck_assert_int_eq(rbd_estimate_deviations(x.e, deviation, NULL), RBD_OK);
    ck_assert_double_eq_tol(deviation[0], 5, 1e-9);
    ck_assert_int_eq(rbd_estimate_deviations(x.e, NULL, &df), RBD_OK);
    ck_assert_int_eq(rbd_estimate_deviations(x.e, deviation, &again), RBD_OK);
    ck_assert(memcmp(&df, &again, sizeof df) == 0);
    ck_assert_int_eq(rbd_estimate_solve(x.e, NULL, NULL, NULL), RBD_OK);
}
END_TEST

/* A model for kinematics alone has no momentum, and no torques to learn from. */
START_TEST(a_robot_without_masses_tells_nothing) {
    static unsigned char memory[4][20000], more[RBD_OBSERVER_SIZE(1)];
    const rbd_observer_options options = {.gain = 1};
    const double one = 1;
    rbd_observer *o;
    learner x;
    learn_on_a_stand(&x, 1, memory);
    ck_assert_int_eq(rbd_estimate_add(x.bare.m, x.d, x.e, &one, &one, &one, &one, NULL), RBD_ERR_MASSLESS);
    ck_assert_int_eq(rbd_observer_init(x.bare.m, &options, more, sizeof more, &o, NULL), RBD_OK);
    ck_assert_int_eq(rbd_observer_step(x.bare.m, x.bare.w, o, &one, &one, &one, 0.01, NULL, NULL, NULL),
                     RBD_ERR_MASSLESS);
}
END_TEST

/* A slide of 2 kg at 0.3 m/s, with friction of 3 N. If 0.5 m/s counts as slow it is at rest, and the band has
   all of the friction; else it moves, and the band is 0. */
START_TEST(slow_is_as_the_option_says) {
    static unsigned char memory[4][20000], more[RBD_OBSERVER_SIZE(1)];
    const rbd_joint_friction friction = {.coulomb = 3};
    learner x;
    learn_on_a_stand(&x, 0, memory);
    for (int slow = 0; slow < 2; slow++) {
        const rbd_observer_options options = {.gain = 100, .slow = slow ? 0.5 : 0.1, .friction = &friction};
        const double q = 0, v = 0.3, tau = 3, huge = 1e308;
        double r, band = -1;
        rbd_estimate_fault fault;
        rbd_observer *o;
        ck_assert_int_eq(rbd_observer_init(x.bare.m, &options, more, sizeof more, &o, NULL), RBD_OK);
        for (int k = 0; k < 100; k++)
            ck_assert_int_eq(rbd_observer_step(x.bare.m, x.bare.w, o, &q, &v, &tau, 0.1, &r, &band, NULL),
                             RBD_OK);
        ck_assert_double_eq_tol(band, slow ? 3 : 0, 1e-9);
        ck_assert_double_eq_tol(r, slow ? -3 : 0, 1e-9);
        ck_assert_int_eq(rbd_observer_step(x.bare.m, x.bare.w, o, &q, &huge, &tau, 0.1, &r, &band, &fault),
                         RBD_ERR_NAN); /* M v overflows */
        ck_assert_str_eq(fault.field, "v");
    }
}
END_TEST

START_TEST(texts_fit_their_memory) {
    const rbd_estimate_fault fault = {"tau", 12}, none = {NULL, -1};
    char text[40];
    ck_assert_str_eq(rbd_estimate_text(RBD_ERR_NAN, &fault, text, sizeof text), "tau[12]: not finite");
    ck_assert_str_eq(rbd_estimate_text(RBD_ERR_NAN, &fault, text, 6), "tau[1");
    ck_assert_str_eq(rbd_estimate_text(RBD_OK, &fault, text, sizeof text), "no error");
    ck_assert_str_eq(rbd_estimate_text(RBD_ERR_MEMORY, &none, text, sizeof text), "the memory is too small");
    ck_assert_str_eq(rbd_estimate_text(RBD_ERR_WORK, NULL, text, sizeof text),
                     "the memory is of another model");
    ck_assert_ptr_null(rbd_estimate_text(RBD_OK, NULL, NULL, 5));
    text[0] = 'x';
    rbd_estimate_text(RBD_OK, NULL, text, 0);
    ck_assert(text[0] == 'x');
}
END_TEST

Suite *estimate_suite(void) {
    Suite *suite = suite_create("estimate");
    TCase *c = tcase_create("estimate"), *slow = slow_tests(suite);
    tcase_set_timeout(c, 60);
    tcase_add_test(c, felt_torques_follow_as_a_filter);
    tcase_add_test(c, any_gain_is_stable);
    tcase_add_test(c, a_floating_base_feels_a_wrench);
    tcase_add_test(c, the_band_has_what_friction_hides);
    tcase_add_test(c, a_known_friction_is_not_felt);
    tcase_add_test(c, a_payload_and_friction_are_found);
    tcase_add_test(c, the_estimate_is_the_optimum);
    tcase_add_test(c, an_untold_payload_is_a_tenth_of_the_options);
    tcase_add_test(c, all_types_of_joints_learn);
    tcase_add_test(c, a_floating_base_weighs_its_payload);
    tcase_add_test(c, a_released_hand_is_empty);
    tcase_add_test(c, a_grip_needs_no_solve_before);
    tcase_add_test(c, friction_can_be_learnt_alone);
    tcase_add_test(c, errors_of_the_observer_have_their_names);
    tcase_add_test(c, errors_of_the_estimate_have_their_names);
    tcase_add_test(c, no_entry_behind_an_array_is_read);
    tcase_add_test(c, a_payload_of_the_world_is_not_felt);
    tcase_add_test(c, a_robot_without_masses_tells_nothing);
    tcase_add_test(c, slow_is_as_the_option_says);
    tcase_add_test(c, texts_fit_their_memory);
    tcase_add_test(slow, noise_costs_what_it_must);
    tcase_add_test(slow, deviations_are_those_of_the_errors);
    tcase_add_test(slow, little_motion_is_no_harm);
    tcase_add_test(slow, an_observer_does_not_drift);
    tcase_add_test(slow, an_estimate_does_not_drift);
    suite_add_tcase(suite, c);
    return suite;
}
