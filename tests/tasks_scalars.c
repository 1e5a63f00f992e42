/* tasks_scalars.c - rbd_tasks.h in double and in float: rows of every kind beside differences, forces that
   stand, limits that are kept, levels. */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "larger.h"
#include "rbd_tasks.h"

#include "models/hyq.h"
#include "models/iiwa.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_Q = 32, MOST_V = 32, KINDS = RBD_TASK_POSTURE, IN_FLOAT = sizeof(rbd_real) == 4 };

static int failures;
static void expect(int holds, const char *what, double value) {
    if (holds) return;
    failures++;
    printf("FAILED: %s: %g\n", what, value);
}

static const rbd_model *m;
static rbd_work *w;
static unsigned char model_memory[100000], work_memory[200000], memory[400000];
static uint64_t seed = 1;

static void build(const rbd_body *bodies, int nb) {
    rbd_report report;
    if (rbd_model_build(bodies, nb, model_memory, sizeof model_memory, &m, &report) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK)
        exit(2);
}

/* All joint types that may stand between bodies, one joint that follows another. */
static const rbd_body tree[7] = {
    {.joint = "a",
     .parent = -1,
     .type = RBD_UNIVERSAL,
     .axis = {0, 0, 1},
     .axis2 = {1, 0, 0},
     .mass = 1,
     .com = {0, 0, 0.1},
     .inertia = {0.1, 0, 0, 0.2, 0, 0.2}},
    {.joint = "b",
     .parent = 0,
     .type = RBD_HELICAL,
     .axis = {0, 1, 1},
     .pitch = 0.1,
     .position = {0.3, 0, 0},
     .mass = 2,
     .com = {0.1, 0.2, 0},
     .inertia = {0.1, 0.01, 0, 0.2, 0, 0.2}},
    {.joint = "c", .parent = 1, .type = RBD_PRISMATIC, .axis = {1, 1, 0}, .position = {0, 0.2, 0}, .mass = 1},
    {.joint = "d",
     .parent = 2,
     .type = RBD_REVOLUTE,
     .axis = {1, 0, 0},
     .position = {0, 0, 0.4},
     .mass = 1,
     .com = {0.1, 0, 0},
     .inertia = {1, 0, 0, 1, 0, 1},
     .mimic = "b",
     .mimic_ratio = -0.7,
     .mimic_offset = 0.2},
    {.joint = "e",
     .parent = 0,
     .type = RBD_SPHERICAL,
     .position = {0.1, 0.5, 0.4},
     .mass = 1,
     .com = {0.1, 0.3, 0},
     .inertia = {1, 0, 0, 1, 0, 1}},
    {.parent = 4,
     .type = RBD_FIXED,
     .position = {0, 0, 0.3},
     .rotation = {0, 1, 0, 0, 0, 1, 1, 0, 0},
     .mass = 0.5},
    {.joint = "f",
     .parent = 5,
     .type = RBD_CONTINUOUS_CS,
     .axis = {1, 0, 2},
     .mass = 1,
     .com = {0.1, 0.3, 0},
     .inertia = {1, 0, 0, 1, 0, 1}},
};

/* ---- rows beside differences ---- */

/* The tasks' rows at q and v. order: 0 with velocities, 1 with accelerations. */
static rbdi_tasks *rows_at(const rbd_tasks *p, const rbd_real *q, const rbd_real *v, int order) {
    static rbd_tasks_result result;
    rbdi_tasks *k = rbdi_tasks_begin(m, w, p, q, v, order, memory, &result);
    k->rows = 0;
    rbdi_tasks_clear_squares(k);
    for (int i = 0; i < p->tasks; i++) rbdi_tasks_put_task(k, &p->task[i]);
    return k;
}

/* J v of all rows, at q. */
static void rates(const rbd_tasks *p, const rbd_real *q, const rbd_real *v, double *u) {
    const rbdi_tasks *k = rows_at(p, q, v, 0);
    for (int r = 0; r < k->rows; r++) u[r] = (double)rbdi_qp_dot(&k->C[r * k->n], v, m->nv);
}

static void move(const rbd_real *q, const rbd_real *v, double h, rbd_real *to) {
    rbd_integrate(m, q, v, (rbd_real)h, to);
}

