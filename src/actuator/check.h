#ifndef RBDI_ACTUATOR_CHECK_H
#define RBDI_ACTUATOR_CHECK_H
#include "base/memory.h"
#include "model/wide.h"
#include "actuator/friction.h"

/* ---- checks [checks] ---- */

/* Ranges are wider than any drive's, and so narrow that products of three fields are finite in float. */
#define RBDI_ACTUATOR_MOST_GEAR RBD_C(1e6)
#define RBDI_ACTUATOR_MOST_INERTIA RBD_C(1e3)      /* kg m^2 */
#define RBDI_ACTUATOR_LEAST RBD_C(1e-9)            /* of what divides */
#define RBDI_ACTUATOR_LEAST_REFLECTED RBD_C(1e-12) /* kg m^2: of a rotor behind a spring, at the shaft */

/* A field and its range, and whether 0 means that it is not used. */
typedef struct rbdi_act_field {
    const char *name;
    rbd_const value, least, most;
    int optional;
} rbdi_act_field;

/* Where a finding is: the motor or, behind them, the transmission. */
typedef struct rbdi_act_where {
    rbd_report *report;
    int at;
    const char *name;
} rbdi_act_where;

RBDI_LOCAL rbd_status rbdi_act_refuse_field(const rbdi_act_where *where, rbd_status status, const char *field,
                                            const char *sentence) {
    return rbdi_refuse_saying(where->report, status, where->at, where->name, field, sentence);
}

/* Checks n fields; one that is 0 and must not be is missing. */
RBDI_LOCAL rbd_status rbdi_act_check_fields(const rbdi_act_where *where, const rbdi_act_field *field, int n) {
    for (int i = 0; i < n; ++i) {
        const rbd_const x = field[i].value;
        if (x <= 0 && x >= 0 && field[i].optional) continue;
        if (x <= 0 && x >= 0 && field[i].least > 0)
            return rbdi_act_refuse_field(where, RBD_ERR_RANGE, field[i].name, "missing");
        if (!(x >= field[i].least && x <= field[i].most))
            return rbdi_act_refuse_field(where, RBD_ERR_RANGE, field[i].name, NULL);
    }
    return RBD_OK;
}

#define RBDI_ACTUATOR_FIELDS(where, list) \
    rbdi_act_check_fields(where, list, (int)(sizeof(list) / sizeof((list)[0])))

RBDI_LOCAL rbd_status rbdi_act_check_friction(const rbdi_act_where *where, const rbd_gear_friction *f) {
    const rbd_const most = RBDI_ACTUATOR_MOST, least = RBDI_ACTUATOR_LEAST;
    const int rest = rbdi_act_has_rest(f);
    /* At rest friction must grow more slowly than the motor's torque, or no torque begins to move. */
    const rbd_const of_motor = RBD_C(0.999);
    const rbdi_act_field field[] = {{"coulomb", f->coulomb, 0, most, 1},
                                    {"viscous", f->viscous, 0, most, 1},
                                    {"load_motor", f->load_motor, 0, of_motor, 1},
                                    {"load_joint", f->load_joint, 0, 10, 1},
                                    {"rest", f->rest, 0, most, 1},
                                    {"rest_motor", f->rest_motor, 0, of_motor - f->load_motor, 1},
                                    {"rest_joint", f->rest_joint, 0, 10, 1},
                                    {"square_motor", f->square_motor, 0, RBD_C(1e6), 1},
                                    {"square_joint", f->square_joint, 0, RBD_C(1e6), 1},
                                    {"bristle", f->bristle, least, most, 1},
                                    {"still", f->still, least, most, 1},
                                    {"speed", f->speed, least, most, !rest},
                                    {"power", f->power, RBD_C(0.1), 10, !rest}};
    return RBDI_ACTUATOR_FIELDS(where, field);
}

/* Resistance, limits and heat. */
RBDI_LOCAL rbd_status rbdi_act_check_electric(const rbdi_act_where *where, const rbd_motor *m) {
    const rbd_const most = RBDI_ACTUATOR_MOST, least = RBDI_ACTUATOR_LEAST;
    const int network = m->heat_case > 0 || m->flow_winding > 0 || m->flow_case > 0;
    const int heat = m->heat_winding > 0, limit = !(m->hot <= 0 && m->hottest <= 0);
    const rbdi_act_field field[] = {
        {"current", m->current, 0, most, 1},
        {"voltage", m->voltage, 0, most, 1},
        {"copper", m->copper, 0, 1, 1},
        {"heat_winding", m->heat_winding, least, RBD_C(1e6), !limit && !network},
        {"heat_case", m->heat_case, least, RBD_C(1e6), 1},
        {"flow_winding", m->flow_winding, least, RBD_C(1e6), !heat},
        {"flow_case", m->flow_case, least, RBD_C(1e6), !(heat && m->heat_case > 0)},
        {"hot", m->hot, least, RBD_C(1e4), !limit},
        {"hottest", m->hottest, least, RBD_C(1e4), !limit},
        {"resistance", m->resistance, least, most, !heat && !(m->voltage > 0) && !m->by_voltage}};
    const rbd_status status = RBDI_ACTUATOR_FIELDS(where, field);
    if (status) return status;
    if (limit && !(m->hottest > m->hot))
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "hottest", "not above 'hot'");
    if (limit && !(m->current > 0))
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "current", "missing: heat lowers this limit");
    return RBD_OK;
}

