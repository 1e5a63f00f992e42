#ifndef RBDI_TASKS_BOUNDS_H
#define RBDI_TASKS_BOUNDS_H
#include "ik/dofs.h"
#include "tasks/layout.h"

/* ---- limits of motion [limits of motion] ----
   A dof that is s before a limit and brakes by b may be as fast as

       speed(s) = (2 s / dt) / (1 + sqrt(1 + 2 s / (b dt^2))),   the v of v^2 + 2 b dt v = 2 b s.

   Then v dt is not more than s, and as after it s' = s - v dt and v^2 = 2 b s', the next such speed is less
   by b dt at most: the limit is approached without a jump, and not passed. So it is if the dof moves by the
   mean of its velocities before and after, but for b dt^2 / 2. Del Prete (2018) calls such states viable. */

/* The most strict limits of a dof: that on its coordinate and on its velocity. */
typedef struct rbdi_tasks_range {
    rbd_real lower, upper;
} rbdi_tasks_range;

RBDI_LOCAL rbd_real rbdi_tasks_speed_before(rbd_real s, rbd_real braking, rbd_real dt) {
    const rbd_real way = rbdi_abs(s) / dt;
    const rbd_real v = 2 * way / (1 + rbdi_sqrt(1 + 2 * way / (braking * dt)));
    return s < 0 ? -v : v;
}

/* x, but not out of -most .. most. */
RBDI_INLINE rbd_real rbdi_tasks_clamp(rbd_real x, rbd_real most) {
    return rbdi_larger(-most, rbdi_smaller(x, most));
}

/* The largest speed of a dof; RBDI_UNBOUNDED: any. */
RBDI_LOCAL rbd_real rbdi_tasks_speed(const rbdi_tasks *k, int dof) {
    const rbd_model *m = k->m;
    const rbdi_frame *u = &m->frame[m->dof[dof].body];
    rbd_real speed = rbdi_set(RBDI_UNBOUNDED);
    if (k->given->without & RBD_WITHOUT_SPEED) return speed;
    if (k->given->speed) return k->given->speed[dof] > 0 ? k->given->speed[dof] : speed;

    if (u->nv == 1 && u->velocity > 0) speed = rbdi_set(u->velocity);
    for (int i = 0; i < rbdi_mimics(m); ++i) {
        const rbd_const own = m->frame[m->dof[m->nv + i].body].velocity;
        if (m->mimic[i].source_v == dof && own > 0)
            speed = rbdi_smaller(speed, rbdi_abs(rbdi_set(own / m->mimic[i].ratio)));
    }
    return speed;
}

/* How far a dof is from its limits of position; RBDI_UNBOUNDED: none. */
RBDI_LOCAL rbdi_tasks_range rbdi_tasks_way(const rbdi_tasks *k, int dof) {
    const rbd_tasks *p = k->given;
    const rbdi_frame *u = &k->m->frame[k->m->dof[dof].body];
    rbdi_tasks_range way = {-RBDI_UNBOUNDED, RBDI_UNBOUNDED};
    rbdi_ik_dof f;
    if (u->nq != 1 || (p->without & RBD_WITHOUT_POSITION)) return way;

    f.dof = (int16_t)dof;
    rbdi_ik_limits(k->m, &f);
    if (p->lower || p->upper) {
        f.lower = p->lower ? p->lower[dof] : -rbdi_set(RBDI_UNBOUNDED);
        f.upper = p->upper ? p->upper[dof] : rbdi_set(RBDI_UNBOUNDED);
    }
    if (f.lower > -RBDI_UNBOUNDED) way.lower = f.lower - k->q[u->iq];
    if (f.upper < RBDI_UNBOUNDED) way.upper = f.upper - k->q[u->iq];
    return way;
}

/* The velocities that a dof may have after this tick. Limits of position and speed ask for no more than the
   dof can brake; a dof that comes too fast passes them. */
RBDI_LOCAL rbdi_tasks_range rbdi_tasks_velocities(const rbdi_tasks *k, int dof) {
    const rbd_tasks *p = k->given;
    const rbd_real speed = rbdi_tasks_speed(k, dof);
    const int limited = p->acceleration && p->acceleration[dof] > 0;
    const rbd_real braking = limited          ? p->acceleration[dof]
                             : p->braking > 0 ? p->braking
                                              : rbdi_set(RBDI_TASKS_BRAKING);
    const rbdi_tasks_range way = rbdi_tasks_way(k, dof);
    rbdi_tasks_range v = {-speed, speed};

    if (way.lower > -RBDI_UNBOUNDED)
        v.lower = rbdi_tasks_clamp(rbdi_tasks_speed_before(way.lower, braking, p->dt), speed);
    if (way.upper < RBDI_UNBOUNDED)
        v.upper = rbdi_tasks_clamp(rbdi_tasks_speed_before(way.upper, braking, p->dt), speed);

    if (k->accelerations || limited) {
        const rbd_real slower = k->v[dof] - braking * p->dt, faster = k->v[dof] + braking * p->dt;
        v.lower = rbdi_smaller(v.lower, faster);
        v.upper = rbdi_larger(v.upper, slower);
        if (limited) {
            v.lower = rbdi_larger(v.lower, slower);
            v.upper = rbdi_smaller(v.upper, faster);
        }
    }
    return v;
}

/* The acceleration that leads to a velocity after this tick; none stays none. */
RBDI_LOCAL rbd_real rbdi_tasks_rate(const rbdi_tasks *k, int dof, rbd_real v) {
    return rbdi_abs(v) < RBDI_UNBOUNDED ? (v - k->v[dof]) / k->given->dt : v;
}

/* Bounds of x: of velocities or accelerations, and of the contacts' normal forces. */
RBDI_LOCAL void rbdi_tasks_bounds(rbdi_tasks *k) {
    const rbd_tasks *p = k->given;

    for (int i = 0; i < k->nv; ++i) {
        const rbdi_tasks_range v = rbdi_tasks_velocities(k, i);
        k->lower[i] = k->accelerations ? rbdi_tasks_rate(k, i, v.lower) : v.lower;
        k->upper[i] = k->accelerations ? rbdi_tasks_rate(k, i, v.upper) : v.upper;
        k->soft[i] = p->limit_weight;
    }

    for (int i = k->nv; i < k->n; ++i) {
        const rbd_task_contact *c = &p->contact[k->contact[(i - k->nv) / 3]];
        const int normal = (i - k->nv) % 3 == 2;
        k->lower[i] = normal ? c->least : -rbdi_set(RBDI_UNBOUNDED);
        k->upper[i] = normal && c->most > 0 ? c->most : rbdi_set(RBDI_UNBOUNDED);
        k->soft[i] = rbdi_zero();
    }
}

#endif
