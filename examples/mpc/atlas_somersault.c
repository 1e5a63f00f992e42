/* atlas_somersault.c - Atlas turns over in the air: it left the ground upright, turning at a rate that
   would take it three quarters of the way round, and shall come down upright. Nothing touches it: only its
   limbs can change how it turns. Iterative LQR finds that it has to fold itself up. Then the motion of the
   joints is replayed with an integrator of order four: momentum is conserved. Prints tables for
   atlas_somersault.gp; with --times what an iteration takes, in parts. SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include <stdio.h>
#include <stdlib.h>

#include "atlas_flight.h"
#include "check.h"
#include "squares.h"
#include "times.h"
#include "../larger.h"

enum { N = 40, SUBSTEPS = 20 };

static const double pi = 3.14159265358979324, rate = 6; /* rad/s */

static double upright[NQ];
static ilqr s;
static ilqr_problem p;

/* Upright in the end, in the pose that it began in; on the way only small torques and speeds, and the
   joints within their limits, with some reserve. */
static rbd_status cost(void *user, int k, const double *q, const double *v, const double *u, double *l,
                       double *l_z, double *l_zz) {
    const squares sum = {l, l_z, l_zz, NZ};
    const double pose = k < N ? 1 : 100, motion = k < N ? 0.1 : 1, reserve = 0.05;
    double weight[NV], difference[NV];
    static double D[NV * NV];
    (void)user;
    *l = 0;
    for (int i = 0; i < NV; i++) weight[i] = i < 3 ? (k < N ? 0 : 3e3) : i < 6 ? 0 : pose;
    const rbd_status status = squares_way(&sum, &atlas_model, weight, upright, q, difference, D);
    for (int i = 0; i < NU; i++) {
        const struct limits *of = &limits[i];
        squares_entry(&sum, motion, v[6 + i], NV + 6 + i);
        squares_beyond(&sum, 1e3, q[7 + i], of->lower + reserve, of->upper - reserve, 6 + i);
        squares_beyond(&sum, 1, v[6 + i], 0.9 * -of->velocity, 0.9 * of->velocity, NV + 6 + i);
        if (u) squares_entry(&sum, 1 / (of->effort * of->effort), u[i], 2 * NV + i);
    }
    return status;
}

/* As it left the ground: arms up, knees a little bent, turning forward about its centre of mass. */
static void leave(double *v) {
    double com[3], momentum[6];
    check(rbd_neutral(&atlas_model, upright));
    upright[ATLAS_Q_L_ARM_SHX] = 1.2, upright[ATLAS_Q_R_ARM_SHX] = -1.2;
    upright[ATLAS_Q_L_ARM_ELX] = 0.3, upright[ATLAS_Q_R_ARM_ELX] = -0.3;
    upright[ATLAS_Q_L_ARM_ELY] = upright[ATLAS_Q_R_ARM_ELY] = 1.5;
    upright[ATLAS_Q_L_LEG_KNY] = upright[ATLAS_Q_R_LEG_KNY] = 0.3;
    upright[ATLAS_Q_L_LEG_HPY] = upright[ATLAS_Q_R_LEG_HPY] = -0.15;
    upright[ATLAS_Q_L_LEG_AKY] = upright[ATLAS_Q_R_LEG_AKY] = -0.15;
    check(rbd_kinematics(&atlas_model, w, upright, NULL, NULL));
    check(rbd_com(&atlas_model, w, com, NULL, NULL));
    memset(v, 0, sizeof *v * NV);
    v[1] = rate, v[3] = -rate * com[2], v[5] = rate * com[0]; /* omega x (0 - com) */
    check(rbd_kinematics(&atlas_model, w, upright, v, NULL));
    check(rbd_momentum(&atlas_model, w, momentum, NULL));
    memcpy(spin, momentum, sizeof spin);
}

static void plan(const double *v) {
    static double reals[ILQR_REALS(NQ, NV, NU, N)], times[N], lower[NU], upper[NU];
    p = (ilqr_problem){&atlas_model, N, NU, 6, times, lower, upper, &p, step, derivatives, cost};
    for (int i = 0; i < NU; i++) upper[i] = limits[i].effort, lower[i] = -upper[i];
    for (int k = 0; k < N; k++) times[k] = dt;
    check(ilqr_init(&s, &p, reals, sizeof reals / sizeof *reals));
    check(ilqr_start(&s, upright, v));
}

/* ---- the replay: as examples/integrator.c, but that the joints' accelerations are given ---- */