/* One task of each kind; it is reached at q moved by `away`. */
static int draw_tasks(const rbd_real *q, double away, int nb, rbd_task *t, rbd_real *there) {
    rbd_real v[MOST_V], R[9], S[9], p[3];
    for (int i = 0; i < m->nv; i++) v[i] = (rbd_real)(away * cos(i));
    move(q, v, 1, there);
    rbd_kinematics(m, w, there, NULL, NULL);

    for (int i = 0; i < KINDS; i++) {
        const int kind = i + 1;
        t[i] = (rbd_task){.kind = (rbd_task_kind)kind,
                          .gain = 1,
                          .body = nb - 1 - i % 2,
                          .reference = nb / 2,
                          .point = {0, (rbd_real)0.1, (rbd_real)0.2},
                          .axis = {1, 2, -2},
                          .q = there};
        if (kind == RBD_TASK_COM) rbd_com(m, w, t[i].position, NULL, NULL);
        if (kind >= RBD_TASK_COM && kind != RBD_TASK_RELATIVE) continue;
        rbd_body_pose(m, w, t[i].body, R, NULL);
        rbd_point_position(m, w, t[i].body, t[i].point, t[i].position);
        for (int a = 0; a < 9; a++) t[i].rotation[a] = R[a];
        for (int a = 0; a < 3; a++)
            t[i].direction[a] =
                R[3 * a] * t[i].axis[0] + R[3 * a + 1] * t[i].axis[1] + R[3 * a + 2] * t[i].axis[2];
        if (kind != RBD_TASK_RELATIVE) continue;

        rbd_body_pose(m, w, t[i].reference, S, p);
        for (int a = 0; a < 3; a++) p[a] = t[i].position[a] - p[a];
        for (int a = 0; a < 3; a++) {
            t[i].position[a] = S[a] * p[0] + S[3 + a] * p[1] + S[6 + a] * p[2];
            for (int b = 0; b < 3; b++)
                t[i].rotation[3 * a + b] = S[a] * R[b] + S[3 + a] * R[3 + b] + S[6 + a] * R[6 + b];
        }
    }
    return KINDS;
}

/* With velocities y = e, whose rate is -J v where angles are small; of lengths anywhere. With accelerations
   and no gain y = -dJ/dt v, and J a - y is the rate of J v. Momentum: J v = h. */
static void check_rows(const rbd_body *bodies, int nb, double away) {
    static double y[2][200], u[2][200], drift[200], J[200][MOST_V];
    rbd_real q[MOST_Q], there[MOST_Q], near[MOST_Q], v[MOST_V], a[MOST_V], to[MOST_V], h6[6];
    rbd_task t[KINDS];
    double worst = 0, worst_drift = 0, worst_momentum = 0;
    const double h = 1e-6;

    build(bodies, nb);
    rbd_random(m, &seed, q);
    for (int i = 0; i < m->nv; i++) {
        v[i] = (rbd_real)sin(2 * i + 1);
        a[i] = (rbd_real)cos(3 * i);
    }
    rbd_tasks p = {.task = t, .tasks = draw_tasks(q, away, nb, t, there), .dt = 1};
    unsigned char none[MOST_V] = {0};
    p.passive = none;

    rbdi_tasks *k = rows_at(&p, q, v, 0);
    const int rows = k->rows;
    expect(rows == 30 + m->nv, "rows", rows); /* 3 + 6 + 3 + 3 + 3 + 6 + 6, and the posture */
    for (int r = 0; r < rows; r++)
        for (int i = 0; i < m->nv; i++) J[r][i] = (double)k->C[r * k->n + i];
    for (int i = 0; i < m->nv; i++) {
        for (int j = 0; j < m->nv; j++) to[j] = j == i;
        for (int side = 0; side < 2; side++) {
            move(q, to, side ? h : -h, near);
            k = rows_at(&p, near, v, 0);
            for (int r = 0; r < rows; r++) y[side][r] = (double)k->lower[k->n + r];
        }
        for (int r = 0; r < rows; r++) {
            const int momentum = r >= 18 && r < 24;
            const int turn = !((r < 3) || (r >= 6 && r < 9) || (r >= 15 && r < 18) || (r >= 27 && r < 30));
            if (momentum || (turn && away > 0.1)) continue;
            worst = larger(worst, fabs(J[r][i] + (y[1][r] - y[0][r]) / (2 * h)));
        }
    }
    expect(worst < (away > 0.1 ? 1e-8 : 5 * away), "rows by differences", worst);

    for (int i = 0; i < KINDS; i++) t[i].gain = 0;
    k = rows_at(&p, q, v, 1);
    for (int r = 0; r < rows; r++) drift[r] = -(double)k->lower[k->n + r];
    for (int side = 0; side < 2; side++) {
        const double s = side ? h : -h;
        move(q, v, s, near);
        for (int i = 0; i < m->nv; i++) to[i] = v[i] + (rbd_real)s * a[i];
        rates(&p, near, to, u[side]);
    }
    for (int r = 0; r < rows; r++) {
        double sum = drift[r];
        for (int i = 0; i < m->nv; i++) sum += J[r][i] * (double)a[i];
        worst_drift = larger(worst_drift, fabs(sum - (u[1][r] - u[0][r]) / (2 * h)));
    }
    expect(worst_drift < 1e-7, "rates of rows by differences", worst_drift);

    rates(&p, q, v, u[0]);
    rbd_kinematics(m, w, q, v, NULL);
    rbd_momentum(m, w, h6, NULL);
    for (int r = 0; r < 6; r++) worst_momentum = larger(worst_momentum, fabs(u[0][18 + r] - (double)h6[r]));
    expect(worst_momentum < 1e-11, "momentum", worst_momentum);
}

