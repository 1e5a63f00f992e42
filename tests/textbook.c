/* textbook.c - see textbook.h. Plain on purpose: this file must be obviously right. */
#include "textbook.h"
#include "larger.h"

#include <math.h>
#include <string.h>

/* ---- small algebra ---- */

static void cross(const tb_real a[3], const tb_real b[3], tb_real out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* [a]x, the matrix for which [a]x b = a x b */
static void cross_matrix(const tb_real a[3], tb_real out[9]) {
    const tb_real m[9] = {0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0};
    memcpy(out, m, sizeof m);
}

static void multiply3(const tb_real A[9], const tb_real B[9], tb_real out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
}

static void transpose3(const tb_real A[9], tb_real out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) out[3 * i + j] = A[3 * j + i];
}

static void apply3(const tb_real A[9], const tb_real x[3], tb_real out[3]) {
    for (int i = 0; i < 3; i++) out[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
}

static void normalise(tb_real *x, int n) {
    tb_real square = 0;
    for (int i = 0; i < n; i++) square += x[i] * x[i];
    for (int i = 0; i < n; i++) x[i] /= sqrtl(square);
}

/* Rotation by angle about a unit axis: 1 + sin [a]x + (1 - cos) [a]x^2 (Rodrigues). */
static void rotation_about(const tb_real axis[3], tb_real sine, tb_real cosine, tb_real R[9]) {
    tb_real K[9], K2[9];
    cross_matrix(axis, K);
    multiply3(K, K, K2);
    for (int i = 0; i < 9; i++) R[i] = (i % 4 == 0 ? 1 : 0) + sine * K[i] + (1 - cosine) * K2[i];
}

/* Rotation of the unit quaternion (x, y, z, w): 1 + 2 w [u]x + 2 [u]x^2. */
static void rotation_of_quaternion(const double *quaternion, tb_real R[9]) {
    tb_real u[4], K[9], K2[9];
    for (int i = 0; i < 4; i++) u[i] = quaternion[i];
    normalise(u, 4);
    cross_matrix(u, K);
    multiply3(K, K, K2);
    for (int i = 0; i < 9; i++) R[i] = (i % 4 == 0 ? 1 : 0) + 2 * u[3] * K[i] + 2 * K2[i];
}

/* ---- spatial algebra, RBDA chapter 2 ---- */

typedef struct matrix6 {
    tb_real e[6][6];
} matrix6;

static void set_block(matrix6 *m, int row, int column, const tb_real block[9], tb_real factor) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m->e[row + i][column + j] = factor * block[3 * i + j];
}

/* Motion vectors from frame A to frame B, whose axes (columns of R) and origin p are given in A:
   [E 0; -E [p]x E], E = R' (RBDA 2.24). */
static matrix6 motion_transform(const tb_real R[9], const tb_real p[3]) {
    matrix6 X = {{{0}}};
    tb_real E[9], P[9], EP[9];
    transpose3(R, E);
    cross_matrix(p, P);
    multiply3(E, P, EP);
    set_block(&X, 0, 0, E, 1);
    set_block(&X, 3, 3, E, 1);
    set_block(&X, 3, 0, EP, -1);
    return X;
}

/* v x for motion vectors, RBDA 2.31 */
static matrix6 motion_cross(const tb_real v[6]) {
    matrix6 X = {{{0}}};
    tb_real W[9], V[9];
    cross_matrix(v, W);
    cross_matrix(v + 3, V);
    set_block(&X, 0, 0, W, 1);
    set_block(&X, 3, 3, W, 1);
    set_block(&X, 3, 0, V, 1);
    return X;
}

