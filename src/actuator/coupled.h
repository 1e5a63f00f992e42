#ifndef RBDI_ACTUATOR_COUPLED_H
#define RBDI_ACTUATOR_COUPLED_H
#include "actuator/transmission.h"
#include "actuator/laws.h"

/* ---- coupled shafts [coupled shafts] ----
   The shafts of a transmission. By their speeds x their joints move as T = base + P (x - point), P = M / dt,
   where M is the mass that a group learns. */

/* Speed of joint j at shaft speeds x. */
RBDI_INLINE rbd_real rbdi_act_joint_speed(const rbdi_act_group *g, int j, const rbd_real *x) {
    rbd_real v = rbdi_zero();
    for (int i = 0; i < g->n; ++i) v = v + g->inverse[g->n * j + i] * x[i];
    return v;
}

/* Solves A x = b, A symmetric and positive definite, by L D L'; b becomes x, A its factor. Returns 0 if A is
   not positive definite. */
RBDI_LOCAL int rbdi_act_solve_small(rbd_real *A, int n, rbd_real *b) {
    for (int k = 0; k < n; ++k) {
        if (!(A[n * k + k] > 0)) return 0;
        for (int i = k + 1; i < n; ++i) {
            const rbd_real factor = A[n * i + k] / A[n * k + k];
            for (int j = k + 1; j < n; ++j) A[n * i + j] = A[n * i + j] - factor * A[n * k + j];
            b[i] = b[i] - factor * b[k];
        }
    }
    for (int k = n - 1; k >= 0; --k) {
        for (int j = k + 1; j < n; ++j) b[k] = b[k] - A[n * k + j] * b[j];
        b[k] = b[k] / A[n * k + k];
    }
    return 1;
}

/* The law of each shaft at its point: without dry friction, and that friction where it sticks and slides. */
typedef struct rbdi_act_laws {
    rbdi_act_piece without[3];
    rbdi_act_stiction sticks[3];
    rbd_real level[3];
} rbdi_act_laws;

RBDI_LOCAL void rbdi_act_take_laws(const rbd_actuators *a, const rbdi_act_group *g, rbdi_act_laws *laws) {
    for (int i = 0; i < g->n; ++i) {
        const rbd_motor *m = &a->motor[g->first + i];
        const rbdi_act_shaft *s = &a->shaft[g->first + i];
        laws->sticks[i].offset = laws->sticks[i].slope = laws->level[i] = rbdi_zero();
        if (m->stiffness > 0) {
            laws->without[i] = rbdi_act_law(m, s, s->point, a);
        } else {
            laws->without[i] = rbdi_act_rigid_without(m, s, s->point, a);
            laws->sticks[i] = rbdi_act_sticks(m, s, a);
            laws->level[i] = s->level;
        }
    }
}

/* The speeds x at which the joints have the torques of the laws, if shaft i sticks (slides[i] = 0) or slides
   (1, -1). Returns by how much friction contradicts that at x, N m; below 0 if there is no x. */
RBDI_LOCAL rbd_real rbdi_act_speeds_if(const rbd_actuators *a, const rbdi_act_group *g,
                                       const rbdi_act_laws *laws, const int *slides, rbd_real *x) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    const int n = g->n;
    rbd_real A[9], off = rbdi_zero();

    /* (P + slope) x = s - w - base + P point */
    for (int i = 0; i < n; ++i) {
        const rbd_real w = slides[i] ? (rbd_real)slides[i] * laws->level[i] : laws->sticks[i].offset;
        x[i] = laws->without[i].s - w - s[i].base;
        for (int k = 0; k < n; ++k) {
            A[n * i + k] = g->mass[n * i + k] / a->dt;
            x[i] = x[i] + A[n * i + k] * s[k].point;
        }
    }
    for (int i = 0; i < n; ++i) {
        A[(n + 1) * i] = A[(n + 1) * i] + laws->without[i].slope;
        if (!slides[i]) A[(n + 1) * i] = A[(n + 1) * i] + laws->sticks[i].slope;
    }
    if (!rbdi_act_solve_small(A, n, x)) return rbdi_set(RBD_C(-1));

    for (int i = 0; i < n; ++i) {
        const rbd_real w = laws->sticks[i].offset + laws->sticks[i].slope * x[i];
        const rbd_real beyond =
            slides[i] ? laws->level[i] - (rbd_real)slides[i] * w : rbdi_abs(w) - laws->level[i];
        if (beyond > 0) off = off + beyond;
    }
    return off;
}

/* Tries the 3^n ways in which shafts stick or slide, and takes the speeds x that contradict theirs least: but
   for rounding one does not. */
