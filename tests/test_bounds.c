/* test_bounds.c - the bound e that each pivot is judged by, measured. RBDI_NOISE is a variable here: the
   verdict on a pivot D changes where D = noise (e + armature). e is computed once more from its definition in
   [pivots] of rbd.h, with 6x6 matrices and without its recursion: the motions y of the links when one joint
   moves and those behind it give way are followed outwards, and y' K y is added up. */
#include "quiet_check.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double test_noise;
#define RBDI_NOISE ((rbd_real)test_noise)
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include "fuzz/robots.h"

enum { MAX_LINKS = 3 * WORLD_BODIES, MAX_DOFS = WORLD_DOFS };

static const int is_float = sizeof(rbd_real) < sizeof(double);

typedef struct link_data {
    double X[6][6];                /* motion of the parent to motion in the link's frame */
    double S[6][6], U[6][6], D[6]; /* per axis: motion, IA S and pivot when it gives way */
    double IA[6][6];               /* articulated inertia, while it is added up */
    double IA_size, M_size;        /* absolute sums of its diagonals, before and after giving way */
    double own[6];                 /* diagonal of the bodies' inertia at the link's origin */
    int n;                         /* axes */
} link_data;
static link_data links[MAX_LINKS];

static double product(const double *x, const double *y, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += x[i] * y[i];
    return sum;
}

static void cross(const double a[3], const double b[3], double c[3]) {
    for (int i = 0; i < 3; i++) c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* ---- what the bound is made of ---- */

/* The frame of link i from its parent's: x_link = E (x_parent - r). */
static void frame_of(const rbd_model *m, const rbd_work *w, int i, double E[3][3], double r[3]) {
    const rbdi_link *l = &m->link[i];
    if (l->kind == RBDI_BLOCK) {
        const rbdi_pose *P = &w->block[l->block].X;
        const rbdi_mat R = P->E;
        const double rows[3][3] = {{R.xx, R.xy, R.xz}, {R.yx, R.yy, R.yz}, {R.zx, R.zy, R.zz}};
        memcpy(E, rows, sizeof rows);
        r[0] = P->r.x, r[1] = P->r.y, r[2] = P->r.z;
        return;
    }
    const rbdi_trig t = rbdi_trig_of(m, w, i, l->flags);
    for (int k = 0; k < 3; k++) {
        const rbdi_v3 x = rbdi_down(l, l->flags, t, rbdi_vec(k == 0, k == 1, k == 2));
        E[0][k] = x.x, E[1][k] = x.y, E[2][k] = x.z;
    }
    const double shift[3] = {l->r.x, l->r.y, l->r.z}, d = (double)t.d;
    for (int k = 0; k < 3; k++) r[k] = shift[k] + E[2][k] * d;
}

static void motion_transform(const rbd_model *m, const rbd_work *w, int i) {
    double E[3][3], r[3];
    frame_of(m, w, i, E, r);
    for (int k = 0; k < 6; k++) {
        double omega[3] = {k == 0, k == 1, k == 2}, v[3] = {k == 3, k == 4, k == 5}, u[3];
        cross(omega, r, u);
        for (int j = 0; j < 3; j++) v[j] += u[j];
        for (int j = 0; j < 3; j++) {
            links[i].X[j][k] = product(E[j], omega, 3);
            links[i].X[j + 3][k] = product(E[j], v, 3);
        }
    }
}

static void motion_axes(const rbd_model *m, int i) {
    const rbdi_link *l = &m->link[i];
    memset(links[i].S, 0, sizeof links[i].S);
    links[i].n = l->kind == RBDI_BLOCK ? m->block[l->block].n : 1;
    if (l->kind == RBDI_BLOCK)
        for (int k = 0; k < links[i].n; k++) links[i].S[k][m->block[l->block].first + k] = 1;
    else
        links[i].S[0][2] = l->rho, links[i].S[0][5] = l->kappa;
}

/* The build's rounding counts relative to the trace. */
static void add_body(const rbdi_frame *u) {
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
    trace += mass * (product(r, r, 3) + product(c, c, 3));
    for (int k = 0; k < 3; k++) {
        links[u->link].own[k] += fabs(diagonal[k]) + mass * (product(p, p, 3) - p[k] * p[k]) + trace * build;
        links[u->link].own[3 + k] += mass;
    }
}

/* The link's regrouped inertia, [tr(Sigma) - Sigma, [h]x; ., m]. */
static void link_inertia(const rbdi_link *l, double I[6][6]) {
    const double S[3][3] = {{l->Sigma.xx, l->Sigma.xy, l->Sigma.xz},
                            {l->Sigma.xy, l->Sigma.yy, l->Sigma.yz},
                            {l->Sigma.xz, l->Sigma.yz, l->Sigma.zz}};
    const double h[3] = {l->h.x, l->h.y, l->h.z};
    memset(I, 0, 36 * sizeof(double));
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int c = 0; c < 3; c++) I[i][c] = -S[i][c];
        I[i][i] = S[j][j] + S[k][k];
        I[i][3 + j] = I[3 + j][i] = -h[k];
        I[i][3 + k] = I[3 + k][i] = h[j];
        I[3 + i][3 + i] = l->mass;
    }
}

