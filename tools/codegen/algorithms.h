/* algorithms.h - what can be generated: one row for each of rbd.h's calls. Included after rbd.h by those who
   record the calls and by those who compute with them. SPDX-License-Identifier: MIT */

struct call {
    const rbd_model *m;
    rbd_work *w;
    const rbd_real *q, *v, *a, *tau, *f_ext; /* f_ext may be NULL */
    rbd_real *out;
};

static int size_nv(const rbd_model *m) { return rbd_nv(m); }
static int size_full(const rbd_model *m) { return rbd_nv(m) * rbd_nv(m); }

/* arguments: q, v, a, tau as t, f_ext as f, gravity as g. pivots: may find the mass matrix singular. */
static const struct algorithm {
    const char *name, *arguments, *result, *shape;
    int (*size)(const rbd_model *m);
    rbd_status (*run)(const call &c);
    bool pivots;
    const char *about;
} algorithms[] = {
    {"id", "qvafg", "tau", "nv", size_nv,
     [](const call &c) { return rbd_rnea(c.m, c.w, c.q, c.v, c.a, c.f_ext, c.out); }, false,
     "Inverse dynamics tau = M(q) a + c(q, v) - sum J' f_ext, by rbd_rnea."},
    {"bias", "qvfg", "c", "nv", size_nv,
     [](const call &c) { return rbd_bias(c.m, c.w, c.q, c.v, c.f_ext, c.out); }, false,
     "Bias force: inverse dynamics at a = 0, by rbd_bias."},
    {"gravity", "qg", "tau", "nv", size_nv, [](const call &c) { return rbd_gravity(c.m, c.w, c.q, c.out); },
     false, "Gravity torque: inverse dynamics at v = a = 0, by rbd_gravity."},
    {"mm", "q", "M", "nv x nv, both triangles", size_full,
     [](const call &c) { return rbd_crba(c.m, c.w, c.q, c.out); }, false, "Mass matrix, by rbd_crba."},
    {"mm_packed", "q", "H", "packed as rbd_crba_packed says", rbd_packed_size,
     [](const call &c) { return rbd_crba_packed(c.m, c.w, c.q, c.out); }, false,
     "Mass matrix, the entries of the lower triangle that the tree fills, by rbd_crba_packed."},
    {"fd", "qvtfg", "a", "nv", size_nv,
     [](const call &c) { return rbd_aba(c.m, c.w, c.q, c.v, c.tau, c.f_ext, c.out); }, true,
     "Forward dynamics a = M^-1 (tau - c + sum J' f_ext), by rbd_aba."},
    {"fd_cholesky", "qvtfg", "a", "nv", size_nv,
     [](const call &c) { return rbd_fd_cholesky(c.m, c.w, c.q, c.v, c.tau, c.f_ext, c.out); }, true,
     "Forward dynamics a = M^-1 (tau - c + sum J' f_ext), by rbd_fd_cholesky."},
};

/* The letters of `arguments`. */
struct argument {
    char letter;
    const char *name, *shape;
    int (*size)(const rbd_model *m);
};
static const argument arguments[] = {
    {'q', "q", "nq", rbd_nq},
    {'v', "v", "nv", size_nv},
    {'a', "a", "nv", size_nv},
    {'t', "tau", "nv", size_nv},
    {'f', "f_ext", "nb x 6: the wrench (moment; force) on each body, in its axes, at its origin",
     [](const rbd_model *m) { return 6 * rbd_nb(m); }},
    {'g', "gravity", "in the world frame", [](const rbd_model *) { return 3; }},
};
