/* one_word.c - what the calls say of singular states, RBD_OK or RBD_ERR_SINGULAR, and which degree of
   freedom they name. Each model is a random tree with a singular end: blocks, screws, massless chains,
   planar joints, bodies that turn about no mass, all placed by axes and positions that rounding cannot hold.
   Three of each:

       singular   exactly, but for the rounding of the description: no call says RBD_OK
       sound      the same with an armature in each joint of the end: all say RBD_OK
       near       the same with an armature of any size, 1e-24 of that or more

   Calls by the factor of M say the same of all three and name the same degree of freedom. rbd_aba has pivots
   of its own: of the near ones it may say another word. Of those the calls with constraints may also find
   that rounding keeps them from holding their rows: RBD_ERR_INFEASIBLE.

       one_word [MODELS]    by default 10,000; one build for each scalar. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#ifdef RBD_LANES
#define RBD_STATIC
#endif
#include "rbd_derivatives.h"

#include "rbd_constraints.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef RBD_LANES
enum { LANES = RBD_LANES };
#else
enum { LANES = 1 };
#endif
enum { BODIES = 24, NV = 48, NQ = 64, CALLS = 11, ABA = 0, CONSTRAINED = 7 };
static const char *const call_name[CALLS] = {"aba",
                                             "fd_cholesky",
                                             "cholesky_factor",
                                             "cholesky_factor_packed",
                                             "minverse",
                                             "fd_derivatives",
                                             "hybrid",
                                             "constrained_fd (end)",
                                             "impact (end)",
                                             "constrained_fd (middle)",
                                             "constrained_fd (loop)"};

typedef enum variant { SINGULAR, SOUND, NEAR, VARIANTS } variant;
static const char *const variant_name[VARIANTS] = {"singular", "sound", "near"};

/* ---- random numbers ---- */

static uint64_t seed;

static double uniform(double low, double high) {
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return low + (high - low) * ((double)(seed >> 11) * 0x1p-53);
}
static int below(int n) { return (int)uniform(0, n); }

static void cross(const double a[3], const double b[3], double c[3]) {
    for (int k = 0; k < 3; k++) c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}