static void note_size(link_data *p) {
    for (int k = 0; k < 3; k++) {
        p->IA_size += fabs(p->IA[k][k]);
        p->M_size += fabs(p->IA[3 + k][3 + k]);
    }
}

/* Articulated inertias by RBDA table 7.1; a held dof is rigid. */
static void articulate(const rbd_model *m, const unsigned char *held) {
    for (int i = 0; i < m->nl; i++) link_inertia(&m->link[i], links[i].IA);
    for (int i = m->nl - 1; i >= 0; i--) {
        link_data *p = &links[i];
        const int iv = m->link[i].iv, parent = m->link[i].parent;
        p->IA_size = p->M_size = 0;
        note_size(p);
        for (int k = p->n - 1; k >= 0; k--) {
            for (int j = 0; j < 6; j++) p->U[k][j] = product(p->IA[j], p->S[k], 6);
            p->D[k] = product(p->U[k], p->S[k], 6) + (double)m->dof[iv + k].armature;
            for (int a = 0; a < 6 && !held[iv + k]; a++)
                for (int b = 0; b < 6; b++) p->IA[a][b] -= p->U[k][a] * p->U[k][b] / p->D[k];
        }
        note_size(p);
        for (int a = 0; a < 6 && parent >= 0; a++)
            for (int b = 0; b < 6; b++)
                for (int c = 0; c < 6; c++)
                    for (int d = 0; d < 6; d++)
                        links[parent].IA[a][b] += p->X[c][a] * p->IA[c][d] * p->X[d][b];
    }
}

static void look_at(const rbd_model *m, const rbd_work *w, const unsigned char *held) {
    memset(links, 0, sizeof links);
    for (int i = 0; i < m->nl; i++) {
        motion_transform(m, w, i);
        motion_axes(m, i);
    }
    for (int b = 0; b < m->nb; b++)
        if (m->frame[b].link >= 0) add_body(&m->frame[b]);
    articulate(m, held);
}

/* ---- e = fixed + noise * by_noise ---- */

typedef struct bound {
    double fixed, by_noise;
} bound;

/* y' K y of link i, whose motion is y, before its own joint moved z; 'way': what the change to the parent's
   frame rounds, the parent turning with omega. */
static void add_own(int i, const double y[6], bound *e) {
    for (int k = 0; k < 6; k++) e->fixed += y[k] * y[k] * links[i].own[k];
}
static void add_way(const rbd_model *m, const rbd_work *w, int i, int held, const double z[6],
                    const double omega[3], bound *e) {
    const rbdi_link *l = &m->link[i];
    const link_data *p = &links[i];
    const int block = l->kind == RBDI_BLOCK;
    const double build = fmin(1, 2.220446049250313e-16 / (double)RBDI_EPS), turn = 0.0625;
    const rbdi_pose *X = block ? &w->block[l->block].X : NULL;
    const double r[3] = {block ? X->r.x : l->r.x, block ? X->r.y : l->r.y, block ? X->r.z : l->r.z};
    const double d = block ? 0 : rbdi_trig_of(m, w, i, l->flags).d, rr = product(r, r, 3);
    const int right_angle = (l->flags & RBDI_TWIST_90) != 0;
    const int whole = block || held || (l->flags & (RBDI_SLIDES | RBDI_ARMATURE)) != 0;
    const double about_z = whole ? 1 : right_angle ? 0 : fabs((double)l->sa);
    const double I = turn * (p->IA_size + d * d * p->M_size), M = turn * p->M_size;
    const double diagonal[6] = {I, I, I * about_z, M, M, M * about_z};
    for (int k = 0; k < 6; k++) e->fixed += diagonal[k] * z[k] * z[k];
    e->fixed += product(omega, omega, 3) * rr * M;
    e->by_noise += product(omega, omega, 3) * build * build * (p->IA_size + (rr + d * d) * p->M_size);
}

