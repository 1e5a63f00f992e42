/* The sum of a_i t_i. */
RBDI_ONCE RBDI_T rbdi_qp_dot(const rbd_real *a, const RBDI_T *t, int n) {
    const RBDI_T zero = {0};
    RBDI_T s0, s1, s2, s3, rest;
    int i = 0;

    s0 = s1 = s2 = s3 = rest = zero;
    for (; i + 4 <= n; i += 4) {
        s0 = s0 + a[i] * t[i];
        s1 = s1 + a[i + 1] * t[i + 1];
        s2 = s2 + a[i + 2] * t[i + 2];
        s3 = s3 + a[i + 3] * t[i + 3];
    }
    for (; i < n; ++i) rest = rest + a[i] * t[i];
    return ((s0 + s2) + (s1 + s3)) + rest;
}

/* The sums of a_i t_i and of b_i t_i: where size counts by two calls, with the same order. */
RBDI_ONCE void rbdi_qp_dots(const rbd_real *a, const rbd_real *b, const RBDI_T *t, int n, RBDI_T *with_a,
                            RBDI_T *with_b) {
    const RBDI_T zero = {0};
    RBDI_T a0, a1, a2, a3, rest_a, b0, b1, b2, b3, rest_b;
    int i = 0;

    if (!RBDI_FOR_SPEED) {
        *with_a = rbdi_qp_dot(a, t, n);
        *with_b = rbdi_qp_dot(b, t, n);
        return;
    }

    a0 = a1 = a2 = a3 = rest_a = zero;
    b0 = b1 = b2 = b3 = rest_b = zero;
    for (; i + 4 <= n; i += 4) {
        const RBDI_T t0 = t[i], t1 = t[i + 1], t2 = t[i + 2], t3 = t[i + 3];
        a0 = a0 + a[i] * t0;
        b0 = b0 + b[i] * t0;
        a1 = a1 + a[i + 1] * t1;
        b1 = b1 + b[i + 1] * t1;
        a2 = a2 + a[i + 2] * t2;
        b2 = b2 + b[i + 2] * t2;
        a3 = a3 + a[i + 3] * t3;
        b3 = b3 + b[i + 3] * t3;
    }
    for (; i < n; ++i) {
        rest_a = rest_a + a[i] * t[i];
        rest_b = rest_b + b[i] * t[i];
    }
    *with_a = ((a0 + a2) + (a1 + a3)) + rest_a;
    *with_b = ((b0 + b2) + (b1 + b3)) + rest_b;
}

/* t += k a + l b. */
RBDI_ONCE void rbdi_qp_adds(RBDI_T k, const rbd_real *a, RBDI_T l, const rbd_real *b, RBDI_T *t, int n) {
    int i = 0;

    for (; RBDI_FOR_SPEED && i + 4 <= n; i += 4) {
        t[i] = t[i] + k * a[i] + l * b[i];
        t[i + 1] = t[i + 1] + k * a[i + 1] + l * b[i + 1];
        t[i + 2] = t[i + 2] + k * a[i + 2] + l * b[i + 2];
        t[i + 3] = t[i + 3] + k * a[i + 3] + l * b[i + 3];
    }
    for (; i < n; ++i) t[i] = t[i] + k * a[i] + l * b[i];
}

/* t += k a. */
RBDI_ONCE void rbdi_qp_add(RBDI_T k, const rbd_real *a, RBDI_T *t, int n) {
    int i = 0;

    for (; RBDI_FOR_SPEED && i + 4 <= n; i += 4) {
        t[i] = t[i] + k * a[i];
        t[i + 1] = t[i + 1] + k * a[i + 1];
        t[i + 2] = t[i + 2] + k * a[i + 2];
        t[i + 3] = t[i + 3] + k * a[i + 3];
    }
    for (; i < n; ++i) t[i] = t[i] + k * a[i];
}
