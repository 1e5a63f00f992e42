/* figures.c - on a microcontroller under QEMU: the worst stack and the instructions of each call, in random
   states. Prints ROBOT,ALGORITHM,WORK_BYTES,STACK_BYTES,INSTRUCTIONS; ends with status 1 if a result is
   wrong. SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>

#include "examples/firmware/board.h"
#include "rbd.h"
#include "rbd_derivatives.h"
#ifdef FIGURES_CONTACTS
#include "rbd_constraints.h"
#endif
#ifdef FIGURES_ESTIMATE
#include "rbd_estimate.h"
#endif

#ifdef FIGURES_GENERATED
#include "bench/firmware/atlas_code.h"
#include "bench/firmware/hyq_code.h"
#include "bench/firmware/iiwa_code.h"
#endif
#ifdef FIGURES_GENERATED_CONSTRAINED
#include "bench/firmware/five_bar_loop_code.h"
#include "bench/firmware/hyq_feet_code.h"
#define FIVE_BAR_MODEL_IMPLEMENTATION
#include "models/five_bar_model.h"
#endif
#define ATLAS_MODEL_IMPLEMENTATION
#define HYQ_MODEL_IMPLEMENTATION
#define IIWA_MODEL_IMPLEMENTATION
#include "models/atlas_model.h"
#include "models/hyq_model.h"
#include "models/iiwa_model.h"

/* How many of the robots fit into the board's RAM. */
#if FIGURES_ROBOTS == 1
#define WORK_SIZE IIWA_WORK_SIZE
enum { MAX_NQ = IIWA_NQ, MAX_NV = IIWA_NV, PAINTED = 3000 };
#elif FIGURES_ROBOTS == 2
#define WORK_SIZE HYQ_WORK_SIZE
enum { MAX_NQ = HYQ_NQ, MAX_NV = HYQ_NV, PAINTED = 3000 };
#else
#define WORK_SIZE ATLAS_WORK_SIZE
enum { MAX_NQ = ATLAS_NQ, MAX_NV = ATLAS_NV, PAINTED = 7000 };
#endif

enum { STATES = 8 };

static unsigned char memory[WORK_SIZE];
static rbd_real q[MAX_NQ], v[MAX_NV], a[MAX_NV], tau[MAX_NV], out[MAX_NV * MAX_NV];
static rbd_work *w;

/* Of hybrid dynamics: all but the first six torques are wanted. */
static rbd_real hybrid_a[MAX_NV], hybrid_tau[MAX_NV];
static unsigned char given[MAX_NV];

#if FIGURES_ROBOTS == 3 /* where there is RAM for it */
static unsigned char derivatives_memory[RBD_DERIVATIVES_SIZE(ATLAS_NB, ATLAS_NV)];
#if !defined FIGURES_ALONE && !defined FIGURES_ESTIMATE
static rbd_real by_v[MAX_NV * MAX_NV];
#endif
static rbd_derivatives *d;
#endif

#ifdef FIGURES_CONTACTS
/* HyQ on four points, Atlas on two flat feet: 12 rows each; the five-bar's loop has fewer. */
enum { ROWS = 12 };
static unsigned char constraints_memory[RBD_CONSTRAINT_SET_SIZE(ATLAS_NV, ROWS)];
static rbd_constraint_set *c;
static size_t set_size;
static rbd_real lambda[ROWS];
#ifndef FIGURES_OWN
static rbd_real by_v_lambda[ROWS * MAX_NV], by_q_lambda[ROWS * MAX_NV];
#endif

static rbd_constraint contact(int robot, int i) {
    static const int hyq[4] = {HYQ_BODY_LF_LOWERLEG, HYQ_BODY_RF_LOWERLEG, HYQ_BODY_LH_LOWERLEG,
                               HYQ_BODY_RH_LOWERLEG};
    static const int atlas[2] = {ATLAS_BODY_L_FOOT, ATLAS_BODY_R_FOOT};
    static const double shin[3] = {0.33, 0, 0}, sole[3] = {0.05, 0, -0.08};
    return robot == HYQ_NV ? rbd_point_contact(hyq[i], shin, NULL) : rbd_flat_contact(atlas[i], sole, NULL);
}

