/* compare.c - see compare.h. SPDX-License-Identifier: MIT */
#include "compare.h"
#include "../larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mujoco.h>

/* ---- memory, random numbers ---- */

static void *zeros(size_t n, size_t size) {
    void *memory = calloc(n + 1, size);
    if (!memory) abort();
    return memory;
}

double random_number(void) {
    static unsigned long long state = 88172645463325252ULL;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) / 4503599627370496.0 - 1;
}

void random_qpos(const struct mjModel_ *m, double *qpos) {
    for (int i = 0; i < m->nq; i++) qpos[i] = random_number();
    for (int j = 0; j < m->njnt; j++) {
        double *quat = qpos + m->jnt_qposadr[j];
        double square = 0;
        if (m->jnt_type[j] == mjJNT_FREE) quat += 3;
        if (m->jnt_type[j] != mjJNT_FREE && m->jnt_type[j] != mjJNT_BALL) continue;
        for (int k = 0; k < 4; k++) square += quat[k] * quat[k];
        for (int k = 0; k < 4; k++) quat[k] /= sqrt(square);
    }
}

/* ---- robots ---- */

int load_robot(loaded *to, const struct mjModel_ *m, const rbd_mjcf_options *options, char reason[500]) {
    rbd_mjcf *r = &to->robot;
    rbd_report report;
    size_t size;
    rbd_mjcf_status status;
    memset(to, 0, sizeof *to);
    reason[0] = 0;
    status = rbd_mjcf_convert(m, options, r);
    if (status == RBD_MJCF_OK) {
        to->memory[0] = r->bodies = zeros((size_t)(r->bodies_max = r->nb), sizeof *r->bodies);
        to->memory[1] = r->names = zeros(r->names_max = r->names_size, 1);
        to->memory[2] = r->frames = zeros((size_t)(r->frames_max = r->nframes), sizeof *r->frames);
        to->memory[3] = r->places = zeros((size_t)(r->places_max = r->nb), sizeof *r->places);
        to->memory[4] = r->constraints =
            zeros((size_t)(r->constraints_max = r->nconstraints), sizeof *r->constraints);
        to->memory[5] = r->warnings = zeros((size_t)(r->warnings_max = r->nwarnings), sizeof *r->warnings);
        status = rbd_mjcf_convert(m, options, r);
    }
    if (status != RBD_MJCF_OK) {
        snprintf(reason, 500, "%s", r->error.text);
        return -1;
    }
    size = rbd_model_size(r->bodies, r->nb);
    to->memory[6] = zeros(size, 1);
    if (rbd_model_build(r->bodies, r->nb, to->memory[6], size, &to->model, &report) != RBD_OK) {
        rbd_finding_text(&report.error, reason, 500);
        return -1;
    }
    size = rbd_work_size(to->model);
    to->memory[7] = zeros(size, 1);
    if (rbd_work_init(to->model, to->memory[7], size, &to->w) != RBD_OK) abort();
    rbd_set_gravity(to->w, r->gravity);
    return 0;
}

void free_robot(loaded *r) {
    for (size_t i = 0; i < sizeof r->memory / sizeof *r->memory; i++) free(r->memory[i]);
}

void velocity_matrix(const loaded *r, const double *qpos, int rows, double *T) {
    const int nv = rbd_nv(r->model);
    double *v = zeros((size_t)nv, sizeof *v), *qvel = zeros((size_t)rows, sizeof *qvel);
    for (int k = 0; k < nv; k++) {
        for (int i = 0; i < nv; i++) v[i] = i == k;
        memset(qvel, 0, (size_t)rows * sizeof *qvel);
        rbd_mjcf_qvel_of_v(&r->robot, qpos, v, qvel);
        for (int i = 0; i < rows; i++) T[i * nv + k] = qvel[i];
    }
    free(v);
    free(qvel);
}

/* ---- comparison ---- */

static void note(double *worst, double difference, double scale) {
    const double relative = difference / (scale > 1e-300 ? scale : 1);
    *worst = larger(*worst, relative);
}

/* Compares n numbers, in relation to the largest of both, and at least of `scale`. */
static void compare_all(double *worst, const double *a, const double *b, int n, double scale) {
    double difference = 0;
    for (int i = 0; i < n; i++) {
        scale = larger(scale, larger(fabs(a[i]), fabs(b[i])));
        difference = larger(difference, fabs(a[i] - b[i]));
    }
    note(worst, difference, scale);
}

static void full_mass_matrix(const mjModel *m, mjData *d, double *M) {
#if mjVERSION_HEADER >= 3011000
    mj_fullM(m, d, M);
#else
    mj_fullM(m, M, d->qM);
#endif
}