static double length(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

static void random_rotation(double R[9]) {
    double x[3], y[3], z[3], n;
    for (int k = 0; k < 3; k++) x[k] = uniform(-1, 1), y[k] = uniform(-1, 1);
    cross(x, y, z);
    n = length(z);
    for (int k = 0; k < 3; k++) z[k] /= n;
    cross(y, z, x);
    n = length(x);
    for (int k = 0; k < 3; k++) x[k] /= n;
    cross(z, x, y);
    for (int k = 0; k < 3; k++) R[3 * k] = x[k], R[3 * k + 1] = y[k], R[3 * k + 2] = z[k];
}

/* ---- models ---- */

typedef struct system {
    rbd_body body[BODIES];
    int nb, first; /* first: body of the singular end */
    double size;   /* of a length */
    double mass;
    int lock;          /* body whose second coordinate stands at a right angle, -1 = none */
    double R[9], t[3]; /* of the last frame: axes and origin of the end's first, in it */
    const char *kind;
} system_;

/* x of the end's axes in the last frame's. */
static void turned(const system_ *s, const double x[3], double y[3]) {
    for (int k = 0; k < 3; k++) y[k] = s->R[k] * x[0] + s->R[3 + k] * x[1] + s->R[6 + k] * x[2];
}

/* A body of the end, massless: its axis (and a second) and origin in the end's own frame, its own frame
   turned at random. R: axes of its frame in the end's; t: origin. */
static rbd_body *add(system_ *s, rbd_joint_type type, const double axis[3], const double origin[3],
                     int turn) {
    rbd_body *b = &s->body[s->nb];
    double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, next[9], r[3], stretch;
    memset(b, 0, sizeof *b);
    b->parent = s->nb - 1;
    b->type = type;
    if (turn) random_rotation(R);
    for (int k = 0; k < 3; k++) r[k] = origin[k] - s->t[k];
    turned(s, r, b->position);
    memcpy(b->rotation, R, sizeof R);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            next[3 * i + j] = s->R[3 * i] * R[j] + s->R[3 * i + 1] * R[3 + j] + s->R[3 * i + 2] * R[6 + j];
    memcpy(s->R, next, sizeof next);
    memcpy(s->t, origin, sizeof s->t);
    turned(s, axis, b->axis);
    stretch = below(2) ? exp(uniform(-2, 2)) : 1;
    for (int k = 0; k < 3; k++) b->axis[k] *= stretch;
    s->nb++;
    return b;
}

static void whole_body(const system_ *s, rbd_body *b) {
    double R[9], e[3];
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    random_rotation(R);
    b->mass = s->mass * exp(uniform(-1, 1));
    for (int k = 0; k < 3; k++) {
        b->com[k] = s->size * uniform(-1, 1);
        e[k] = b->mass * s->size * s->size * uniform(0.1, 0.5);
    }
    for (int k = 0; k < 6; k++) {
        b->inertia[k] = 0;
        for (int i = 0; i < 3; i++)
            b->inertia[k] += R[3 * row[k] + i] * R[3 * column[k] + i] * (e[(i + 1) % 3] + e[(i + 2) % 3]);
    }
}

/* A point mass at x of the end's frame. */
static void point_mass(system_ *s, rbd_body *b, const double x[3]) {
    double r[3];
    for (int k = 0; k < 3; k++) r[k] = x[k] - s->t[k];
    turned(s, r, b->com);
    b->mass = s->mass;
}

static void random_line(double u[3]) {
    double n = 0;
    for (int k = 0; k < 3; k++) u[k] = uniform(-1, 1);
    if (below(4) == 0) u[0] = u[1] = 0;
    n = length(u);
    for (int k = 0; k < 3; k++) u[k] /= n;
}

/* The point of a line at this distance from `at`. */
static void along(const double at[3], const double u[3], double distance, double x[3]) {
    for (int k = 0; k < 3; k++) x[k] = at[k] + u[k] * distance;
}

enum { KINDS = 15 };

/* The end: see the names. */
static void add_end(system_ *s, int kind) {
    static const rbd_joint_type turns[6] = {RBD_SPHERICAL, RBD_EULER_ZYX, RBD_EULER_XYZ,
                                            RBD_EULER_YXZ, RBD_EULER_ZXY, RBD_UNIVERSAL},
                                coaxial[4] = {RBD_REVOLUTE, RBD_PRISMATIC, RBD_HELICAL, RBD_CYLINDRICAL};
    const double L = s->size;
    double u[3], w[3], n[3], at[3], x[3];
    rbd_body *b;
    random_line(u);
    random_line(w);
    cross(u, w, n);
    for (int k = 0; k < 3; k++) at[k] = 2 * L * uniform(-1, 1);
    s->first = s->nb;
    s->lock = -1;
    switch (kind) {
    case 0: /* nothing turns about the axis, as in aba_singular_unseen.c */
        s->kind = "point mass on a slide along a massless axis";
        add(s, RBD_REVOLUTE, u, at, 1);
        along(at, u, L * uniform(-2, 2) * below(2), x);
        b = add(s, RBD_PRISMATIC, u, x, below(2));
        point_mass(s, b, x);
        break;
    case 1:
        s->kind = "point mass on the axis of a cylindrical joint";
        b = add(s, RBD_CYLINDRICAL, u, at, 1);
        along(at, u, L * uniform(-2, 2) * below(2), x);
        point_mass(s, b, x);
        break;
    case 2:
        s->kind = "three massless joints about and along one axis";
        for (int i = 0; i < 3; i++) {
            along(at, u, L * uniform(-2, 2), x);
            b = add(s, coaxial[below(3)], u, x, below(3));
            b->pitch = L * uniform(-0.3, 0.3);
        }
        whole_body(s, b);
        break;
    case 3:
        s->kind = "four massless slides";
        for (int i = 0; i < 4; i++) {
            random_line(u);
            for (int k = 0; k < 3; k++) x[k] = at[k] + L * uniform(-1, 1);
            b = add(s, RBD_PRISMATIC, u, x, below(2));
        }
        whole_body(s, b);
        break;
    case 4:
        s->kind = "four massless axes through a point";
        for (int i = 0; i < 4; i++) {
            random_line(u);
            b = add(s, RBD_REVOLUTE, u, at, below(3));
        }
        whole_body(s, b);
        break;
    case 5:
        s->kind = "four massless parallel axes";
        for (int i = 0; i < 4; i++) {
            for (int k = 0; k < 3; k++) x[k] = at[k] + L * uniform(-1, 1);
            b = add(s, RBD_REVOLUTE, u, x, below(3));
        }
        whole_body(s, b);
        break;
    case 6:
        s->kind = "seven massless joints";
        for (int i = 0; i < 7; i++) {
            random_line(u);
            for (int k = 0; k < 3; k++) x[k] = at[k] + L * uniform(-1, 1);
            b = add(s, i % 3 == 2 && below(2) ? RBD_PRISMATIC : RBD_REVOLUTE, u, x, below(3));
        }
        whole_body(s, b);
        break;
    case 7:
        s->kind = "a massless planar joint and a turn about its normal or a slide in its plane";
        add(s, RBD_PLANAR, u, at, 1);
        for (int k = 0; k < 3; k++) {
            u[k] = s->R[3 * k + 2], w[k] = s->R[3 * k] * 0.6 + s->R[3 * k + 1] * 0.8;
            x[k] = at[k] + L * uniform(-1, 1);
        }
        if (below(2))
            b = add(s, RBD_REVOLUTE, u, x, 1);
        else
            b = add(s, RBD_PRISMATIC, w, x, 1);
        whole_body(s, b);
        break;
    case 8:
        s->kind = "a massless ball or Euler joint and a turn through its centre";
        add(s, turns[below(5)], u, at, 1);
        b = add(s, RBD_REVOLUTE, u, at, 1);
        whole_body(s, b);
        break;
    case 9:
        s->kind = "a massless translation and a slide";
        add(s, RBD_TRANSLATION, u, at, 1);
        b = add(s, RBD_PRISMATIC, u, at, 1);
        whole_body(s, b);
        break;
    case 10:
        s->kind = "point mass on three turns";
        b = add(s, turns[below(5)], u, at, 1);
        for (int k = 0; k < 3; k++) x[k] = at[k] + L * uniform(-1, 1) * below(2);
        point_mass(s, b, x);
        break;
    case 11:
        s->kind = "gimbal lock";
        b = add(s, turns[1 + below(4)], u, at, 1);
        s->lock = s->nb - 1;
        whole_body(s, b);
        break;
    case 12:
        s->kind = "a massless free joint and a turn";
        add(s, RBD_FLOATING, u, at, 1);
        if (below(2)) s->body[s->nb - 1].parent = -1;
        for (int k = 0; k < 3; k++) x[k] = at[k] + L * uniform(-1, 1);
        b = add(s, RBD_REVOLUTE, w, x, 1);
        whole_body(s, b);
        break;
    case 13: /* positions that nearly undo each other round as the longer */
        s->kind = "point mass on an axis, over a distant fixed body";
        add(s, RBD_REVOLUTE, u, at, 1);
        for (int k = 0; k < 3; k++) x[k] = at[k] + 1e3 * L * uniform(-1, 1);
        add(s, RBD_FIXED, u, x, 1);
        along(at, u, L * uniform(-2, 2), x);
        b = add(s, below(2) ? RBD_PRISMATIC : RBD_FIXED, u, x, 1);
        point_mass(s, b, x);
        break;
    default:
        s->kind = "a mimic joint that undoes its leader";
        b = add(s, RBD_REVOLUTE, u, at, 1);
        b->joint = "leader";
        along(at, u, L * uniform(-2, 2), x);
        b = add(s, RBD_REVOLUTE, u, x, below(2));
        b->mimic = "leader";
        b->mimic_ratio = -1;
        whole_body(s, b);
        break;
    }
}

static void random_system(system_ *s, int kind) {
    const int before = below(4);
    memset(s, 0, sizeof *s);
    s->size = pow(10, uniform(-3, 2));
    s->mass = pow(10, uniform(-3, 3));
    s->R[0] = s->R[4] = s->R[8] = 1;
    for (int i = 0; i < before; i++) {
        double u[3], at[3];
        random_line(u);
        for (int k = 0; k < 3; k++) at[k] = s->t[k] + s->size * uniform(-2, 2);
        rbd_body *b =
            add(s, (rbd_joint_type)(RBD_REVOLUTE + below(RBD_FLOATING - RBD_REVOLUTE + 1)), u, at, 1);
        random_line(b->axis2);
        b->pitch = s->size * 0.1;
        whole_body(s, b);
    }
    add_end(s, kind);
    for (int i = 0; i < s->nb; i++) {
        random_line(s->body[i].axis2);
        if (s->body[i].type != RBD_FIXED) continue;
        memset(s->body[i].axis, 0, sizeof s->body[i].axis);
        memset(s->body[i].axis2, 0, sizeof s->body[i].axis2);
    }
}

/* Whether degree of freedom k of a joint slides. */
static int slides(int type, int k) {
    return type == RBD_PRISMATIC || type == RBD_TRANSLATION || (type == RBD_CYLINDRICAL && k == 1) ||
           (type == RBD_PLANAR && k > 0) || (type == RBD_FLOATING && k > 2);
}

/* Armature in the joints of the end: share of a body's inertia. */
static void add_armature(system_ *s, double share) {
    for (int i = s->first; i < s->nb; i++)
        for (int k = 0; k < 6; k++) {
            rbd_body *b = &s->body[i];
            b->armature[k] = share * s->mass * (slides((int)b->type, k) ? 1 : s->size * s->size);
        }
}

/* ---- calls ---- */

static union {
    long double align;
    unsigned char bytes[1 << 20];
} memory[4];

static void put(rbd_real *x, int lane, double y) { ((RBD_REAL *)x)[lane] = (RBD_REAL)y; }
static double get(const rbd_real *x, int lane) { return (double)((const RBD_REAL *)x)[lane]; }

typedef struct words {
    int status[CALLS], dof[CALLS];
} words;

static void random_state(const rbd_model *m, const system_ *s, rbd_real *q, rbd_real *v, rbd_real *tau) {
    for (int lane = 0; lane < LANES; lane++) {
        for (int i = 0; i < rbd_nq(m); i++) put(&q[i], lane, uniform(-1.5, 1.5));
        for (int i = 0; i < rbd_nv(m); i++) {
            put(&v[i], lane, 0);
            put(&tau[i], lane, s->mass * s->size * s->size * uniform(-1, 1));
        }
        for (int i = 0; i < s->nb; i++) {
            const int iq = m->frame[i].iq, type = (int)s->body[i].type;
            const int unit = type == RBD_SPHERICAL       ? 4
                             : type == RBD_CONTINUOUS_CS ? 2
                             : type == RBD_FLOATING      ? 4
                                                         : 0;
            const int first = iq + (type == RBD_FLOATING ? 3 : 0);
            const int lengths = type == RBD_PRISMATIC                             ? 1
                                : type == RBD_PLANAR                              ? 2
                                : type == RBD_TRANSLATION || type == RBD_FLOATING ? 3
                                                                                  : 0;
            double square = 0;
            if (s->body[i].mimic) continue;
            for (int k = 0; k < unit; k++) square += get(&q[first + k], lane) * get(&q[first + k], lane);
            for (int k = 0; k < unit; k++) put(&q[first + k], lane, get(&q[first + k], lane) / sqrt(square));
            for (int k = 0; k < 3; k++)
                if (type == RBD_CYLINDRICAL ? k == 1 : k < lengths)
                    put(&q[iq + k], lane, s->size * get(&q[iq + k], lane));
            if (i == s->lock) put(&q[iq + 1], lane, 1.57079632679489661923);
        }
    }
}

/* Status and dof of each call for one state; returns the number of dofs. */
static int run(const system_ *s, words *o) {
    static rbd_real q[NQ], v[NV], tau[NV], a[NV], M[3][NV * NV];
    unsigned char given[NV] = {0};
    const rbd_model *m;
    rbd_work *w;
    rbd_derivatives *d;
    rbd_report report;
    rbd_status status = rbd_model_build(s->body, s->nb, &memory[0], sizeof memory[0], &m, &report);
    if (status == RBD_OK) status = rbd_work_init(m, &memory[1], sizeof memory[1], &w);
    if (status == RBD_OK) status = rbd_derivatives_init(m, w, &memory[2], sizeof memory[2], &d);
    if (status != RBD_OK) {
        fprintf(stderr, "one_word: %s: status %d\n", s->kind, status);
        exit(2);
    }
    random_state(m, s, q, v, tau);
#define SAY(k, call) o->status[k] = call, o->dof[k] = rbd_singular_dof(w)
    SAY(0, rbd_aba(m, w, q, v, tau, NULL, a));
    SAY(1, rbd_fd_cholesky(m, w, q, v, tau, NULL, a));
    rbd_crba(m, w, q, M[0]);
    SAY(2, rbd_cholesky_factor(m, w, M[0], M[1]));
    rbd_crba_packed(m, w, q, M[0]);
    SAY(3, rbd_cholesky_factor_packed(m, w, M[0]));
    SAY(4, rbd_minverse(m, w, q, M[0]));
    SAY(5, rbd_fd_derivatives(m, d, q, v, tau, NULL, a, M[0], M[1], M[2]));
    SAY(6, rbd_hybrid(m, w, q, v, given, a, tau, NULL));
    for (int k = 0; k < 4; k++) { /* a foot at the end, a foot before it, and one held to the first body */
        const double point[3] = {s->size, 0, s->size}, place[3] = {0, s->size, 0};
        const rbd_real no_bounce = {0};
        rbd_constraint foot = rbd_point_contact(k == 2 ? s->first - 1 : s->nb - 1, point, NULL);
        rbd_constraint_set *c;
        if (k == 3) foot = rbd_ball_loop(s->nb - 1, point, 0, place);
        o->status[7 + k] = o->status[1], o->dof[7 + k] = o->dof[1];
        if (rbd_constraint_set_init(m, w, &foot, 1, &memory[3], sizeof memory[3], &c, NULL) != RBD_OK)
            continue;
        SAY(7 + k, k == 1 ? rbd_impact(m, c, q, v, no_bounce, a, NULL)
                          : rbd_constrained_fd(m, c, q, v, tau, NULL, a, NULL));
    }
    return rbd_nv(m);
}

int main(int argc, char **argv) {
    const long models = argc > 1 ? strtol(argv[1], NULL, 10) : 10000;
    static long count[KINDS][VARIANTS], wrong[KINDS][VARIANTS], refused[KINDS][VARIANTS];
    static const char *kind_name[KINDS];
    long failures = 0;
    const double armature = sizeof(RBD_REAL) == 8 ? 1e-3 : 0.1;
    seed = 88172645463325252u;
    for (long i = 0; i < models; i++)
        for (int f = 0; f < VARIANTS; f++) {
            const int kind = (int)(i % KINDS);
            const uint64_t before = seed;
            static system_ s;
            static words o;
            int bad = 0, nv;
            random_system(&s, kind);
            if (f == SOUND) add_armature(&s, armature);
            if (f == NEAR) add_armature(&s, armature * pow(10, uniform(-24, 0)));
            nv = run(&s, &o);
            kind_name[kind] = s.kind;
            for (int k = 0; k < CALLS; k++) {
                if (f == SINGULAR) bad |= o.status[k] != RBD_ERR_SINGULAR;
                if (f == SOUND) bad |= o.status[k] != RBD_OK;
                if (k == ABA) continue;
                if (f == NEAR && k >= CONSTRAINED && o.status[1] == RBD_OK &&
                    o.status[k] == RBD_ERR_INFEASIBLE)
                    continue;
                bad |= o.status[k] != o.status[1] || o.dof[k] != o.dof[1];
            }
            count[kind][f]++, refused[kind][f] += o.status[1] != RBD_OK;
            if (bad && ++failures <= 20) {
                printf("model %ld (%s, %s, %d dofs, size %.1e):", i, variant_name[f], s.kind, nv, s.size);
                for (int k = 0; k < CALLS; k++) printf(" %s %d (%d)", call_name[k], o.status[k], o.dof[k]);
                puts("");
            }
            wrong[kind][f] += bad;
            if (f + 1 < VARIANTS) seed = before; /* the same model */
        }
    for (int k = 0; k < KINDS && kind_name[k]; k++) {
        printf("%-75s", kind_name[k]);
        for (int f = 0; f < VARIANTS; f++)
            printf(" %s: %ld wrong, %ld of %ld refused;", variant_name[f], wrong[k][f], refused[k][f],
                   count[k][f]);
        puts("");
    }
    printf("%ld failed\n", failures);
    return failures != 0;
}
