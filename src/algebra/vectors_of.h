RBDI_INLINE rbdi_v3 rbdi_vec(RBDI_T x, RBDI_T y, RBDI_T z) {
    const rbdi_v3 v = {x, y, z};
    return v;
}

RBDI_INLINE rbdi_v3 rbdi_add(rbdi_v3 a, rbdi_v3 b) { return rbdi_vec(a.x + b.x, a.y + b.y, a.z + b.z); }
RBDI_INLINE rbdi_v3 rbdi_scale(RBDI_T k, rbdi_v3 a) { return rbdi_vec(k * a.x, k * a.y, k * a.z); }
RBDI_INLINE rbdi_v3 rbdi_cross(rbdi_v3 a, rbdi_v3 b) {
    return rbdi_vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

RBDI_INLINE rbdi_motion rbdi_motion_add(rbdi_motion a, rbdi_motion b) {
    a.omega = rbdi_add(a.omega, b.omega);
    a.v = rbdi_add(a.v, b.v);
    return a;
}

RBDI_INLINE rbdi_force rbdi_force_add(rbdi_force a, rbdi_force b) {
    a.n = rbdi_add(a.n, b.n);
    a.f = rbdi_add(a.f, b.f);
    return a;
}

/* S' f. */
RBDI_INLINE RBDI_T rbdi_power(rbdi_motion S, rbdi_force f) {
    return (f.n.x * S.omega.x + f.n.y * S.omega.y + f.n.z * S.omega.z) +
           (f.f.x * S.v.x + f.f.y * S.v.y + f.f.z * S.v.z);
}