/* ---- squares ---- */

/* H of the last QP is symmetric to the bit where it couples variables: the QP takes that for granted. */
static void expect_symmetric(const rbd_tasks *p) {
    const rbdi_tasks *k = rbdi_tasks_lay_out(m, p, memory);
    int apart = 0;
    for (int i = 0; i < k->nv; i++)
        for (int j = 0; j < k->nv; j++) apart += !(k->H[i * k->n + j] == k->H[j * k->n + i]);
    expect(apart == 0, "H is symmetric", apart);
}

/* A row that is no number reaches the diagonal of H, all that the QP of tasks looks at. */
static void check_squares(void) {
    const rbd_real q[MOST_Q] = {0}, y[1] = {0}, J[7] = {1, (rbd_real)0.5, -1, 0, 1, 1, 0};
    const rbd_task t = {.kind = RBD_TASK_ROWS, .rows = 1, .jacobian = J, .y = y};
    const rbd_tasks p = {.task = &t, .tasks = 1, .dt = 1};
    rbd_real v[MOST_V] = {0};
    rbd_tasks_result result;
    build(iiwa_bodies, IIWA_NB);
    expect(rbd_tasks_velocity(m, w, &p, q, memory, sizeof memory, v, &result) == RBD_TASKS_OK, "squares",
           result.error);
    expect_symmetric(&p);

    rbdi_tasks *k = rows_at(&p, q, v, 0);
    rbdi_tasks_clear_squares(k);
    k->C[(k->rows - 1) * k->n + 2] = (rbd_real)NAN;
    rbdi_tasks_square(k, 1);
    expect(rbdi_tasks_solve_level(k, 0, 0) == RBD_QP_NAN, "no number", k->result->qp);
}

/* ---- a robot that stands ---- */

