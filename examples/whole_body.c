/* whole_body.c - HyQ stands on a hard, slippery floor and is pushed to the left, by two controllers of the
   same gains. Both choose where the trunk accelerates.

   least forces   the wrench that this takes, by inverse dynamics, is shared out among the feet at the least
                  sum of squares. Nothing says that a foot must not slip or pull.
   tasks          rbd_tasks_acceleration: the same wish, but feet that are held, forces within friction and
                  torques that the motors have. Where the wish does not fit, the trunk gives way.

   Prints a table for whole_body.gp. */
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"

#include "rbd_tasks.h"
#include "models/hyq_model.h"
#include "larger.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NQ = HYQ_NQ, NV = HYQ_NV, FEET = 4, STEPS = 2000, STEPS_PER_ROW = 10, ROWS = STEPS / STEPS_PER_ROW };
enum { PUSHES = 5, CONTROLLERS = 2 };

static const double dt = 1e-3, mu = 0.4, gain = 10; /* s, of the floor, 1/s */
static const double assumed_mu = 0.36;              /* the controller leaves a tenth */
static const double toe[3] = {0.33, 0, 0};
static const double pushes[PUSHES] = {100, 150, 200, 300, 400}; /* N, for a tenth of a second */
static const char *const names[CONTROLLERS] = {"least forces", "tasks"};

static unsigned char memory[HYQ_WORK_SIZE], floor_memory[HYQ_WORK_SIZE],
    contact_memory[RBD_CONTACT_SET_SIZE(NV, FEET, 0)];
static rbd_work *w, *floor_w;
static rbd_contact_set *contacts;
static double home[NQ];

/* What a push did. */
typedef struct outcome {
    double slip, aside, low;                /* m: of a foot; of the trunk, to the left and down, at most */
    double steepest, torque, end;           /* slope of a force; N m; m: where the trunk is in the end */
    int fell, unsolved;                     /* ticks */
    double row_aside[ROWS], row_slip[ROWS]; /* m */
} outcome;
static outcome outcomes[CONTROLLERS][PUSHES];

static void check(rbd_status status) {
    if (status == RBD_OK) return;
    fprintf(stderr, "%s\n", rbd_status_string(status));
    exit(EXIT_FAILURE);
}

static int leg(int foot) { return HYQ_BODY_LF_LOWERLEG + foot; }

/* ---- least forces ---- */

/* b = A^-1 b, n rows of six at most, by Gauss's elimination. */
static void solve(int n, double A[6][6], double *b) {
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++) best = fabs(A[i][k]) > fabs(A[best][k]) ? i : best;
        for (int j = 0; j <= n; j++) {
            double *x = j < n ? &A[k][j] : &b[k];
            double *y = j < n ? &A[best][j] : &b[best];
            const double t = *x;
            *x = *y;
            *y = t;
        }
        for (int i = 0; i < n; i++) {
            const double factor = A[i][k] / A[k][k];
            if (i == k) continue;
            for (int j = k; j < n; j++) A[i][j] -= factor * A[k][j];
            b[i] -= factor * b[k];
        }
    }
    for (int k = 0; k < n; k++) b[k] /= A[k][k];
}

/* Accelerations of a leg's joints that keep its foot where it is, J a + dJ/dt v = 0. */
static void follow(int foot, const double J[6 * NV], double a[NV]) {
    double A[6][6], b[6];
    check(rbd_point_acceleration(&hyq_model, w, leg(foot), toe, RBD_WORLD_AXES, b));
    for (int i = 0; i < 3; i++) {
        b[i] = -b[3 + i];
        for (int k = 0; k < 6; k++) b[i] -= J[(3 + i) * NV + k] * a[k];
        for (int k = 0; k < 3; k++) A[i][k] = J[(3 + i) * NV + 6 + 4 * k + foot];
    }
    solve(3, A, b);
    for (int k = 0; k < 3; k++) a[6 + 4 * k + foot] = b[k];
}

/* tau, and the feet's least forces with G f = b, what the trunk needs: f = G' (G G')^-1 b. Returns 1: there
   are always some. */