/* Inertia about the link origin: [I + m [c]x [c]x', m [c]x; m [c]x', m 1] (RBDA 2.63). */
static matrix6 spatial_inertia(const rbd_body *body) {
    matrix6 I = {{{0}}};
    const double *i = body->inertia;
    const tb_real central[9] = {i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5]};
    const tb_real c[3] = {body->com[0], body->com[1], body->com[2]};
    tb_real C[9], Ct[9], CCt[9], about[9];
    cross_matrix(c, C);
    transpose3(C, Ct);
    multiply3(C, Ct, CCt);
    for (int k = 0; k < 9; k++) about[k] = central[k] + body->mass * CCt[k];
    set_block(&I, 0, 0, about, 1);
    set_block(&I, 0, 3, C, body->mass);
    set_block(&I, 3, 0, Ct, body->mass);
    for (int k = 3; k < 6; k++) I.e[k][k] = body->mass;
    return I;
}

static void apply6(const matrix6 *A, const tb_real x[6], tb_real out[6]) {
    for (int i = 0; i < 6; i++) {
        out[i] = 0;
        for (int j = 0; j < 6; j++) out[i] += A->e[i][j] * x[j];
    }
}

static void apply6_transposed(const matrix6 *A, const tb_real x[6], tb_real out[6]) {
    for (int i = 0; i < 6; i++) {
        out[i] = 0;
        for (int j = 0; j < 6; j++) out[i] += A->e[j][i] * x[j];
    }
}

static tb_real dot6(const tb_real a[6], const tb_real b[6]) {
    tb_real sum = 0;
    for (int i = 0; i < 6; i++) sum += a[i] * b[i];
    return sum;
}

/* ---- the mechanism as a tree of links ---- */

enum { MAX_LINKS = 5 * TB_MAX_BODIES }; /* placement, at most three motions, see add_joint */

/* A frame and the motion subspace by which it moves relative to its parent, constant in its axes. */
typedef struct link {
    int parent; /* link, -1 = world */
    tb_real R[9], p[3];
    matrix6 X; /* of R and p: motion vectors from the parent to the link */
    int dofs;
    tb_real subspace[6][6]; /* row k: motion of degree of freedom k */
    int iv;                 /* of the first */
    tb_real ratio;          /* v of the link = ratio * v of that degree of freedom */
    tb_real armature[6];
} link;

typedef struct tree {
    int links;
    link link[MAX_LINKS];
    int link_of_body[TB_MAX_BODIES];
    int moved[TB_MAX_BODIES]; /* some joint moves the body */
    int nv;
} tree;

static const tb_real identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, zero[3] = {0, 0, 0};
static const tb_real unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

int tb_nv(const rbd_body *body) {
    if (body->mimic) return 0;
    switch (body->type) {
    case RBD_FIXED: return 0;
    case RBD_CYLINDRICAL:
    case RBD_UNIVERSAL: return 2;
    case RBD_SPHERICAL:
    case RBD_EULER_ZYX:
    case RBD_EULER_XYZ:
    case RBD_EULER_YXZ:
    case RBD_EULER_ZXY:
    case RBD_PLANAR:
    case RBD_TRANSLATION: return 3;
    case RBD_FLOATING: return 6;
    default: return 1;
    }
}

int tb_nq(const rbd_body *body) {
    int quaternion = body->type == RBD_SPHERICAL || body->type == RBD_FLOATING;
    return tb_nv(body) + (quaternion || (body->type == RBD_CONTINUOUS_CS && !body->mimic));
}

static link *add_link(tree *t, const tb_real R[9], const tb_real p[3]) {
    link *l = &t->link[t->links];
    memset(l, 0, sizeof *l);
    l->parent = t->links - 1;
    memcpy(l->R, R, sizeof l->R);
    memcpy(l->p, p, sizeof l->p);
    l->X = motion_transform(R, p);
    l->ratio = 1;
    t->links++;
    return l;
}

/* Where a joint finds its coordinates: its own, or those of the joint it follows. */
typedef struct drive {
    const double *q;
    int iv;
    tb_real ratio, offset;
    const double *armature;
} drive;

