/* all_calls.h - the results of the library's calls for one model, one after the other: for comparing builds.
   States follow from whole numbers, so that every build has the same. The file that includes this has
   included rbd_derivatives.h and, after it, rbd_contact.h, rbd_ik.h, rbd_estimate.h and rbd_actuator.h, with
   or without the implementation. */
#ifndef TESTS_ALL_CALLS_H
#define TESTS_ALL_CALLS_H

#include "plain_calls.h"
#include <stdlib.h>
#include <string.h>

/* Takes the status and the n results of a call, and the header that declares it. */
typedef void all_calls_sink(void *to, const char *header, const char *call, rbd_status status,
                            const rbd_real *x, int n);

/* From -1 to 1, in steps of 2^-20: Lehmer's generator. */
static rbd_real all_calls_number(uint64_t *seed) {
    *seed = *seed * 48271u % 2147483647u;
    return (rbd_real)((double)(int64_t)(*seed % 2097152u) / 1048576 - 1);
}

static void all_calls_numbers(uint64_t *seed, rbd_real size, rbd_real *x, int n) {
    for (int i = 0; i < n; i++) x[i] = size * all_calls_number(seed);
}

typedef struct all_calls {
    const rbd_model *m;
    rbd_work *w;
    rbd_derivatives *d;
    int nb, nq, nv, nh, room;
    rbd_real *q, *v, *a, *tau, *f_ext, *out, *q2; /* v, a, tau and f_ext one behind the other */
    rbd_const *weights;
    unsigned char *given;
    all_calls_sink *sink;
    void *to;
    const char *header;
} all_calls;

#define ALL_CALLS_RUN(call, n) ALL_CALLS_NAMED(#call, call, n)
#define ALL_CALLS_NAMED(name, call, n) \
    do { \
        const int n_ = (n); \
        memset(s->out, 0, sizeof(rbd_real) * (size_t)s->room); \
        const rbd_status status_ = call; \
        s->sink(s->to, s->header, name, status_, s->out, n_); \
    } while (0)

static void all_calls_put(rbd_real *to, const rbd_const *x, int n) {
    for (int i = 0; i < n; i++) to[i] = (rbd_real)x[i];
}

/* Names, indices and sizes of the model, and random positions. */
static void all_calls_model(all_calls *s) {
    rbd_real *o = s->out;
    uint64_t seed = 11;
    s->header = "rbd.h";
    ALL_CALLS_RUN((o[0] = (rbd_real)rbd_mass(s->m), RBD_OK), 1);
    ALL_CALLS_RUN(rbd_random(s->m, &seed, o), s->nq);
    for (int i = 0; i < s->nb; i++) {
        rbd_joint_info joint;
        ALL_CALLS_RUN(rbd_joint(s->m, i, &joint), 0);
        ALL_CALLS_RUN((o[0] = (rbd_real)joint.type, o[1] = (rbd_real)joint.iq, o[2] = (rbd_real)joint.nq,
                       o[3] = (rbd_real)joint.iv, o[4] = (rbd_real)joint.nv, o[5] = (rbd_real)joint.lower,
                       o[6] = (rbd_real)joint.upper, o[7] = (rbd_real)joint.velocity,
                       o[8] = (rbd_real)joint.effort, RBD_OK),
                      9);
        ALL_CALLS_RUN((o[0] = (rbd_real)rbd_body_index(s->m, rbd_body_name(s->m, i)), RBD_OK), 1);
        ALL_CALLS_RUN((o[0] = (rbd_real)rbd_joint_index(s->m, rbd_joint_name(s->m, i)), RBD_OK), 1);
    }
    for (int k = 0; k < s->nv; k++)
        ALL_CALLS_RUN(
            (o[0] = (rbd_real)rbd_dof_body(s->m, k), o[1] = (rbd_real)rbd_packed_index(s->m, k, 0), RBD_OK),
            2);
}

/* With gravity askew. */
static void all_calls_gravity(all_calls *s) {
    const rbd_const askew[3] = {(rbd_const)1.5, (rbd_const)-2.25, (rbd_const)-8};
    rbd_const before[3];
    rbd_real *o = s->out;
    s->header = "rbd.h";
    ALL_CALLS_RUN(rbd_get_gravity(s->w, before), 0);
    ALL_CALLS_RUN(rbd_set_gravity(s->w, askew), 0);
    ALL_CALLS_RUN(rbd_gravity_torque(s->m, s->w, s->q, o), s->nv);
    ALL_CALLS_RUN((all_calls_put(o, before, 3), rbd_set_gravity(s->w, before)), 3);
}

