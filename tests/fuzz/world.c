/* world.c - see world.h */
#define RBD_CHECK_SCALAR 0 /* it reads descriptions, for programs of every scalar */
#include "world.h"

#include <string.h>

#ifdef WORLD_LONG_DOUBLE
#include <math.h>
#define sinq sinl
#define cosq cosl
#define sqrtq sqrtl
#else
/* libquadmath's; clang has the type but not the header. */
extern quad sinq(quad x), cosq(quad x), sqrtq(quad x);
#endif

/* ---- small algebra ---- */

static const quad identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, zero[3] = {0, 0, 0};
static const quad unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

quad world_sqrt(quad x) { return sqrtq(x); }

static quad magnitude(quad x) { return x < 0 ? -x : x; }

static quad larger(quad x, quad y) { return x > y ? x : y; }

static quad dot(const quad a[3], const quad b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static quad length(const quad a[3]) { return sqrtq(dot(a, a)); }

static void cross(const quad a[3], const quad b[3], quad out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void add(const quad a[3], quad factor, quad to[3]) {
    for (int i = 0; i < 3; i++) to[i] += factor * a[i];
}

static void add_cross(const quad a[3], const quad b[3], quad factor, quad to[3]) {
    quad c[3];
    cross(a, b, c);
    add(c, factor, to);
}

static void turn(const quad R[9], const quad x[3], quad out[3]) {
    for (int i = 0; i < 3; i++) out[i] = dot(R + 3 * i, x);
}

static void product(const quad A[9], const quad B[9], quad out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
}

static void normalise(quad *x, int n) {
    quad square = 0;
    for (int i = 0; i < n; i++) square += x[i] * x[i];
    for (int i = 0; i < n; i++) x[i] /= sqrtq(square);
}

/* Rotation by an angle about a unit axis: x cos + axis x x sin + axis (axis x) (1 - cos). */
static void rotation_about(const quad axis[3], quad sine, quad cosine, quad R[9]) {
    for (int column = 0; column < 3; column++) {
        quad c[3];
        cross(axis, unit[column], c);
        for (int row = 0; row < 3; row++)
            R[3 * row + column] =
                cosine * unit[column][row] + sine * c[row] + (1 - cosine) * axis[row] * axis[column];
    }
}

static void rotation_of_quaternion(const quad *quaternion, quad R[9]) {
    quad u[4];
    memcpy(u, quaternion, sizeof u);
    normalise(u, 4);
    const quad x = u[0], y = u[1], z = u[2], w = u[3];
    const quad of_unit[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                             2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                             2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(R, of_unit, sizeof of_unit);
}

/* The rotation of a description is orthonormal to six decimals: its rows, first to last, decide. */
void world_rotation(const double rotation[9], quad R[9]) {
    int given = 0;
    for (int k = 0; k < 9; k++) {
        R[k] = rotation[k];
        given |= rotation[k] < 0 || rotation[k] > 0;
    }
    if (!given) {
        memcpy(R, identity, sizeof identity);
        return;
    }
    normalise(R, 3);
    add(R, -dot(R, R + 3), R + 3);
    normalise(R + 3, 3);
    cross(R, R + 3, R + 6);
}

/* ---- motion ---- */

static const world_element *before(const world *s, const world_element *e) {
    static const world_element ground = {.R = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    return e->before < 0 ? &ground : &s->element[e->before];
}

/* How a joint, or part of it, moves its frame: pose relative to the frame before, and for each rate the
   angular velocity and the velocity of the origin in axes of the moved frame. */
typedef struct part {
    quad R[9], p[3];
    int dofs;
    quad turn[6][3], shift[6][3];
} part;

/* Where a joint finds its coordinates: its own, or those of the joint that it follows. */
typedef struct drive {
    const quad *q;
    const quad *v, *a;
    int iv;
    quad ratio, offset;
    const double *armature;
} drive;

/* omega = sum turn v, u = sum shift v; domega and du likewise with a: relative, in world axes. */
static void relative_motion(const world_element *e, const quad *v, quad omega[3], quad u[3], quad *omega_size,
                            quad *u_size) {
    *omega_size = *u_size = 0;
    memcpy(omega, zero, sizeof zero);
    memcpy(u, zero, sizeof zero);
    for (int k = 0; v && k < e->dofs; k++) {
        const quad rate = e->ratio * v[k];
        add(e->turn[k], rate, omega);
        add(e->shift[k], rate, u);
        *omega_size += magnitude(rate) * length(e->turn[k]);
        *u_size += magnitude(rate) * length(e->shift[k]);
    }
}

/* The kinematics of a moving frame B whose origin lies at d from that of A, with omega and u the velocities
   and beta and b the accelerations of B relative to A. */
static void move_element(const world *s, world_element *e, const quad d[3], const quad *rates,
                         const quad *accelerations) {
    const world_element *up = before(s, e);
    quad omega[3], u[3], beta[3], b[3], wd[3], omega_size, u_size, beta_size, b_size;
    relative_motion(e, rates, omega, u, &omega_size, &u_size);
    relative_motion(e, accelerations, beta, b, &beta_size, &b_size);
    for (int i = 0; i < 3; i++) {
        e->p[i] = up->p[i] + d[i];
        e->w[i] = up->w[i] + omega[i];
        e->v[i] = up->v[i] + u[i];
        e->alpha[i] = up->alpha[i] + beta[i];
        e->a[i] = up->a[i] + b[i];
    }
    add_cross(up->w, d, 1, e->v);
    add_cross(up->w, omega, 1, e->alpha);
    cross(up->w, d, wd);
    add_cross(up->alpha, d, 1, e->a);
    add_cross(up->w, wd, 1, e->a);
    add_cross(up->w, u, 2, e->a);
    add_cross(omega, u, 1, e->a); /* the components of u are given in axes that turn */
    const quad l = length(d);
    e->path = up->path + l;
    e->w_size = up->w_size + omega_size;
    e->v_size = up->v_size + up->w_size * l + u_size;
    e->alpha_size = up->alpha_size + up->w_size * omega_size + beta_size;
    e->a_size = up->a_size + (up->alpha_size + up->w_size * up->w_size) * l + 2 * up->w_size * u_size +
                omega_size * u_size + b_size;
}

/* Appends a frame that is driven by the coordinates of d from the first on; a placement is by none (NULL). */
static void append(world *s, int after, const part *p, const drive *d, int first) {
    world_element *e = &s->element[s->elements];
    memset(e, 0, sizeof *e);
    e->before = after;
    const world_element *up = before(s, e);
    quad shift[3];
    product(up->R, p->R, e->R);
    turn(up->R, p->p, shift);
    e->dofs = p->dofs;
    e->ratio = d ? d->ratio : 1;
    e->iv = d ? d->iv + first : 0;
    for (int k = 0; k < p->dofs; k++) {
        turn(e->R, p->turn[k], e->turn[k]);
        turn(e->R, p->shift[k], e->shift[k]);
        e->armature[k] = d->armature[first + k];
    }
    move_element(s, e, shift, d && d->v ? d->v + e->iv : NULL, d && d->a ? d->a + e->iv : NULL);
    s->elements++;
}

/* Coordinate k turns about an axis and goes along it: one radian with `pitch` metres (turning = 1), or pitch
   metres per unit alone (turning = 0). */
static void append_screw(world *s, const drive *d, int k, const quad axis[3], int turning, quad pitch) {
    const quad x = d->ratio * d->q[k] + d->offset;
    part p = {.dofs = 1};
    quad n[3];
    memcpy(n, axis, sizeof n);
    normalise(n, 3);
    memcpy(p.R, identity, sizeof identity);
    if (turning) {
        rotation_about(n, sinq(x), cosq(x), p.R);
        s->largest_angle = larger(s->largest_angle, magnitude(d->ratio * d->q[k]) + magnitude(d->offset));
    }
    add(n, pitch * x, p.p);
    add(n, turning, p.turn[0]);
    add(n, pitch, p.shift[0]);
    append(s, s->elements - 1, &p, d, k);
}

static void append_turns(world *s, const drive *d, const char *axes) {
    for (int k = 0; axes[k]; k++) append_screw(s, d, k, unit[axes[k] - 'x'], 1, 0);
}

/* A joint whose rates are components of the velocity in body axes: turns first, then shifts. */
static void append_body_axes(world *s, const drive *d, part *p, const char *turns, const char *shifts) {
    for (; *turns; turns++) p->turn[p->dofs++][*turns - 'x'] = 1;
    for (; *shifts; shifts++) p->shift[p->dofs++][*shifts - 'x'] = 1;
    append(s, s->elements - 1, p, d, 0);
}

static void append_joint(world *s, const rbd_body *b, const drive *d) {
    const quad axis[3] = {b->axis[0], b->axis[1], b->axis[2]},
               axis2[3] = {b->axis2[0], b->axis2[1], b->axis2[2]};
    part p = {.dofs = 0};
    memcpy(p.R, identity, sizeof identity);
    switch (b->type) {
    case RBD_REVOLUTE:
    case RBD_CONTINUOUS: append_screw(s, d, 0, axis, 1, 0); break;
    case RBD_CONTINUOUS_CS: {
        quad n[3] = {axis[0], axis[1], axis[2]}, cs[2] = {d->q[0], d->q[1]};
        normalise(n, 3);
        normalise(cs, 2);
        rotation_about(n, cs[1], cs[0], p.R);
        memcpy(p.turn[0], n, sizeof n);
        p.dofs = 1;
        append(s, s->elements - 1, &p, d, 0);
        break;
    }
    case RBD_PRISMATIC: append_screw(s, d, 0, axis, 0, 1); break;
    case RBD_HELICAL: append_screw(s, d, 0, axis, 1, b->pitch); break;
    case RBD_CYLINDRICAL:
        append_screw(s, d, 0, axis, 1, 0);
        append_screw(s, d, 1, axis, 0, 1);
        break;
    case RBD_UNIVERSAL:
        append_screw(s, d, 0, axis, 1, 0);
        append_screw(s, d, 1, axis2, 1, 0);
        break;
    case RBD_SPHERICAL:
        rotation_of_quaternion(d->q, p.R);
        append_body_axes(s, d, &p, "xyz", "");
        break;
    case RBD_EULER_ZYX: append_turns(s, d, "zyx"); break;
    case RBD_EULER_XYZ: append_turns(s, d, "xyz"); break;
    case RBD_EULER_YXZ: append_turns(s, d, "yxz"); break;
    case RBD_EULER_ZXY: append_turns(s, d, "zxy"); break;
    case RBD_PLANAR:
        p.p[0] = d->q[0], p.p[1] = d->q[1];
        rotation_about(unit[2], sinq(d->q[2]), cosq(d->q[2]), p.R);
        s->largest_angle = larger(s->largest_angle, magnitude(d->q[2]));
        append_body_axes(s, d, &p, "z", "xy");
        break;
    case RBD_TRANSLATION:
        for (int k = 0; k < 3; k++) append_screw(s, d, k, unit[k], 0, 1);
        break;
    case RBD_FLOATING:
        memcpy(p.p, d->q, sizeof p.p);
        rotation_of_quaternion(d->q + 3, p.R);
        append_body_axes(s, d, &p, "xyz", "xyz");
        break;
    default: /* fixed: the placement is all */ break;
    }
}

int world_nv(const rbd_body *body) {
    if (body->mimic) return 0;
    switch (body->type) {
    case RBD_REVOLUTE:
    case RBD_CONTINUOUS:
    case RBD_CONTINUOUS_CS:
    case RBD_PRISMATIC:
    case RBD_HELICAL: return 1;
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
    default: return 0; /* fixed */
    }
}

int world_nq(const rbd_body *body) {
    const int type = (int)body->type;
    return world_nv(body) +
           (!body->mimic && (type == RBD_CONTINUOUS_CS || type == RBD_SPHERICAL || type == RBD_FLOATING));
}

static int leader_of(const rbd_body *bodies, int nb, int i) {
    for (int k = 0; bodies[i].mimic && k < nb; k++)
        if (bodies[k].joint && strcmp(bodies[k].joint, bodies[i].mimic) == 0) return k;
    return i;
}

/* The longest link that begins or ends at each body, or at what is fixed to it; that of a root does not
 * count. */
static void measure_reach(const rbd_body *b, int nb, quad *reach) {
    memset(reach, 0, (size_t)nb * sizeof *reach);
    for (int i = 0; i < nb; i++) {
        quad sum = 0;
        int k = i;
        while (b[i].type != RBD_FIXED && b[k].parent >= 0 && (k == i || b[k].type == RBD_FIXED)) {
            const quad position[3] = {b[k].position[0], b[k].position[1], b[k].position[2]};
            sum += length(position);
            k = b[k].parent;
            reach[k] = larger(reach[k], sum);
        }
        reach[i] = larger(reach[i], sum);
    }
    for (int i = 0; i < nb; i++)
        if (b[i].type == RBD_FIXED && b[i].parent >= 0) reach[i] = larger(reach[i], reach[b[i].parent]);
}

/* The size of a body's motion: its own, and that of the far ends of the links on the way to it.
   The library chooses the points that it computes with, as engineers do, on the axes: as far from the body as
   that. */
static void measure_bodies(world *s) {
    quad p[WORLD_BODIES], v[WORLD_BODIES], a[WORLD_BODIES];
    const quad *reach = s->reach;
    measure_reach(s->bodies, s->nb, s->reach);
    for (int i = 0; i < s->nb; i++) {
        const world_element *e = &s->element[s->last[i]];
        const int up = s->bodies[i].parent;
        p[i] = larger(reach[i], up < 0 ? 0 : p[up]);
        v[i] = larger(e->w_size * reach[i], up < 0 ? 0 : v[up]);
        a[i] = larger((e->alpha_size + e->w_size * e->w_size) * reach[i], up < 0 ? 0 : a[up]);
        s->p_size[i] = e->path + p[i];
        s->v_size[i] = e->v_size + v[i];
        s->a_size[i] = e->a_size + a[i];
    }
}

void world_move(world *s, const rbd_body *bodies, int nb, const quad *q, const quad *v, const quad *a) {
    int iq[WORLD_BODIES], iv[WORLD_BODIES], nq = 0;
    s->bodies = bodies, s->nb = nb;
    s->elements = s->nv = 0;
    s->largest_angle = 0;
    for (int i = 0; i < nb; i++) {
        iq[i] = nq, iv[i] = s->nv;
        nq += world_nq(&bodies[i]);
        s->nv += world_nv(&bodies[i]);
    }
    for (int i = 0; i < nb; i++) {
        const rbd_body *b = &bodies[i];
        const int leader = leader_of(bodies, nb, i);
        const drive d = {
            q + iq[leader], v, a, iv[leader], b->mimic ? b->mimic_ratio : 1, b->mimic ? b->mimic_offset : 0,
            b->armature};
        part placement = {.p = {b->position[0], b->position[1], b->position[2]}};
        world_rotation(b->rotation, placement.R);
        append(s, b->parent < 0 ? -1 : s->last[b->parent], &placement, NULL, 0);
        append_joint(s, b, &d);
        s->last[i] = s->elements - 1;
        s->moved[i] = b->type != RBD_FIXED || (b->parent >= 0 && s->moved[b->parent]);
    }
    measure_bodies(s);
}

/* ---- a body's centre of mass and inertia, in world axes ---- */

typedef struct mass {
    quad m, I[9], I_size;
    quad c[3], arm; /* centre of mass in the world, and its distance from the link origin */
    quad v[3], a[3], v_size, a_size;
} mass;

static void mass_of(const world *s, int body, mass *k) {
    const rbd_body *b = &s->bodies[body];
    const world_element *e = &s->element[s->last[body]];
    const double *i = b->inertia;
    const quad central[9] = {i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5]},
               com[3] = {b->com[0], b->com[1], b->com[2]};
    quad transposed[9], RI[9], r[3], wr[3];
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) transposed[3 * row + column] = e->R[3 * column + row];
    product(e->R, central, RI);
    product(RI, transposed, k->I);
    k->I_size = 0;
    for (int j = 0; j < 9; j++) k->I_size += central[j] * central[j];
    k->I_size = sqrtq(k->I_size);
    k->m = b->mass;
    turn(e->R, com, r);
    k->arm = length(com);
    for (int j = 0; j < 3; j++) {
        k->c[j] = e->p[j] + r[j];
        k->v[j] = e->v[j];
        k->a[j] = e->a[j];
    }
    cross(e->w, r, wr);
    add(wr, 1, k->v);
    add_cross(e->alpha, r, 1, k->a);
    add_cross(e->w, wr, 1, k->a);
    k->v_size = e->v_size + e->w_size * k->arm;
    k->a_size = e->a_size + (e->alpha_size + e->w_size * e->w_size) * k->arm;
}

/* The velocity per unit of rate k of an element at a point of the body behind it. */
static void partial_velocity(const world_element *e, int k, const quad point[3], quad out[3]) {
    quad r[3] = {point[0] - e->p[0], point[1] - e->p[1], point[2] - e->p[2]};
    cross(e->turn[k], r, out);
    add(e->shift[k], 1, out);
}

/* ---- inverse dynamics ---- */

/* tau_k = sum over bodies of (partial angular velocity) . N + (partial velocity of a point) . F at that point
 */
static void add_wrench(const world *s, int body, const quad point[3], quad arm, const quad N[3],
                       const quad F[3], quad N_size, quad F_size, quad *tau, quad *size) {
    const quad reach = s->element[s->last[body]].path + arm;
    for (int i = s->last[body]; i >= 0; i = s->element[i].before) {
        const world_element *e = &s->element[i];
        for (int k = 0; k < e->dofs; k++) {
            quad u[3];
            partial_velocity(e, k, point, u);
            tau[e->iv + k] += e->ratio * (dot(e->turn[k], N) + dot(u, F));
            size[e->iv + k] +=
                magnitude(e->ratio) *
                (length(e->turn[k]) * (N_size + (reach - e->path) * F_size) + length(e->shift[k]) * F_size);
        }
    }
}

void world_torques(const world *s, const quad gravity[3], const quad *a, const quad *f_ext, quad *tau,
                   quad *size) {
    for (int k = 0; k < s->nv; k++) tau[k] = size[k] = 0;
    for (int i = 0; i < s->nb; i++) {
        const world_element *e = &s->element[s->last[i]];
        mass k;
        quad Iw[3], N[3], F[3];
        mass_of(s, i, &k);
        turn(k.I, e->alpha, N);
        turn(k.I, e->w, Iw);
        add_cross(e->w, Iw, 1, N);
        for (int j = 0; j < 3; j++) F[j] = k.m * (k.a[j] - gravity[j]);
        add_wrench(s, i, k.c, k.arm, N, F, k.I_size * (e->alpha_size + e->w_size * e->w_size),
                   k.m * (k.a_size + length(gravity)), tau, size);
        if (!f_ext) continue;
        for (int j = 0; j < 3; j++) {
            N[j] = -dot(e->R + 3 * j, f_ext + 6 * i);
            F[j] = -dot(e->R + 3 * j, f_ext + 6 * i + 3);
        }
        add_wrench(s, i, e->p, s->reach[i], N, F, length(N), length(F), tau, size);
    }
    for (int i = 0; i < s->elements; i++) {
        const world_element *e = &s->element[i];
        for (int k = 0; a && k < e->dofs; k++) {
            const quad rotor = e->ratio * e->armature[k] * e->ratio * a[e->iv + k];
            tau[e->iv + k] += rotor;
            size[e->iv + k] += magnitude(rotor);
        }
    }
}

/* ---- mass matrix ---- */

/* A degree of freedom as a body feels it. */
typedef struct partial {
    int iv;
    quad w[3], Iw[3], v[3], size; /* size: square root of what it can add to the diagonal */
} partial;

static int partials_of(const world *s, int body, partial *out) {
    int n = 0;
    mass k;
    mass_of(s, body, &k);
    const quad reach = s->element[s->last[body]].path + k.arm;
    for (int i = s->last[body]; i >= 0; i = s->element[i].before) {
        const world_element *e = &s->element[i];
        for (int j = 0; j < e->dofs; j++) {
            partial *x = &out[n++];
            x->iv = e->iv + j;
            partial_velocity(e, j, k.c, x->v);
            memcpy(x->w, e->turn[j], sizeof x->w);
            for (int c = 0; c < 3; c++) {
                x->w[c] *= e->ratio;
                x->v[c] *= e->ratio;
            }
            turn(k.I, x->w, x->Iw);
            const quad w = length(x->w),
                       v = magnitude(e->ratio) * length(e->shift[j]) + w * (reach - e->path);
            x->size = sqrtq(k.I_size * w * w + k.m * v * v);
        }
    }
    return n;
}

void world_mass_matrix(const world *s, quad *M, quad *size) {
    static partial p[6 * WORLD_BODIES];
    quad root[WORLD_DOFS]; /* what two joints of one body add to the same degree of freedom goes as a sum
                              squared */
    const int nv = s->nv;
    memset(M, 0, (size_t)(nv * nv) * sizeof *M);
    memset(size, 0, (size_t)nv * sizeof *size);
    for (int i = 0; i < s->nb; i++) {
        const int n = partials_of(s, i, p);
        const quad m = s->bodies[i].mass;
        memset(root, 0, sizeof root);
        for (int k = 0; k < n; k++) {
            root[p[k].iv] += p[k].size;
            for (int l = 0; l < n; l++)
                M[p[k].iv * nv + p[l].iv] += dot(p[k].w, p[l].Iw) + m * dot(p[k].v, p[l].v);
        }
        for (int k = 0; k < nv; k++) size[k] += root[k] * root[k];
    }
    for (int i = 0; i < s->elements; i++) {
        const world_element *e = &s->element[i];
        for (int k = 0; k < e->dofs; k++) {
            const quad rotor = e->ratio * e->ratio * e->armature[k];
            M[(e->iv + k) * (nv + 1)] += rotor;
            size[e->iv + k] += rotor;
        }
    }
}

/* M = L L' in place, then the inverse column by column. */
quad world_distance(quad *M, const quad *size, int n) {
    quad norm = 0, x[WORLD_DOFS];
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            quad sum = M[i * n + j] / sqrtq(size[i] * size[j]);
            for (int k = 0; k < j; k++) sum -= M[i * n + k] * M[j * n + k];
            if (i == j && !(sum > 0)) return 0;
            M[i * n + j] = i == j ? sqrtq(sum) : sum / M[j * n + j];
        }
    for (int column = 0; column < n; column++) {
        quad sum = 0;
        for (int i = column; i < n; i++) {
            x[i] = i == column;
            for (int k = column; k < i; k++) x[i] -= M[i * n + k] * x[k];
            x[i] /= M[i * n + i];
        }
        for (int i = n - 1; i >= 0; i--) {
            x[i] = i < column ? 0 : x[i];
            for (int k = i + 1; k < n; k++) x[i] -= M[k * n + i] * x[k];
            x[i] /= M[i * n + i];
            sum += magnitude(x[i]);
        }
        norm = larger(norm, sum);
    }
    return norm > 0 ? 1 / norm : 1;
}

/* ---- energy and centre of mass ---- */

void world_total(const world *s, const quad gravity[3], const quad *v, world_totals *t) {
    quad total = 0;
    memset(t, 0, sizeof *t);
    for (int i = 0; i < s->nb; i++) {
        const world_element *e = &s->element[s->last[i]];
        mass k;
        quad Iw[3];
        if (!s->moved[i]) continue;
        mass_of(s, i, &k);
        turn(k.I, e->w, Iw);
        total += k.m;
        add(k.c, k.m, t->com[0]);
        add(k.v, k.m, t->com[1]);
        add(k.a, k.m, t->com[2]);
        t->com_size[0] += k.m * (e->path + k.arm);
        t->com_size[1] += k.m * k.v_size;
        t->com_size[2] += k.m * k.a_size;
        t->energy[0] += (dot(e->w, Iw) + k.m * dot(k.v, k.v)) / 2;
        t->energy_size[0] += (k.I_size * e->w_size * e->w_size + k.m * k.v_size * k.v_size) / 2;
        t->energy[1] -= k.m * dot(gravity, k.c);
        t->energy_size[1] += k.m * length(gravity) * (e->path + k.arm);
    }
    for (int i = 0; i < s->elements; i++) {
        const world_element *e = &s->element[i];
        for (int k = 0; k < e->dofs; k++) {
            const quad rate = e->ratio * v[e->iv + k], rotor = e->armature[k] * rate * rate / 2;
            t->energy[0] += rotor;
            t->energy_size[0] += rotor;
        }
    }
    for (int k = 0; k < 3 && total > 0; k++) {
        t->com_size[k] /= total;
        for (int j = 0; j < 3; j++) t->com[k][j] /= total;
    }
}

/* ---- steps on the configuration manifold ---- */

/* (sin x) / x, (1 - cos x) / x^2, (x - sin x) / x^3 */
static void exponential(quad x, quad *A, quad *B, quad *C) {
    if (x > (quad)0.125) {
        *A = sinq(x) / x;
        *B = 2 * sinq(x / 2) * sinq(x / 2) / (x * x);
        *C = (1 - *A) / (x * x);
        return;
    }
    quad a = 1, b = (quad)0.5, c = (quad)1 / 6;
    *A = *B = *C = 0;
    for (int k = 1; k < 24; k += 2) { /* terms (-1)^j x^2j / (2j + 1)!, (2j + 2)!, (2j + 3)! */
        *A += a, *B += b, *C += c;
        a *= -x * x / ((k + 1) * (k + 2));
        b *= -x * x / ((k + 2) * (k + 3));
        c *= -x * x / ((k + 3) * (k + 4));
    }
}

/* The shift of a screw motion with turn w and translation u: u + B w x u + C w x (w x u). */
static void screw_shift(const quad w[3], const quad u[3], quad out[3]) {
    quad A, B, C, wu[3];
    exponential(length(w), &A, &B, &C);
    memcpy(out, u, 3 * sizeof *u);
    cross(w, u, wu);
    add(wu, B, out);
    add_cross(w, wu, C, out);
}

static void step_quaternion(const quad *q, const quad w[3], quad *next, quad *size) {
    quad u[4], half[3] = {w[0] / 2, w[1] / 2, w[2] / 2}, A, B, C, v[3] = {0, 0, 0};
    memcpy(u, q, sizeof u);
    normalise(u, 4);
    exponential(length(half), &A, &B, &C);
    add(half, A, v);
    const quad c = cosq(length(half));
    cross(u, v, next);
    add(v, u[3], next);
    add(u, c, next);
    next[3] = u[3] * c - dot(u, v);
    for (int k = 0; k < 4; k++) size[k] = 1 + length(w);
}

/* The position of a joint whose v is in body axes: it goes by R shift, R the rotation before the step. */
static void step_position(const quad R[9], const quad w[3], const quad u[3], int n, const quad *q, quad *next,
                          quad *size) {
    quad shift[3], moved[3];
    screw_shift(w, u, shift);
    turn(R, shift, moved);
    for (int k = 0; k < n; k++) {
        next[k] = q[k] + moved[k];
        size[k] = magnitude(q[k]) + length(u) * (1 + length(w));
    }
}

void world_step(const rbd_body *body, const quad *q, const quad *d, quad *next, quad *size) {
    quad R[9];
    switch (body->type) {
    case RBD_CONTINUOUS_CS: {
        quad cs[2] = {q[0], q[1]};
        normalise(cs, 2);
        next[0] = cs[0] * cosq(d[0]) - cs[1] * sinq(d[0]);
        next[1] = cs[1] * cosq(d[0]) + cs[0] * sinq(d[0]);
        size[0] = size[1] = 1 + magnitude(d[0]);
        break;
    }
    case RBD_SPHERICAL: step_quaternion(q, d, next, size); break;
    case RBD_PLANAR: {
        const quad w[3] = {0, 0, d[0]}, u[3] = {d[1], d[2], 0};
        rotation_about(unit[2], sinq(q[2]), cosq(q[2]), R);
        step_position(R, w, u, 2, q, next, size);
        next[2] = q[2] + d[0];
        size[2] = magnitude(q[2]) + magnitude(d[0]);
        break;
    }
    case RBD_FLOATING:
        rotation_of_quaternion(q + 3, R);
        step_position(R, d, d + 3, 3, q, next, size);
        step_quaternion(q + 3, d, next + 3, size + 3);
        break;
    default:
        for (int k = 0; k < world_nv(body); k++) {
            next[k] = q[k] + d[k];
            size[k] = magnitude(q[k]) + magnitude(d[k]);
        }
    }
}
