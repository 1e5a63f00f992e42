#ifndef RBDI_ACTUATOR_ROTOR_H
#define RBDI_ACTUATOR_ROTOR_H
#include "api/dynamics.h"
#include "api/kinematics.h"
#include "algebra/vectors.h"
#include "model/calls.h"
#include "actuator/layout.h"

/* ---- rotors [rotors code] ----
   A rotor with inertia I about its axis s, that spins with W = gear v relative to its body, which turns with
   omega: its angular momentum is I W s beside that of the locked rotor, which the body has. The body gets the
   moment -(I W' s + omega x I W s), and the shaft's motor gives gear I s.omega' beside gear^2 I v', which is
   the armature's. */

RBDI_LOCAL rbd_status rbdi_act_check_rotor(const rbd_model *m, const rbd_rotor *r) {
    rbd_real square = rbdi_zero();
    if (r->body < -1 || r->body >= m->nb || r->dof < 0 || r->dof >= m->nv) return RBD_ERR_INDEX;
    for (int i = 0; i < 3; ++i) square = square + (rbd_real)r->axis[i] * r->axis[i];
    if (!(square > RBD_C(1e-18) && square < RBD_C(1e18))) return RBD_ERR_AXIS;
    if (!(r->inertia >= 0 && r->inertia <= RBDI_ACTUATOR_MOST)) return RBD_ERR_RANGE;
    return rbdi_abs(r->gear) > 0 && rbdi_abs(r->gear) <= RBDI_ACTUATOR_MOST ? RBD_OK : RBD_ERR_RANGE;
}

/* The axis, of unit length. */
RBDI_INLINE rbdi_v3 rbdi_act_rotor_axis(const rbd_rotor *r) {
    const rbdi_v3 s = rbdi_vec(r->axis[0], r->axis[1], r->axis[2]);
    return rbdi_scale(1 / rbdi_sqrt(rbdi_dot(s, s)), s);
}

/* Adds the moment on the rotor's body to f_ext, after rbd_kinematics. */
RBDI_LOCAL void rbdi_act_add_rotor(const rbd_model *m, const rbd_work *w, const rbd_rotor *r, rbd_real spin,
                                   rbd_real rate, rbd_real *f_ext) {
    const rbdi_v3 s = rbdi_act_rotor_axis(r);
    rbd_real velocity[6];
    rbdi_v3 moment;
    (void)rbd_body_velocity(m, w, r->body, velocity);

    moment = rbdi_cross(rbdi_load_vec(velocity, 1), rbdi_scale(spin, s));
    moment = rbdi_scale(-(rbd_real)r->inertia, rbdi_add(moment, rbdi_scale(rate, s)));
    f_ext[0] = f_ext[0] + moment.x;
    f_ext[1] = f_ext[1] + moment.y;
    f_ext[2] = f_ext[2] + moment.z;
}

RBDI_API rbd_status rbd_rotor_torque(const rbd_model *m, rbd_work *w, const rbd_rotor *rotors, int n,
                                     const rbd_real *q, const rbd_real *v, const rbd_real *a, rbd_real *f_ext,
                                     rbd_real *tau) {
    rbd_status status = rbdi_check(m, w, (rotors || !n) && q && v && a && f_ext && tau);
    if (status) return status;
    if (n < 0) return RBD_ERR_COUNT;
    for (int i = 0; i < n; ++i) {
        status = rbdi_act_check_rotor(m, &rotors[i]);
        if (status) return status;
    }

    (void)rbd_kinematics(m, w, q, v, a);
    for (int i = 0; i < n; ++i) {
        const rbd_rotor *r = &rotors[i];
        if (r->body < 0) continue;
        rbdi_act_add_rotor(m, w, r, r->gear * v[r->dof], r->gear * a[r->dof], &f_ext[6 * r->body]);
    }
    (void)rbd_rnea(m, w, q, v, a, f_ext, tau);

    for (int i = 0; i < n; ++i) {
        const rbd_rotor *r = &rotors[i];
        rbd_real acceleration[6];
        if (r->body < 0) continue;
        (void)rbd_body_acceleration(m, w, r->body, acceleration);
        tau[r->dof] = tau[r->dof] + (rbd_real)r->gear * r->inertia *
                                        rbdi_dot(rbdi_act_rotor_axis(r), rbdi_load_vec(acceleration, 1));
    }
    return RBD_OK;
}

#endif