static void check_standing(void) {
    static const int foot[4] = {HYQ_BODY_LF_LOWERLEG, HYQ_BODY_RF_LOWERLEG, HYQ_BODY_LH_LOWERLEG,
                                HYQ_BODY_RH_LOWERLEG};
    rbd_task_contact c[4];
    rbd_real q[MOST_Q], v[MOST_V] = {0}, a[MOST_V], tau[MOST_V], f[12], up = 0;
    const double bound = IN_FLOAT ? 1e-4 : 1e-8; /* motions cost something */
    rbd_tasks_result result;
    char text[200];

    build(hyq_bodies, HYQ_NB);
    rbd_neutral(m, q);
    for (int i = 0; i < 4; i++) {
        q[HYQ_Q_LF_HFE_JOINT + i] = (rbd_real)(i < 2 ? 0.7 : -0.7);
        q[HYQ_Q_LF_KFE_JOINT + i] = (rbd_real)(i < 2 ? -1.4 : 1.4);
        c[i] =
            (rbd_task_contact){.body = foot[i], .point = {(rbd_real)0.33, 0, 0}, .friction = (rbd_real)0.5};
    }
    const rbd_task t[2] = {{.kind = RBD_TASK_COM},
                           {.kind = RBD_TASK_POSTURE, .q = q, .gain = 10, .level = 1}};
    rbd_tasks p = {.task = t,
                   .tasks = 2,
                   .contact = c,
                   .contacts = 4,
                   .dt = (rbd_real)1e-3,
                   .motion_cost = (rbd_real)(IN_FLOAT ? 0 : 1e-9)};
    memset(memory, 0xff,
           sizeof memory); /* no number: H of forces has its diagonal alone, nothing else is read */
    for (int again = 0; again < 2; again++) {
        const rbd_tasks_status status =
            rbd_tasks_acceleration(m, w, &p, q, v, memory, sizeof memory, a, f, tau, &result);
        expect(status == RBD_TASKS_OK, rbd_tasks_text(status, &result, text, sizeof text),
               (double)result.primal);
        for (int i = 0; i < 2; i++)
            expect(result.part[i] == RBD_TASKS_NOTHING && result.at[i] == -1, "no blame", result.at[i]);
        up = f[2] + f[5] + f[8] + f[11];
        expect(fabs((double)up / (9.81 * (double)rbd_mass(m)) - 1) < bound, "weight", (double)up);
        for (int i = 0; i < m->nv; i++)
            expect(fabs((double)a[i]) < (IN_FLOAT ? 0.01 : 1e-6), "at rest", (double)a[i]);
        expect_symmetric(&p);
        p.warm = 1;
    }
}

/* ---- limits ---- */

/* An arm that is called beyond all its limits, ten thousand steps: none is passed, and no joint brakes by
   more than it may. */
static void check_limits(void) {
    rbd_real q[7] = {0}, v[7] = {0}, a[7], tau[7], far[7], lower[7], upper[7];
    const double dt = 1e-3, eps = IN_FLOAT ? 2e-5 : 1e-12;
    double hardest = 0, beyond = 0, last[7];
    rbd_tasks_result result;
    build(iiwa_bodies, IIWA_NB);
    for (int i = 0; i < 7; i++) {
        far[i] = (rbd_real)(i % 2 ? 4 : -4);
        lower[i] = (rbd_real) - (0.5 + 0.1 * i);
        upper[i] = (rbd_real)(0.4 + 0.1 * i);
    }
    const rbd_task t = {.kind = RBD_TASK_POSTURE, .q = far, .gain = 5};
    const rbd_tasks p = {.task = &t,
                         .tasks = 1,
                         .dt = (rbd_real)dt,
                         .lower = lower,
                         .upper = upper,
                         .without = RBD_WITHOUT_TORQUE,
                         .braking = 10};
    for (int step = 0; step < 10000; step++) {
        if (step % 2500 == 0)
            for (int i = 0; i < 7; i++) far[i] = -far[i];
        expect(rbd_tasks_acceleration(m, w, &p, q, v, memory, sizeof memory, a, NULL, tau, &result) ==
                   RBD_TASKS_OK,
               "status", step);
        for (int i = 0; i < 7; i++) {
            last[i] = (double)v[i];
            v[i] = v[i] + (rbd_real)dt * a[i];
            q[i] = q[i] + (rbd_real)dt * v[i];
            beyond = larger(beyond, larger((double)(q[i] - upper[i]), (double)(lower[i] - q[i])));
            if ((double)v[i] * last[i] > 0 && fabs((double)v[i]) < fabs(last[i]) && step % 2500 > 1)
                hardest = larger(hardest, (fabs(last[i]) - fabs((double)v[i])) / dt);
        }
        if (step % 2500 == 2499)
            for (int i = 0; i < 7; i++)
                expect(fmin(fabs((double)(q[i] - upper[i])), fabs((double)(q[i] - lower[i]))) < 1e-3,
                       "at a limit", (double)q[i]);
    }
    expect(beyond < eps, "beyond a limit", beyond);
    expect(hardest < 10 + (IN_FLOAT ? 0.5 : 1e-6), "braking", hardest);
}

/* ---- which limit a row is ---- */

static int is_limit(const rbdi_tasks *k, int row) {
    const rbd_tasks_part part = rbdi_tasks_limit_of(k, row).part;
    return part != RBD_TASKS_NOTHING && part != RBD_TASKS_HELD && part != RBD_TASKS_PASSIVE;
}

