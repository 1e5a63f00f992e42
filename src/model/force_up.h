/* Turns (x, y) back by an angle with cosine c and sine s, or as the flags say: see rbdi_turn_up_z. */
RBDI_INLINE void rbdi_array_turn(int flags, rbd_real c, rbd_real s, RBDI_T *x, RBDI_T *y) {
    const RBDI_T x0 = *x, y0 = *y;
    if (flags & RBDI_TWIST_0) return;

    *x = -y0;
    *y = x0;
    if (flags & RBDI_TWIST_90) return;

    *x = x0 * c - y0 * s;
    *y = x0 * s + y0 * c;
}

/* F = (n; f), each of its six components an RBDI_T: the moment of the slide d, the turns by q, alpha and
   beta, the moment of the shift r. n += r x f. */
RBDI_INLINE void rbdi_array_up(const rbdi_link *l, int flags, rbdi_trig t, RBDI_T *F) {
    if (flags & RBDI_SHIFT_Z) {
        F[0] = F[0] - F[4] * t.d;
        F[1] = F[1] + F[3] * t.d;
    }

    RBDI_UNROLL_SIX for (int k = 0; k < 6; k += 3) {
        rbdi_array_turn(0, t.c, t.s, &F[k], &F[k + 1]);
        rbdi_array_turn(flags, rbdi_set(l->ca), rbdi_set(l->sa), &F[k + 1], &F[k + 2]);
        if (flags & RBDI_BRANCH_TURN) rbdi_array_turn(0, rbdi_set(l->cb), rbdi_set(l->sb), &F[k], &F[k + 1]);
    }
    if (!(flags & RBDI_SHIFT_R)) return;

    F[1] = F[1] - F[5] * l->r.x;
    F[2] = F[2] + F[4] * l->r.x;
    if (flags & RBDI_SHIFT_XYZ) {
        F[0] = F[0] + (F[5] * l->r.y - F[4] * l->r.z);
        F[1] = F[1] + F[3] * l->r.z;
        F[2] = F[2] - F[3] * l->r.y;
    }
}