/* Lists the robot's constraints; returns how many. */
static int list_constraints(const rbd_model *m, rbd_constraint list[4]) {
#ifdef FIGURES_GENERATED_CONSTRAINED
    if (m == &five_bar_model) {
        list[0] = five_bar_constraints[0];
        return 1;
    }
#endif
    const int n = rbd_nv(m) == HYQ_NV ? 4 : 2;
    for (int i = 0; i < n; i++) list[i] = contact(rbd_nv(m), i);
    return n;
}
#endif

#ifdef FIGURES_ESTIMATE
/* The last body carries a payload: SAMPLES of its motion before the estimate is solved, or one. */
enum { SAMPLES = 200 };
static unsigned char observer_memory[RBD_OBSERVER_SIZE(ATLAS_NV)],
    estimate_memory[RBD_ESTIMATE_SIZE(ATLAS_NV)];
static rbd_observer *observer;
static rbd_estimate *estimate;
static rbd_const payload[10];
static rbd_joint_friction friction[MAX_NV];
#endif

/* ---- instructions ---- */

/* With -icount shift=4 an instruction takes 16 ns of the timer's time; RISC-V's minstret then counts ns. */
enum { INSTRUCTION_PS = 16000 };

static uint32_t now(void) {
#ifdef __riscv
    uint32_t count;
    __asm__ volatile("csrr %0, minstret" : "=r"(count));
    return count;
#else
    return board_now();
#endif
}

static double instructions(uint32_t from, uint32_t to) {
#ifdef __riscv
    return (double)(to - from) * 1000 / INSTRUCTION_PS;
#else
    return (double)((to - from) & BOARD_TICK_MASK) * BOARD_TICK_PS / INSTRUCTION_PS;
#endif
}

/* ---- algorithms: each one call, not inlined, from the state above ---- */

#define CALL(name, call) \
    static __attribute__((noinline)) rbd_status name(const rbd_model *m) { return call; }
CALL(nothing, m ? RBD_OK : RBD_ERR_NULL)
CALL(id, rbd_rnea(m, w, q, v, a, NULL, out))
CALL(fd, rbd_aba(m, w, q, v, tau, NULL, out))
#if defined FIGURES_OWN || (!defined FIGURES_CONTACTS && !defined FIGURES_ALONE && !defined FIGURES_ESTIMATE)
#define FIGURES_MAIN
CALL(mm, rbd_crba(m, w, q, out))
CALL(fd_cholesky, rbd_fd_cholesky(m, w, q, v, tau, NULL, out))
#if FIGURES_ROBOTS == 3
CALL(id_derivatives, rbd_id_derivatives(m, d, q, v, a, NULL, out, by_v, NULL))
CALL(fd_derivatives, rbd_fd_derivatives(m, d, q, v, tau, NULL, NULL, out, by_v, NULL))
#endif
#ifndef FIGURES_OWN
CALL(kinematics, rbd_kinematics(m, w, q, v, a))
CALL(jacobian, rbd_jacobian(m, w, rbd_nb(m) - 1, NULL, RBD_WORLD_AXES, out))
CALL(hybrid, rbd_hybrid(m, w, q, v, given, hybrid_a, hybrid_tau, NULL))
CALL(minv, rbd_minverse(m, w, q, out))
#if FIGURES_ROBOTS == 3
CALL(momentum_matrix, rbd_momentum_matrix(m, d, q, NULL, out, NULL))
CALL(coriolis, rbd_coriolis(m, d, q, v, out))
#endif
#endif
#endif

#ifdef FIGURES_CONTACTS
CALL(constrained_fd, rbd_constrained_fd(m, c, q, v, tau, NULL, out, lambda))
#ifndef FIGURES_OWN
CALL(impact, rbd_impact(m, c, q, v, 0, out, lambda))
CALL(constrained_id, rbd_constrained_id(m, c, q, v, a, NULL, NULL, NULL, out, lambda))
CALL(constrained_fd_derivatives,
     rbd_constrained_fd_derivatives(m, c, d, q, v, tau, NULL,
                                    &(rbd_constrained_fd_results){.da_dq = out,
                                                                  .da_dv = by_v,
                                                                  .dlambda_dq = by_q_lambda,
                                                                  .dlambda_dv = by_v_lambda}))