/* Sides of all limits come back as they were kept; friction has as many rows as its pyramid has sides. */
static void check_places(void) {
    rbd_task_contact c[4] = {{.sides = 8}, {.open = 1}, {.sides = 4}, {.sides = 8}};
    rbd_real q[MOST_Q], v[MOST_V] = {0};
    int friction[4] = {0}, forces[4] = {0};
    const rbd_tasks p = {.contact = c, .contacts = 4, .dt = 1};
    rbd_tasks_result result;
    build(hyq_bodies, HYQ_NB);
    rbd_neutral(m, q);
    for (int i = 0; i < 4; i++) c[i].body = HYQ_BODY_LF_LOWERLEG;

    rbdi_tasks *k = rbdi_tasks_begin(m, w, &p, q, v, 1, memory, &result);
    const int all = k->n + k->rows;
    for (int row = 0; row < all; row++) {
        const rbdi_tasks_limit limit = rbdi_tasks_limit_of(k, row);
        if (limit.part == RBD_TASKS_FRICTION) friction[limit.at]++;
        if (limit.part == RBD_TASKS_FORCE) forces[limit.at]++;
        k->side[row] = (signed char)(row * row % 3 - row % 2);
    }
    rbdi_tasks_keep(k, 1, k->rows, 1);
    for (int row = 0; row < all; row++) k->side[row] = 0;
    rbdi_tasks_keep(k, 1, k->rows, 0);
    for (int row = 0; row < all; row++)
        if (is_limit(k, row)) expect(k->side[row] == row * row % 3 - row % 2, "a side is kept", row);

    expect(rbdi_tasks_limit_of(k, all).part == RBD_TASKS_NOTHING, "a row of a task is no limit", all);
    expect(rbdi_tasks_part_name(RBD_TASKS_NOTHING)[0] == 'n', "nothing has a name", 0);
    expect(k->rows - k->friction == 8 + 4 + 8, "sides of all pyramids", k->rows - k->friction);
    for (int i = 0; i < 4; i++) {
        expect(friction[i] == (c[i].open ? 0 : c[i].sides), "rows of friction", friction[i]);
        expect(forces[i] == !c[i].open, "rows of a force", forces[i]);
    }
}

/* A wall's normal is its own, whatever the axis. */
static void check_grounds(void) {
    for (int axis = 0; axis < 3; axis++) {
        rbd_task_contact wall = {0};
        wall.normal[axis] = 2;
        const rbdi_mat ground = rbdi_tasks_ground(&wall);
        const rbd_real normal[3] = {ground.zx, ground.zy, ground.zz};
        for (int i = 0; i < 3; i++)
            expect(fabs((double)normal[i] - (i == axis)) < 1e-6, "a normal", (double)normal[i]);
    }
}

/* ---- what is read ---- */

/* What stands behind the wrenches is no input. */
static void check_wrenches(void) {
    rbd_real f_ext[7 * IIWA_NB] = {0}, q[7] = {0}, v[7] = {0}, a[7], tau[7];
    const rbd_tasks p = {.dt = 1, .f_ext = f_ext};
    rbd_tasks_result result;
    build(iiwa_bodies, IIWA_NB);
    for (int i = 6 * m->nb; i < 7 * IIWA_NB; i++) f_ext[i] = (rbd_real)NAN;
    expect(rbd_tasks_acceleration(m, w, &p, q, v, memory, sizeof memory, a, NULL, tau, &result) ==
               RBD_TASKS_OK,
           "wrenches", result.error);
    f_ext[6 * m->nb - 1] = (rbd_real)NAN;
    expect(rbd_tasks_acceleration(m, w, &p, q, v, memory, sizeof memory, a, NULL, tau, &result) ==
               RBD_TASKS_ERROR,
           "the last wrench", result.error);
}

/* ---- where it begins ---- */

/* A weight so large that motion_cost is rounding beside it: the QP is semidefinite to its eyes. After a tick
   that moved joints fast, one that asks for a point alone moves as from a cold start: of the motions that do
   it the least, not the last. */
