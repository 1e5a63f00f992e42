/* test_bounds.c - the bound e that each pivot is judged by, measured. RBDI_NOISE is a variable here: the
   verdict on a pivot D in doubt changes where D = noise (e + armature). e is computed once more from its
   definition in [pivots] of rbd.h, with dense matrices. */
#include "quiet_check.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double test_noise;
#define RBDI_NOISE ((rbd_real)test_noise)
#define RBDI_TURN 0
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include "fuzz/robots.h"

enum { MAX_LINKS = 3 * WORLD_BODIES, MAX_DOFS = WORLD_DOFS };

typedef struct link_data {
    double S[6][6]; /* per axis: motion */
    double own[6];  /* diagonal of the bodies' inertia at the link's origin */
    int n;          /* axes */
} link_data;
static link_data links[MAX_LINKS];

static double product(const double *x, const double *y, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += x[i] * y[i];
    return sum;
}

/* ---- what the bound is made of ---- */

static void motion_axes(const rbd_model *m, int i) {
    const rbdi_link *l = &m->link[i];
    memset(links[i].S, 0, sizeof links[i].S);
    links[i].n = l->kind == RBDI_BLOCK ? m->block[l->block].n : 1;
    if (l->kind == RBDI_BLOCK)
        for (int k = 0; k < links[i].n; k++) links[i].S[k][m->block[l->block].first + k] = 1;
    else
        links[i].S[0][2] = l->rho, links[i].S[0][5] = l->kappa;
}

/* The build's rounding counts relative to the trace, the user's origin of the joint being as far as its
   body's r. */
static void add_body(const rbd_model *m, const rbdi_frame *u) {
    const rbdi_c3 user = m->frame[m->dof[m->link[u->link].iv].body].r;
    const double o[3] = {user.x, user.y, user.z};
    const double build = 2.220446049250313e-16 / (double)RBDI_EPS;
    const double I[3][3] = {
        {u->I.xx, u->I.xy, u->I.xz}, {u->I.xy, u->I.yy, u->I.yz}, {u->I.xz, u->I.yz, u->I.zz}};
    const double r[3] = {u->r.x, u->r.y, u->r.z}, com[3] = {u->com.x, u->com.y, u->com.z}, mass = u->mass;
    double E[9], c[3], p[3], diagonal[3] = {0}, trace = 0;
    for (int k = 0; k < 9; k++) E[k] = u->E[k];
    for (int k = 0; k < 3; k++) {
        c[k] = E[k] * com[0] + E[3 + k] * com[1] + E[6 + k] * com[2];
        p[k] = r[k] + c[k];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) diagonal[k] += E[3 * i + k] * I[i][j] * E[3 * j + k];
        trace += fabs(diagonal[k]);
    }
    trace += mass * (product(r, r, 3) + product(c, c, 3) + product(o, o, 3));
    for (int k = 0; k < 3; k++) {
        links[u->link].own[k] += fabs(diagonal[k]) + mass * (product(p, p, 3) - p[k] * p[k]) + trace * build;
        links[u->link].own[3 + k] += mass;
    }
}

static void look_at(const rbd_model *m) {
    memset(links, 0, sizeof links);
    for (int i = 0; i < m->nl; i++) motion_axes(m, i);
    for (int b = 0; b < m->nb; b++)
        if (m->frame[b].link >= 0) add_body(m, &m->frame[b]);
}

/* e = sum of y_j^2 K_jj, y column k of L^-1, K_jj = M_jj + own + scale / 4. */
static void factor_bounds(const rbd_model *m, double M[MAX_DOFS][MAX_DOFS], double *e) {
    const int n = m->nv;
    double K[MAX_DOFS], column[MAX_DOFS];
    for (int k = 0; k < n; k++) K[k] = M[k][k] + (double)m->dof[k].scale / 4;
    for (int i = 0; i < m->nl; i++)
        for (int k = 0; k < links[i].n; k++) {
            const int dof = m->link[i].iv + k, mimic = dof - n;
            const double ratio = mimic < 0 ? 1 : m->mimic[mimic].ratio;
            double own = 0;
            for (int c = 0; c < 6; c++) own += links[i].own[c] * links[i].S[k][c] * links[i].S[k][c];
            K[mimic < 0 ? dof : m->mimic[mimic].source_v] += own * ratio * ratio;
        }
    for (int j = n - 1; j >= 0; j--) /* M = L'DL, in place: L below the diagonal */
        for (int a = 0; a < j; a++) {
            const double l = M[j][a] / M[j][j];
            for (int b = 0; b <= a; b++) M[a][b] -= l * M[j][b];
        }
    for (int k = 0; k < n; k++) {
        column[k] = 1;
        e[k] = K[k];
        for (int j = k + 1; j < n; j++) {
            column[j] = -product(&M[j][k], &column[k], j - k) / M[j][j];
            e[k] += column[j] * column[j] * K[j];
        }
    }
}

