/* algorithms.h - what can be generated: one row for each of the calls of rbd.h, rbd_derivatives.h and
   rbd_constraints.h.
   Included after these by those who record the calls and by those who compute with them.
   SPDX-License-Identifier: MIT */

struct call {
    const rbd_model *m;
    rbd_work *w;
    rbd_derivatives *d;
    rbd_constraint_set *set;       /* may be NULL */
    int rows;                      /* of all constraints, though the set may have fewer */
    const unsigned char *actuated; /* NULL: all but those of a free base */
    int body;
    const rbd_real *q, *v, *a, *tau, *f_ext, *gravity, *restitution; /* f_ext may be NULL */
    rbd_real *out[4];
};

typedef int size_of(const call &c);
static int size_nq(const call &c) { return rbd_nq(c.m); }
static int size_nv(const call &c) { return rbd_nv(c.m); }
static int size_packed(const call &c) { return rbd_packed_size(c.m); }
static int size_full(const call &c) { return rbd_nv(c.m) * rbd_nv(c.m); }
static int size_rows_3(const call &c) { return 3 * rbd_nv(c.m); }
static int size_rows_6(const call &c) { return 6 * rbd_nv(c.m); }
static int size_wrenches(const call &c) { return 6 * rbd_nb(c.m); }
static int size_held(const call &c) { return c.rows; }
static int size_delta(const call &c) { return c.rows * c.rows; }
static int size_1(const call &) { return 1; }
static int size_3(const call &) { return 3; }
static int size_9(const call &) { return 9; }

enum traits {
    PLAIN = 0,
    PIVOTS = 1 /* may find M singular */,
    BODY = 2 /* of a body, whose link is named */,
    HELD = 4 /* with constraints */,
    ALL_HELD = 12 /* with all of them, and rows may depend on each other */
};

struct quantity {
    const char *name, *shape;
    size_of *size;
};

static void demand(rbd_status status) {
    if (status != RBD_OK) throw std::runtime_error(rbd_status_string(status));
}

static void kinematics(const call &c) { demand(rbd_kinematics(c.m, c.w, c.q, NULL, NULL)); }

/* Delta, once an impact has carried the rows through the tree. */
static rbd_status run_delta(const call &c) {
    const std::vector<rbd_real> still(size_t(rbd_nv(c.m)), rbd_real(0));
    std::vector<rbd_real> moved(still);
    const rbd_status status = rbd_impact(c.m, c.set, c.q, still.data(), rbd_real(0), moved.data(), NULL);
    for (const auto *k = c.set->constraint; k < c.set->constraint + c.set->n; k++) {
        rbdi_delta(c.set, k->dof, k->dofs, k->row, k->rows);
        for (int i = k->row; i < k->row + k->rows; i++)
            for (int j = i; j < c.rows; j++)
                c.out[0][i * c.rows + j] = c.out[0][j * c.rows + i] = c.set->R[i * c.set->stride + j];
    }
    return status;
}

#define ROW(name, arguments, traits, run, about, ...) \
    {name, arguments, traits, {__VA_ARGS__}, [](const call &c) { return run; }, about}