#define MODEL s->m
#define WORK s->w
#define DERIVATIVES s->d
#define BODY body
#define OTHER_BODY (s->nb - 1 - body)
#define AXES (body % 2 ? RBD_LINK_AXES : RBD_WORLD_AXES)
#define NUMBER (rbd_real)0.0078125
#define NQ s->nq
#define NV s->nv
#define NB s->nb
#define NH s->nh
#define Q(k) (k ? s->q2 : s->q)
#define IN(k, n) (s->v + k * s->nv)
#define WEIGHTS(n) s->weights
#define OUT(at, n) (s->out + (at))
#define RUN_OF_BODY(of, name, may_fail, arguments, n) \
    s->header = of; \
    ALL_CALLS_NAMED(#name, name arguments, n);
#define RUN_PLAIN(of, name, may_fail, arguments, n) \
    s->header = of; \
    (void)rbd_kinematics(s->m, s->w, s->q, s->v, s->a); \
    ALL_CALLS_NAMED(#name, name arguments, n);

/* The plain calls: see tests/calls.py. */
static void all_calls_plain(all_calls *s) {
    PLAIN_CALLS(RUN_PLAIN)
    (void)rbd_kinematics(s->m, s->w, s->q, s->v, s->a);
    for (int body = 0; body < s->nb; body++) {
        BODY_CALLS(RUN_OF_BODY)
    }
}

#undef MODEL
#undef WORK
#undef DERIVATIVES
#undef BODY
#undef OTHER_BODY
#undef AXES
#undef NUMBER
#undef NQ
#undef NV
#undef NB
#undef NH
#undef Q
#undef IN
#undef WEIGHTS
#undef OUT
#undef RUN_OF_BODY
#undef RUN_PLAIN

/* The other calls of rbd.h, and what the plain ones do with other arguments. */
static void all_calls_dynamics(all_calls *s) {
    const int nv = s->nv;
    rbd_real *o = s->out;
    s->header = "rbd.h";
    ALL_CALLS_RUN(rbd_bias(s->m, s->w, s->q, s->v, NULL, o), nv);
    ALL_CALLS_RUN((memcpy(o, s->a, sizeof *o * (size_t)nv), memcpy(o + nv, s->tau, sizeof *o * (size_t)nv),
                   rbd_hybrid(s->m, s->w, s->q, s->v, s->given, o, o + nv, s->f_ext)),
                  2 * nv);
    ALL_CALLS_RUN((rbd_crba(s->m, s->w, s->q, o), rbd_cholesky_factor(s->m, s->w, o, o)), s->nh);
    ALL_CALLS_RUN((rbd_crba_packed(s->m, s->w, s->q, o), rbd_cholesky_factor_packed(s->m, s->w, o)), s->nh);
    rbd_real *factor = (rbd_real *)malloc(sizeof *factor * (size_t)(nv * nv + 1));
    memcpy(factor, o, sizeof *o * (size_t)s->nh);
    ALL_CALLS_RUN(rbd_cholesky_solve(s->m, s->w, factor, s->tau, o), nv);
    ALL_CALLS_RUN(rbd_cholesky_solve_many(s->m, s->w, factor, 2, s->v, o), 2 * nv); /* of v and a */
    free(factor);
    ALL_CALLS_RUN((o[0] = (rbd_real)rbd_singular_dof(s->w), RBD_OK), 1);
}

static void all_calls_kinematics(all_calls *s) {
    const int nv = s->nv, last = s->nb - 1;
    const rbd_real point[3] = {(rbd_real)0.125, (rbd_real)-0.25, (rbd_real)0.375};
    rbd_real *o = s->out;
    s->header = "rbd.h";
    ALL_CALLS_RUN(rbd_kinematics(s->m, s->w, s->q, s->v, s->a), 0);
    ALL_CALLS_RUN(rbd_jacobian(s->m, s->w, last, point, RBD_WORLD_AXES, o), 6 * nv);
    ALL_CALLS_RUN(rbd_jacobian(s->m, s->w, last, point, RBD_LINK_AXES, o), 6 * nv);
    ALL_CALLS_RUN(rbd_body_kinematics(s->m, s->w, last, s->q, s->v, NULL), 0);
    ALL_CALLS_RUN(rbd_point_acceleration(s->m, s->w, last, point, RBD_LINK_AXES, o), 6);
    ALL_CALLS_RUN(rbd_integrate(s->m, s->q, s->v, (rbd_real)0.5, o), s->nq);
    ALL_CALLS_RUN(rbd_step(s->m, s->q, s->v, s->a, (rbd_real)0.5, o, o + s->nq), s->nq + nv);
    for (int i = 0; i < 3; i++)
        ALL_CALLS_RUN(rbd_interpolate(s->m, s->q, s->q2, (rbd_real)0.5 * (rbd_real)i, o), s->nq);
    ALL_CALLS_RUN(rbd_distance(s->m, s->q, s->q2, NULL, o), 1);
    ALL_CALLS_RUN(
        (rbd_rates_from_velocity(s->m, s->q, s->v, o), rbd_velocity_from_rates(s->m, s->q, o, o + s->nq)),
        s->nq + nv);
}

/* The other calls of rbd_derivatives.h. */
static void all_calls_derivatives(all_calls *s) {
    const int nv = s->nv, n = nv * nv;
    rbd_real *o = s->out;
    s->header = "rbd_derivatives.h";
    ALL_CALLS_RUN(rbd_integrate_derivatives(s->m, s->v, (rbd_real)0.5, o, o + n), 2 * n);
    ALL_CALLS_RUN(
        (memcpy(o, s->a, sizeof *o * (size_t)nv), rbd_id_free_base(s->m, s->d, s->q, s->v, o, o + nv, NULL)),
        2 * nv);
    for (int i = 0; i < s->nb; i++) {
        rbd_const pi[10];
        rbd_body body;
        memset(&body, 0, sizeof body);
        ALL_CALLS_RUN((rbd_body_parameters(s->m, i, pi), all_calls_put(o, pi, 10), rbd_check_parameters(pi)),
                      10);
        ALL_CALLS_RUN(rbd_set_parameters(&body, pi), 0);
        for (int k = 0; k < 3; k++) o[k] = (rbd_real)body.com[k];
        for (int k = 0; k < 6; k++) o[3 + k] = (rbd_real)body.inertia[k];
        s->sink(s->to, s->header, "what rbd_set_parameters set", RBD_OK, o, 9);
    }
    ALL_CALLS_RUN(rbd_keep_zeros(s->d, 1), 0);
    ALL_CALLS_RUN(rbd_id_derivatives(s->m, s->d, s->q, s->v, s->a, s->f_ext, o, o + n, NULL), 2 * n);
    ALL_CALLS_RUN(rbd_keep_zeros(s->d, 0), 0);
}

static void all_calls_constraint_set(all_calls *s, const rbd_constraint *list, int constraints) {
    const int nv = s->nv;
    const size_t size = rbd_constraint_set_size(s->m, list, constraints),
                 derivatives_size = rbd_derivatives_size(s->m);
    void *memory = malloc(size), *derivatives_memory = malloc(derivatives_size);
    rbd_constraint_set *c;
    rbd_derivatives *d;
    rbd_real *o = s->out;
    s->header = "rbd_constraints.h";
    ALL_CALLS_RUN(rbd_constraint_set_init(s->m, s->w, list, constraints, memory, size, &c, NULL), 0);
    ALL_CALLS_RUN(rbd_derivatives_init(s->m, s->w, derivatives_memory, derivatives_size, &d), 0);
    const int rows = rbd_constraint_rows(c);
    ALL_CALLS_RUN(rbd_constraint_jacobian(s->m, c, s->q, s->v, o, o + rows * nv, NULL), rows * (nv + 1));
    ALL_CALLS_RUN(rbd_constrained_fd(s->m, c, s->q, s->v, s->tau, s->f_ext, o, o + nv), nv + rows);
    ALL_CALLS_RUN(rbd_impact(s->m, c, s->q, s->v, (rbd_real)0.5, o, o + nv), nv + rows);
    ALL_CALLS_RUN((o[0] = (rbd_real)rbd_constraint_rank(c), o[1] = (rbd_real)rbd_infeasible_row(c),
                   o[2] = (rbd_real)rbd_constraint_first(c, 1), RBD_OK),
                  3);
    ALL_CALLS_RUN(rbd_constrained_id(s->m, c, s->q, s->v, s->a, s->f_ext, NULL, NULL, o, o + nv), nv + rows);
    ALL_CALLS_RUN(rbd_assemble(s->m, c, s->q, s->v, NULL, o, o + s->nq), s->nq + nv);
    const int n = nv * nv, k = rows * nv;
    rbd_real *by = o + nv + rows;
    const rbd_constrained_fd_results out = {.a = o,
                                            .lambda = o + nv,
                                            .da_dq = by,
                                            .da_dv = by + n,
                                            .da_dtau = by + 2 * n,
                                            .dlambda_dq = by + 3 * n,
                                            .dlambda_dv = by + 3 * n + k,
                                            .dlambda_dtau = by + 3 * n + 2 * k};
    ALL_CALLS_RUN(rbd_constrained_fd_derivatives(s->m, c, d, s->q, s->v, s->tau, s->f_ext, &out),
                  nv + rows + 3 * n + 3 * k);
    free(memory), free(derivatives_memory);
}

/* The last body is held at a point, and another in all axes; or the same two as by a ball and a hinge. */

static void all_calls_constraints(all_calls *s) {
    const double place[3] = {0.125, 0, 0.25}, axis[3] = {0.25, 1, -0.5};
    const rbd_constraint contacts[2] = {rbd_point_contact(s->nb - 1, place, NULL),
                                        rbd_flat_contact(s->nb / 2, NULL, NULL)};
    const rbd_constraint loops[2] = {rbd_ball_loop(s->nb - 1, place, -1, axis),
                                     rbd_hinge_loop(s->nb / 2, place, axis, -1, place, axis)};
    all_calls_constraint_set(s, contacts, 2);
    all_calls_constraint_set(s, loops, 2);
}

/* A problem of two contacts and two bounded rows, by itself. */
static void all_calls_contact_problem(all_calls *s, uint64_t *seed) {
    enum { ROWS = 8 };
    const rbd_real friction[2] = {(rbd_real)0.5, (rbd_real)0.75}, lower[2] = {-2, 0}, upper[2] = {2, 1};
    rbd_real delta[ROWS * ROWS], b[ROWS];
    for (int i = 0; i < ROWS; i++)
        for (int k = 0; k <= i; k++)
            delta[ROWS * i + k] = delta[ROWS * k + i] = all_calls_number(seed) + (i == k ? 9 : 0);
    all_calls_numbers(seed, 8, b, ROWS);
    const rbd_contact_problem problem = {.contacts = 2,
                                         .bounded = 2,
                                         .delta = delta,
                                         .b = b,
                                         .friction = friction,
                                         .lower = lower,
                                         .upper = upper};
    const size_t size = rbd_contact_solve_size(2, 2);
    void *memory = malloc(size);
    rbd_contact_state state[2];
    rbd_contact_solution solution;
    rbd_real *o = s->out;
    s->header = "rbd_contact.h";
    ALL_CALLS_RUN(rbd_contact_solve(&problem, memory, size, o, state, &solution), ROWS);
    ALL_CALLS_RUN((o[0] = solution.residual, o[1] = (rbd_real)solution.sweeps,
                   o[2] = (rbd_real)solution.newton_steps, o[3] = (rbd_real)state[0],
                   o[4] = (rbd_real)state[1], RBD_OK),
                  5);
    free(memory);
}

/* The last body and one in the middle touch planes just below them. */
static void all_calls_contact(all_calls *s) {
    rbd_contact list[2] = {{.body1 = s->nb - 1, .body2 = -1, .point = {0.125, 0, 0.25}, .friction = 0.5},
                           {.body1 = s->nb / 2, .body2 = -1, .radius = 0.25, .friction = 0.75}};
    const rbd_contact_options options = {.margin = 100,
                                         .joint_limits = 1,
                                         .joint_friction = 1,
                                         .joint_damping = 1,
                                         .derivatives = 1,
                                         .rows = 1};
    const rbd_contact_row row = {.dofs = s->nv > 1 ? 2 : 1,
                                 .dof = {s->nv - 1, 0},
                                 .jacobian = {1, (rbd_real)0.5},
                                 .lower = (rbd_real)-0.5,
                                 .upper = (rbd_real)0.25};
    const double slope[3] = {0.25, -0.5, 2};
    const size_t size = rbd_contact_set_size(s->m, 2, NULL, 0, &options),
                 derivatives_size = rbd_derivatives_size(s->m);
    void *memory = malloc(size), *derivatives_memory = malloc(derivatives_size);
    const int nq = s->nq, nv = s->nv, n = nv * nv;
    rbd_contact_set *c;
    rbd_derivatives *d;
    rbd_real *o = s->out, *added = calloc((size_t)s->nh, sizeof *added);
    for (int k = 0; k < s->nv; k++) added[rbd_packed_index(s->m, k, k)] = (rbd_real)0.125;
    s->header = "rbd_contact.h";
    ALL_CALLS_RUN(rbd_contact_set_init(s->m, s->w, list, 2, NULL, 0, &options, memory, size, &c, NULL), 0);
    ALL_CALLS_RUN(
        rbd_contact_step(s->m, c, s->q, s->v, s->tau, s->f_ext, NULL, (rbd_real)0.0078125, o, o + s->nq),
        s->nq + s->nv);
    for (int i = 0; i < 2; i++) ALL_CALLS_RUN((o[4] = (rbd_real)rbd_contact_get(c, i, o, o + 1), RBD_OK), 5);
    rbd_contact_solution last;
    ALL_CALLS_RUN((last = rbd_contact_last(c), o[0] = last.residual, o[1] = (rbd_real)last.sweeps,
                   o[2] = (rbd_real)last.newton_steps, RBD_OK),
                  3);
    ALL_CALLS_RUN(rbd_contact_fd(s->m, c, s->q, s->v, s->tau, s->f_ext, NULL, (rbd_real)0.0078125, o), nv);
    ALL_CALLS_RUN(rbd_contact_plane(s->m, c, 0, slope, 0.125), 0);
    ALL_CALLS_RUN((rbd_contact_reset(c), RBD_OK), 0);
    ALL_CALLS_RUN(rbd_contact_row_set(s->m, c, 0, &row), 0);
    ALL_CALLS_RUN(rbd_contact_friction(s->m, c, nv - 1, (rbd_real)0.25), 0);
    ALL_CALLS_RUN(rbd_contact_inertia(s->m, c, added), 0);
    ALL_CALLS_RUN(rbd_derivatives_init(s->m, s->w, derivatives_memory, derivatives_size, &d), 0);
    rbd_real *by = o + nq + nv;
    const rbd_contact_step_results out = {.q_next = o,
                                          .v_next = o + nq,
                                          .dq_next_dq = by,
                                          .dq_next_dv = by + n,
                                          .dq_next_dtau = by + 2 * n,
                                          .dv_next_dq = by + 3 * n,
                                          .dv_next_dv = by + 4 * n,
                                          .dv_next_dtau = by + 5 * n};
    ALL_CALLS_RUN(rbd_contact_step_derivatives(s->m, c, d, s->q, s->v, s->tau, s->f_ext, NULL,
                                               (rbd_real)0.0078125, &out),
                  nq + nv + 6 * n);
    ALL_CALLS_RUN((o[1] = (rbd_real)rbd_contact_row_get(c, 0, o), RBD_OK), 2);
    free(memory), free(derivatives_memory), free(added);
}

/* Inverse kinematics: the last body's pose at q2 from q, an axis and a place that need not be reached: the
   centre of mass if there is mass. The default options, which try long in vain, for the pose alone. */
static void all_calls_ik(all_calls *s) {
    enum { TARGETS = 3 };
    const int nq = s->nq, most = rbd_mass(s->m) > 0 ? TARGETS : TARGETS - 1;
    const size_t size = rbd_ik_size(s->m, TARGETS);
    const rbd_ik_options options = {.starts = 3, .evaluations = 200};
    rbd_ik_target target[TARGETS] = {
        {.kind = RBD_IK_POSE, .body = s->nb - 1, .point = {0, 0, (rbd_real)0.125}},
        {.kind = RBD_IK_AXIS, .body = s->nb / 2, .axis = {0, 0, 1}, .direction = {1, 2, -2}, .weight = 2},
        {.kind = RBD_IK_COM, .position = {(rbd_real)0.25, 0, (rbd_real)0.5}}};
    void *memory = malloc(size);
    s->header = "rbd_ik.h";
    rbd_kinematics(s->m, s->w, s->q2, NULL, NULL);
    rbd_body_pose(s->m, s->w, s->nb - 1, target[0].rotation, NULL);
    rbd_point_position(s->m, s->w, s->nb - 1, target[0].point, target[0].position);
    for (int n = 1; n <= most; n++) {
        rbd_ik_result result = {0};
        rbd_real *o = s->out;
        memset(o, 0, sizeof(rbd_real) * (size_t)s->room);
        for (int k = 0; k < nq; k++) o[k] = s->q[k];
        const rbd_ik_status status =
            rbd_ik(s->m, s->w, target, n, n == 1 ? NULL : &options, memory, size, o, &result);
        o[nq] = result.metres, o[nq + 1] = result.radians, o[nq + 2] = (rbd_real)result.evaluations;
        s->sink(s->to, s->header, "rbd_ik", (rbd_status)status, o, nq + 3);
    }
    free(memory);
}

/* External torques between the states q and q2; friction and payload of the last body from a few samples. */
static void all_calls_observer(all_calls *s) {
    const size_t size = rbd_observer_size(s->m);
    rbd_joint_friction *friction = (rbd_joint_friction *)calloc((size_t)s->nv + 1, sizeof *friction);
    rbd_observer_options options = {.gain = 40, .share = (rbd_real)0.25, .least = 1, .friction = friction};
    rbd_real *o = s->out;
    void *memory = malloc(size);
    rbd_observer *x;
    for (int i = 0; i < s->nv; i++) friction[i].coulomb = friction[i].viscous = (rbd_real)(i % 3);
    ALL_CALLS_RUN(rbd_observer_init(s->m, &options, memory, size, &x, NULL), 0);
    for (int k = 0; k < 3 && x; k++)
        ALL_CALLS_RUN(rbd_observer_step(s->m, s->w, x, k % 2 ? s->q2 : s->q, s->v, s->tau, (rbd_real)0.0625,
                                        o, o + s->nv, NULL),
                      2 * s->nv);
    if (x) ALL_CALLS_RUN(rbd_observer_reset(x), 0);
    free(memory), free(friction);
}

static void all_calls_estimate(all_calls *s) {
    const size_t size = rbd_estimate_size(s->m);
    rbd_joint_friction *friction = (rbd_joint_friction *)calloc((size_t)s->nv + 1, sizeof *friction);
    rbd_real *o = s->out;
    rbd_const payload[10];
    void *memory = malloc(size);
    rbd_estimate *e;
    s->header = "rbd_estimate.h";
    all_calls_observer(s);
    ALL_CALLS_RUN(rbd_estimate_init(s->m, s->nb - 1, NULL, memory, size, &e, NULL), 0);
    for (int k = 0; k < 4 && e; k++) {
        ALL_CALLS_RUN(
            rbd_estimate_add(s->m, s->d, e, k % 2 ? s->q2 : s->q, k < 2 ? s->v : s->a, s->a, s->tau, NULL),
            0);
        ALL_CALLS_RUN(rbd_estimate_solve(e, payload, friction, o), 1);
        all_calls_put(o, payload, 10), memcpy(o + 10, friction, sizeof *friction * (size_t)s->nv);
        s->sink(s->to, s->header, "friction and payload", RBD_OK, o, 10 + 3 * s->nv);
        ALL_CALLS_RUN(rbd_estimate_deviations(e, payload, friction), 0);
        all_calls_put(o, payload, 10), memcpy(o + 10, friction, sizeof *friction * (size_t)s->nv);
        s->sink(s->to, s->header, "deviations", RBD_OK, o, 10 + 3 * s->nv);
        if (k == 1) ALL_CALLS_RUN(rbd_estimate_grip(e), 0);
        if (k == 2) ALL_CALLS_RUN(rbd_estimate_release(e), 0);
    }
    free(memory), free(friction);
}

/* A motor for each of up to six joints: of all kinds, in turn. Returns how many. */
static int all_calls_motors(const all_calls *s, rbd_motor *motors) {
    int n = 0;
    memset(motors, 0, 6 * sizeof *motors);
    for (int k = 0; k < s->nv && n < 6; k++) {
        const int body = rbd_dof_body(s->m, k);
        rbd_joint_info joint;
        rbd_motor *motor = &motors[n];
        rbd_joint(s->m, body, &joint);
        if (joint.nv != 1 || joint.nq != 1 || !rbd_joint_name(s->m, body)) continue;
        motor->joint = rbd_joint_name(s->m, body);
        motor->gear = (rbd_const)(n % 2 ? -30 : 50), motor->constant = (rbd_const)0.0625;
        motor->resistance = (rbd_const)0.5, motor->current = 20, motor->voltage = 24;
        motor->copper = (rbd_const)0.00390625, motor->heat_winding = 20, motor->heat_case = 300;
        motor->flow_winding = (rbd_const)1.5, motor->flow_case = 3, motor->hot = 80, motor->hottest = 120;
        motor->cogging = (rbd_const)0.015625, motor->teeth = 12, motor->step = (rbd_const)0.0009765625;
        motor->delay = n % 2, motor->sampled = n % 5 == 4;
        if (n % 3 == 1) motor->stiffness = 2000, motor->damping = 2, motor->backlash = (rbd_const)0.0078125;
        if (n % 3 == 2) motor->friction.bristle = 1000;
        motor->friction.coulomb = 1, motor->friction.viscous = (rbd_const)0.5,
        motor->friction.rest = (rbd_const)0.5;
        motor->friction.load_motor = (rbd_const)0.125, motor->friction.load_joint = (rbd_const)0.0625;
        motor->friction.rest_motor = (rbd_const)0.0625, motor->friction.rest_joint = (rbd_const)0.03125;
        motor->friction.square_motor = motor->friction.square_joint = (rbd_const)0.00390625;
        motor->friction.speed = (rbd_const)0.25, motor->friction.power = (rbd_const)1.375;
        motor->inertia = n % 3 == 1 ? (rbd_const)0.0001220703125 : 0;
        n++;
    }
    return n;
}

/* Actuators without and with a transmission, and a rotor. A joint with armature is refused a spring. */
static void all_calls_actuator(all_calls *s) {
    const int nv = s->nv;
    rbd_motor motors[6];
    rbd_command commands[6] = {{0}};
    rbd_drive drives[6];
    rbd_actuator_state state;
    rbd_actuators *a = NULL;
    rbd_transmission both = {.kind = RBD_BY_MATRIX, .n = 2, .matrix = {1, 0, 1, -1}};
    const rbd_rotor rotor = {
        .body = s->nb - 1, .dof = 0, .axis = {1, 2, 2}, .gear = 9, .inertia = (rbd_const)0.0078125};
    const int n = all_calls_motors(s, motors);
    const size_t size = rbd_actuators_size(6, 1, 1);
    void *memory = malloc(size);
    rbd_real *o = s->out;
    s->header = "rbd_actuator.h";
    for (int i = 0; i < 6; i++)
        commands[i].kp = 200, commands[i].kd = 2, commands[i].torque = (rbd_real)(i - 2);
    for (int coupled = 0; coupled < 2 && n > coupled; coupled++) {
        if (coupled) {
            both.joint[0] = motors[0].joint, both.joint[1] = motors[1].joint;
            motors[0].joint = motors[1].joint = NULL;
        }
        ALL_CALLS_RUN(rbd_actuators_init(s->m, motors, n, &both, coupled, memory, size, &a, NULL), 0);
        if (!a) continue;
        ALL_CALLS_RUN(rbd_actuators_reset(a, s->q2, 25), 0);
        ALL_CALLS_RUN(rbd_actuators_map(a, s->q, s->v, o, o + n), 2 * n);
        ALL_CALLS_RUN((o[0] = (rbd_real)rbd_actuators_fault(a), RBD_OK), 1);
        for (int k = 0; k < 2; k++) {
            rbd_real dt = (rbd_real)0.0078125;
            ALL_CALLS_RUN(rbd_actuators_begin(a, commands, s->q, s->v, dt, k, o, o + nv), 2 * nv);
            ALL_CALLS_RUN(rbd_actuators_derivatives(a, o, o + nv * nv, o + 2 * nv * nv),
                          2 * nv * nv + nv * n);
            ALL_CALLS_RUN((o[2 * nv] = (rbd_real)rbd_actuators_again(a, s->v, o, o + nv), RBD_OK),
                          2 * nv + 1);
            while (rbd_actuators_again(a, s->v, o, o + nv)) {
            }
        }
        for (int i = 0; i < n; i++) {
            ALL_CALLS_RUN((rbd_actuators_get(a, i, &state), o[0] = state.angle, o[1] = state.speed,
                           o[2] = state.motor, o[3] = state.joint, o[4] = state.friction,
                           o[5] = state.winding, RBD_OK),
                          6);
            ALL_CALLS_RUN(
                (o[0] = rbd_friction_level(&motors[i].friction, s->v[0], s->tau[0], s->a[0]), RBD_OK), 1);
        }
        ALL_CALLS_RUN(rbd_actuators_inverse(a, s->q, s->v, s->a, s->tau, drives), 0);
        for (int i = 0; i < n; i++)
            ALL_CALLS_RUN((o[0] = drives[i].torque, o[1] = drives[i].current, o[2] = drives[i].voltage,
                           o[3] = drives[i].by_torque, RBD_OK),
                          4);
    }
    for (int i = 0; i < 6 * s->nb; i++) o[nv + i] = 0;
    ALL_CALLS_RUN(rbd_rotor_torque(s->m, s->w, &rotor, 1, s->q, s->v, s->a, o + nv, o), nv);
    free(memory);
}

/* All of it, at `states` states. */
static void all_calls_of(const rbd_model *m, int states, all_calls_sink *sink, void *to) {
    uint64_t seed = 1;
    all_calls all = {.m = m, .sink = sink, .to = to}, *s = &all;
    const size_t size = rbd_work_size(m), d_size = rbd_derivatives_size(m);
    void *memory = malloc(size), *d_memory = malloc(d_size);
    const int nb = s->nb = rbd_nb(m), nq = s->nq = rbd_nq(m), nv = s->nv = rbd_nv(m);
    rbd_real *x;
    s->room = 6 * nv * nv + 24 * (nv + nb) + 10 * nb * nv + 64 * nv + 64;
    x = (rbd_real *)calloc((size_t)(2 * nq + 3 * nv + 6 * nb + s->room), sizeof(rbd_real));
    s->q = x, s->q2 = s->q + nq, s->v = s->q2 + nq, s->a = s->v + nv, s->tau = s->a + nv,
    s->f_ext = s->tau + nv;
    s->out = s->f_ext + 6 * nb;
    s->nh = rbd_packed_size(m);
    s->given = (unsigned char *)calloc((size_t)nv + 1, 1);
    s->weights = (rbd_const *)malloc(sizeof *s->weights * (size_t)(nv + 1));
    for (int k = 0; k < nv; k++) s->weights[k] = (rbd_const)0.25 * (rbd_const)(k % 4);
    s->header = "rbd.h";
    ALL_CALLS_RUN(rbd_work_init(m, memory, size, &s->w), 0);
    s->header = "rbd_derivatives.h";
    if (s->w) ALL_CALLS_RUN(rbd_derivatives_init(m, s->w, d_memory, d_size, &s->d), 0);
    all_calls_model(s);
    for (int i = 0; i < states && s->w; i++) {
        s->header = "rbd.h";
        ALL_CALLS_RUN((rbd_neutral(m, s->q), rbd_neutral(m, s->q2)), 0);
        all_calls_numbers(&seed, 2, s->v, nv);
        ALL_CALLS_RUN(rbd_integrate(m, s->q2, s->v, 1, s->q2), 0);
        all_calls_numbers(&seed, i < 2 ? 2 : (rbd_real)(1 << (8 * i)), s->v,
                          nv); /* also angles of any size */
        ALL_CALLS_RUN(rbd_integrate(m, s->q, s->v, 1, s->q), 0);
        all_calls_numbers(&seed, 3, s->v, nv);
        all_calls_numbers(&seed, 9, s->a, nv);
        all_calls_numbers(&seed, 50, s->tau, nv);
        all_calls_numbers(&seed, 30, s->f_ext, 6 * nb);
        for (int k = 0; k < nv; k++) s->given[k] = (unsigned char)(k % 3 == 0);
        all_calls_plain(s);
        all_calls_dynamics(s);
        all_calls_gravity(s);
        all_calls_kinematics(s);
        all_calls_derivatives(s);
        all_calls_constraints(s);
        all_calls_contact(s);
        all_calls_contact_problem(s, &seed);
        all_calls_ik(s);
        all_calls_estimate(s);
        all_calls_actuator(s);
    }
    free(memory), free(d_memory), free(x), free(s->given), free(s->weights);
}

#endif