static void check_start(void) {
    rbd_real q[7], v[7] = {0}, jacobian[21] = {0}, y[3] = {50, -50, 50}, a[2][7], tau[7];
    double most = 0, apart = 0;
    rbd_task wish[2] = {{.kind = RBD_TASK_ROWS, .rows = 3, .jacobian = jacobian, .y = y},
                        {.kind = RBD_TASK_POINT, .weight = (rbd_real)(IN_FLOAT ? 1e4 : 1e9)}};
    rbd_tasks p = {.task = wish, .tasks = 1, .dt = (rbd_real)0.01, .without = RBD_WITHOUT_TORQUE};
    rbd_tasks_result result;
    build(iiwa_bodies, IIWA_NB);
    for (int i = 0; i < 7; i++) q[i] = (rbd_real)(0.2 + 0.1 * i);
    for (int i = 0; i < 3; i++) jacobian[7 * i + 2 * i] = 1;
    wish[1].body = IIWA_NB - 1;
    wish[1].acceleration[3] = 1;

    for (int cold = 0; cold < 2; cold++) {
        p.warm = 0;
        p.task = wish;
        expect(rbd_tasks_acceleration(m, w, &p, q, v, memory, sizeof memory, a[cold], NULL, tau, &result) ==
                   RBD_TASKS_OK,
               "a tick before", result.error);
        p.warm = !cold;
        p.task = wish + 1;
        expect(rbd_tasks_acceleration(m, w, &p, q, v, memory, sizeof memory, a[cold], NULL, tau, &result) ==
                   RBD_TASKS_OK,
               "a start", cold);
    }
    for (int i = 0; i < 7; i++) {
        most = larger(most, fabs((double)a[1][i]));
        apart = larger(apart, fabs((double)(a[0][i] - a[1][i])));
    }
    expect(apart <= 1e-3 * most && most < 10, "a warm start apart from a cold one", apart);
}

/* ---- rows missed ---- */

/* The largest miss of a hard row, as a share of its terms, where x_i counts as |x_i| + 1; of a QP whose last
   rows are those of tasks. */
static double missed_of_terms(const rbd_tasks *p, int of_tasks) {
    const rbdi_tasks *k = rbdi_tasks_lay_out(m, p, memory);
    double most = 0;
    for (int row = 0; row < k->n + k->rows - of_tasks; row++) {
        const double lower = (double)k->lower[row], upper = (double)k->upper[row];
        double value = 0, terms = 0;
        for (int i = 0; i < k->n; i++) {
            const double c = row < k->n ? i == row : (double)k->C[(row - k->n) * k->n + i];
            value += c * (double)k->x[i];
            terms += fabs(c) * (fabs((double)k->x[i]) + 1);
        }
        const double side = value < lower ? lower : upper;
        const double miss = larger(lower - value, value - upper);
        if (!(miss <= 0)) most = larger(most, miss / (fabs(side) + terms));
    }
    return most;
}

/* Three slides in a row, the last of which is held: x0 + x1 + x2 = 0. The first is behind its stop and must
   come back, the others are asked for more and more. In float 1 is rounding beside them in the end: then the
   answer is no longer called exact. Nor is it where so many steps are too few. */
static void check_missed(int steps) {
    const rbd_body slides[3] = {
        {.joint = "a", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1},
        {.joint = "b", .parent = 0, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1},
        {.joint = "c", .parent = 1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = 1}};
    const rbd_real q[3] = {1}, J[6] = {1, 1, 1, 0, 1, (rbd_real)0.3};
    const rbd_real none = (rbd_real)RBD_QP_NONE, upper[3] = {0, none, none}, dt = 1, braking = 1;
    const double back = sqrt(3) - 1; /* v^2 + 2 b dt v = 2 b s */
    const double most = IN_FLOAT ? 1e-3 : 1e-7;
    const rbd_task_contact held = {.body = 2};
    int inexact = 0, asked = 0;
    build(slides, 3);

    for (double big = 10; big < 1e9; big *= 3) {
        const rbd_real y[2] = {(rbd_real)big, (rbd_real)(-big / 3)};
        const rbd_task t = {.kind = RBD_TASK_ROWS, .rows = 2, .jacobian = J, .y = y};
        const rbd_tasks p = {.task = &t,
                             .tasks = 1,
                             .contact = &held,
                             .contacts = 1,
                             .dt = dt,
                             .upper = upper,
                             .braking = braking,
                             .steps = steps};
        rbd_tasks_result result;
        rbd_real v[3] = {0};
        const rbd_tasks_status status = rbd_tasks_velocity(m, w, &p, q, memory, sizeof memory, v, &result);
        const double missed = (double)v[0] + back, primal = (double)result.primal;
        const double of_terms = missed_of_terms(&p, 2), rounding = IN_FLOAT ? 4e-7 : 1e-15;
        expect(status >= 0, "slides have an answer", status);
        expect(primal > of_terms - rounding, "each row by its own terms", of_terms);
        if (status == RBD_TASKS_OK) expect(missed <= most * (1 + 2 * back), "a limit is kept", missed);
        if (status == RBD_TASKS_OK) expect(primal < most, "the result says so", primal);
        if (missed > 2 * most * (1 + 2 * back)) expect(primal > most, "and that it is not", primal);
        inexact += status == RBD_TASKS_INEXACT;
        asked++;
    }
    if (steps)
        expect(inexact == asked, "too few steps", inexact);
    else
        expect(IN_FLOAT ? inexact > 0 && inexact < 6 : inexact == 0, "inexact", inexact);
}