/* The link's axes and origin in the world. */
static void pose_of(const rbd_work *w, int i, double E[3][3], double r[3]) {
    const rbdi_pose *X = &w->kin[i].X;
    const rbdi_mat *A = &X->E;
    const double rows[3][3] = {{A->xx, A->xy, A->xz}, {A->yx, A->yy, A->yz}, {A->zx, A->zy, A->zz}};
    memcpy(E, rows, sizeof rows);
    r[0] = X->r.x, r[1] = X->r.y, r[2] = X->r.z;
}

/* The same of articulated bodies, except for the rounding of frames: e = sum of y_j^2 (D_j + share of scale)
   and of each link's inertia along its motion with y. Those behind dof k move by the column of L^-1. */
static void body_bounds(const rbd_model *m, const rbd_work *w, double M[MAX_DOFS][MAX_DOFS], double *e) {
    static double motion[MAX_LINKS][6]; /* world axes, at the world's origin */
    const int n = m->nv;
    double y[MAX_DOFS];
    for (int j = n - 1; j >= 0; j--)
        for (int a = 0; a < j; a++) {
            const double l = M[j][a] / M[j][j];
            for (int b = 0; b <= a; b++) M[a][b] -= l * M[j][b];
        }
    for (int k = 0; k < n; k++) {
        memset(y, 0, sizeof y);
        y[k] = 1;
        for (int j = k + 1; j < n; j++) y[j] = -product(&M[j][k], &y[k], j - k) / M[j][j];
        e[k] = 0;
        for (int j = k; j < n; j++)
            e[k] += y[j] * y[j] *
                    (M[j][j] + (double)m->dof[j].scale * (double)RBDI_SHARE + (double)m->dof[j].armature);
        for (int i = 0; i < m->nl; i++) {
            const rbdi_link *l = &m->link[i];
            double E[3][3], r[3], own[6] = {0}, omega[3], v[3];
            pose_of(w, i, E, r);
            memset(motion[i], 0, sizeof motion[i]);
            if (l->parent >= 0) memcpy(motion[i], motion[l->parent], sizeof motion[i]);
            for (int a = 0; a < links[i].n; a++)
                for (int c = 0; c < 6; c++) own[c] += links[i].S[a][c] * y[l->iv + a];
            for (int c = 0; c < 3; c++) {
                omega[c] = E[0][c] * own[0] + E[1][c] * own[1] + E[2][c] * own[2];
                v[c] = E[0][c] * own[3] + E[1][c] * own[4] + E[2][c] * own[5];
            }
            for (int c = 0; c < 3; c++) { /* v at the world's origin: v - omega x r */
                motion[i][c] += omega[c];
                motion[i][3 + c] +=
                    v[c] - omega[(c + 1) % 3] * r[(c + 2) % 3] + omega[(c + 2) % 3] * r[(c + 1) % 3];
            }
            for (int c = 0; c < 3; c++)
                v[c] = motion[i][3 + c] + motion[i][(c + 1) % 3] * r[(c + 2) % 3] -
                       motion[i][(c + 2) % 3] * r[(c + 1) % 3];
            for (int c = 0; c < 3; c++) {
                const double turn = product(E[c], motion[i], 3), shift = product(E[c], v, 3);
                e[k] += links[i].own[c] * turn * turn + links[i].own[3 + c] * shift * shift;
            }
        }
    }
}

/* ---- the verdicts ---- */

/* Makes the rows and columns of held dofs those of a diagonal matrix, as in dense below. */
static void hold_rows(const rbd_model *m, const unsigned char *held, rbd_real *H) {
    for (int i = 0; i < m->nv; i++)
        for (int j = 0; j <= i; j++) {
            const int at = rbd_packed_index(m, i, j);
            if (at >= 0 && (held[i] || held[j])) H[at] = i == j ? 1 + (rbd_real)m->dof[i].scale : 0;
        }
}

/* The pivots of M without what is held: each is sound just below the noise where D = noise (e + armature),
   and not just above; and in any case if no pivot is in doubt. */
