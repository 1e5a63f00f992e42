/* whole_body.c - HyQ stands on soft ground and is pushed. Its controller chooses where the trunk accelerates;
   the wrench that this takes, by inverse dynamics, is shared out among the feet at the least cost; torques
   follow. */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "models/hyq_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NQ = HYQ_NQ, NV = HYQ_NV, FEET = 4, STEPS = 5000 };
static const double dt = 2.5e-4, toe[3] = {0.33, 0, 0}, stiffness = 1e5, damping = 1e3; /* s, m, N/m, N s/m */
static const double cost[FEET] = {1, 1, 2, 1}; /* of a newton squared: the left hind foot is spared */
static const int lower[FEET] = {HYQ_BODY_LF_LOWERLEG, HYQ_BODY_RF_LOWERLEG, HYQ_BODY_LH_LOWERLEG,
                                HYQ_BODY_RH_LOWERLEG};

static unsigned char memory[HYQ_WORK_SIZE];
static rbd_work *w;
static double place[FEET][3]; /* where the ground holds them */

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* b = A^-1 b, n rows of six at most. */
static void solve(int n, double A[6][6], double *b) {
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++) best = fabs(A[i][k]) > fabs(A[best][k]) ? i : best;
        for (int j = 0; j <= n; j++) {
            double *x = j < n ? &A[k][j] : &b[k], *y = j < n ? &A[best][j] : &b[best], t = *x;
            *x = *y, *y = t;
        }
        for (int i = 0; i < n; i++) {
            const double factor = A[i][k] / A[k][k];
            for (int j = k; j < n && i != k; j++) A[i][j] -= factor * A[k][j];
            if (i != k) b[i] -= factor * b[k];
        }
    }
    for (int k = 0; k < n; k++) b[k] /= A[k][k];
}

/* Accelerations of a leg's joints that keep its foot where it is, J a + dJ/dt v = 0. */
static void follow(int foot, const double J[6 * NV], double a[NV]) {
    double A[6][6], b[6];
    check(rbd_point_acceleration(&hyq_model, w, lower[foot], toe, RBD_WORLD_AXES, b));
    for (int i = 0; i < 3; i++) {
        b[i] = -b[3 + i];
        for (int k = 0; k < 6; k++) b[i] -= J[(3 + i) * NV + k] * a[k];
        for (int k = 0; k < 3; k++) A[i][k] = J[(3 + i) * NV + 6 + 4 * k + foot];
    }
    solve(3, A, b);
    for (int k = 0; k < 3; k++) a[6 + 4 * k + foot] = b[k];
}

/* tau, and the feet's forces f of least cost with G f = b, what the trunk needs: f = W^-1 G' (G W^-1 G')^-1
   b. */
static void control(const double *home, const double *q, const double *v, double *tau, double f[FEET][3]) {
    static double J[FEET][6 * NV];
    double d[NV], a[NV], A[6][6] = {{0}}, b[6], share[NV];
    check(rbd_difference(&hyq_model, q, home, d));
    for (int k = 0; k < 6; k++) a[k] = 100 * d[k] - 20 * v[k];
    check(rbd_kinematics(&hyq_model, w, q, v, NULL));
    for (int i = 0; i < FEET; i++) {
        check(rbd_jacobian(&hyq_model, w, lower[i], toe, RBD_WORLD_AXES, J[i]));
        follow(i, J[i], a);
        for (int r = 0; r < 6; r++)
            for (int c = 0; c < 6; c++)
                for (int k = 3; k < 6; k++) A[r][c] += J[i][k * NV + r] * J[i][k * NV + c] / cost[i];
    }
    check(rbd_rnea(&hyq_model, w, q, v, a, NULL, tau));
    for (int k = 0; k < 6; k++) b[k] = tau[k];
    solve(6, A, b);
    for (int i = 0; i < FEET; i++) {
        double wrench[6] = {0};
        for (int k = 0; k < 3; k++) {
            f[i][k] = 0;
            for (int r = 0; r < 6; r++) f[i][k] += J[i][(3 + k) * NV + r] * b[r] / cost[i];
            wrench[3 + k] = f[i][k];
        }
        check(rbd_jacobian_transpose(&hyq_model, w, lower[i], toe, RBD_WORLD_AXES, wrench, share));
        for (int k = 0; k < NV; k++) tau[k] -= share[k]; /* the trunk's six become 0 */
    }
}

