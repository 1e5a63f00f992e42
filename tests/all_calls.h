/* all_calls.h - the results of the library's calls for one model, one after the other: for comparing builds.
   States follow from whole numbers, so that every build has the same. The file that includes this has
   included rbd_contact.h and rbd_derivatives.h, with or without the implementation. */
#ifndef TESTS_ALL_CALLS_H
#define TESTS_ALL_CALLS_H

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
    int nb, nq, nv, room;
    rbd_real *q, *v, *a, *tau, *f_ext, *out, *q2;
    unsigned char *given;
    all_calls_sink *sink;
    void *to;
    const char *header;
} all_calls;

#define ALL_CALLS_RUN(call, n) \
    do { \
        const int n_ = (n); \
        memset(s->out, 0, sizeof(rbd_real) * (size_t)s->room); \
        const rbd_status status_ = call; \
        s->sink(s->to, s->header, #call, status_, s->out, n_); \
    } while (0)

static void all_calls_dynamics(all_calls *s) {
    const int nv = s->nv;
    rbd_real *o = s->out;
    s->header = "rbd.h";
    ALL_CALLS_RUN(rbd_rnea(s->m, s->w, s->q, s->v, s->a, s->f_ext, o), nv);
    ALL_CALLS_RUN(rbd_bias(s->m, s->w, s->q, s->v, NULL, o), nv);
    ALL_CALLS_RUN(rbd_gravity_torque(s->m, s->w, s->q, o), nv);
    ALL_CALLS_RUN(rbd_generalized_momentum(s->m, s->w, s->q, s->v, o, o + nv), 2 * nv);
    ALL_CALLS_RUN(rbd_crba(s->m, s->w, s->q, o), nv * nv);
    ALL_CALLS_RUN(rbd_crba_packed(s->m, s->w, s->q, o), rbd_packed_size(s->m));
    ALL_CALLS_RUN(rbd_aba(s->m, s->w, s->q, s->v, s->tau, s->f_ext, o), nv);
    ALL_CALLS_RUN(rbd_fd_cholesky(s->m, s->w, s->q, s->v, s->tau, s->f_ext, o), nv);
    ALL_CALLS_RUN(rbd_minverse(s->m, s->w, s->q, o), nv * nv);
    ALL_CALLS_RUN((memcpy(o, s->a, sizeof *o * (size_t)nv), memcpy(o + nv, s->tau, sizeof *o * (size_t)nv),
                   rbd_hybrid(s->m, s->w, s->q, s->v, s->given, o, o + nv, s->f_ext)),
                  2 * nv);
    ALL_CALLS_RUN((rbd_crba(s->m, s->w, s->q, o), rbd_cholesky_factor(s->m, s->w, o, o)),
                  rbd_packed_size(s->m));
    ALL_CALLS_RUN(rbd_passive(s->m, s->w, s->v, o), nv);
}

static void all_calls_kinematics(all_calls *s) {
    const int nv = s->nv, last = s->nb - 1;
    const rbd_real point[3] = {(rbd_real)0.125, (rbd_real)-0.25, (rbd_real)0.375};
    rbd_real *o = s->out;
    s->header = "rbd.h";
    ALL_CALLS_RUN(rbd_joint_wrench(s->m, s->w, s->q, s->v, s->a, s->f_ext, o), 6 * s->nb);
    ALL_CALLS_RUN(rbd_kinematics(s->m, s->w, s->q, s->v, s->a), 0);
    for (int i = 0; i < s->nb; i++) {
        ALL_CALLS_RUN(rbd_body_pose(s->m, s->w, i, o, o + 9), 12);
        ALL_CALLS_RUN(rbd_body_velocity(s->m, s->w, i, o), 6);
        ALL_CALLS_RUN(rbd_body_acceleration(s->m, s->w, i, o), 6);
        ALL_CALLS_RUN(rbd_point_acceleration(s->m, s->w, i, point, RBD_WORLD_AXES, o), 6);
    }
    ALL_CALLS_RUN(rbd_jacobian(s->m, s->w, last, point, RBD_WORLD_AXES, o), 6 * nv);
    ALL_CALLS_RUN(rbd_jacobian(s->m, s->w, last, point, RBD_LINK_AXES, o), 6 * nv);
    ALL_CALLS_RUN(rbd_relative_jacobian(s->m, s->w, last, point, 0, RBD_LINK_AXES, o), 6 * nv);
    ALL_CALLS_RUN(rbd_jacobian_transpose(s->m, s->w, last, point, RBD_WORLD_AXES, s->f_ext, o), nv);
    ALL_CALLS_RUN(rbd_energy(s->m, s->w, o, o + 1), 2);
    ALL_CALLS_RUN(rbd_com(s->m, s->w, o, o + 3, o + 6), 9);
    ALL_CALLS_RUN(rbd_momentum(s->m, s->w, o, o + 6), 12);
    ALL_CALLS_RUN(rbd_integrate(s->m, s->q, s->v, (rbd_real)0.5, o), s->nq);
    ALL_CALLS_RUN(rbd_step(s->m, s->q, s->v, s->a, (rbd_real)0.5, o, o + s->nq), s->nq + nv);
    ALL_CALLS_RUN(rbd_difference(s->m, s->q, s->q2, o), nv);
    ALL_CALLS_RUN(rbd_rates_from_velocity(s->m, s->q, s->v, o), s->nq);
}

static void all_calls_derivatives(all_calls *s) {
    const int nv = s->nv, n = nv * nv;
    const size_t size = rbd_derivatives_size(s->m);
    void *memory = malloc(size);
    rbd_derivatives *d;
    rbd_real *o = s->out;
    s->header = "rbd_derivatives.h";
    ALL_CALLS_RUN(rbd_derivatives_init(s->m, s->w, memory, size, &d), 0);
    ALL_CALLS_RUN(rbd_id_derivatives(s->m, d, s->q, s->v, s->a, s->f_ext, o, o + n, o + 2 * n), 3 * n);
    ALL_CALLS_RUN(
        rbd_fd_derivatives(s->m, d, s->q, s->v, s->tau, s->f_ext, o, o + nv, o + nv + n, o + nv + 2 * n),
        nv + 3 * n);
    ALL_CALLS_RUN(rbd_gravity_torque_derivatives(s->m, d, s->q, o), n);
    ALL_CALLS_RUN(rbd_coriolis(s->m, d, s->q, s->v, o), n);
    ALL_CALLS_RUN(rbd_momentum_matrix(s->m, d, s->q, s->v, o, o + 6 * nv), 6 * nv + 6);
    ALL_CALLS_RUN(rbd_com_jacobian(s->m, d, s->q, o), 3 * nv);
    ALL_CALLS_RUN(rbd_regressor(s->m, d, s->q, s->v, s->a, o), 10 * s->nb * nv);
    ALL_CALLS_RUN(rbd_energy_regressors(s->m, d, s->q, s->v, o, o + 10 * s->nb), 20 * s->nb);
    ALL_CALLS_RUN(rbd_integrate_derivatives(s->m, s->v, (rbd_real)0.5, o, o + n), 2 * n);
    ALL_CALLS_RUN(rbd_difference_derivatives(s->m, s->q, s->q2, o, o + n), 2 * n);
    ALL_CALLS_RUN(
        (memcpy(o, s->a, sizeof *o * (size_t)nv), rbd_id_free_base(s->m, d, s->q, s->v, o, o + nv, NULL)),
        2 * nv);
    free(memory);
}

/* The last body is held at a point, and another in all axes. */
static void all_calls_constraints(all_calls *s) {
    const int nv = s->nv;
    const double place[3] = {0.125, 0, 0.25};
    rbd_constraint list[2] = {rbd_point_contact(s->nb - 1, place, NULL),
                              rbd_flat_contact(s->nb / 2, NULL, NULL)};
    const size_t size = rbd_constraint_set_size(s->m, list, 2);
    void *memory = malloc(size);
    rbd_constraint_set *c;
    rbd_real *o = s->out;
    s->header = "rbd_constraints.h";
    ALL_CALLS_RUN(rbd_constraint_set_init(s->m, s->w, list, 2, memory, size, &c, NULL), 0);
    const int rows = rbd_constraint_rows(c);
    ALL_CALLS_RUN(rbd_constraint_jacobian(s->m, c, s->q, s->v, o, o + rows * nv, NULL), rows * (nv + 1));
    ALL_CALLS_RUN(rbd_constrained_fd(s->m, c, s->q, s->v, s->tau, s->f_ext, o, o + nv), nv + rows);
    ALL_CALLS_RUN(rbd_impact(s->m, c, s->q, s->v, (rbd_real)0.5, o, o + nv), nv + rows);
    ALL_CALLS_RUN(rbd_constrained_id(s->m, c, s->q, s->v, s->a, s->f_ext, NULL, NULL, o, o + nv), nv + rows);
    free(memory);
}

/* The last body and one in the middle touch planes just below them. */
static void all_calls_contact(all_calls *s) {
    rbd_contact list[2] = {{.body1 = s->nb - 1, .body2 = -1, .point = {0.125, 0, 0.25}, .friction = 0.5},
                           {.body1 = s->nb / 2, .body2 = -1, .radius = 0.25, .friction = 0.75}};
    const rbd_contact_options options = {
        .margin = 100, .joint_limits = 1, .joint_friction = 1, .joint_damping = 1};
    const size_t size = rbd_contact_set_size(s->m, 2, NULL, 0, &options);
    void *memory = malloc(size);
    rbd_contact_set *c;
    rbd_real *o = s->out;
    s->header = "rbd_contact.h";
    ALL_CALLS_RUN(rbd_contact_set_init(s->m, s->w, list, 2, NULL, 0, &options, memory, size, &c, NULL), 0);
    ALL_CALLS_RUN(
        rbd_contact_step(s->m, c, s->q, s->v, s->tau, s->f_ext, NULL, (rbd_real)0.0078125, o, o + s->nq),
        s->nq + s->nv);
    ALL_CALLS_RUN(rbd_contact_fd(s->m, c, s->q, s->v, s->tau, s->f_ext, NULL, (rbd_real)0.0078125, o), s->nv);
    free(memory);
}

/* All of it, at `states` states. */
static void all_calls_of(const rbd_model *m, int states, all_calls_sink *sink, void *to) {
    uint64_t seed = 1;
    all_calls all = {.m = m, .sink = sink, .to = to}, *s = &all;
    const size_t size = rbd_work_size(m);
    void *memory = malloc(size);
    const int nb = s->nb = rbd_nb(m), nq = s->nq = rbd_nq(m), nv = s->nv = rbd_nv(m);
    rbd_real *x;
    s->room = 4 * nv * nv + 24 * (nv + nb) + 10 * nb * nv + 64 * nv + 64;
    x = (rbd_real *)calloc((size_t)(2 * nq + 3 * nv + 6 * nb + s->room), sizeof(rbd_real));
    s->q = x, s->q2 = s->q + nq, s->v = s->q2 + nq, s->a = s->v + nv, s->tau = s->a + nv,
    s->f_ext = s->tau + nv;
    s->out = s->f_ext + 6 * nb;
    s->given = (unsigned char *)calloc((size_t)nv + 1, 1);
    s->header = "rbd.h";
    ALL_CALLS_RUN(rbd_work_init(m, memory, size, &s->w), 0);
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
        all_calls_dynamics(s);
        all_calls_kinematics(s);
        all_calls_derivatives(s);
        all_calls_constraints(s);
        all_calls_contact(s);
    }
    free(memory), free(x), free(s->given);
}

#endif
