/* derivatives_record.h - derivatives of dynamics in the frames of the links, for the record. Included behind
   rbd.h by record.cpp. SPDX-License-Identifier: MIT

   rbd.h's loops take all dofs into one frame, where they are SIMD lanes. Straight-line code is shorter in the
   frames of the links: S is a unit vector there, so half of the entries are components, which cost nothing.
   The sums, columns and entries are those of rbd_derivatives.h's [common frame] and [entries], which hold in
   any frame that moves uniformly: here one for each link, which moves with the link's origin. F, D and E are
   the same in all of them. From a link to its parent the velocities of points change by u, that of the link's
   origin in the parent's frame. So X and P change too, and T by 2 u x f with f of F. */

/* Of a link's subtree. */
struct subtree {
    rbdi_rbi C;
    rbdi_mat X; /* X and P of twice the velocities, for 2 B; of the velocities, for C */
    rbdi_v3 P;
    rbdi_force f;
};

/* Of a dof, in the axes of its link. */
struct motions {
    rbdi_motion S, Psi, U, Phi;
};
/* Of a dof, in the axes of the link to which they go; T is a moment. Those that are not at work are zero. */
struct columns {
    rbdi_force F, D, E;
    rbdi_v3 T;
};

/* Of a link's origin: where it is from its parent's, and u, or 2 u for 2 B; the part along the link's z, in
   its axes, and the rest, in the parent's axes. */
struct offset {
    rbdi_v3 z, r, u_z, u_r;
};