/* A link moved along a screw: one turn about the axis goes with 2 pi pitch along it; a pure
   translation has turn = 0 and pitch = 1. The k-th coordinate of the joint drives it. */
static void add_screw(tree *t, const drive *d, int k, const tb_real axis[3], tb_real turn, tb_real pitch) {
    tb_real x = d->ratio * d->q[k] + d->offset, R[9], p[3], a[3];
    memcpy(a, axis, sizeof a);
    normalise(a, 3);
    rotation_about(a, sinl(turn * x), cosl(turn * x), R);
    for (int i = 0; i < 3; i++) p[i] = pitch * x * a[i];
    link *l = add_link(t, R, p);
    l->dofs = 1;
    l->iv = d->iv + k;
    l->ratio = d->ratio;
    l->armature[0] = d->armature[k];
    for (int i = 0; i < 3; i++) {
        l->subspace[0][i] = turn * a[i];
        l->subspace[0][3 + i] = pitch * a[i];
    }
}

static void add_turns(tree *t, const drive *d, int first, int second, int third) {
    add_screw(t, d, 0, unit[first], 1, 0);
    add_screw(t, d, 1, unit[second], 1, 0);
    add_screw(t, d, 2, unit[third], 1, 0);
}

/* A joint given by R and p, whose degrees of freedom are components first... of the motion in body
   axes (0 to 2 turn about, 3 to 5 move along x, y, z). */
static void add_body_axes(tree *t, const drive *d, const tb_real R[9], const tb_real p[3], int first,
                          int dofs) {
    link *l = add_link(t, R, p);
    l->dofs = dofs;
    l->iv = d->iv;
    for (int k = 0; k < dofs; k++) {
        l->subspace[k][first + k] = 1;
        l->armature[k] = d->armature[k];
    }
}

static void add_joint(tree *t, const rbd_body *b, const drive *d) {
    const tb_real axis[3] = {b->axis[0], b->axis[1], b->axis[2]};
    const tb_real axis2[3] = {b->axis2[0], b->axis2[1], b->axis2[2]};
    tb_real R[9];
    switch (b->type) {
    case RBD_REVOLUTE:
    case RBD_CONTINUOUS: add_screw(t, d, 0, axis, 1, 0); break;
    case RBD_CONTINUOUS_CS: {
        tb_real a[3] = {axis[0], axis[1], axis[2]};
        normalise(a, 3);
        rotation_about(a, d->q[1], d->q[0], R);
        add_body_axes(t, d, R, zero, 0, 1);
        memcpy(t->link[t->links - 1].subspace[0], a, sizeof a);
        break;
    }
    case RBD_PRISMATIC: add_screw(t, d, 0, axis, 0, 1); break;
    case RBD_HELICAL: add_screw(t, d, 0, axis, 1, b->pitch); break;
    case RBD_CYLINDRICAL:
        add_screw(t, d, 0, axis, 1, 0);
        add_screw(t, d, 1, axis, 0, 1);
        break;
    case RBD_UNIVERSAL:
        add_screw(t, d, 0, axis, 1, 0);
        add_screw(t, d, 1, axis2, 1, 0);
        break;
    case RBD_SPHERICAL:
        rotation_of_quaternion(d->q, R);
        add_body_axes(t, d, R, zero, 0, 3);
        break;
    case RBD_EULER_ZYX: add_turns(t, d, 2, 1, 0); break;
    case RBD_EULER_XYZ: add_turns(t, d, 0, 1, 2); break;
    case RBD_EULER_YXZ: add_turns(t, d, 1, 0, 2); break;
    case RBD_EULER_ZXY: add_turns(t, d, 2, 0, 1); break;
    case RBD_PLANAR: {
        const tb_real p[3] = {d->q[0], d->q[1], 0};
        rotation_about(unit[2], sinl(d->q[2]), cosl(d->q[2]), R);
        add_body_axes(t, d, R, p, 2, 3); /* turn about z, move along x, y */
        break;
    }
    case RBD_TRANSLATION:
        for (int k = 0; k < 3; k++) add_screw(t, d, k, unit[k], 0, 1);
        break;
    case RBD_FLOATING: {
        const tb_real p[3] = {d->q[0], d->q[1], d->q[2]};
        rotation_of_quaternion(d->q + 3, R);
        add_body_axes(t, d, R, p, 0, 6);
        break;
    }
    default: /* fixed: the placement is all */ break;
    }
}