/* Axis k of link i moves, those behind it in the link and in its subtree give way. */
static bound bound_of(const rbd_model *m, const rbd_work *w, const unsigned char *held, int i, int k) {
    static double y[MAX_LINKS][6];
    int moves[MAX_LINKS] = {0};
    bound e = {0, 0};
    for (int j = i; j < m->nl; j++) {
        const link_data *p = &links[j];
        const int parent = m->link[j].parent;
        double z[6] = {0};
        if (j != i && !(parent >= i && moves[parent])) continue;
        moves[j] = 1;
        for (int c = 0; c < 6 && j != i; c++) z[c] = product(p->X[c], y[parent], 6);
        memcpy(y[j], j == i ? p->S[k] : z, sizeof y[j]);
        for (int a = j == i ? k + 1 : 0; a < p->n; a++) {
            const double x = held[m->link[j].iv + a] ? 0 : product(p->U[a], y[j], 6) / p->D[a];
            for (int c = 0; c < 6; c++) y[j][c] -= p->S[a][c] * x;
            e.fixed += (double)m->dof[m->link[j].iv + a].armature * x * x;
        }
        add_own(j, y[j], &e);
        if (j != i) add_way(m, w, j, held[m->link[j].iv], z, y[parent], &e);
    }
    return e;
}

/* Of the factor: e = sum of w_j^2 K_jj, w column k of L^-1, K_jj = M_jj + own + scale / 4. */
static void factor_bounds(const rbd_model *m, double M[MAX_DOFS][MAX_DOFS], bound *e) {
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
        e[k].fixed = K[k], e[k].by_noise = 0;
        for (int j = k + 1; j < n; j++) {
            column[j] = -product(&M[j][k], &column[k], j - k) / M[j][j];
            e[k].fixed += column[j] * column[j] * K[j];
        }
    }
}

/* ---- the verdicts ---- */

typedef void judge(const rbd_model *m, rbd_work *w, const void *more);
static void judge_aba(const rbd_model *m, rbd_work *w, const void *more) {
    (void)more;
    rbdi_aba_judge(m, w);
}
static void judge_hybrid(const rbd_model *m, rbd_work *w, const void *given) {
    rbdi_hybrid_judge(m, w, given);
}
static void judge_factor(const rbd_model *m, rbd_work *w, const void *L) { rbdi_factor_judge(m, w, L); }

/* Pivot k is sound just below the noise where D = noise (e + armature), and not just above. */
static void expect_bound(const char *what, const rbd_model *m, rbd_work *w, judge *call, const void *more,
                         const rbd_real *D, int k, bound e) {
    const double b = e.fixed + (double)m->dof[k].armature, a = e.by_noise, c = (double)D[k];
    const double limit = 2 * c / (b + sqrt(b * b + 4 * a * c)), away = is_float ? 3e-3 : 1e-6;
    for (int side = -1; side <= 1; side += 2) {
        memcpy(w->pivot, D, (size_t)m->nv * sizeof *D);
        test_noise = limit * (1 + side * away);
        call(m, w, more);
        ck_assert_msg((w->pivot[k] > 0) == (side < 0), "%s, dof %d of %d: %s at %.9g of the noise", what, k,
                      m->nv, side < 0 ? "not sound" : "sound", 1 + side * away);
    }
}

static void expect_links(const char *what, const rbd_model *m, rbd_work *w, judge *call, const void *more,
                         const unsigned char *held) {
    rbd_real D[MAX_DOFS];
    memcpy(D, w->pivot, (size_t)m->nv * sizeof *D);
    look_at(m, w, held);
    for (int i = 0; i < m->nl; i++)
        for (int k = 0; k < links[i].n; k++)
            if (!held[m->link[i].iv + k])
                expect_bound(what, m, w, call, more, D, m->link[i].iv + k, bound_of(m, w, held, i, k));
}