static int least_forces(const double *q, const double *v, double forces[FEET][3], double *tau) {
    static double J[FEET][6 * NV];
    double d[NV], a[NV], A[6][6] = {{0}}, b[6], share[NV];
    check(rbd_difference(&hyq_model, q, home, d));
    for (int k = 0; k < 6; k++) a[k] = gain * gain * d[k] - 2 * gain * v[k];

    check(rbd_kinematics(&hyq_model, w, q, v, NULL));
    for (int i = 0; i < FEET; i++) {
        check(rbd_jacobian(&hyq_model, w, leg(i), toe, RBD_WORLD_AXES, J[i]));
        follow(i, J[i], a);
        for (int r = 0; r < 6; r++)
            for (int c = 0; c < 6; c++)
                for (int k = 3; k < 6; k++) A[r][c] += J[i][k * NV + r] * J[i][k * NV + c];
    }
    check(rbd_rnea(&hyq_model, w, q, v, a, NULL, tau));
    for (int k = 0; k < 6; k++) b[k] = tau[k];
    solve(6, A, b);

    for (int i = 0; i < FEET; i++) {
        double wrench[6] = {0};
        for (int k = 3; k < 6; k++) {
            for (int r = 0; r < 6; r++) wrench[k] += J[i][k * NV + r] * b[r];
            forces[i][k - 3] = wrench[k];
        }
        check(rbd_jacobian_transpose(&hyq_model, w, leg(i), toe, RBD_WORLD_AXES, wrench, share));
        for (int k = 0; k < NV; k++) tau[k] -= share[k]; /* the trunk's six become 0 */
    }
    return 1;
}

/* ---- tasks ---- */

/* The trunk at home, its joints near home where that leaves a choice, feet that hold. Returns 0 where no
   forces do that; the torques then stay what they were. */
static int tasks(const double *q, const double *v, double forces[FEET][3], double *tau) {
    static unsigned char tasks_memory[RBD_TASKS_SIZE(NV, 6 + NV, FEET, 0)];
    const rbd_task wishes[2] = {
        {.kind = RBD_TASK_POSE, .position = {home[0], home[1], home[2]}, .gain = gain},
        {.kind = RBD_TASK_POSTURE, .q = home, .gain = gain, .weight = 1e-3}};
    rbd_task_contact feet[FEET] = {{0}};
    const rbd_tasks problem = {.task = wishes, .tasks = 2, .contact = feet, .contacts = FEET, .dt = dt};
    rbd_tasks_result result;
    double a[NV];

    for (int i = 0; i < FEET; i++) {
        feet[i].body = leg(i);
        memcpy(feet[i].point, toe, sizeof toe);
        feet[i].friction = assumed_mu;
        feet[i].least = 5;
        feet[i].most = 1500;
    }
    return rbd_tasks_acceleration(&hyq_model, w, &problem, q, v, tasks_memory, sizeof tasks_memory, a,
                                  forces[0], tau, &result) == RBD_TASKS_OK;
}

/* ---- the robot ---- */

/* Stands on z = 0. */
static void stand(void) {
    rbd_contact foot[FEET] = {{0}};
    double at[3];
    check(rbd_work_init(&hyq_model, memory, sizeof memory, &w));
    check(rbd_work_init(&hyq_model, floor_memory, sizeof floor_memory, &floor_w));
    check(rbd_neutral(&hyq_model, home));
    for (int i = 0; i < FEET; i++) {
        home[HYQ_Q_LF_HFE_JOINT + i] = i < 2 ? 0.7 : -0.7;
        home[HYQ_Q_LF_KFE_JOINT + i] = i < 2 ? -1.4 : 1.4;
        foot[i].body1 = leg(i);
        foot[i].body2 = -1;
        memcpy(foot[i].point, toe, sizeof toe);
        foot[i].friction = mu;
    }
    check(rbd_kinematics(&hyq_model, w, home, NULL, NULL));
    check(rbd_point_position(&hyq_model, w, leg(0), toe, at));
    home[HYQ_Q_ROOT_Z] -= at[2];
    check(rbd_contact_set_init(&hyq_model, floor_w, foot, FEET, NULL, 0, NULL, contact_memory,
                               sizeof contact_memory, &contacts, NULL));
}

static void places(const double *q, double place[FEET][3]) {
    check(rbd_kinematics(&hyq_model, w, q, NULL, NULL));
    for (int i = 0; i < FEET; i++) check(rbd_point_position(&hyq_model, w, leg(i), toe, place[i]));
}