RBDI_LOCAL void rbdi_act_speeds(const rbd_actuators *a, const rbdi_act_group *g, const rbdi_act_laws *laws,
                                rbd_real *x) {
    const int ways = g->n == 1 ? 3 : g->n == 2 ? 9 : 27;
    rbd_real least = rbdi_set(RBD_C(-1));
    for (int i = 0; i < g->n; ++i) x[i] = a->shaft[g->first + i].point;
    for (int way = 0; way < ways; ++way) {
        const int slides[3] = {way % 3 - 1, way / 3 % 3 - 1, way / 9 - 1};
        rbd_real tried[3], off;
        off = rbdi_act_speeds_if(a, g, laws, slides, tried);
        if (off < 0 || (least >= 0 && !(off < least))) continue;
        least = off;
        for (int i = 0; i < g->n; ++i) x[i] = tried[i];
        if (!(off > 0)) return;
    }
}

/* Tells the joints torques and dampings with which they have the torques G'T at the shaft speeds x. The
   dampings are a diagonal D that is at least A = G' diag(slope) G:

       D_jj = sum |A_jk|,   s = G'T + D G^-1 x */
RBDI_LOCAL void rbdi_act_tell_joints(rbdi_act_group *g, const rbd_real *T, const rbd_real *x,
                                     const rbd_real *slope) {
    const int n = g->n;
    for (int j = 0; j < n; ++j) {
        rbd_real torque = rbdi_zero(), bound = rbdi_zero();
        for (int i = 0; i < n; ++i) torque = torque + g->G[n * i + j] * T[i];
        for (int k = 0; k < n; ++k) {
            rbd_real A = rbdi_zero();
            for (int i = 0; i < n; ++i) A = A + g->G[n * i + j] * slope[i] * g->G[n * i + k];
            bound = bound + rbdi_abs(A);
        }
        g->s[j] = torque + bound * rbdi_act_joint_speed(g, j, x);
        g->damping[j] = bound;
    }
}

/* The solution, where the joints' motion is known: torques T at the speeds x. Returns 0 if it is not, or if a
   mass far from the true one makes torques or speeds without bound. */
RBDI_LOCAL int rbdi_act_solve_group(const rbd_actuators *a, const rbdi_act_group *g, rbd_real *T, rbd_real *x,
                                    rbd_real *slope) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    const int n = g->n;
    rbdi_act_laws laws;
    if (!g->known) return 0;

    rbdi_act_take_laws(a, g, &laws);
    rbdi_act_speeds(a, g, &laws, x);
    for (int i = 0; i < n; ++i) {
        T[i] = s[i].base;
        for (int k = 0; k < n; ++k) T[i] = T[i] + g->mass[n * i + k] / a->dt * (x[k] - s[k].point);
        if (!(rbdi_abs(T[i]) <= RBDI_ACTUATOR_LARGEST && rbdi_abs(x[i]) <= RBDI_ACTUATOR_MOST)) return 0;
        slope[i] = laws.without[i].slope;
    }
    return 1;
}

/* Tells the joints of a group its laws at the point or, if the mass is known, at the speeds that will come
   out. */
RBDI_LOCAL void rbdi_act_tell_group(const rbd_actuators *a, rbdi_act_group *g) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    rbd_real T[3], x[3], slope[3];
    g->known = rbdi_act_solve_group(a, g, T, x, slope);
    for (int i = 0; i < g->n && !g->known; ++i) {
        const rbdi_act_piece piece = rbdi_act_law(&a->motor[g->first + i], &s[i], s[i].point, a);
        x[i] = s[i].point;
        T[i] = rbdi_act_torque_of(piece, x[i]);
        slope[i] = piece.slope;
    }
    rbdi_act_tell_joints(g, T, x, slope);
}

/* Notes speeds and torques of the shafts at joint speeds v. */
RBDI_LOCAL void rbdi_act_note_group(const rbd_actuators *a, const rbdi_act_group *g, const rbd_real *v) {
    rbdi_act_shaft *s = &a->shaft[g->first];
    for (int i = 0; i < g->n; ++i) {
        s[i].next = rbdi_act_shaft_speed(g, i, v);
        s[i].force = s[i].scale = rbdi_zero();
        for (int j = 0; j < g->n; ++j) {
            const rbd_real torque = g->s[j] - g->damping[j] * v[g->dof[j]];
            s[i].force = s[i].force + g->inverse[g->n * j + i] * torque;
            s[i].scale = s[i].scale + rbdi_abs(g->G[g->n * i + j] * v[g->dof[j]]);
        }
    }
}