/* Rotor, drive and spring. */
RBDI_LOCAL rbd_status rbdi_act_check_mechanical(const rbdi_act_where *where, const rbd_motor *m) {
    const rbd_const most = RBDI_ACTUATOR_MOST, least = RBDI_ACTUATOR_LEAST;
    const rbd_const gear = m->gear < 0 ? -m->gear : m->gear;
    const int spring = m->stiffness > 0, springs = m->damping > 0 || m->backlash > 0;
    const rbdi_act_field field[] = {{"gear", gear, RBD_C(1e-6), RBDI_ACTUATOR_MOST_GEAR, 0},
                                    {"constant", m->constant, least, most, 0},
                                    {"inertia", m->inertia, 0, RBDI_ACTUATOR_MOST_INERTIA, 1},
                                    {"cogging", m->cogging, 0, most, 1},
                                    {"teeth", m->teeth, RBD_C(1), RBD_C(1e6), !(m->cogging > 0)},
                                    {"phase", m->phase, -most, most, 1},
                                    {"step", m->step, least, most, 1},
                                    {"offset", m->offset, -most, most, 1},
                                    {"stiffness", m->stiffness, least, most, !springs},
                                    {"damping", m->damping, 0, most, 1},
                                    {"backlash", m->backlash, 0, most, 1}};
    const rbd_status status = RBDI_ACTUATOR_FIELDS(where, field);
    if (status) return status;
    if (m->delay < 0 || m->delay > RBDI_ACTUATOR_MOST_DELAY)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "delay", "below 0 or above 1000");
    if (m->by_voltage != 0 && m->by_voltage != 1)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "by_voltage", "neither 0 nor 1");
    if (m->sampled != 0 && m->sampled != 1)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "sampled", "neither 0 nor 1");
    if (spring && !(gear * gear * m->inertia >= RBDI_ACTUATOR_LEAST_REFLECTED))
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "inertia",
                                     "missing: a rotor on a spring needs it");
    if (spring && m->friction.bristle > 0)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "bristle", "not beside a stiffness");
    return RBD_OK;
}

/* The coordinate and dof of a joint: it must have one of each, and no motor yet. */
RBDI_LOCAL rbd_status rbdi_act_find_joint(const rbd_model *m, const rbdi_act_where *where, const char *joint,
                                          const rbd_motor *motor, int16_t *dof, int16_t *at) {
    const rbdi_frame *u;
    int body = -1;
    for (int b = 0; b < m->nb; ++b)
        if (rbdi_same(m->frame[b].joint, joint)) body = b;
    if (body < 0) return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "joint", "no such joint");

    u = &m->frame[body];
    if (u->nv != 1 || u->nq != 1)
        return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "joint",
                                     "has not one coordinate and one degree of freedom of its own");
    if (motor->inertia > 0 && m->dof[u->iv].armature > 0)
        return rbdi_act_refuse_field(where, RBD_ERR_ARMATURE, "inertia",
                                     "the rotor counts twice: the model has it as armature of the joint");
    if (motor->stiffness > 0 && m->dof[u->iv].armature > 0)
        return rbdi_act_refuse_field(where, RBD_ERR_ARMATURE, "stiffness",
                                     "the model has the rotor as armature, but a spring lies between");
    *dof = u->iv;
    *at = u->iq;
    return RBD_OK;
}

RBDI_INLINE int rbdi_act_is_used(rbd_const x) { return x > 0 || x < 0; }