/* arguments: the first letters of those below. */
static const struct algorithm {
    const char *name, *arguments;
    int traits;
    quantity results[4];
    rbd_status (*run)(const call &c);
    const char *about;
} algorithms[] = {
    ROW("id", "qvafg", PLAIN, rbd_rnea(c.m, c.w, c.q, c.v, c.a, c.f_ext, c.out[0]),
        "Inverse dynamics tau = M(q) a + c(q, v) - sum J' f_ext: rbd_rnea.", {"tau", "nv", size_nv}),
    ROW("bias", "qvfg", PLAIN, rbd_bias(c.m, c.w, c.q, c.v, c.f_ext, c.out[0]),
        "Bias force, tau at a = 0: rbd_bias.", {"c", "nv", size_nv}),
    ROW("gravity_torque", "qg", PLAIN, rbd_gravity_torque(c.m, c.w, c.q, c.out[0]),
        "Gravity torque, tau at v = a = 0: rbd_gravity_torque.", {"tau", "nv", size_nv}),
    ROW("mm", "q", PLAIN, rbd_crba(c.m, c.w, c.q, c.out[0]), "Mass matrix: rbd_crba.",
        {"M", "nv x nv, both triangles", size_full}),
    ROW("mm_packed", "q", PLAIN, rbd_crba_packed(c.m, c.w, c.q, c.out[0]),
        "Mass matrix, lower triangle, packed: rbd_crba_packed.",
        {"H", "row after row, the entries that the tree fills", size_packed}),
    ROW("minv", "q", PIVOTS, rbd_minverse(c.m, c.w, c.q, c.out[0]),
        "Inverse of the mass matrix: rbd_minverse.", {"Minv", "nv x nv", size_full}),
    ROW("fd", "qvtfg", PIVOTS, rbd_aba(c.m, c.w, c.q, c.v, c.tau, c.f_ext, c.out[0]),
        "Forward dynamics a = M^-1 (tau - c + sum J' f_ext) by articulated bodies: rbd_aba.",
        {"a", "nv", size_nv}),
    ROW("fd_cholesky", "qvtfg", PIVOTS, rbd_fd_cholesky(c.m, c.w, c.q, c.v, c.tau, c.f_ext, c.out[0]),
        "Forward dynamics by mass matrix and its factor: rbd_fd_cholesky.", {"a", "nv", size_nv}),
    ROW("id_derivatives", "qvafg", PLAIN,
        rbd_id_derivatives(c.m, c.d, c.q, c.v, c.a, c.f_ext, c.out[0], c.out[1], NULL),
        "Derivatives of the inverse dynamics: rbd_id_derivatives.",
        {"dtau_dq", "nv x nv, along tangent steps of q", size_full}, {"dtau_dv", "nv x nv", size_full}),
    ROW("fd_derivatives", "qvtfg", PIVOTS,
        rbd_fd_derivatives(c.m, c.d, c.q, c.v, c.tau, c.f_ext, c.out[0], c.out[1], c.out[2], c.out[3]),
        "Derivatives of the forward dynamics: rbd_fd_derivatives.", {"a", "nv, the acceleration", size_nv},
        {"da_dq", "nv x nv, along tangent steps of q", size_full}, {"da_dv", "nv x nv", size_full},
        {"Minv", "nv x nv, da/dtau", size_full}),
    ROW("gravity_torque_derivatives", "qg", PLAIN, rbd_gravity_torque_derivatives(c.m, c.d, c.q, c.out[0]),
        "Derivatives of the gravity torque: rbd_gravity_torque_derivatives.",
        {"dg_dq", "nv x nv", size_full}),
    ROW("coriolis", "qv", PLAIN, rbd_coriolis(c.m, c.d, c.q, c.v, c.out[0]),
        "Coriolis matrix, dM/dt - 2 C being skew: rbd_coriolis.", {"C", "nv x nv", size_full}),
    ROW("momentum_matrix", "q", PLAIN, rbd_momentum_matrix(c.m, c.d, c.q, NULL, c.out[0], NULL),
        "Centroidal momentum matrix, world axes: rbd_momentum_matrix.",
        {"A", "6 x nv, angular rows first", size_rows_6}),
    ROW("com_jacobian", "q", PLAIN, rbd_com_jacobian(c.m, c.d, c.q, c.out[0]),
        "Jacobian of the centre of mass, world axes: rbd_com_jacobian.", {"J", "3 x nv", size_rows_3}),
    ROW("jacobian", "q", BODY,
        (kinematics(c), rbd_jacobian(c.m, c.w, c.body, NULL, RBD_WORLD_AXES, c.out[0])),
        "Jacobian of the link's origin, world axes: rbd_jacobian.",
        {"J", "6 x nv, angular rows first", size_rows_6}),
    ROW("pose", "q", BODY, (kinematics(c), rbd_body_pose(c.m, c.w, c.body, c.out[0], c.out[1])),
        "Pose of the link: rbd_body_pose.", {"R", "3 x 3, link vectors into world vectors", size_9},
        {"p", "the link's origin", size_3}),
    ROW("constrained", "qvtfg", PIVOTS | HELD,
        rbd_constrained_fd(c.m, c.set, c.q, c.v, c.tau, c.f_ext, c.out[0], c.out[1]),
        "Forward dynamics with constraints, M a + c = tau + J' lambda + sum J_b' f_ext: rbd_constrained_fd.",
        {"a", "nv", size_nv}, {"lambda", "constraint forces, of the held axes row after row", size_held}),
    ROW("impact", "qvr", PIVOTS | HELD,
        rbd_impact(c.m, c.set, c.q, c.v, c.restitution[0], c.out[0], c.out[1]),
        "Velocity after an impact, J v_plus = -restitution J v: rbd_impact.",
        {"v_plus", "nv, behind the impact", size_nv},
        {"impulse", "of the held axes row after row", size_held}),
    ROW("delta", "q", PIVOTS | ALL_HELD, run_delta(c),
        "J M^-1 J' of the constraints, as rbd_contact_solve takes it: the inverse of the inertia at the "
        "contacts.",
        {"Delta", "rows x rows of all constraints, both triangles", size_delta}),
    ROW("constrained_id", "qvafg", HELD,
        rbd_constrained_id(c.m, c.set, c.q, c.v, c.a, c.f_ext, c.actuated, NULL, c.out[0], c.out[1]),
        "Inverse dynamics with constraints, of all lambda with tau = 0 at joints without motors the least: "
        "rbd_constrained_id.",
        {"tau", "nv", size_nv}, {"lambda", "constraint forces, of the held axes row after row", size_held}),
};