static int leader_of(const rbd_body *bodies, int nb, const char *joint) {
    for (int i = 0; i < nb; i++)
        if (bodies[i].joint && strcmp(bodies[i].joint, joint) == 0) return i;
    return -1;
}

static void expand(const rbd_body *bodies, int nb, const double *q, tree *t) {
    int iq[TB_MAX_BODIES], iv[TB_MAX_BODIES], nq = 0;
    t->links = t->nv = 0;
    for (int i = 0; i < nb; i++) {
        iq[i] = nq;
        iv[i] = t->nv;
        nq += tb_nq(&bodies[i]);
        t->nv += tb_nv(&bodies[i]);
    }
    for (int i = 0; i < nb; i++) {
        const rbd_body *b = &bodies[i];
        const int leader = b->mimic ? leader_of(bodies, nb, b->mimic) : i;
        const drive d = {q + iq[leader], iv[leader], b->mimic ? b->mimic_ratio : 1,
                         b->mimic ? b->mimic_offset : 0, b->armature};
        tb_real R[9], p[3];
        int given = 0;
        for (int k = 0; k < 9; k++) {
            R[k] = b->rotation[k];
            given |= b->rotation[k] < 0 || b->rotation[k] > 0;
        }
        for (int k = 0; k < 3; k++) p[k] = b->position[k];
        add_link(t, given ? R : identity, p)->parent = b->parent < 0 ? -1 : t->link_of_body[b->parent];
        add_joint(t, b, &d);
        t->link_of_body[i] = t->links - 1;
        t->moved[i] = b->type != RBD_FIXED || (b->parent >= 0 && t->moved[b->parent]);
    }
}

/* ---- recursive Newton-Euler, RBDA table 5.1 ---- */

typedef struct link_motion {
    tb_real v[6], a[6], R[9], p[3];
} link_motion;

/* S x, for x of v's coordinates */
static void joint_motion(const link *l, const double *x, tb_real out[6]) {
    memset(out, 0, 6 * sizeof *out);
    for (int k = 0; k < l->dofs; k++)
        for (int i = 0; i < 6; i++) out[i] += l->subspace[k][i] * l->ratio * x[l->iv + k];
}

/* v_i = X v_p + S qd ; a_i = X a_p + S qdd + v_i x S qd ; and the pose in the world */
static void move_link(const link *l, const link_motion *parent, const double *qd, const double *qdd,
                      link_motion *out) {
    tb_real joint[6], joint_a[6], carried[6], p[3];
    joint_motion(l, qd, joint);
    joint_motion(l, qdd, joint_a);
    apply6(&l->X, parent->v, out->v);
    for (int i = 0; i < 6; i++) out->v[i] += joint[i];
    const matrix6 vx = motion_cross(out->v);
    apply6(&vx, joint, carried);
    apply6(&l->X, parent->a, out->a);
    for (int i = 0; i < 6; i++) out->a[i] += joint_a[i] + carried[i];
    multiply3(parent->R, l->R, out->R);
    apply3(parent->R, l->p, p);
    for (int i = 0; i < 3; i++) out->p[i] = parent->p[i] + p[i];
}