static void expect_bounds(const rbd_model *m, rbd_work *w, const rbd_real *q, const unsigned char *held) {
    static rbd_real M[MAX_DOFS * MAX_DOFS], L[MAX_DOFS * MAX_DOFS], D[MAX_DOFS];
    static double dense[MAX_DOFS][MAX_DOFS];
    const int n = m->nv, doubt = 1;
    double e[MAX_DOFS];
    ck_assert_int_eq(rbd_crba(m, w, q, M), RBD_OK);
    look_at(m);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            dense[i][j] = held[i] || held[j] ? 0 : (double)M[i * n + j];
            if (i == j && held[i]) dense[i][j] = 1 + (double)m->dof[i].scale;
        }
    factor_bounds(m, dense, e);
    ck_assert_int_eq(rbd_crba_packed(m, w, q, L), RBD_OK);
    hold_rows(m, held, L);
    ck_assert(!rbdi_factor(m, w, L));
    memcpy(D, w->pivot, (size_t)n * sizeof *D);
    for (int k = 0; k < n; k++)
        for (int side = -1; side <= 1; side += 2) {
            const double away = 1e-6, limit = (double)D[k] / (e[k] + (double)m->dof[k].armature);
            test_noise = limit * (1 + side * away);
            memcpy(w->pivot, D, (size_t)n * sizeof *D);
            rbdi_check_factor(m, w, L, doubt);
            ck_assert_msg((w->pivot[k] > 0) == (side < 0), "dof %d of %d: %s at %.9g of the noise", k, n,
                          side < 0 ? "not sound" : "sound", 1 + side * away);
            memcpy(w->pivot, D, (size_t)n * sizeof *D);
            rbdi_check_factor(m, w, L, !doubt);
            ck_assert_msg(w->pivot[k] > 0, "dof %d of %d: not sound without doubt", k, n);
        }
}

/* The pivots of articulated bodies: the same. */
static void expect_body_bounds(const rbd_model *m, rbd_work *w, const rbd_real *q) {
    static rbd_real M[MAX_DOFS * MAX_DOFS], zero[MAX_DOFS], a[MAX_DOFS], D[MAX_DOFS];
    static double dense[MAX_DOFS][MAX_DOFS];
    const int n = m->nv, doubt = 1;
    double e[MAX_DOFS];
    ck_assert_int_eq(rbd_kinematics(m, w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_crba(m, w, q, M), RBD_OK);
    look_at(m);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) dense[i][j] = (double)M[i * n + j];
    body_bounds(m, w, dense, e);
    ck_assert_int_eq(rbd_aba(m, w, q, zero, zero, NULL, a), RBD_OK);
    memcpy(D, w->pivot, (size_t)n * sizeof *D);
    for (int k = 0; k < n; k++)
        for (int side = -1; side <= 1; side += 2) {
            test_noise = (double)D[k] / e[k] * (1 + side * 1e-6);
            memcpy(w->pivot, D, (size_t)n * sizeof *D);
            rbdi_check_bodies(m, w, doubt);
            ck_assert_msg((w->pivot[k] > 0) == (side < 0),
                          "articulated, dof %d of %d: %s at %.9g of the noise", k, n,
                          side < 0 ? "not sound" : "sound", 1 + side * 1e-6);
        }
}

/* ---- robots ---- */

/* With nothing held, or other dofs for each robot. */
static void for_robots(int class_number, int count, int hold) {
    static union {
        long double align;
        unsigned char bytes[1 << 20];
    } model_memory, work_memory;
    for (int number = 0; number < count; number++) {
        unsigned char held[MAX_DOFS] = {0};
        sample s;
        sample_state x;
        rbd_real q[WORLD_COORDINATES];
        const rbd_model *m;
        rbd_work *w;
        draw_robot(&s, class_number, number);
        draw_state(&s, &x);
        ck_assert_int_eq(rbd_model_build(s.bodies, s.nb, &model_memory, sizeof model_memory, &m, NULL),
                         RBD_OK);
        ck_assert_int_eq(rbd_work_init(m, &work_memory, sizeof work_memory, &w), RBD_OK);
        for (int k = 0; k < s.nq; k++) q[k] = (rbd_real)x.q[k];
        for (int k = 0; k < m->nv && hold; k++) held[k] = (k * 5 + number) % (2 + number % 3) == 0;
        test_noise = 0;
        expect_bounds(m, w, q, held);
        test_noise = 0;
        if (!hold && m->nmimic == 0) expect_body_bounds(m, w, q);
    }
}

START_TEST(bound_of_the_factor_is_that_of_its_definition) {
    for_robots(ORDINARY, 40, 0);
    for_robots(AXES, 40, 0);
    for_robots(FOLLOWERS, 40, 0);
    for_robots(ORDINARY, 40, 1);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("bounds");
    TCase *c = tcase_create("bounds");
    SRunner *runner;
    int failed;
    tcase_add_test(c, bound_of_the_factor_is_that_of_its_definition);
    suite_add_tcase(suite, c);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