enum { Q, V, A, TAU, F_EXT, GRAVITY, RESTITUTION, ARGUMENTS };
static const quantity arguments[ARGUMENTS] = {
    {"q", "nq", size_nq},
    {"v", "nv", size_nv},
    {"a", "nv", size_nv},
    {"tau", "nv", size_nv},
    {"f_ext", "nb x 6: the wrench (moment; force) on each body, in its axes, at its origin", size_wrenches},
    {"gravity", "world frame", size_3},
    {"restitution", "0 (nothing rebounds) to 1, which is not checked", size_1}};

/* Of "NAME" or "NAME:LINK"; or NULL. */
static const algorithm *row_of(const std::string &name) {
    for (const algorithm &x : algorithms)
        if (name.substr(0, name.find(':')) == x.name) return &x;
    return NULL;
}

/* A robot with memory to compute in, and a call of an algorithm. */
struct session {
    std::vector<unsigned char> model_memory, work_memory, derivatives_memory, set_memory;
    call c;
    const algorithm *row;
    std::vector<int> held; /* of each row of the set: which one of all */

    session(const robot &r, const std::string &name, int stance = 0) : c(), row() {
        const rbd_body *bodies = reinterpret_cast<const rbd_body *>(r.bodies); /* of this namespace */
        model_memory.resize(rbd_model_size(bodies, r.nb));
        demand(rbd_model_build_kinematic(bodies, r.nb, model_memory.data(), model_memory.size(), &c.m, NULL));
        work_memory.resize(rbd_work_size(c.m));
        demand(rbd_work_init(c.m, work_memory.data(), work_memory.size(), &c.w));
        derivatives_memory.resize(rbd_derivatives_size(c.m));
        demand(rbd_derivatives_init(c.m, c.w, derivatives_memory.data(), derivatives_memory.size(), &c.d));
        row = row_of(name);
        c.body = row->traits & BODY ? rbd_body_index(c.m, name.c_str() + name.find(':') + 1) : 0;
        if (c.body < 0) throw std::runtime_error(name + ": there is no such link");
        if (rbd_nv(c.m) == 0) throw std::runtime_error("the robot has no degree of freedom");
        c.actuated = r.actuated.empty() ? NULL : r.actuated.data();
        if (row->traits & HELD) hold(r, stance);
    }