/* f = I a + v x* I v, with v x* = -(v x)' (RBDA 2.33) */
static void add_wrench(const rbd_body *body, const link_motion *m, tb_real f[6]) {
    const matrix6 I = spatial_inertia(body), vx = motion_cross(m->v);
    tb_real Ia[6], Iv[6], gyroscopic[6];
    apply6(&I, m->a, Ia);
    apply6(&I, m->v, Iv);
    apply6_transposed(&vx, Iv, gyroscopic);
    for (int i = 0; i < 6; i++) f[i] += Ia[i] - gyroscopic[i];
}

static void move_all(const tree *t, const double gravity[3], const double *v, const double *a,
                     link_motion *motion) {
    link_motion world = {{0}, {0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0}};
    for (int i = 0; i < 3; i++)
        world.a[3 + i] = -(tb_real)gravity[i]; /* gravity as an acceleration of the world */
    for (int i = 0; i < t->links; i++) {
        const link *l = &t->link[i];
        move_link(l, l->parent < 0 ? &world : &motion[l->parent], v, a, &motion[i]);
    }
}

static void torques(const tree *t, const double *a, tb_real (*f)[6], tb_real *tau) {
    for (int k = 0; k < t->nv; k++) tau[k] = 0;
    for (int i = t->links - 1; i >= 0; i--) {
        const link *l = &t->link[i];
        for (int k = 0; k < l->dofs; k++) {
            tb_real rotor = l->armature[k] * l->ratio * a[l->iv + k];
            tau[l->iv + k] += l->ratio * (dot6(l->subspace[k], f[i]) + rotor);
        }
        if (l->parent >= 0) {
            tb_real up[6];
            apply6_transposed(&l->X, f[i], up);
            for (int k = 0; k < 6; k++) f[l->parent][k] += up[k];
        }
    }
}

/* ---- what is derived from the motion of the bodies ---- */

static void add_to_totals(const rbd_body *body, const link_motion *m, const tb_real classical[3],
                          const double gravity[3], tb_motion *out) {
    const tb_real c[3] = {body->com[0], body->com[1], body->com[2]};
    const matrix6 I = spatial_inertia(body);
    tb_real Iv[6], v[3], a[3], wc[3], wwc[3], world_c[3], world_v[3], world_a[3];
    apply6(&I, m->v, Iv);
    out->kinetic += dot6(m->v, Iv) / 2;
    out->mass += body->mass;
    cross(m->v, c, wc);
    cross(m->v, wc, wwc);
    cross(m->a, c, a);
    for (int i = 0; i < 3; i++) {
        v[i] = m->v[3 + i] + wc[i];
        a[i] += classical[i] + wwc[i];
    }
    apply3(m->R, c, world_c);
    apply3(m->R, v, world_v);
    apply3(m->R, a, world_a);
    for (int i = 0; i < 3; i++) {
        out->com[i] += body->mass * (m->p[i] + world_c[i]);
        out->com_velocity[i] += body->mass * world_v[i];
        out->com_acceleration[i] += body->mass * world_a[i];
        out->potential -= body->mass * gravity[i] * (m->p[i] + world_c[i]);
    }
}

static void report_motion(const rbd_body *bodies, int nb, const tree *t, const double gravity[3],
                          const double *v, const double *a, tb_motion *out) {
    static const double none[3] = {0, 0, 0};
    link_motion motion[MAX_LINKS];
    memset(out, 0, sizeof *out);
    move_all(t, none, v, a, motion);
    for (int i = 0; i < nb; i++) {
        const link_motion *m = &motion[t->link_of_body[i]];
        tb_real wv[3];
        memcpy(out->R[i], m->R, sizeof m->R);
        memcpy(out->p[i], m->p, sizeof m->p);
        memcpy(out->velocity[i], m->v, sizeof m->v);
        memcpy(out->acceleration[i], m->a, sizeof m->a);
        memcpy(out->classical[i], m->a, sizeof m->a);
        cross(m->v, m->v + 3, wv);
        for (int k = 0; k < 3; k++) out->classical[i][3 + k] += wv[k];
        if (t->moved[i]) add_to_totals(&bodies[i], m, out->classical[i] + 3, gravity, out);
    }
    for (int i = 0; i < t->links; i++)
        for (int k = 0; k < t->link[i].dofs; k++) {
            tb_real rate = t->link[i].ratio * v[t->link[i].iv + k];
            out->kinetic += t->link[i].armature[k] * rate * rate / 2;
        }
    for (int k = 0; k < 3 && out->mass > 0; k++) {
        out->com[k] /= out->mass;
        out->com_velocity[k] /= out->mass;
        out->com_acceleration[k] /= out->mass;
    }
}