#endif
#endif

#ifdef FIGURES_ESTIMATE
CALL(observer_step, rbd_observer_step(m, w, observer, q, v, tau, (rbd_real)1e-3, out, NULL, NULL))
CALL(estimate_add, rbd_estimate_add(m, d, estimate, q, v, a, tau, NULL))
CALL(estimate_solve, m ? rbd_estimate_solve(estimate, payload, friction, NULL) : RBD_ERR_NULL)
CALL(estimate_solve_early, m ? rbd_estimate_solve(estimate, payload, friction, NULL) : RBD_ERR_NULL)
#endif

#ifdef FIGURES_GENERATED_CONSTRAINED /* rbd-codegen's, of the five-bar's loop and of HyQ on four points */
CALL(five_bar_loop, (m && five_bar_loop_constrained(q, v, tau, out, lambda) == 0 ? RBD_OK : RBD_ERR_SINGULAR))
CALL(hyq_feet, (m && hyq_feet_constrained(q, v, tau, out, lambda) == 0 ? RBD_OK : RBD_ERR_SINGULAR))
#endif

#ifdef FIGURES_GENERATED /* rbd-codegen's, each for its robot alone */
CALL(iiwa_generated_id, (iiwa_id(q, v, a, out), m ? RBD_OK : RBD_ERR_NULL))
CALL(iiwa_generated_fd, (m && iiwa_fd(q, v, tau, out) == 0 ? RBD_OK : RBD_ERR_SINGULAR))
CALL(hyq_generated_id, (hyq_id(q, v, a, out), m ? RBD_OK : RBD_ERR_NULL))
CALL(hyq_generated_fd, (m && hyq_fd(q, v, tau, out) == 0 ? RBD_OK : RBD_ERR_SINGULAR))
CALL(atlas_generated_id, (atlas_id(q, v, a, out), m ? RBD_OK : RBD_ERR_NULL))
CALL(atlas_generated_fd, (m && atlas_fd(q, v, tau, out) == 0 ? RBD_OK : RBD_ERR_SINGULAR))
#endif

typedef struct algorithm {
    const char *name;
    rbd_status (*call)(const rbd_model *m);
} algorithm;

#if defined FIGURES_OWN
static const algorithm algorithms[] = {{"id_own", id},
                                       {"mm_own", mm},
                                       {"fd_own", fd},
#if FIGURES_ROBOTS == 3
                                       {"id_derivatives_own", id_derivatives},
                                       {"fd_derivatives_own", fd_derivatives},
#endif
#ifdef FIGURES_CONTACTS
                                       {"constrained_fd_own", constrained_fd}
#endif
};
#elif defined FIGURES_CONTACTS
static const algorithm algorithms[] = {{"constrained_fd", constrained_fd},
                                       {"impact", impact},
                                       {"constrained_id", constrained_id},
                                       {"constrained_fd_derivatives", constrained_fd_derivatives}};
#elif defined FIGURES_ALONE
static const algorithm algorithms[] = {{"fd_alone", fd}};
#elif defined FIGURES_ESTIMATE
static const algorithm algorithms[] = {{"observer_step", observer_step},
                                       {"estimate_add", estimate_add},
                                       {"estimate_solve", estimate_solve},
                                       {"estimate_solve_early", estimate_solve_early}};
#else
static const algorithm algorithms[] = {
    {"id", id},
    {"mm", mm},
    {"fd", fd},
    {"fd_cholesky", fd_cholesky},
    {"kinematics", kinematics},
    {"jacobian", jacobian},
    {"hybrid", hybrid},
    {"minv", minv},
#if FIGURES_ROBOTS == 3
    {"momentum_matrix", momentum_matrix},
    {"coriolis", coriolis},
    {"id_derivatives", id_derivatives},
    {"fd_derivatives", fd_derivatives},
#endif
};
#endif