/* ---- rows that nearly depend on each other ---- */

/* A plate that is held at two points, and shall turn. The nearer they are, the larger are the multipliers,
   whose rounding is more than the QP's accuracy in the end; x is 0 all the same, which is what is asked. */
static void check_near_contacts(void) {
    const rbd_body plate = {
        .parent = -1, .type = RBD_PLANAR, .axis = {0, 0, 1}, .mass = 1, .inertia = {1, 0, 0, 1, 0, 1}};
    const rbd_task turn = {.kind = RBD_TASK_ROTATION, .velocity = {0, 0, 1}};
    int inexact = 0;
    build(&plate, 1);
    for (double apart = .1; apart > (IN_FLOAT ? 2e-4 : 2e-9); apart /= 2) {
        const rbd_task_contact c[2] = {{.point = {(rbd_real)0.3, (rbd_real)0.2, 0}},
                                       {.point = {(rbd_real)(0.3 + apart), (rbd_real)0.2, 0}}};
        const rbd_tasks p = {
            .task = &turn, .tasks = 1, .contact = c, .contacts = 2, .dt = 1, .motion_cost = 1};
        const rbd_real q[MOST_Q] = {0};
        rbd_real v[MOST_V] = {0};
        rbd_tasks_result result;
        const rbd_tasks_status status = rbd_tasks_velocity(m, w, &p, q, memory, sizeof memory, v, &result);
        expect(status == RBD_TASKS_OK, "near contacts", apart);
        for (int i = 0; i < m->nv; i++) expect(fabs((double)v[i]) < 1e-9, "held", (double)v[i]);
        inexact += result.qp == RBD_QP_INACCURATE;
    }
    expect(inexact > 0, "inexact multipliers", inexact);
}

/* Variables and soft rows of a thousand floating bodies are too many. */
static void check_sizes(void) {
    static rbd_model many;
    rbd_tasks p = {.contacts = 900, .limit_weight = 1, .torque_weight = 1};
    many.nv = 5000;
    expect(rbd_tasks_size(&many, &p) > 0, "5000 dofs", many.nv);
    many.nv = 6000;
    expect(rbd_tasks_size(&many, &p) == 0, "6000 dofs", many.nv);

    /* nv + 3 contacts + nv soft rows may be 20000 variables */
    p.contacts = 2;
    p.torque_weight = 0;
    many.nv = (20000 - 6) / 2;
    expect(rbd_tasks_size(&many, &p) > 0, "variables", many.nv);
    many.nv++;
    expect(rbd_tasks_size(&many, &p) == 0, "a variable too many", many.nv);
}

int main(void) {
    for (int i = 0; i < 20 && !IN_FLOAT; i++) {
        check_rows(hyq_bodies, HYQ_NB, i % 2 ? 0.7 : 1e-4);
        check_rows(iiwa_bodies, IIWA_NB, i % 2 ? 0.7 : 1e-4);
        check_rows(tree, 7, i % 2 ? 0.7 : 1e-4);
    }
    check_squares();
    check_standing();
    check_limits();
    check_places();
    check_grounds();
    check_wrenches();
    check_start();
    check_near_contacts();
    check_sizes();
    check_missed(0);
    check_missed(1);
    printf("%s\n", failures ? "FAILED" : "rbd_tasks.h: ok");
    return failures > 0;
}