static void newton_euler(const rbd_body *bodies, int nb, const tree *t, const double gravity[3],
                         const double *v, const double *a, const double *f_ext, tb_real *tau) {
    link_motion motion[MAX_LINKS];
    tb_real f[MAX_LINKS][6] = {{0}};
    move_all(t, gravity, v, a, motion);
    for (int i = 0; i < nb; i++) {
        const int l = t->link_of_body[i];
        add_wrench(&bodies[i], &motion[l], f[l]);
        for (int k = 0; f_ext && k < 6; k++) f[l][k] -= f_ext[6 * i + k];
    }
    torques(t, a, f, tau);
}

void tb_rnea(const rbd_body *bodies, int nb, const double gravity[3], const double *q, const double *v,
             const double *a, const double *f_ext, tb_real *tau, tb_motion *out) {
    tree t;
    expand(bodies, nb, q, &t);
    newton_euler(bodies, nb, &t, gravity, v, a, f_ext, tau);
    if (out) report_motion(bodies, nb, &t, gravity, v, a, out);
}

/* ---- mass matrix and forward dynamics ---- */

/* Column k: the torque of the unit acceleration of degree of freedom k, at rest without gravity: f = I a. */
void tb_mass_matrix(const rbd_body *bodies, int nb, const double *q, tb_real *M) {
    static const tb_real world[6];
    matrix6 I[TB_MAX_BODIES];
    tree t;
    expand(bodies, nb, q, &t);
    for (int i = 0; i < nb; i++) I[i] = spatial_inertia(&bodies[i]);
    for (int k = 0; k < t.nv; k++) {
        double one[TB_MAX_DOFS] = {0};
        tb_real a[MAX_LINKS][6], f[MAX_LINKS][6] = {{0}}, column[TB_MAX_DOFS];
        one[k] = 1;
        for (int i = 0; i < t.links; i++) {
            const link *l = &t.link[i];
            tb_real own[6];
            joint_motion(l, one, own);
            apply6(&l->X, l->parent < 0 ? world : a[l->parent], a[i]);
            for (int j = 0; j < 6; j++) a[i][j] += own[j];
        }
        for (int i = 0; i < nb; i++) apply6(&I[i], a[t.link_of_body[i]], f[t.link_of_body[i]]);
        torques(&t, one, f, column);
        for (int i = 0; i < t.nv; i++) M[i * t.nv + k] = column[i];
    }
}

static int count_dofs(const rbd_body *bodies, int nb) {
    int nv = 0;
    for (int i = 0; i < nb; i++) nv += tb_nv(&bodies[i]);
    return nv;
}

/* M = L L'; inverse column by column */
int tb_invert(const tb_real *M, int n, tb_real *inverse) {
    static tb_real L[TB_MAX_DOFS * TB_MAX_DOFS];
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            tb_real sum = M[i * n + j];
            for (int k = 0; k < j; k++) sum -= L[i * n + k] * L[j * n + k];
            if (i == j && !(sum > 0)) return 0;
            L[i * n + j] = i == j ? sqrtl(sum) : sum / L[j * n + j];
        }
    for (int column = 0; column < n; column++) {
        tb_real x[TB_MAX_DOFS];
        for (int i = 0; i < n; i++) {
            x[i] = i == column;
            for (int k = 0; k < i; k++) x[i] -= L[i * n + k] * x[k];
            x[i] /= L[i * n + i];
        }
        for (int i = n - 1; i >= 0; i--) {
            for (int k = i + 1; k < n; k++) x[i] -= L[k * n + i] * x[k];
            x[i] /= L[i * n + i];
            inverse[i * n + column] = x[i];
        }
    }
    return 1;
}