static void expect_factor(const rbd_model *m, rbd_work *w, const rbd_real *q) {
    static rbd_real M[MAX_DOFS * MAX_DOFS], L[MAX_DOFS * MAX_DOFS], D[MAX_DOFS];
    static double dense[MAX_DOFS][MAX_DOFS];
    static const unsigned char none[MAX_DOFS + WORLD_BODIES];
    bound e[MAX_DOFS];
    ck_assert_int_eq(rbd_crba(m, w, q, M), RBD_OK);
    look_at(m, w, none);
    for (int i = 0; i < m->nv * m->nv; i++) dense[i / m->nv][i % m->nv] = (double)M[i];
    factor_bounds(m, dense, e);
    ck_assert_int_eq(rbd_cholesky_factor(m, w, M, L), RBD_OK);
    memcpy(D, w->pivot, (size_t)m->nv * sizeof *D);
    for (int k = 0; k < m->nv; k++) expect_bound("factor", m, w, judge_factor, L, D, k, e[k]);
}

/* ---- robots ---- */

typedef void check_robot(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *x, int number);

static void for_robots(int class_number, int count, check_robot *check) {
    static union {
        long double align;
        unsigned char bytes[1 << 20];
    } model_memory, work_memory;
    for (int number = 0; number < count; number++) {
        sample s;
        sample_state x;
        rbd_real q[WORLD_COORDINATES], v[WORLD_DOFS];
        const rbd_model *m;
        rbd_work *w;
        draw_robot(&s, class_number, number);
        draw_state(&s, &x);
        ck_assert_int_eq(rbd_model_build(s.bodies, s.nb, &model_memory, sizeof model_memory, &m, NULL),
                         RBD_OK);
        ck_assert_int_eq(rbd_work_init(m, &work_memory, sizeof work_memory, &w), RBD_OK);
        for (int k = 0; k < s.nq; k++) q[k] = (rbd_real)x.q[k];
        for (int k = 0; k < s.nv; k++) v[k] = (rbd_real)x.v[k];
        test_noise = 0;
        check(m, w, q, v, number);
    }
}

static void check_aba(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *x, int number) {
    static const unsigned char none[MAX_DOFS];
    rbd_real a[WORLD_DOFS];
    (void)number;
    ck_assert_int_eq(rbd_aba(m, w, q, x, x, NULL, a), RBD_OK);
    expect_links("aba", m, w, judge_aba, NULL, none);
}

/* With other dofs held for each robot, of the blocks some. */
static void check_hybrid(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *x, int number) {
    unsigned char held[MAX_DOFS];
    rbd_real a[WORLD_DOFS], tau[WORLD_DOFS];
    rbdi_given given = {held, a};
    for (int k = 0; k < m->nv; k++) held[k] = (k * 5 + number) % (2 + number % 3) == 0, a[k] = tau[k] = x[k];
    ck_assert_int_eq(rbd_hybrid(m, w, q, x, held, NULL, a, tau), RBD_OK);
    expect_links("hybrid", m, w, judge_hybrid, &given, held);
}

static void check_factor(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *x, int number) {
    (void)x, (void)number;
    expect_factor(m, w, q);
}

START_TEST(bound_of_articulated_bodies_is_that_of_its_definition) {
    for_robots(ORDINARY, 40, check_aba);
    for_robots(AXES, 40, check_aba);
}
END_TEST

START_TEST(bound_of_hybrid_dynamics_is_that_of_its_definition) { for_robots(ORDINARY, 40, check_hybrid); }
END_TEST

START_TEST(bound_of_the_factor_is_that_of_its_definition) {
    for_robots(ORDINARY, 40, check_factor);
    for_robots(FOLLOWERS, 40, check_factor);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("bounds");
    TCase *c = tcase_create("bounds");
    SRunner *runner;
    int failed;
    tcase_add_test(c, bound_of_articulated_bodies_is_that_of_its_definition);
    tcase_add_test(c, bound_of_hybrid_dynamics_is_that_of_its_definition);
    if (!is_float) /* which keeps too few digits of the longest robots' factors */
        tcase_add_test(c, bound_of_the_factor_is_that_of_its_definition);
    suite_add_tcase(suite, c);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