/* MuJoCo's bias force with the acceleration that a = 0 of rbd means: of free joints omega x u, world axes. */
static void bias_without_acceleration(const mjModel *m, const mjData *d, const double *M, double *bias) {
    double *a = zeros((size_t)m->nv, sizeof *a);
    for (int j = 0; j < m->njnt; j++) {
        const int dof = m->jnt_dofadr[j];
        double omega[3];
        if (m->jnt_type[j] != mjJNT_FREE) continue;
        mju_rotVecQuat(omega, d->qvel + dof + 3, d->qpos + m->jnt_qposadr[j] + 3);
        mju_cross(a + dof, omega, d->qvel + dof);
    }
    for (int i = 0; i < m->nv; i++) {
        bias[i] = d->qfrc_bias[i];
        for (int k = 0; k < m->nv; k++) bias[i] += M[i * m->nv + k] * a[k];
    }
    free(a);
}

/* The pose that rbd has for a frame. */
static void frame_pose(const loaded *r, const rbd_mjcf_frame *f, double R[9], double p[3]) {
    double B[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, o[3] = {0, 0, 0};
    if (f->body >= 0) rbd_body_pose(r->model, r->w, f->body, B, o);
    for (int i = 0; i < 3; i++) {
        p[i] = o[i];
        for (int k = 0; k < 3; k++) p[i] += B[3 * i + k] * f->position[k];
        for (int j = 0; j < 3; j++) {
            R[3 * i + j] = 0;
            for (int k = 0; k < 3; k++) R[3 * i + j] += B[3 * i + k] * f->rotation[3 * k + j];
        }
    }
}

static void compare_poses(const mjModel *m, const mjData *d, const loaded *r, differences *x) {
    int compared = 0;
    for (int i = 0; i < r->robot.nframes; i++) {
        const rbd_mjcf_frame *f = &r->robot.frames[i];
        const int body = mj_name2id(m, mjOBJ_BODY, f->link), site = mj_name2id(m, mjOBJ_SITE, f->link);
        double R[9], p[3];
        if (body < 0 && site < 0) continue;
        frame_pose(r, f, R, p);
        compare_all(&x->poses, R, body >= 0 ? d->xmat + 9 * body : d->site_xmat + 9 * site, 9, 0);
        for (int k = 0; k < 3; k++)
            note(&x->poses, fabs(p[k] - (body >= 0 ? d->xpos + 3 * body : d->site_xpos + 3 * site)[k]), 1);
        compared++;
    }
    if (compared == 0) x->poses = NAN;
}

/* Of MuJoCo's M, T' M T; of its bias, T' b. */
static void to_rbd(const double *T, const double *M, const double *bias, int rows, int nv, double *M_of_rbd,
                   double *bias_of_rbd) {
    double *MT = zeros((size_t)rows * (size_t)nv, sizeof *MT);
    for (int i = 0; i < rows; i++)
        for (int k = 0; k < nv; k++)
            for (int j = 0; j < rows; j++) MT[i * nv + k] += M[i * rows + j] * T[j * nv + k];
    for (int i = 0; i < nv; i++) {
        bias_of_rbd[i] = 0;
        for (int j = 0; j < rows; j++) bias_of_rbd[i] += T[j * nv + i] * bias[j];
        for (int k = 0; k < nv; k++) {
            M_of_rbd[i * nv + k] = 0;
            for (int j = 0; j < rows; j++) M_of_rbd[i * nv + k] += T[j * nv + i] * MT[j * nv + k];
        }
    }
    free(MT);
}

/* sum -m g'p over all bodies. */
static double potential_energy(const mjModel *m, const mjData *d, const double gravity[3]) {
    double energy = 0;
    for (int i = 1; i < m->nbody; i++)
        for (int k = 0; k < 3; k++) energy -= m->body_mass[i] * gravity[k] * d->xipos[3 * i + k];
    return energy;
}

typedef struct state {
    double *q, *v, *q_again, *v_again, *M, *bias, *M_of_rbd, *bias_of_rbd, *T, *M_of_mujoco, *bias_of_mujoco;
} state;

static void compare_dynamics(const mjModel *m, mjData *d, const loaded *r, state *s, differences *x) {
    const int nv = rbd_nv(r->model), rows = (int)m->nv;
    double kinetic, mujoco_kinetic = 0, largest = 0;
    velocity_matrix(r, d->qpos, rows, s->T);
    full_mass_matrix(m, d, s->M_of_mujoco);
    bias_without_acceleration(m, d, s->M_of_mujoco, s->bias_of_mujoco);
    to_rbd(s->T, s->M_of_mujoco, s->bias_of_mujoco, rows, nv, s->M_of_rbd, s->bias_of_rbd);
    rbd_crba(r->model, r->w, s->q, s->M);
    rbd_bias(r->model, r->w, s->q, s->v, NULL, s->bias);
    compare_all(&x->mass, s->M, s->M_of_rbd, nv * nv, 0);
    for (int i = 0; i < nv; i++) largest = larger(largest, s->M[i * nv + i]);
    compare_all(&x->bias, s->bias, s->bias_of_rbd, nv, largest);

    rbd_kinematics(r->model, r->w, s->q, s->v, NULL);
    rbd_energy(r->model, r->w, &kinetic, NULL);
    for (int i = 0; i < rows; i++)
        for (int k = 0; k < rows; k++)
            mujoco_kinetic += 0.5 * d->qvel[i] * s->M_of_mujoco[i * rows + k] * d->qvel[k];
    note(&x->kinetic, fabs(kinetic - mujoco_kinetic), mujoco_kinetic);
}

/* Potential energies differ by a constant, that of bodies fixed to the world: the first state gives it. */
static void compare_potential(const mjModel *m, const mjData *d, const loaded *r, int is_first,
                              double *constant, differences *x) {
    const double mujoco = potential_energy(m, d, r->robot.gravity);
    double potential;
    rbd_energy(r->model, r->w, NULL, &potential);
    if (is_first) *constant = mujoco - potential;
    note(&x->potential, fabs(mujoco - potential - *constant), fabs(mujoco) + fabs(potential) + 1e-3);
}

/* A random state of MuJoCo that rbd has too: joints that follow do, held joints are where they are held. */
static void random_state(const mjModel *m, mjData *d, const loaded *r, state *s, const double *held,
                         differences *x) {
    random_qpos(m, d->qpos);
    for (int i = 0; i < m->nq; i++)
        if (held && !isnan(held[i])) d->qpos[i] = held[i];
    for (int i = 0; i < m->nv; i++) d->qvel[i] = 0;
    rbd_mjcf_q_of_qpos(&r->robot, d->qpos, s->q);
    rbd_mjcf_qpos_of_q(&r->robot, s->q, d->qpos);
    for (int i = 0; i < rbd_nv(r->model); i++) s->v[i] = random_number();
    rbd_mjcf_qvel_of_v(&r->robot, d->qpos, s->v, d->qvel);

    rbd_mjcf_q_of_qpos(&r->robot, d->qpos, s->q_again);
    rbd_mjcf_v_of_qvel(&r->robot, d->qpos, d->qvel, s->v_again);
    compare_all(&x->coordinates, s->q, s->q_again, rbd_nq(r->model), 0);
    compare_all(&x->coordinates, s->v, s->v_again, rbd_nv(r->model), 0);
}

/* For each coordinate of qpos where its joint is held still, NaN = it moves. */
static double *held_coordinates(const mjModel *m, const rbd_mjcf_options *options, const loaded *r) {
    double *held = zeros((size_t)m->nq, sizeof *held);
    for (int i = 0; i < m->nq; i++) held[i] = m->qpos0[i];
    for (int i = 0; i < r->robot.nb; i++) {
        const int n = r->robot.bodies[i].type == RBD_FLOATING    ? 7
                      : r->robot.bodies[i].type == RBD_SPHERICAL ? 4
                                                                 : 1;
        for (int k = 0; k < n && r->robot.places[i].qpos >= 0; k++) held[r->robot.places[i].qpos + k] = NAN;
    }
    for (int i = 0; i < m->neq; i++) {
        const double *a = m->eq_data + i * mjNEQDATA;
        if (m->eq_type[i] == mjEQ_JOINT && !isnan(held[m->jnt_qposadr[m->eq_obj1id[i]]]))
            held[m->jnt_qposadr[m->eq_obj1id[i]]] += a[0];
    }
    for (const rbd_mjcf_lock *lock = options ? options->lock : NULL; lock && lock->joint; lock++)
        held[m->jnt_qposadr[mj_name2id(m, mjOBJ_JOINT, lock->joint)]] = lock->value;
    return held;
}

differences compare(const struct mjModel_ *m, const rbd_mjcf_options *options, int states) {
    differences x;
    loaded r;
    memset(&x, 0, sizeof x);
    if (load_robot(&r, m, options, x.reason) == 0) {
        const size_t n = (size_t)(m->nq + m->nv + rbd_nq(r.model) + 10);
        double *memory = zeros(n * (8 * n + 8), sizeof *memory), constant = 0;
        double *held = held_coordinates(m, options, &r);
        state s;
        double **const arrays[] = {&s.q,    &s.v,           &s.q_again,       &s.v_again,
                                   &s.bias, &s.bias_of_rbd, &s.bias_of_mujoco};
        double **const matrices[] = {&s.M, &s.M_of_rbd, &s.T, &s.M_of_mujoco};
        mjData *d = mj_makeData(m);
        for (size_t i = 0; i < 7; i++) *arrays[i] = memory + i * n;
        for (size_t i = 0; i < 4; i++) *matrices[i] = memory + (8 + 2 * i * n) * n;
        x.nb = r.robot.nb;
        x.nq = rbd_nq(r.model);
        x.nv = rbd_nv(r.model);
        x.nconstraints = r.robot.nconstraints;
        x.nwarnings = r.robot.nwarnings;
        for (int i = 0; i < states; i++) {
            random_state(m, d, &r, &s, held, &x);
            mj_fwdPosition(m, d);
            mj_fwdVelocity(m, d);
            compare_dynamics(m, d, &r, &s, &x);
            compare_poses(m, d, &r, &x);
            compare_potential(m, d, &r, i == 0, &constant, &x);
        }
        mj_deleteData(d);
        free(held);
        free(memory);
    }
    free_robot(&r);
    return x;
}