static tb_real norm1(const tb_real *M, int n) {
    double largest = 0;
    for (int j = 0; j < n; j++) {
        tb_real sum = 0;
        for (int i = 0; i < n; i++) sum += fabsl(M[i * n + j]);
        largest = larger(largest, (double)sum);
    }
    return largest;
}

tb_real tb_forward(const rbd_body *bodies, int nb, const double gravity[3], const double *q, const double *v,
                   const double *tau, const double *f_ext, tb_real *a) {
    static tb_real M[TB_MAX_DOFS * TB_MAX_DOFS], inverse[TB_MAX_DOFS * TB_MAX_DOFS];
    const int nv = count_dofs(bodies, nb);
    const double none[TB_MAX_DOFS] = {0};
    tb_real c[TB_MAX_DOFS];
    tb_mass_matrix(bodies, nb, q, M);
    if (!tb_invert(M, nv, inverse)) return -1;
    tb_rnea(bodies, nb, gravity, q, v, none, f_ext, c, NULL);
    for (int i = 0; i < nv; i++) {
        a[i] = 0;
        for (int k = 0; k < nv; k++) a[i] += inverse[i * nv + k] * (tau[k] - c[k]);
    }
    return norm1(M, nv) * norm1(inverse, nv);
}

/* ---- articulated bodies, RBDA table 7.1, in its letters ----
   lambda is the parent of link i, X takes motion vectors from lambda to i, S are the columns of the subspace.
   The rotors' inertia (armature) adds to the diagonal of D. S is constant in the link's axes, so that c has
   no term of its derivative. */

typedef struct articulated {
    matrix6 X, IA;
    tb_real v[6], c[6], a[6], pA[6];
    tb_real U[6][6]; /* row k: column k of U */
    tb_real Dinv[36], u[6];
} articulated;

/* Pass 1, root to leaves: v_i = X v_lambda + S qd and c_i = v_i x S qd. */
static void aba_velocity(const link *l, const articulated *lambda, const double *qd, articulated *x) {
    tb_real vJ[6] = {0};
    x->X = l->X;
    apply6(&x->X, lambda->v, x->v);
    for (int k = 0; k < l->dofs; k++)
        for (int i = 0; i < 6; i++) vJ[i] += l->subspace[k][i] * qd[l->iv + k];
    for (int i = 0; i < 6; i++) x->v[i] += vJ[i];
    const matrix6 vx = motion_cross(x->v);
    apply6(&vx, vJ, x->c);
}

/* Pass 1: IA_i = I_i and pA_i = v_i x* I_i v_i - f_ext, with v x* = -(v x)'. Links that carry no body keep 0.
 */
static void aba_body(const rbd_body *body, const double *f_ext, articulated *x) {
    const matrix6 vx = motion_cross(x->v);
    tb_real Iv[6], minus[6];
    x->IA = spatial_inertia(body);
    apply6(&x->IA, x->v, Iv);
    apply6_transposed(&vx, Iv, minus);
    for (int i = 0; i < 6; i++) x->pA[i] = -minus[i] - (f_ext ? f_ext[i] : 0);
}

/* Pass 2, leaves to root: U = IA S, D = S' U, u = tau - S' pA. Returns 0 if D is not positive definite. */
static int aba_joint(const link *l, const double *tau, articulated *x) {
    tb_real D[36];
    for (int k = 0; k < l->dofs; k++) {
        apply6(&x->IA, l->subspace[k], x->U[k]);
        x->u[k] = tau[l->iv + k] - dot6(l->subspace[k], x->pA);
    }
    for (int j = 0; j < l->dofs; j++)
        for (int k = 0; k < l->dofs; k++)
            D[j * l->dofs + k] = dot6(l->subspace[j], x->U[k]) + (j == k ? l->armature[k] : 0);
    return tb_invert(D, l->dofs, x->Dinv);
}