    bool holds_all() const { return (row->traits & ALL_HELD) == ALL_HELD; }

    void hold(const robot &r, int stance) {
        const rbd_constraint *all = reinterpret_cast<const rbd_constraint *>(r.constraints);
        std::vector<rbd_constraint> own;
        for (int i = 0; i < r.nc; i++) {
            const auto holds = [&](const std::vector<int> &x) {
                return std::count(x.begin(), x.end(), i) > 0;
            };
            const bool is_own = r.stances.empty() || holds_all() || holds(r.stances[size_t(stance)]);
            if (is_own) own.push_back(all[i]);
            for (int axis : all[i].axes)
                if (axis && is_own)
                    held.push_back(c.rows++);
                else
                    c.rows += axis;
        }
        const int n = int(own.size());
        set_memory.resize(rbd_constraint_set_size(c.m, own.data(), n) + 1);
        demand(rbd_constraint_set_init(c.m, c.w, own.data(), n, set_memory.data(), set_memory.size(), &c.set,
                                       NULL));
    }

    bool takes(const robot &r, int k) const {
        const bool wanted = k == F_EXT ? r.f_ext : k == GRAVITY ? r.gravity_argument : true;
        return wanted && std::strchr(row->arguments, arguments[k].name[0]);
    }

    /* x: an array for each argument. */
    std::vector<rbd_real> run(const std::vector<rbd_real> x[ARGUMENTS],
                              rbd_status (*run_call)(const call &)) {
        const rbd_real **given[ARGUMENTS] = {&c.q, &c.v, &c.a, &c.tau, &c.f_ext, &c.gravity, &c.restitution};
        std::vector<rbd_real> out[4], all;
        for (int k = 0; k < ARGUMENTS; k++) *given[k] = x[k].empty() ? NULL : x[k].data();
        for (int k = 0; k < 4; k++) {
            if (row->results[k].size) out[k].resize(size_t(row->results[k].size(c)));
            c.out[k] = out[k].data();
        }
        const rbd_status status = run_call(c);
        if (status == RBD_ERR_SINGULAR || status == RBD_ERR_MASSLESS) {
            const int body = c.m->dof[rbd_singular_dof(c.w)].body;
            const char *name = rbd_body_name(c.m, body);
            const std::string link =
                name ? "link '" + std::string(name) + "'" : "body " + std::to_string(body);
            throw std::runtime_error(
                status == RBD_ERR_MASSLESS
                    ? "dynamics needs masses, and the joint of " + link +
                          " moves none: with --kinematic there are jacobian:LINK and pose:LINK alone"
                    : rbd_status_string(status) + (" at the joint of " + link));
        }
        demand(status == RBD_ERR_INFEASIBLE ? RBD_OK : status); /* by rows that depend on each other */
        for (int k = 0; k < 4; k++) {
            std::vector<rbd_real> &y = out[k], own = y;
            if (row->results[k].size == size_held) std::fill(y.begin(), y.end(), rbd_real(0));
            for (size_t i = 0; i < held.size() && row->results[k].size == size_held; i++)
                y[size_t(held[i])] = own[i];
            all.insert(all.end(), y.begin(), y.end());
        }
        return all;
    }
};

/* The results for an array of each argument that the call takes. */
template <class inputs> std::vector<rbd_real> results_for(session *s, const robot &r, const inputs &in) {
    std::vector<rbd_real> x[ARGUMENTS];
    const typename inputs::value_type::value_type *gravity = r.gravity;
    size_t given = 0;
    for (int k = 0; k < ARGUMENTS; k++) {
        if (!s->takes(r, k)) continue;
        if (k == GRAVITY) gravity = in[given].data();
        x[k].assign(in[given].begin(), in[given].end());
        given++;
    }
    demand(rbd_set_gravity(s->c.w, gravity));
    return s->run(x, s->row->run);
}