/* ---- stack ---- */

#ifdef __riscv
#define STACK_POINTER(sp) __asm__ volatile("mv %0, sp" : "=r"(sp))
#else
#define STACK_POINTER(sp) __asm__ volatile("mov %0, sp" : "=r"(sp))
#endif

/* Paints what lies below the stack pointer, calls, and looks how deep the paint is gone. */
static __attribute__((noinline)) int stack_of(rbd_status (*call)(const rbd_model *m), const rbd_model *m) {
    enum { PAINT = 0xa5 };
    volatile unsigned char *sp;
    STACK_POINTER(sp);
    for (int i = 1; i <= PAINTED; i++) sp[-i] = PAINT;
    const rbd_status status = call(m);
    int depth = PAINTED;
    while (depth > 0 && sp[-depth] == PAINT) depth--;
    return status == RBD_OK && depth < PAINTED ? depth : -1;
}

/* ---- robots ---- */

typedef struct robot {
    const char *name;
    const rbd_model *model;
#ifdef FIGURES_GENERATED
    algorithm generated[2];
#endif
} robot;

#ifdef FIGURES_GENERATED
#define GENERATED(name) \
    , { \
        {"generated_id", name##_generated_id}, { "generated_fd", name##_generated_fd } \
    }
#else
#define GENERATED(name)
#endif
static const robot robots[] = {{"iiwa", &iiwa_model GENERATED(iiwa)},
                               {"hyq", &hyq_model GENERATED(hyq)},
                               {"atlas", &atlas_model GENERATED(atlas)}};

/* Uniform in [-bound, bound), by a linear congruential generator. */
static void draw(rbd_real *x, int n, rbd_real bound, uint32_t *seed) {
    for (int i = 0; i < n; i++) {
        *seed = *seed * 1664525u + 1013904223u;
        x[i] = bound * ((rbd_real)(*seed >> 8) * (rbd_real)(1.0 / (1 << 23)) - 1);
    }
}

static rbd_status draw_state(const rbd_model *m, uint64_t *seed_q, uint32_t *seed) {
    const rbd_status status = rbd_random(m, seed_q, q);
    draw(v, rbd_nv(m), 2, seed);
    draw(a, rbd_nv(m), 3, seed);
    draw(tau, rbd_nv(m), 20, seed);
    for (int i = 0; i < rbd_nv(m); i++) {
        given[i] = i >= 6;
        hybrid_a[i] = a[i];
        hybrid_tau[i] = 0;
    }
    return status != RBD_OK ? status : rbd_kinematics(m, w, q, v, a); /* for the Jacobian */
}

#ifdef FIGURES_ESTIMATE
/* tau = rbd_rnea + friction + the torque of four masses on the last body: f = m (acceleration - gravity). */
static rbd_status draw_torque(const rbd_model *m) {
    static const rbd_real corner[4][3] = {{0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}, {-0.1f, -0.1f, -0.1f}};
    const rbd_real kilograms = 0.25f, gravity = 9.81f;
    const int body = rbd_nb(m) - 1;
    rbd_status status = rbd_rnea(m, w, q, v, a, NULL, tau);
    if (status == RBD_OK) status = rbd_kinematics(m, w, q, v, a);

    for (int i = 0; i < rbd_nv(m); i++) tau[i] += v[i] > 0 ? 1 + v[i] : v[i] - 1;
    for (int i = 0; i < 4 && status == RBD_OK; i++) {
        rbd_real f[6];
        status = rbd_point_acceleration(m, w, body, corner[i], RBD_WORLD_AXES, f);
        for (int j = 0; j < 3; j++) {
            f[j] = 0;
            f[3 + j] = kilograms * (f[3 + j] + (j == 2 ? gravity : 0));
        }
        if (status == RBD_OK) status = rbd_jacobian_transpose(m, w, body, corner[i], RBD_WORLD_AXES, f, out);
        for (int j = 0; j < rbd_nv(m); j++) tau[j] += out[j];
    }
    return status;
}

/* An observer after its first step, which takes the state alone; and an estimate after some samples. */
static rbd_status prepare_estimate(const rbd_model *m, int samples) {
    rbd_observer_options options = {0};
    uint64_t seed_q = 3;
    uint32_t seed = 4;
    options.gain = 30;
    rbd_status status =
        rbd_observer_init(m, &options, observer_memory, sizeof observer_memory, &observer, NULL);
    if (status == RBD_OK)
        status = rbd_estimate_init(m, rbd_nb(m) - 1, NULL, estimate_memory, sizeof estimate_memory, &estimate,
                                   NULL);
    for (int i = 0; i < samples && status == RBD_OK; i++) {
        status = draw_state(m, &seed_q, &seed);
        if (status == RBD_OK) status = draw_torque(m);
        if (status == RBD_OK) status = estimate_add(m);
    }
    return status == RBD_OK ? observer_step(m) : status;
}
#endif

static rbd_status prepare(const rbd_model *m) {
    const rbd_status status = rbd_work_init(m, memory, sizeof memory, &w);
#if FIGURES_ROBOTS == 3
    if (status != RBD_OK ||
        rbd_derivatives_init(m, w, derivatives_memory, sizeof derivatives_memory, &d) != RBD_OK)
        return RBD_ERR_MEMORY;
#endif
#ifdef FIGURES_CONTACTS
    rbd_constraint list[4];
    const int n = list_constraints(m, list);
    set_size = rbd_constraint_set_size(m, list, n);
    return rbd_constraint_set_init(m, w, list, n, constraints_memory, sizeof constraints_memory, &c, NULL);
#else
    return status;
#endif
}

/* The forward dynamics of the torque that inverse dynamics gives is the acceleration. */
static int gives_back(const rbd_model *m, const algorithm *inverse, const algorithm *forward) {
    const rbd_real bound = sizeof(rbd_real) == sizeof(float) ? (rbd_real)2e-2 : (rbd_real)1e-9;
    if (inverse->call(m) != RBD_OK) return 0;
    for (int i = 0; i < rbd_nv(m); i++) tau[i] = out[i];
    if (forward->call(m) != RBD_OK) return 0;
    for (int i = 0; i < rbd_nv(m); i++)
        if (!(out[i] - a[i] < bound && a[i] - out[i] < bound)) return 0;
    return 1;
}

/* The calls agree: each inverse dynamics is undone by rbd_aba, and each forward dynamics undoes rbd_rnea. */
static int is_right(const robot *r) {
    static const algorithm inverse[1] = {{"id", id}}, forward[1] = {{"fd", fd}};
#ifdef FIGURES_GENERATED
    if (!gives_back(r->model, &r->generated[0], forward) || !gives_back(r->model, inverse, &r->generated[1]))
        return 0;
#endif
#ifdef FIGURES_MAIN
    static const algorithm cholesky[1] = {{"fd_cholesky", fd_cholesky}};
    if (!gives_back(r->model, inverse, cholesky)) return 0;
#endif
    return gives_back(r->model, inverse, forward);
}

#ifdef FIGURES_GENERATED_CONSTRAINED
/* The generated code and the library's call find the same accelerations and forces, to a share of the largest
   of each. */
static int is_near(const rbd_real *x, const rbd_real *y, int n) {
    rbd_real largest = 1;
    for (int i = 0; i < n; i++)
        if (x[i] > largest || -x[i] > largest) largest = x[i] < 0 ? -x[i] : x[i];
    for (int i = 0; i < n; i++)
        if (!(x[i] - y[i] < largest * (rbd_real)1e-2 && y[i] - x[i] < largest * (rbd_real)1e-2)) return 0;
    return 1;
}
static int is_generated_constrained(const algorithm *g) {
    return g->call == five_bar_loop || g->call == hyq_feet;
}
static int is_constrained_right(const rbd_model *m, const algorithm *generated) {
    static rbd_real qdd[MAX_NV], force[ROWS];
    const int rows = rbd_constraint_rows(c);
    if (constrained_fd(m) != RBD_OK) return 0;
    for (int i = 0; i < rbd_nv(m); i++) qdd[i] = out[i], out[i] = (rbd_real)NAN;
    for (int i = 0; i < rows; i++) force[i] = lambda[i], lambda[i] = (rbd_real)NAN;
    return generated->call(m) == RBD_OK && is_near(qdd, out, rbd_nv(m)) && is_near(force, lambda, rows);
}
#endif

/* work: bytes that the call needs; generated code needs none. */
static int print_row(const robot *r, const algorithm *g, size_t work) {
    uint64_t seed_q = 1;
    uint32_t seed = 2;
    double sum = 0;
    int stack = 0;
    for (int i = 0; i < STATES; i++) {
        if (draw_state(r->model, &seed_q, &seed) != RBD_OK) return 0;
        const uint32_t start = now();
        const rbd_status status = nothing(r->model);
        const uint32_t middle = now();
        const rbd_status again = g->call(r->model);
        const uint32_t end = now();
        const int depth = stack_of(g->call, r->model);
        if (status != RBD_OK || again != RBD_OK || depth < 0) return 0;
        sum += instructions(middle, end) - instructions(start, middle);
        stack = depth > stack ? depth : stack;
#ifdef FIGURES_GENERATED_CONSTRAINED
        if (is_generated_constrained(g) && !is_constrained_right(r->model, g)) return 0;
#endif
        if (!is_right(r)) return 0;
    }
    printf("%s,%s,%lu,%d,%lu\n", r->name, g->name, (unsigned long)work, stack,
           (unsigned long)(sum / STATES + 0.5));
    return 1;
}

/* RAM: the work, and what a set of constraints, an observer or an estimate takes beside it. */
static size_t work_of(const rbd_model *m, const algorithm *g) {
#ifdef FIGURES_CONTACTS
    (void)g;
    return rbd_work_size(m) + set_size;
#elif defined FIGURES_ESTIMATE
    if (g->call == observer_step) return rbd_work_size(m) + rbd_observer_size(m);
    return rbd_work_size(m) + rbd_derivatives_size(m) + rbd_estimate_size(m);
#else
    (void)g;
    return rbd_work_size(m);
#endif
}

/* All that a row needs. */
static rbd_status prepare_row(const rbd_model *m, const algorithm *g) {
    const rbd_status status = prepare(m);
#ifdef FIGURES_ESTIMATE
    if (status == RBD_OK) return prepare_estimate(m, g->call == estimate_solve_early ? 1 : SAMPLES);
#else
    (void)g;
#endif
    return status;
}

/* The rows of some algorithms; work: whether they need one. */
static int print_rows(const robot *r, const algorithm *list, size_t n, int work) {
    for (size_t j = 0; j < n; j++)
        if (prepare_row(r->model, &list[j]) != RBD_OK ||
            !print_row(r, &list[j], work ? work_of(r->model, &list[j]) : 0)) {
            printf("%s, %s: wrong\n", r->name, list[j].name);
            return 0;
        }
    return 1;
}

int main(void) {
    board_start();
#if defined FIGURES_OWN /* the library's own robot */
    const size_t first = FIGURES_OWN, end = first + 1;
#elif defined FIGURES_CONTACTS
    const size_t first = 1, end = FIGURES_ROBOTS; /* the iiwa stands on nothing */
#else
    const size_t first = 0, end = FIGURES_ROBOTS;
#endif
    for (size_t i = first; i < end; i++) {
        if (!print_rows(&robots[i], algorithms, sizeof algorithms / sizeof *algorithms, 1)) return 1;
#ifdef FIGURES_GENERATED
        if (!print_rows(&robots[i], robots[i].generated, 2, 0)) return 1;
#endif
    }
#ifdef FIGURES_GENERATED_CONSTRAINED
    static const robot five_bar = {"five_bar", &five_bar_model}, *const hyq = &robots[1];
    static const algorithm loop[1] = {{"generated_constrained_fd", five_bar_loop}},
                           feet[1] = {{"generated_constrained_fd", hyq_feet}};
    if (!print_rows(&five_bar, loop, 1, 0) || !print_rows(hyq, feet, 1, 0)) return 1;
#endif
    return 0;
}