/* The ground's forces on the feet, and their rows of f_ext. */
static void ground(double f[FEET][3], double *f_ext) {
    for (int i = 0; i < FEET; i++) {
        double x[3], v[6], wrench[6] = {0};
        check(rbd_point_position(&hyq_model, w, lower[i], toe, x));
        check(rbd_point_velocity(&hyq_model, w, lower[i], toe, RBD_WORLD_AXES, v));
        for (int k = 0; k < 3; k++)
            wrench[3 + k] = f[i][k] = stiffness * (place[i][k] - x[k]) - damping * v[3 + k];
        check(rbd_point_wrench(&hyq_model, w, lower[i], toe, RBD_WORLD_AXES, wrench, f_ext + 6 * lower[i]));
    }
}

/* How far the zero-moment point, from the momentum's rate, is from the centre of the feet's pressure. */
static double apart(const double *q, const double *v, const double *a, double f[FEET][3]) {
    double c[3], h_dot[6], total[3] = {0}, pressed[2] = {0}, z[2];
    check(rbd_kinematics(&hyq_model, w, q, v, a));
    check(rbd_com(&hyq_model, w, c, NULL, NULL));
    check(rbd_momentum(&hyq_model, w, NULL, h_dot));
    for (int i = 0; i < FEET; i++)
        for (int k = 0; k < 3; k++) {
            total[k] += f[i][k];
            if (k < 2) pressed[k] += f[i][2] * place[i][k];
        }
    h_dot[5] += rbd_mass(&hyq_model) * 9.81;
    z[0] = c[0] - (h_dot[1] + c[2] * h_dot[3]) / h_dot[5];
    z[1] = c[1] + (h_dot[0] - c[2] * h_dot[4]) / h_dot[5];
    return hypot(z[0] - pressed[0] / total[2], z[1] - pressed[1] / total[2]);
}

int main(void) {
    double q[NQ], v[NV] = {0}, a[NV], tau[NV], home[NQ], wanted[FEET][3], f[FEET][3], steepest = 0, off = 0,
                  zmp = 0;
    check(rbd_work_init(&hyq_model, memory, sizeof memory, &w));
    check(rbd_neutral(&hyq_model, home));
    for (int i = 0; i < FEET; i++) {
        home[HYQ_Q_LF_HFE_JOINT + i] = i < 2 ? 0.7 : -0.7;
        home[HYQ_Q_LF_KFE_JOINT + i] = i < 2 ? -1.4 : 1.4;
    }
    check(rbd_kinematics(&hyq_model, w, home, NULL, NULL));
    check(rbd_point_position(&hyq_model, w, lower[0], toe, place[0]));
    home[HYQ_Q_ROOT_Z] -= place[0][2]; /* the ground is z = 0 */
    check(rbd_kinematics(&hyq_model, w, home, NULL, NULL));
    for (int i = 0; i < FEET; i++) check(rbd_point_position(&hyq_model, w, lower[i], toe, place[i]));
    for (int i = 0; i < NQ; i++) q[i] = home[i];
    for (int step = 0; step <= STEPS; step++) {
        double f_ext[6 * HYQ_NB] = {0};
        if (step >= 1000 && step < 1400)
            f_ext[6 * HYQ_BODY_BASE_LINK_0 + 4] = 100; /* N, to the left, for 0.1 s */
        control(home, q, v, tau, wanted);
        ground(f, f_ext);
        for (int i = 0; i < FEET && step >= 1000; i++)
            steepest = fmax(steepest, f[i][2] > 0 ? hypot(f[i][0], f[i][1]) / f[i][2] : HUGE_VAL);
        if (step % 1000 == 0 && step > 0)
            printf("%.2f s: trunk %4.1f mm to the left; left hind foot %.0f N of %.0f N\n", step * dt,
                   1e3 * (q[HYQ_Q_ROOT_Y] - home[HYQ_Q_ROOT_Y]), f[2][2],
                   f[0][2] + f[1][2] + f[2][2] + f[3][2]);
        check(rbd_aba(&hyq_model, w, q, v, tau, f_ext, a));
        if (step >= 1400) zmp = fmax(zmp, apart(q, v, a, f));
        check(rbd_step(&hyq_model, q, v, a, dt, q, v));
    }
    for (int i = 0; i < FEET; i++)
        for (int k = 0; k < 3; k++) off = fmax(off, fabs(f[i][k] - wanted[i][k]));
    const int good =
        steepest < 0.6 && off < 0.1 && zmp < 1e-3 && fabs(q[HYQ_Q_ROOT_Y] - home[HYQ_Q_ROOT_Y]) < 1e-4;
    printf("feet push, never steeper than 0.6, in the end as chosen; zero-moment point among them; it came "
           "back: %s\n",
           good ? "yes" : "no");
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
