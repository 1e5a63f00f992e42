/* t := L^-1 t, where t is 0 before `from`, a multiple of four, and from `to` on. */
RBDI_PART void rbdi_qp_solve_lower(const rbdi_qp *s, RBDI_T *t, int from, int to) {
    int i = from;
    int at;

    for (; i < s->coupled; ++i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        const int k = s->first[i] > from ? s->first[i] : from;
        if (k < i) t[i] = t[i] - rbdi_qp_dot(l + k, t + k, i - k);
        t[i] = t[i] * l[i];
    }
    at = rbdi_qp_pivot(i);
    for (; i < to; ++i) {
        t[i] = t[i] * s->L[at];
        at = at + i + 2;
    }
}

/* t := L'^-1 t, where t is 0 from `to` on. */
RBDI_PART void rbdi_qp_solve_upper(const rbdi_qp *s, RBDI_T *t, int to) {
    int i = to - 1;
    int at = rbdi_qp_pivot(i);

    for (; i >= s->coupled; --i) {
        t[i] = s->L[at] * t[i];
        at = at - i - 1;
    }
    for (; i >= 0; --i) {
        const rbd_real *l = s->L + i * (i + 1) / 2;
        const int k = s->first[i];
        t[i] = l[i] * t[i];
        if (k < i) rbdi_qp_add(-t[i], l + k, t + k, i - k);
    }
}

/* t := (1 - beta v v') t, of reflection e. */
RBDI_PART void rbdi_qp_reflect(const rbdi_qp *s, int e, RBDI_T *t) {
    const rbd_real *v = s->V + e * s->n + e;
    const int length = s->end[e] - e;

    rbdi_qp_add(-s->beta[e] * rbdi_qp_dot(v, t + e, length), v, t + e, length);
}

/* Reflections e and e + 1, of vectors v and w, in one pass; backwards: first e + 1, then e. With c = v'w

       a = beta_v v't,  b = beta_w (w't - c a)      or  b = beta_w w't,  a = beta_v (v't - c b)
       t -= a v + b w */
RBDI_PART void rbdi_qp_reflect_two(const rbdi_qp *s, int e, int backwards, RBDI_T *t) {
    const rbd_real *v = s->V + e * s->n, *w = v + s->n;
    const int end = s->end[e] > s->end[e + 1] ? s->end[e] : s->end[e + 1], from = e + 1;
    RBDI_T a, b;

    rbdi_qp_dots(v + from, w + from, t + from, end - from, &a, &b);
    a = a + v[e] * t[e];
    if (backwards) {
        b = s->beta[e + 1] * b;
        a = s->beta[e] * (a - s->cross[e] * b);
    } else {
        a = s->beta[e] * a;
        b = s->beta[e + 1] * (b - s->cross[e] * a);
    }

    t[e] = t[e] - a * v[e];
    rbdi_qp_adds(-a, v + from, -b, w + from, t + from, end - from);
}

/* t := Q t, of the first k reflections */
RBDI_PART void rbdi_qp_reflect_back(const rbdi_qp *s, int k, RBDI_T *t) {
    if (k % 2) rbdi_qp_reflect(s, k - 1, t);
    for (int e = k / 2 * 2 - 2; e >= 0; e -= 2) rbdi_qp_reflect_two(s, e, 1, t);
}