/* Whether the shafts have the torques of their laws, but for rounding of these and of the momentum. */
RBDI_LOCAL int rbdi_act_group_settles(const rbd_actuators *a, const rbdi_act_group *g) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    for (int i = 0; i < g->n; ++i) {
        const rbd_motor *m = &a->motor[g->first + i];
        const rbd_real off = rbdi_abs(rbdi_act_off(m, &s[i], s[i].force, s[i].next, a));
        rbd_real size = rbdi_act_size(m, &s[i], a) + a->dt * m->friction.bristle * s[i].scale;
        for (int k = 0; k < g->n && g->known; ++k)
            size = size + rbdi_abs(g->mass[g->n * i + k]) / a->dt * s[k].scale;
        if (off > RBDI_ACTUATOR_SETTLED * size) return 0;
    }
    return 1;
}

/* ---- mass that is learnt [learning] ---- */

/* A first guess of the mass, a diagonal in kg m^2: the impulse of the step over the largest change of speed
   that it can have made. The least torque, 1e-3 N m, keeps it above 0. */
RBDI_LOCAL void rbdi_act_guess_mass(const rbd_actuators *a, rbdi_act_group *g) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    for (int i = 0; i < g->n * g->n; ++i) g->mass[i] = rbdi_zero();
    for (int i = 0; i < g->n; ++i) {
        const rbd_real change = rbdi_abs(s[i].x) + rbdi_abs(s[i].next) + a->dt; /* by 1 rad/s^2 at least */
        const rbd_real torque = rbdi_abs(s[i].force) + s[i].level + RBD_C(1e-3);
        g->mass[(g->n + 1) * i] = a->dt * torque / change + rbdi_act_rotor_inertia(&a->motor[g->first + i]);
    }
    g->known = 1;
}

/* Adds factor x x'. */
RBDI_INLINE void rbdi_act_add_square(rbd_real *A, int n, rbd_real factor, const rbd_real *x) {
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) A[n * i + j] = A[n * i + j] + factor * x[i] * x[j];
}

RBDI_LOCAL int rbdi_act_is_positive(const rbd_real *A, int n) {
    rbd_real copy[9], none[3] = {0, 0, 0};
    for (int i = 0; i < n * n; ++i) copy[i] = A[i];
    return rbdi_act_solve_small(copy, n, none);
}

/* Corrects the mass M so that M d = y, for the change d of the speeds and the impulse y that made it: by SR1
   or, if that is not positive definite, by BFGS (Nocedal and Wright 2006, chapter 6). With r = y - M d

       M + r r' / (r'd),   M + y y' / (y'd) - M d (M d)' / (d'M d)

   SR1 is left out where r is across d to 1e-5, for it would divide by rounding. */
RBDI_LOCAL void rbdi_act_learn(const rbd_actuators *a, rbdi_act_group *g) {
    const rbdi_act_shaft *s = &a->shaft[g->first];
    const int n = g->n;
    rbd_real d[3], y[3], Md[3], r[3], A[9];
    rbd_real d_d = rbdi_zero(), y_d = d_d, r_d = d_d, r_r = d_d, dMd = d_d, size = d_d;
    for (int i = 0; i < n; ++i) d[i] = s[i].next - s[i].point;
    for (int i = 0; i < n; ++i) {
        Md[i] = rbdi_zero();
        for (int k = 0; k < n; ++k) Md[i] = Md[i] + g->mass[n * i + k] * d[k];
        y[i] = a->dt * (s[i].force - s[i].base);
        r[i] = y[i] - Md[i];
        d_d = d_d + d[i] * d[i];
        y_d = y_d + y[i] * d[i];
        r_d = r_d + r[i] * d[i];
        r_r = r_r + r[i] * r[i];
        dMd = dMd + d[i] * Md[i];
        size = size + s[i].scale * s[i].scale;
    }
    if (!(d_d > RBDI_ACTUATOR_NOISE * RBDI_ACTUATOR_NOISE * size) || !(y_d > 0) || !(r_r > 0)) return;

    for (int i = 0; i < n * n; ++i) A[i] = g->mass[i];
    if (r_d * r_d > RBD_C(1e-10) * r_r * d_d) rbdi_act_add_square(A, n, 1 / r_d, r);
    if (!rbdi_act_is_positive(A, n)) {
        for (int i = 0; i < n * n; ++i) A[i] = g->mass[i];
        rbdi_act_add_square(A, n, 1 / y_d, y);
        rbdi_act_add_square(A, n, -1 / dMd, Md);
        if (!rbdi_act_is_positive(A, n)) return;
    }
    for (int i = 0; i < n * n; ++i) g->mass[i] = A[i];
}

/* Guesses the base of the next step: the joints' torque at the speeds of this step's beginning. */
RBDI_LOCAL void rbdi_act_foresee(const rbd_actuators *a, const rbdi_act_group *g) {
    rbdi_act_shaft *s = &a->shaft[g->first];
    for (int i = 0; i < g->n; ++i) {
        s[i].base = s[i].force;
        for (int k = 0; k < g->n; ++k)
            s[i].base = s[i].base - g->mass[g->n * i + k] / a->dt * (s[k].next - s[k].x);
    }
}

#endif