/* Notes what the controller asked for and where that led. */
static void observe(outcome *o, int step, const double *q, double forces[FEET][3], const double *tau,
                    double start[FEET][3]) {
    double place[FEET][3], slip = 0;
    const double aside = q[HYQ_Q_ROOT_Y] - home[HYQ_Q_ROOT_Y];
    places(q, place);
    for (int i = 0; i < FEET; i++) {
        const double slope = hypot(forces[i][0], forces[i][1]) / forces[i][2];
        slip = larger(slip, hypot(place[i][0] - start[i][0], place[i][1] - start[i][1]));
        o->steepest = larger(o->steepest, slope >= 0 ? slope : HUGE_VAL);
    }
    for (int i = 6; i < NV; i++) o->torque = larger(o->torque, fabs(tau[i]));

    o->slip = larger(o->slip, slip);
    o->aside = larger(o->aside, aside);
    o->low = larger(o->low, home[HYQ_Q_ROOT_Z] - q[HYQ_Q_ROOT_Z]);
    o->end = aside;
    o->row_aside[step / STEPS_PER_ROW] = aside;
    o->row_slip[step / STEPS_PER_ROW] = slip;
}

static void push(int controller, double newtons, outcome *o) {
    const double damping[NV] = {0};
    double q[NQ], v[NV] = {0}, tau[NV] = {0}, forces[FEET][3] = {{0}}, start[FEET][3];
    memcpy(q, home, sizeof q);
    places(q, start);
    rbd_contact_reset(contacts);
    for (int i = 0; i < ROWS; i++) o->row_aside[i] = o->row_slip[i] = NAN; /* after a fall */

    for (int step = 0; step < STEPS && !o->fell; step++) {
        double wrench[6 * HYQ_NB] = {0};
        rbd_status status;
        if (step >= 300 && step < 400) wrench[6 * HYQ_BODY_BASE_LINK_0 + 4] = newtons;

        o->unsolved += !(controller ? tasks(q, v, forces, tau) : least_forces(q, v, forces, tau));
        status = rbd_contact_step(&hyq_model, contacts, q, v, tau, wrench, damping, dt, q, v);
        if (status == RBD_ERR_NAN) o->fell = step; /* it tumbles, by torques beyond all measure */
        if (o->fell) break;
        check(status);
        observe(o, step, q, forces, tau, start);
        if (q[HYQ_Q_ROOT_Z] < 0.6 * home[HYQ_Q_ROOT_Z]) o->fell = step;
    }
}

static void print_table(void) {
    printf("t s");
    for (int c = 0; c < CONTROLLERS; c++)
        for (int k = 0; k < PUSHES; k++) printf(",%s %g N: trunk mm,feet mm", names[c], pushes[k]);
    for (int row = 0; row < ROWS; row++) {
        printf("\n%.2f", row * STEPS_PER_ROW * dt);
        for (int c = 0; c < CONTROLLERS; c++)
            for (int k = 0; k < PUSHES; k++)
                printf(",%.2f,%.2f", 1e3 * outcomes[c][k].row_aside[row], 1e3 * outcomes[c][k].row_slip[row]);
    }
    puts("");
}

int main(void) {
    int good = 1;
    stand();
    for (int k = 0; k < PUSHES; k++) {
        for (int c = 0; c < CONTROLLERS; c++) {
            outcome *o = &outcomes[c][k];
            push(c, pushes[k], o);
            fprintf(stderr, "%3g N, %-12s: ", pushes[k], names[c]);
            if (o->fell)
                fprintf(stderr, "falls\n");
            else
                fprintf(stderr, "feet slip %5.1f mm; trunk goes %4.1f mm to the left, in the end %.1f mm\n",
                        1e3 * o->slip, 1e3 * o->aside, 1e3 * fabs(o->end));
        }
        const outcome *t = &outcomes[1][k];
        good &= !t->fell && !t->unsolved && t->slip < 1e-3 && t->steepest <= assumed_mu + 1e-6 &&
                t->torque <= 150 + 1e-6 && fabs(t->end) < 1e-3;
    }
    good &= outcomes[0][1].slip > 5e-3 && outcomes[0][4].fell;
    print_table();
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