static rbdi_mat mat_add(rbdi_mat A, rbdi_mat B) {
    return {A.xx + B.xx, A.xy + B.xy, A.xz + B.xz, A.yx + B.yx, A.yy + B.yy,
            A.yz + B.yz, A.zx + B.zx, A.zy + B.zy, A.zz + B.zz};
}
static rbdi_mat mat_of_sym(rbdi_sym A) { return {A.xx, A.xy, A.xz, A.xy, A.yy, A.yz, A.xz, A.yz, A.zz}; }
/* The matrix with these columns. */
static rbdi_mat mat_of_columns(rbdi_v3 x, rbdi_v3 y, rbdi_v3 z) {
    return {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
}
/* a b'. */
static rbdi_mat outer(rbdi_v3 a, rbdi_v3 b) {
    return mat_of_columns(rbdi_scale(b.x, a), rbdi_scale(b.y, a), rbdi_scale(b.z, a));
}
/* [w]x A. */
static rbdi_mat cross_mat(rbdi_v3 w, rbdi_mat A) {
    return mat_of_columns(rbdi_cross(w, rbdi_vec(A.xx, A.yx, A.zx)),
                          rbdi_cross(w, rbdi_vec(A.xy, A.yy, A.zy)),
                          rbdi_cross(w, rbdi_vec(A.xz, A.yz, A.zz)));
}
/* (tr(A) - A) w. */
static rbdi_v3 mul_trace_less(rbdi_mat A, rbdi_v3 w) {
    return rbdi_vec((A.yy + A.zz) * w.x - A.xy * w.y - A.xz * w.z,
                    (A.xx + A.zz) * w.y - A.yx * w.x - A.yz * w.z,
                    (A.xx + A.yy) * w.z - A.zx * w.x - A.zy * w.y);
}
static rbdi_motion motion_cross(rbdi_motion V, rbdi_motion S) {
    return {rbdi_cross(V.omega, S.omega), rbdi_add(rbdi_cross(V.v, S.omega), rbdi_cross(V.omega, S.v))};
}
/* V x* f. */
static rbdi_force force_cross(rbdi_motion V, rbdi_force f) {
    return {rbdi_add(rbdi_cross(V.omega, f.n), rbdi_cross(V.v, f.f)), rbdi_cross(V.omega, f.f)};
}

class dynamics_derivatives {
  public:
    /* Of the joints' transforms that w has. coriolis: C in place of dtau/dv. */
    dynamics_derivatives(const rbd_model *m_, rbd_work *w_, const number *v_, const number *a_,
                         rbdi_c3 gravity, const number *f_ext, bool coriolis_)
        : m(m_), w(w_), v(v_), a(a_), coriolis(coriolis_), world(rbdi_world_state(gravity)),
          subtrees(size_t(m_->nl)), offsets(size_t(m_->nl)), motion(size_t(m_->nv + rbdi_mimics(m_))) {
        rbdi_forward(m, w, 0, m->nl, &world, v, a, 1, 1);
        rbdi_external(m, w, f_ext);
    }

    /* Into matrices, of which either may be NULL. Sum after sum and column after column: so few values are at
       work that registers hold them. */
    void run(number *by_q, number *by_v) {
        out[BY_Q] = by_q, out[BY_V] = by_v;
        for (number *x : out)
            if (x) rbdi_clear(x, m->nv * m->nv);
        for (subtree &s : subtrees) s = {rbdi_rbi_zero(), rbdi_abi_zero().H, rbdi_vec0(), rbdi_force0()};
        for (int i = 0; i < m->nl; i++) offsets[size_t(i)] = offset_of(i), put_motions(i);
        for (int i = m->nl - 1; i >= 0; i--) sum_f(i);
        for (int i = m->nl - 1; i >= 0; i--) sum_C(i);
        for (int i = m->nl - 1; i >= 0; i--) sum_B(i);
        for (int i = m->nl - 1; i >= 0; i--)
            for (int k : dofs_of(i)) put_columns(i, k);
    }

  private:
    const rbd_model *m;
    rbd_work *w;
    const number *v, *a;
    bool coriolis;
    rbdi_state world;
    std::vector<subtree> subtrees; /* of links */
    std::vector<offset> offsets;
    std::vector<motions> motion; /* of dofs, in the solver's order */
    enum { BY_Q, BY_V };
    number *out[2];

    bool is_block(int i) const { return rbdi_is(&m->link[i], RBDI_BLOCK); }
    int flags(int i) const { return rbdi_flags(&m->link[i]); }
    rbdi_trig trig(int i) const { return rbdi_trig_of(m, w, i, flags(i)); }
    const rbdi_pose &pose(int i) const { return w->block[m->link[i].block].X; }
    rbdi_state parent_state(int i) const {
        return m->link[i].parent < 0 ? world : w->kin[m->link[i].parent].state;
    }
    std::vector<int> dofs_of(int i) const {
        std::vector<int> all;
        for (int k = 0; k < rbdi_link_dofs(m, &m->link[i]); k++) all.push_back(m->link[i].first + k);
        return all;
    }
    rbdi_v3 times_B(rbdi_v3 u) const { return coriolis ? u : rbdi_add(u, u); }

    /* ---- motions ---- */

    /* Of the joint, for rates x of its dofs. */
    rbdi_motion joint_motion(int i, const number *x) const {
        const rbdi_link *l = &m->link[i];
        rbdi_motion J = rbdi_motion0();
        if (is_block(i)) return rbdi_block_motion(rbdi_block_of(m, l), x);
        J.omega.z = *x * l->rho, J.v.z = *x * l->kappa;
        return J;
    }

    offset offset_of(int i) const {
        const rbdi_v3 omega = parent_state(i).omega, slide = joint_motion(i, &v[m->link[i].iv]).v;
        offset d;
        if (is_block(i)) {
            d.z = d.u_z = rbdi_vec0(), d.r = pose(i).r;
            d.u_r = times_B(rbdi_add(rbdi_cross(omega, d.r), rbdi_mul_t(pose(i).E, slide)));
            return d;
        }
        d.z = rbdi_vec(rbdi_zero(), rbdi_zero(), trig(i).d), d.r = rbdi_vec_c(m->link[i].r);
        d.u_z = times_B(rbdi_add(rbdi_cross(w->kin[i].state.omega, d.z), slide));
        d.u_r = times_B(rbdi_cross(omega, d.r));
        return d;
    }

    /* Psi = V_p x S and Phi = A_p x S + V_p x Psi, with V_p = (omega; -slide) and A_p in classical terms, acc
       and Omega: those of the parent where it carries the link, in the link's axes. */
    void put_motions(int i) {
        const rbdi_link *l = &m->link[i];
        const rbdi_state p = parent_state(i);
        const rbdi_motion J = joint_motion(i, &v[l->iv]), V = {w->kin[i].state.omega, rbdi_vec0()};
        rbdi_v3 omega, omega_dot, acc;
        if (is_block(i)) {
            omega = rbdi_mul(pose(i).E, p.omega), omega_dot = rbdi_mul(pose(i).E, p.omega_dot);
            acc = rbdi_mul(rbdi_omega(p.omega, p.omega_dot), pose(i).r);
            acc = rbdi_mul(pose(i).E, rbdi_add(p.acc, acc));
        } else {
            const rbdi_v3 slide = joint_motion(i, &a[l->iv]).v;
            omega = rbdi_down(l, flags(i), trig(i), p.omega),
            omega_dot = rbdi_down(l, flags(i), trig(i), p.omega_dot);
            acc = rbdi_add(rbdi_joint_product(omega, J).v, slide);
            acc = rbdi_sub(w->kin[i].state.acc, acc);
        }
        const rbdi_mat Omega = rbdi_omega(omega, omega_dot);
        const rbdi_motion V_p = {omega, rbdi_sub(rbdi_vec0(), J.v)};
        for (int k : dofs_of(i)) {
            motions &x = motion[size_t(k)];
            number unit[6] = {0, 0, 0, 0, 0, 0};
            for (int n = 0; n < rbdi_link_dofs(m, l); n++) unit[n] = n == k - l->first;
            x.S = joint_motion(i, unit);
            x.Psi = motion_cross(V_p, x.S);
            x.U = motion_cross(V, x.S);
            if (!coriolis) x.U = rbdi_motion_add(x.Psi, x.U);
            const rbdi_v3 once = rbdi_cross(V_p.v, x.Psi.omega);
            x.Phi.omega = rbdi_mul(Omega, x.S.omega);
            x.Phi.v =
                rbdi_add(rbdi_add(rbdi_mul(Omega, x.S.v), rbdi_cross(acc, x.S.omega)), rbdi_add(once, once));
        }
    }

    /* ---- sums over subtrees ---- */

    void sum_f(int i) {
        const int parent = m->link[i].parent;
        rbdi_force &f = subtrees[size_t(i)].f;
        f = rbdi_force_add(w->scratch[i].f, f);
        if (parent < 0) return;
        subtrees[size_t(parent)].f = rbdi_force_add(subtrees[size_t(parent)].f, up(i, f));
    }
    void sum_C(int i) {
        const rbdi_link *l = &m->link[i];
        rbdi_rbi &C = subtrees[size_t(i)].C;
        C = rbdi_rbi_add_link(l, C);
        if (l->parent < 0) return;
        const rbdi_rbi moved = is_block(i) ? rbdi_rbi_up_block(&pose(i), l->subtree_mass, C)
                                           : rbdi_rbi_up(l, flags(i), trig(i), C);
        subtrees[size_t(l->parent)].C = rbdi_rbi_add(subtrees[size_t(l->parent)].C, moved);
    }
    void sum_B(int i) {
        const rbdi_link *l = &m->link[i];
        const rbdi_v3 omega = times_B(w->kin[i].state.omega);
        const offset &d = offsets[size_t(i)];
        subtree &s = subtrees[size_t(i)];
        s.X = mat_add(s.X, cross_mat(omega, mat_of_sym(rbdi_sym_c(l->Sigma))));
        s.P = rbdi_add(s.P, rbdi_cross(omega, rbdi_vec_c(l->h)));
        if (l->parent < 0) return;
        const number mass = rbdi_set(l->subtree_mass);
        subtree &parent = subtrees[size_t(l->parent)], x = s;
        shift(d.z, d.u_z, mass, &x);
        x.X = up(i, x.X), x.P = up(i, x.P), x.C.h = up(i, x.C.h);
        shift(d.r, d.u_r, mass, &x);
        parent.X = mat_add(parent.X, x.X), parent.P = rbdi_add(parent.P, x.P);
    }
    /* X = the integral of v x' dm: with x + r in place of x, and v + u in place of v. */
    static void shift(rbdi_v3 r, rbdi_v3 u, number mass, subtree *s) {
        s->C.h = rbdi_add(s->C.h, rbdi_scale(mass, r));
        s->X = mat_add(s->X, mat_add(outer(s->P, r), outer(u, s->C.h)));
        s->P = rbdi_add(s->P, rbdi_scale(mass, u));
    }

    /* To the parent's axes and origin. */
    rbdi_force up(int i, rbdi_force F) const {
        return is_block(i) ? rbdi_force_up_block(&pose(i), F)
                           : rbdi_force_up(&m->link[i], flags(i), trig(i), F);
    }
    /* To the parent's axes. */
    rbdi_v3 up(int i, rbdi_v3 x) const { return up(i, rbdi_force{x, rbdi_vec0()}).n; }
    rbdi_mat up(int i, rbdi_mat A) const {
        const rbdi_link *l = &m->link[i];
        if (is_block(i)) return rbdi_mat_up(pose(i).E, A);
        A = rbdi_mat_cycle(rbdi_mat_up_z(0, trig(i).c, trig(i).s, A));
        A = rbdi_mat_up_z(flags(i), rbdi_set(l->ca), rbdi_set(l->sa), A);
        A = rbdi_mat_cycle(rbdi_mat_cycle(A));
        return flags(i) & RBDI_BRANCH_TURN ? rbdi_mat_up_z(0, rbdi_set(l->cb), rbdi_set(l->sb), A) : A;
    }

    /* ---- columns and entries ---- */

    static rbdi_force inertia_times(const subtree &s, number mass, rbdi_motion V) {
        return {rbdi_add(mul_trace_less(mat_of_sym(s.C.Sigma), V.omega), rbdi_cross(s.C.h, V.v)),
                rbdi_add(rbdi_scale(mass, V.v), rbdi_cross(V.omega, s.C.h))};
    }
    /* 2 B (omega; any). */
    static rbdi_force B_times(const subtree &s, rbdi_v3 omega) {
        return {mul_trace_less(s.X, omega), rbdi_cross(omega, s.P)};
    }

    /* Entries of dof j of link i and the dofs on the path, to which its columns go one after the other. */
    void put_columns(int i, int j) {
        const subtree &s = subtrees[size_t(i)];
        const motions &own = motion[size_t(j)];
        const number mass = rbdi_set(m->link[i].subtree_mass);
        const rbdi_force none = rbdi_force0();
        columns c = {none, none, none, none.n};
        c.D = inertia_times(s, mass, own.U);
        c.D = rbdi_force_add(B_times(s, own.S.omega), c.D);
        for (int k : dofs_of(i)) put(BY_V, k, j, rbdi_power(motion[size_t(k)].S, c.D));
        walk(i, c, [&](int k, const motions &x, const columns &y) { put(BY_V, k, j, rbdi_power(x.S, y.D)); });
        c.D = none;
        c.E = inertia_times(s, mass, own.Phi);
        c.E = rbdi_force_add(B_times(s, own.Psi.omega), c.E);
        c.E = rbdi_force_add(c.E, force_cross(own.S, s.f));
        walk(i, c, [&](int k, const motions &x, const columns &y) { put(BY_Q, k, j, rbdi_power(x.S, y.E)); });
        c.E = none;
        c.F = inertia_times(s, mass, own.S);
        c.T = rbdi_add(mul_trace_less(rbdi_transpose(s.X), own.S.omega), rbdi_cross(s.P, own.S.v));
        for (int k : dofs_of(i)) {
            const motions &x = motion[size_t(k)];
            put(BY_Q, j, k, rbdi_dot(x.Psi.omega, c.T) + rbdi_power(x.Phi, c.F));
        }
        walk(i, c, [&](int k, const motions &x, const columns &y) {
            put(BY_V, j, k, rbdi_dot(x.S.omega, y.T) + rbdi_power(x.U, y.F));
            put(BY_Q, j, k, rbdi_dot(x.Psi.omega, y.T) + rbdi_power(x.Phi, y.F));
        });
    }
    /* visit(dof, its motions, the columns there) from the parent of link i to the root. */
    template <class function> void walk(int i, columns c, function visit) const {
        while (m->link[i].parent >= 0) {
            const offset &d = offsets[size_t(i)];
            c.T = up(i, rbdi_add(c.T, rbdi_cross(d.u_z, c.F.f)));
            c.F = up(i, c.F), c.D = up(i, c.D), c.E = up(i, c.E);
            c.T = rbdi_add(c.T, rbdi_cross(d.u_r, c.F.f));
            i = m->link[i].parent;
            for (int k : dofs_of(i)) visit(k, motion[size_t(k)], c);
        }
    }
    /* With mimic joints a result is G' (.) G. */
    void put(int result, int i, int j, number y) {
        const int row = m->order[i].dof, column = m->order[j].dof;
        if (!out[result]) return;
        number *to = &out[result][rbdi_source(m, row) * m->nv + rbdi_source(m, column)];
        *to = *to + y * (rbdi_ratio(m, row) * rbdi_ratio(m, column));
    }
};

/* ---- the calls ---- */

static rbd_status record_derivatives(const call &c, const number *v, const number *a, const number *f_ext,
                                     number *by_q, number *by_v, bool coriolis) {
    rbdi_joints(c.m, c.w, rbdi_expand_q(c.m, c.w, c.q));
    v = rbdi_expand_v(c.m, v, c.w->vx), a = rbdi_expand_v(c.m, a, c.w->ax);
    dynamics_derivatives(c.m, c.w, v, a, c.w->gravity, f_ext, coriolis).run(by_q, by_v);
    return RBD_OK;
}

/* The steps of rbd_fd_derivatives, which says why a free base has no linear velocity and no gravity
   meanwhile. */
static rbd_status record_fd_derivatives(const call &c) {
    const rbd_model *m = c.m;
    const int nv = m->nv, base = c.d->base, unsolved = base ? 4 : 0;
    const rbdi_c3 gravity = c.w->gravity, felt = base ? rbdi_c3{0, 0, 0} : gravity;
    number *a = c.d->a, *by_q = c.out[1], *by_v = c.out[2], *H = c.w->H, *turn[3];
    std::vector<number> moving(c.v, c.v + nv);
    for (int k = 3; k < base; k++) moving[size_t(k)] = 0;
    const number *v = rbdi_expand_v(m, moving.data(), c.w->vx);
    rbd_crba_packed(m, c.w, c.q, H);
    c.w->gravity = felt;
    rbd_bias(m, c.w, c.q, moving.data(), c.f_ext, a);
    c.w->gravity = gravity;
    for (int k = 0; k < nv; k++) a[k] = c.tau[k] - a[k];
    rbdi_factor(m, c.w, H);
    rbdi_invert(m, c.w, H, c.out[3]);
    rbdi_solve(m, c.w, H, a);
    dynamics_derivatives(m, c.w, v, rbdi_expand_v(m, a, c.w->ax), felt, c.f_ext, false).run(by_q, by_v);
    if (base) rbdi_place_turns(by_q, by_v, turn);
    for (int i = 0; base && i < nv * nv; i += nv)
        for (int k = 0; k < 3; k++) turn[k][i] = by_v[i + k];
    rbdi_solve_two(m, c.w, H, -1, nv, nv - unsolved, by_q + unsolved, by_v + unsolved);
    if (base) rbdi_from_base(m, c.d, c.v, by_q, by_v);
    for (int k = 0; k < nv; k++) c.out[0][k] = a[k];
    return RBD_OK;
}

/* The recording in place of that of rbd.h's call; NULL if there is none. */
static rbd_status (*record_of(const std::string &name))(const call &c) {
    if (name == "constrained_id") return record_constrained_id;
    if (name == "fd_derivatives") return record_fd_derivatives;
    if (name == "id_derivatives")
        return
            [](const call &c) { return record_derivatives(c, c.v, c.a, c.f_ext, c.out[0], c.out[1], false); };
    if (name == "gravity_torque_derivatives")
        return [](const call &c) {
            return record_derivatives(c, c.w->zero, c.w->zero, NULL, c.out[0], NULL, false);
        };
    if (name == "coriolis")
        return
            [](const call &c) { return record_derivatives(c, c.v, c.w->zero, NULL, NULL, c.out[0], true); };
    return NULL;
}