/* Pass 2: Ia = IA - U D^-1 U' and pa = pA + Ia c + U D^-1 u, what the parent feels of the link;
   IA_lambda += X' Ia X and pA_lambda += X' pa. */
static void aba_to_parent(const link *l, const articulated *x, articulated *lambda) {
    matrix6 Ia = x->IA, IaX;
    tb_real pa[6], up[6];
    for (int i = 0; i < 6; i++) {
        pa[i] = x->pA[i];
        for (int j = 0; j < l->dofs; j++)
            for (int k = 0; k < l->dofs; k++) {
                const tb_real U_Dinv = x->U[j][i] * x->Dinv[j * l->dofs + k];
                pa[i] += U_Dinv * x->u[k];
                for (int column = 0; column < 6; column++) Ia.e[i][column] -= U_Dinv * x->U[k][column];
            }
    }
    for (int i = 0; i < 6; i++) pa[i] += dot6(Ia.e[i], x->c);
    for (int i = 0; i < 6; i++) apply6_transposed(&x->X, Ia.e[i], IaX.e[i]); /* row i of Ia X */
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            for (int k = 0; k < 6; k++) lambda->IA.e[i][j] += x->X.e[k][i] * IaX.e[k][j];
    apply6_transposed(&x->X, pa, up);
    for (int i = 0; i < 6; i++) lambda->pA[i] += up[i];
}

/* Pass 3, root to leaves: a' = X a_lambda + c, qdd = D^-1 (u - U' a'), a_i = a' + S qdd. */
static void aba_acceleration(const link *l, const articulated *lambda, articulated *x, tb_real *qdd) {
    apply6(&x->X, lambda->a, x->a);
    for (int i = 0; i < 6; i++) x->a[i] += x->c[i];
    tb_real rest[6];
    for (int k = 0; k < l->dofs; k++) rest[k] = x->u[k] - dot6(x->U[k], x->a);
    for (int j = 0; j < l->dofs; j++) {
        tb_real *found = &qdd[l->iv + j];
        *found = 0;
        for (int k = 0; k < l->dofs; k++) *found += x->Dinv[j * l->dofs + k] * rest[k];
        for (int i = 0; i < 6; i++) x->a[i] += l->subspace[j][i] * *found;
    }
}

int tb_aba(const rbd_body *bodies, int nb, const double gravity[3], const double *q, const double *v,
           const double *tau, const double *f_ext, tb_real *a) {
    static tree t;
    static articulated links[MAX_LINKS + 1]; /* the first is the world */
    memset(links, 0, sizeof links);
    expand(bodies, nb, q, &t);
    for (int i = 0; i < 3; i++) links[0].a[3 + i] = -(tb_real)gravity[i]; /* a_0 = -a_g */
    for (int i = 0; i < t.links; i++)
        aba_velocity(&t.link[i], &links[t.link[i].parent + 1], v, &links[i + 1]);
    for (int i = 0; i < nb; i++) {
        if (bodies[i].mimic) return 0;
        aba_body(&bodies[i], f_ext ? f_ext + 6 * i : NULL, &links[t.link_of_body[i] + 1]);
    }
    for (int i = t.links - 1; i >= 0; i--) {
        if (!aba_joint(&t.link[i], tau, &links[i + 1])) return 0;
        aba_to_parent(&t.link[i], &links[i + 1], &links[t.link[i].parent + 1]);
    }
    for (int i = 0; i < t.links; i++)
        aba_acceleration(&t.link[i], &links[t.link[i].parent + 1], &links[i + 1], a);
    return 1;
}