/* b += x [e, v], the bracket of se(3), in which the floating base moves. */
static void add_bracket(const double *e, const double *v, double x, double *b) {
    for (int i = 0, k = 1, l = 2; i < 3; k = l, l = i++) {
        b[i] += x * (e[k] * v[l] - e[l] * v[k]);
        b[3 + i] += x * (e[k] * v[3 + l] - e[l] * v[3 + k] + e[3 + k] * v[l] - e[3 + l] * v[k]);
    }
}

/* A step of Runge and Kutta's, Munthe-Kaas's way; a: joints in, the base's out. The largest torque over its
   limit, if that is more. */
static void replay_step(double *q, double *v, double *a, double time, double *most) {
    static const double node[4] = {0, 0.5, 0.5, 1}, share[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
    double turn[NV] = {0}, move[NV] = {0}, gain[NV] = {0}, e[NV], qs[NQ], vs[NV];
    unsigned char given[NV];
    for (int i = 0; i < NV; i++) given[i] = i >= 6;
    for (int stage = 0; stage < 4; stage++) {
        double b[NV] = {0}, tau[NV] = {0};
        for (int i = 0; i < NV; i++) {
            e[i] = time * node[stage] * turn[i];
            vs[i] = v[i] + (stage ? time * node[stage] * a[i] : 0);
        }
        check(rbd_integrate(&atlas_model, q, e, 1, qs));
        check(rbd_hybrid(&atlas_model, w, qs, vs, given, a, tau, NULL));
        add_bracket(e, vs, 1, b);
        for (int i = 0; i < NV; i++) turn[i] = vs[i] + b[i] / 2;
        add_bracket(e, b, 1. / 12, turn);
        for (int i = 0; i < NV; i++) {
            move[i] += time * share[stage] * turn[i], gain[i] += time * share[stage] * a[i];
            if (i >= 6) *most = larger(*most, fabs(tau[i]) / limits[i - 6].effort);
        }
    }
    check(rbd_integrate(&atlas_model, q, move, 1, q));
    for (int i = 0; i < NV; i++) v[i] += gain[i];
}

/* How far the momentum at (q, v) is from that at the start, relative to it. */
static double momentum_error(const double *q, const double *v) {
    double now[6], error = 0, all = 0;
    check(rbd_kinematics(&atlas_model, w, q, v, NULL));
    check(rbd_momentum(&atlas_model, w, now, NULL));
    for (int i = 0; i < 6; i++)
        error += pow(now[i] - (i < 3 ? spin[i] : 0), 2), all += i < 3 ? spin[i] * spin[i] : 0;
    return sqrt(error / all);
}

/* How far forward the pelvis leans, of the turns that the last value lies in, rad. */
static double lean(const double *q, double last) {
    double up[3] = {0, 0, 1}, origin[3];
    check(rbd_kinematics(&atlas_model, w, q, NULL, NULL));
    check(rbd_point_position(&atlas_model, w, ATLAS_BODY_PELVIS, NULL, origin));
    check(rbd_point_position(&atlas_model, w, ATLAS_BODY_PELVIS, up, up));
    const double angle = atan2(up[0] - origin[0], up[2] - origin[2]);
    return angle + 2 * pi * floor((last - angle) / (2 * pi) + 0.5);
}

/* ---- tables ---- */

static const int left_side[] = {ATLAS_BODY_L_HAND, ATLAS_BODY_L_LARM, ATLAS_BODY_L_UARM, ATLAS_BODY_UTORSO,
                                ATLAS_BODY_PELVIS, ATLAS_BODY_L_ULEG, ATLAS_BODY_L_LLEG, ATLAS_BODY_L_FOOT},
                 right_side[] = {ATLAS_BODY_R_HAND, ATLAS_BODY_R_LARM, ATLAS_BODY_R_UARM, ATLAS_BODY_UTORSO,
                                 ATLAS_BODY_PELVIS, ATLAS_BODY_R_ULEG, ATLAS_BODY_R_LLEG, ATLAS_BODY_R_FOOT};

/* Side view at q from hand to foot, on either side, the back, and the head on it; moved. */
static void figure(const double *q, double right, double up) {
    double at[3];
    check(rbd_kinematics(&atlas_model, w, q, NULL, NULL));
    for (int side = 0; side < 2; side++, puts(""))
        for (int i = 0; i < 8; i++) {
            const double toe[3] = {i == 7 ? 0.15 : 0, 0, i == 7 ? -0.05 : 0};
            check(rbd_point_position(&atlas_model, w, side ? left_side[i] : right_side[i], toe, at));
            printf("%.3f,%.3f,%d\n", at[0] + right, at[2] + up, side);
        }
    for (int i = 0; i < 4; i++) { /* waist, chest, head; and the head's mark */
        static const double point[4][3] = {{0, 0, 0}, {0.14, 0, 0.48}, {-0.05, 0, 0.03}, {-0.05, 0, 0.03}};
        check(rbd_point_position(&atlas_model, w, i < 2 ? ATLAS_BODY_UTORSO : ATLAS_BODY_HEAD, point[i], at));
        if (i == 3) puts("");
        printf("%.3f,%.3f,%d\n", at[0] + right, at[2] + up, i < 3 ? 1 : 2);
    }
    puts("");
}

typedef struct outcome {
    double error, most, lean; /* of momentum; torque over its limit; at the end */
} outcome;

/* The joints move as planned, the base as it must. */
static outcome replay(void) {
    static double shown[N + 1][NQ];
    outcome o = {0, 0, 0};
    double q[NQ], v[NV], a[NV] = {0}, planned = 0;
    memcpy(q, s.q, sizeof q), memcpy(v, s.v, sizeof v);
    puts("t s,lean deg,as planned,if the joints were locked,momentum's error,torque over its limit");
    for (int k = 0; k <= N; k++) {
        double most = 0, error = momentum_error(q, v);
        o.lean = lean(q, o.lean), planned = lean(s.q + k * NQ, planned), o.error = larger(o.error, error);
        for (int i = 0; i < NU && k < N; i++) most = larger(most, fabs(s.u[k * NU + i]) / limits[i].effort);
        printf("%.2f,%.1f,%.1f,%.1f,%.1e,%.3f\n", k * dt, o.lean * 180 / pi, planned * 180 / pi,
               rate * k * dt * 180 / pi, error + 1e-17, most);
        memcpy(shown[k], q, sizeof q);
        for (int i = 0; i < SUBSTEPS && k < N; i++) {
            for (int j = 6; j < NV; j++) a[j] = (s.v[(k + 1) * NV + j] - s.v[k * NV + j]) / dt;
            replay_step(q, v, a, dt / (double)SUBSTEPS, &o.most);
        }
    }
    puts("\n");
    for (int k = 0; k <= N; k += N / 8) /* the frame falls as if thrown up */
        figure(shown[k], 1.6 * k / (N / 8), 9.81 / 2 * k * (N - k) * dt * dt);
    return o;
}

int main(int count, char **arguments) {
    static double scratch[2 * (NQ + 2 * NV + NU)];
    double v[NV], beyond = 0, torque = 0;
    int iterations = 0, better = 1, falling = 1;
    prepare_flight();
    leave(v);
    plan(v);
    const double derivative_error = ilqr_derivative_error(&s, scratch);
    s.tolerance = 1e-4;
    while (better && iterations < 120) {
        const double before = s.cost;
        check(ilqr_iterate(&s, &better));
        falling = falling && (better ? s.cost < before : s.cost == before);
        iterations += better;
    }
    for (int k = 0; k < N; k++)
        for (int i = 0; i < NU; i++) {
            const double x = s.q[(k + 1) * NQ + 7 + i];
            beyond = larger(beyond, larger(limits[i].lower - x, x - limits[i].upper));
            torque = larger(torque, fabs(s.u[k * NU + i]) / limits[i].effort);
        }
    if (count > 1 && strcmp(arguments[1], "--times") == 0) {
        ilqr_print_times(&s, "the somersault");
        return EXIT_SUCCESS;
    }
    const outcome o = replay();
    fprintf(stderr, "the cost fell in each iteration, fewer than 120: %s\n",
            falling && !better ? "yes" : "no");
    fprintf(stderr, "replayed it turns once, to 10 degrees, where locked joints give 275: %s\n",
            fabs(o.lean - 2 * pi) < pi / 18 ? "yes" : "no");
    fprintf(stderr, "joints and torques within their limits: %s\n",
            beyond <= 0 && torque <= 1 ? "yes" : "no");
    fprintf(stderr, "momentum conserved to 1e-9: %s; derivatives agree with differences to 1e-6: %s\n",
            o.error < 1e-9 ? "yes" : "no", derivative_error < 1e-6 ? "yes" : "no");
    const int good = falling && !better && fabs(o.lean - 2 * pi) < pi / 18 && beyond <= 0 && torque <= 1;
    return good && o.error < 1e-9 && derivative_error < 1e-6 ? EXIT_SUCCESS : EXIT_FAILURE;
}