/* Fields that do nothing without others. */
RBDI_LOCAL rbd_status rbdi_act_check_partners(const rbdi_act_where *where, const rbd_motor *m) {
    const rbd_gear_friction *f = &m->friction;
    const int rest = rbdi_act_has_rest(f),
              dry = rest || f->coulomb > 0 || f->load_motor > 0 || f->load_joint > 0;
    const struct {
        const char *name;
        int lonely;
        const char *sentence;
    } field[] = {{"teeth", m->teeth > 0 && !(m->cogging > 0), "does nothing without 'cogging'"},
                 {"phase", rbdi_act_is_used(m->phase) && !(m->cogging > 0), "does nothing without 'cogging'"},
                 {"flow_case", m->flow_case > 0 && !(m->heat_case > 0), "does nothing without 'heat_case'"},
                 {"copper", m->copper > 0 && !(m->resistance > 0), "does nothing without 'resistance'"},
                 {"speed", f->speed > 0 && !rest, "does nothing without friction at rest"},
                 {"power", f->power > 0 && !rest, "does nothing without friction at rest"},
                 {"bristle", f->bristle > 0 && !dry, "does nothing without dry friction"},
                 {"still", f->still > 0 && !dry, "does nothing without dry friction"}};
    for (int i = 0; i < (int)(sizeof field / sizeof *field); ++i)
        if (field[i].lonely)
            return rbdi_act_refuse_field(where, RBD_ERR_RANGE, field[i].name, field[i].sentence);
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_act_check_motor(const rbdi_act_where *where, const rbd_motor *m) {
    rbd_status status = rbdi_act_check_mechanical(where, m);
    if (!status) status = rbdi_act_check_electric(where, m);
    if (!status) status = rbdi_act_check_friction(where, &m->friction);
    return status ? status : rbdi_act_check_partners(where, m);
}

RBDI_LOCAL int rbdi_act_is_vector(const rbd_const x[3]) {
    for (int i = 0; i < 3; ++i)
        if (!(rbdi_abs((rbd_real)x[i]) <= RBD_C(1e6))) return 0;
    return 1;
}

RBDI_LOCAL rbd_real rbdi_act_dot_of(const rbd_const a[3], const rbd_const b[3]) {
    return (rbd_real)a[0] * b[0] + (rbd_real)a[1] * b[1] + (rbd_real)a[2] * b[2];
}

/* A crank's directions are of unit length and across to 1e-6: six decimals in a file will do. */
RBDI_LOCAL rbd_status rbdi_act_check_rod(const rbdi_act_where *where, const rbd_rod *rod) {
    const rbd_real off = RBD_C(RBDI_ORTHONORMAL), one = rbdi_set(RBD_C(1));
    const rbdi_act_field field[] = {{"crank", rod->crank, RBDI_ACTUATOR_LEAST, RBD_C(1e6), 0},
                                    {"length", rod->length, RBDI_ACTUATOR_LEAST, RBD_C(1e6), 0}};
    const rbd_status status = RBDI_ACTUATOR_FIELDS(where, field);
    if (status) return status;
    if (!rbdi_act_is_vector(rod->place)) return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "place", NULL);
    if (!rbdi_act_is_vector(rod->point)) return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "point", NULL);
    if (!rbdi_act_is_vector(rod->axis) || !(rbdi_abs(rbdi_act_dot_of(rod->axis, rod->axis) - one) <= off))
        return rbdi_act_refuse_field(where, RBD_ERR_AXIS, "axis", "not of unit length");
    if (!rbdi_act_is_vector(rod->zero) || !(rbdi_abs(rbdi_act_dot_of(rod->zero, rod->zero) - one) <= off))
        return rbdi_act_refuse_field(where, RBD_ERR_AXIS, "zero", "not of unit length");
    if (!(rbdi_abs(rbdi_act_dot_of(rod->axis, rod->zero)) <= off))
        return rbdi_act_refuse_field(where, RBD_ERR_AXIS, "zero", "not across the axis");
    if (rod->elbow != 1 && rod->elbow != -1)
        return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "elbow", "neither 1 nor -1");
    return RBD_OK;
}

/* A transmission beside n motors; its joints are checked where they are looked up. */
RBDI_LOCAL rbd_status rbdi_act_check_transmission(const rbdi_act_where *where, const rbd_transmission *t,
                                                  const rbd_motor *motors, int n) {
    const int kind = (int)t->kind, most = t->kind == RBD_BY_RODS ? 2 : 3;
    if (kind < 0 || kind > (int)RBD_BY_RODS)
        return rbdi_act_refuse_field(where, RBD_ERR_TYPE, "kind", "unknown kind of transmission");
    if (t->n < 1 || t->n > most)
        return rbdi_act_refuse_field(where, RBD_ERR_COUNT, "n", "below 1 or above 3, or above 2 by rods");
    if (t->motor < 0 || t->motor > n - t->n)
        return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "motor", "the table has no such motors");
    for (int i = 0; i < t->n; ++i)
        if (motors[t->motor + i].joint)
            return rbdi_act_refuse_field(where, RBD_ERR_INDEX, "motor",
                                         "one of its motors has a joint of its own");

    for (int i = 0; i < t->n * t->n && t->kind == RBD_BY_MATRIX; ++i)
        if (!(rbdi_abs((rbd_real)t->matrix[i]) <= RBD_C(1e6)))
            return rbdi_act_refuse_field(where, RBD_ERR_RANGE, "matrix", NULL);
    for (int i = 0; i < t->n && t->kind == RBD_BY_RODS; ++i) {
        const rbd_status status = rbdi_act_check_rod(where, &t->rod[i]);
        if (status) return status;
    }
    return RBD_OK;
}

#endif
