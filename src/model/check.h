#ifndef RBDI_MODEL_CHECK_H
#define RBDI_MODEL_CHECK_H
#include "model/work.h"
#include "base/memory.h"
#include "model/describe.h"

/* ---- model build [model build] ----
   From the description to the model, in the caller's memory. Steps:
     checks   rbdi_check_body; after step 2 rbdi_check_moves: the first error ends the build
     1, 2     rbdi_build_joint, rbdi_build_mass: the links of each joint, in the user's frames; their moments
     3, 4     rbdi_build_axis: joint axis on z; rbdi_build_order: depth first, favourite child next
     5        rbdi_build_measure: mass and moments of each subtree
     6        rbdi_build_normalise: root to leaves, Denavit and Hartenberg's form where it loses no digit
     7, 8     rbdi_build_scale: bounds of the pivots; rbdi_build_regroup: leaves to root, base parameters
     9, 10    rbdi_emit_link, rbdi_emit_tree, called by rbdi_emit: constants, dofs, packed rows, frames */

/* -- small dense algebra of the build -- */

RBDI_LOCAL int rbdi_nonzero(rbdi_wide x) { return x < 0 || x > 0; }

/* Scales (c, s) to the unit circle, and moves it to the nearest right angle if one is as close as this,
   rad. */
RBDI_LOCAL void rbdi_w_snap(rbdi_wide *c, rbdi_wide *s, rbdi_wide close) {
    rbdi_wide length = RBDI_WIDE_LIBM(rbdi_root)(*c * *c + *s * *s);

    *c /= length;
    *s /= length;

    if (rbdi_w_abs(*s) <= close) {
        *c = *c > 0 ? 1 : -1;
        *s = 0;
    }

    if (rbdi_w_abs(*c) <= close) {
        *s = *s > 0 ? 1 : -1;
        *c = 0;
    }
}

/* Sine and cosine of an angle of at most 90 degrees, to 1e-29: sums of their series, which give the same bits
   everywhere. */
RBDI_LOCAL void rbdi_w_series(rbdi_wide x, rbdi_wide *sine, rbdi_wide *cosine) {
    const rbdi_wide x2 = x * x;
    rbdi_wide sum_c = 1, sum_s = 1;

    for (int k = RBDI_TAIL_TERMS; k > 0; --k) {
        sum_c = 1 - sum_c * x2 / (2 * k * (2 * k - 1));
        sum_s = 1 - sum_s * x2 / (2 * k * (2 * k + 1));
    }

    *sine = x * sum_s;
    *cosine = sum_c;
}

/* Angle, at most 45 degrees, from its cosine and sine: rbdi_signed_angle in the build's arithmetic. */
RBDI_LOCAL rbdi_wide rbdi_w_angle(rbdi_wide c, rbdi_wide s) {
    rbdi_wide sine = rbdi_w_abs(s), t = sine / (1 + c);
    rbdi_wide angle = t * (2 - (rbdi_wide)RBDI_ANGLE_START * t * t);

    for (int i = 0; i < 4; ++i) {
        rbdi_wide sine_of, cosine_of;
        rbdi_w_series(angle, &sine_of, &cosine_of);
        angle += sine * cosine_of - c * sine_of;
    }

    return s < 0 ? -angle : angle;
}

/* Adds moments of mass (Sigma, h, mass) to those of a link, in whose frame a point x is A x + t: h_new = A h
   + mass t, Sigma_new = A Sigma A' + t (A h)' + h_new t'. */
RBDI_LOCAL void rbdi_add_moments(rbdi_build_link *to, const rbdi_wide A[9], const rbdi_wide t[3],
                                 const rbdi_wide Sigma[6], const rbdi_wide h[3], rbdi_wide mass) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    rbdi_wide full[9], turned[9], Ah[3], T[9];

    for (int k = 0; k < 6; ++k) full[3 * row[k] + column[k]] = full[3 * column[k] + row[k]] = Sigma[k];
    rbdi_w_product(A, full, turned);
    rbdi_w_transpose(A, T);
    rbdi_w_product(turned, T, full);
    rbdi_w_apply(A, h, Ah);

    for (int k = 0; k < 6; ++k) {
        int i = row[k], j = column[k];
        to->Sigma[k] += full[3 * i + j] + t[i] * Ah[j] + (Ah[i] + mass * t[i]) * t[j];
    }

    for (int i = 0; i < 3; ++i) to->h[i] += Ah[i] + mass * t[i];
    to->mass += mass;
}

/* Changes a link's frame, and so its moments: the point x becomes A x + t. */
RBDI_LOCAL void rbdi_change_moments(rbdi_build_link *l, const rbdi_wide A[9], const rbdi_wide t[3]) {
    rbdi_build_link old = *l;
    for (int k = 0; k < 6; ++k) l->Sigma[k] = 0;
    for (int k = 0; k < 3; ++k) l->h[k] = 0;
    l->mass = 0;
    rbdi_add_moments(l, A, t, old.Sigma, old.h, old.mass);
}

/* -- the checks -- */

RBDI_LOCAL int rbdi_parallel(const double axis[3], const double axis2[3]) {
    rbdi_wide x[3], y[3], cross[3];
    rbdi_widen(axis, 3, x);
    rbdi_widen(axis2, 3, y);
    rbdi_unit(x, x);
    rbdi_unit(y, y);
    for (int k = 0; k < 3; ++k) cross[k] = x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3];
    return !(rbdi_w_length(cross) > RBDI_PARALLEL);
}

RBDI_LOCAL int rbdi_is_axis(const double axis[3]) { return rbdi_finite(axis, 3) && !rbdi_all_zero(axis, 3); }

RBDI_LOCAL void rbdi_warn_saying(rbd_report *report, rbd_status status, int body, const char *name,
                                 const char *field, const char *sentence) {
    if (report->warnings < RBD_MAX_WARNINGS) {
        rbd_finding *f = &report->warning[report->warnings];
        f->status = status;
        f->body = body;
        f->name = name;
        f->field = field;
        f->text = sentence;
    }

    ++report->warnings;
}

RBDI_LOCAL void rbdi_warn(rbd_report *report, rbd_status status, int body, const char *name,
                          const char *field) {
    rbdi_warn_saying(report, status, body, name, field, NULL);
}

/* Warns of an inertia that no real body has. I must be positive semi-definite, and so must Sigma = tr(I)/2 -
   I (the triangle inequalities of the principal moments). Dynamics computes with others too. */
RBDI_LOCAL void rbdi_check_inertia(const rbd_body *b, int i, rbd_report *report) {
    const double *I = b->inertia, trace = I[0] + I[3] + I[5];
    double size = 0, Sigma[6];

    for (int k = 0; k < 6; ++k) {
        size += I[k] < 0 ? -I[k] : I[k];
        Sigma[k] = (k == 0 || k == 3 || k == 5 ? trace / 2 : 0) - I[k];
    }

    if (!(size > 0)) {
        if (b->mass > 0) rbdi_warn(report, RBD_WARN_INERTIA_ZERO, i, b->name, "inertia");
        return;
    }

    if (!(b->mass > 0)) rbdi_warn(report, RBD_WARN_MASS_ZERO, i, b->name, "mass");
    if (!rbdi_semidefinite(I, size))
        rbdi_warn(report, RBD_WARN_INERTIA_NEGATIVE, i, b->name, "inertia");
    else if (!rbdi_semidefinite(Sigma, size))
        rbdi_warn(report, RBD_WARN_INERTIA_TRIANGLE, i, b->name, "inertia");
}

/* Whether a joint has limits as the model stores them: in float they may be equal. */
RBDI_LOCAL int rbdi_is_limited(const rbd_body *b) {
    return rbdi_has_limits((int)b->type) && RBD_C(b->lower) < RBD_C(b->upper);
}

/* Warns of limits that are set and mean none. */
RBDI_LOCAL void rbdi_check_limits(const rbd_body *b, int i, rbd_report *report) {
    const char *sentence = "not below upper: read as no limits";
    if (rbdi_all_zero(&b->lower, 1) && rbdi_all_zero(&b->upper, 1)) return;
    if (rbdi_is_limited(b)) return;

    if (b->lower < b->upper) sentence = "as near to upper as rounding: read as no limits";
    if (!rbdi_has_limits((int)b->type)) sentence = "limits of a joint whose type has none: read as none";
    rbdi_warn_saying(report, RBD_WARN_LIMITS, i, b->name, "lower", sentence);
}

/* A limit x of a body's joint as a limit of the joint that it mimics, if any: x = ratio q + offset. */
RBDI_LOCAL rbd_const rbdi_source_limit(const rbd_body *b, double x) {
    return b->mimic ? (RBD_C(x) - RBD_C(b->mimic_offset)) / RBD_C(b->mimic_ratio) : RBD_C(x);
}

/* Whether two joints with limits, of which one mimics the other or both mimic a third one, cannot both be
   within their limits. */
RBDI_LOCAL int rbdi_limits_contradict(const rbd_body *one, const rbd_body *two) {
    const rbd_body *of[2] = {one, two};
    rbd_const lower[2], upper[2];
    if (!rbdi_is_limited(one) || !rbdi_is_limited(two)) return 0;

    for (int k = 0; k < 2; ++k) {
        const int turned = of[k]->mimic && of[k]->mimic_ratio < 0;
        lower[k] = rbdi_source_limit(of[k], turned ? of[k]->upper : of[k]->lower);
        upper[k] = rbdi_source_limit(of[k], turned ? of[k]->lower : of[k]->upper);
    }

    return upper[0] < lower[1] || upper[1] < lower[0];
}

/* Warns of each joint that mimics another if its limits contradict those of that joint, or of a joint before
   it that mimics the same one. Ranges of one coordinate have a place in common if each two of them have. */
RBDI_LOCAL void rbdi_check_followers(const rbd_body *bodies, int nb, rbd_report *report) {
    for (int i = 0; i < nb; ++i) {
        const rbd_body *b = &bodies[i];
        int contradicts = 0;
        if (!b->mimic) continue;

        for (int j = 0; j < nb; ++j) {
            const int source = j != i && rbdi_same(bodies[j].joint, b->mimic);
            const int beside = j < i && rbdi_same(bodies[j].mimic, b->mimic);
            if (source || beside) contradicts |= rbdi_limits_contradict(b, &bodies[j]);
        }

        if (contradicts)
            rbdi_warn_saying(report, RBD_WARN_LIMITS, i, b->name, "lower",
                             "no place of the joint that it mimics is within the limits of all");
    }
}

/* Index of the body whose joint body i mimics, -1 if there is none that can be followed. */
RBDI_LOCAL int rbdi_mimic_source(const rbd_body *bodies, int nb, int i) {
    for (int j = 0; j < nb; ++j)
        if (j != i && rbdi_same(bodies[j].joint, bodies[i].mimic))
            return rbdi_can_mimic((int)bodies[j].type) && !bodies[j].mimic ? j : -1;
    return -1;
}

/* -- a row of the description: the first condition that fails is the report's error -- */

RBDI_LOCAL rbd_status rbdi_check_names(const rbd_body *bodies, int i, rbd_report *report) {
    const rbd_body *b = &bodies[i];
    for (int j = 0; j < i; ++j) {
        if (rbdi_same(b->name, bodies[j].name)) return rbdi_refuse(report, RBD_ERR_NAME, i, b->name, "name");
        if (rbdi_same(b->joint, bodies[j].joint))
            return rbdi_refuse(report, RBD_ERR_NAME, i, b->name, "joint");
    }
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_check_joint(const rbd_body *b, int i, rbd_report *report) {
    const int type = (int)b->type;
    int axes;
    if (b->parent < -1 || b->parent >= i) return rbdi_refuse(report, RBD_ERR_PARENT, i, b->name, "parent");
    if (type < 0 || type >= RBD_JOINT_TYPES) return rbdi_refuse(report, RBD_ERR_TYPE, i, b->name, "type");
    if (type == RBD_FIXED && !rbdi_all_zero(b->axis, 3))
        return rbdi_refuse_saying(report, RBD_ERR_TYPE, i, b->name, "type",
                                  "missing? it is 0, fixed, but the joint has an axis");

    axes = rbdi_described_axes(type);
    if (axes > 0 && !rbdi_is_axis(b->axis)) return rbdi_refuse(report, RBD_ERR_AXIS, i, b->name, "axis");
    if (axes > 1 && (!rbdi_is_axis(b->axis2) || rbdi_parallel(b->axis, b->axis2)))
        return rbdi_refuse(report, RBD_ERR_AXIS, i, b->name, "axis2");

    if (!rbdi_finite(&b->pitch, 1)) return rbdi_refuse(report, RBD_ERR_PITCH, i, b->name, "pitch");
    if (!rbdi_finite(b->position, 3)) return rbdi_refuse(report, RBD_ERR_POSITION, i, b->name, "position");
    if (!rbdi_is_rotation(b->rotation)) return rbdi_refuse(report, RBD_ERR_ROTATION, i, b->name, "rotation");
    return RBD_OK;
}

/* The body's inertia, and the armature, damping, friction and limits of its joint. */
RBDI_LOCAL rbd_status rbdi_check_numbers(const rbd_body *b, int i, rbd_report *report) {
    if (!rbdi_finite_positive(&b->mass, 1)) return rbdi_refuse(report, RBD_ERR_MASS, i, b->name, "mass");
    if (!rbdi_finite(b->com, 3)) return rbdi_refuse(report, RBD_ERR_COM, i, b->name, "com");
    if (!rbdi_finite(b->inertia, 6)) return rbdi_refuse(report, RBD_ERR_INERTIA, i, b->name, "inertia");

    if (!rbdi_finite_positive(b->armature, 6))
        return rbdi_refuse(report, RBD_ERR_ARMATURE, i, b->name, "armature");
    if (!rbdi_finite_positive(b->damping, 6))
        return rbdi_refuse(report, RBD_ERR_DAMPING, i, b->name, "damping");
    if (!rbdi_finite_positive(b->friction, 6))
        return rbdi_refuse(report, RBD_ERR_FRICTION, i, b->name, "friction");

    if (!rbdi_finite(&b->lower, 1)) return rbdi_refuse(report, RBD_ERR_LIMITS, i, b->name, "lower");
    if (!rbdi_finite(&b->upper, 1)) return rbdi_refuse(report, RBD_ERR_LIMITS, i, b->name, "upper");
    if (!rbdi_finite_positive(&b->velocity, 1))
        return rbdi_refuse(report, RBD_ERR_LIMITS, i, b->name, "velocity");
    if (!rbdi_finite_positive(&b->effort, 1))
        return rbdi_refuse(report, RBD_ERR_LIMITS, i, b->name, "effort");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_check_mimic(const rbd_body *bodies, int nb, int i, rbd_report *report) {
    const rbd_body *b = &bodies[i];
    if (!b->mimic) return RBD_OK;
    if (!rbdi_can_mimic((int)b->type) || rbdi_mimic_source(bodies, nb, i) < 0)
        return rbdi_refuse(report, RBD_ERR_MIMIC, i, b->name, "mimic");
    if (!rbdi_finite(&b->mimic_ratio, 1))
        return rbdi_refuse_saying(report, RBD_ERR_MIMIC, i, b->name, "mimic_ratio", "not finite");
    if (!(RBD_C(b->mimic_ratio) < 0 || RBD_C(b->mimic_ratio) > 0))
        return rbdi_refuse_saying(report, RBD_ERR_MIMIC, i, b->name, "mimic_ratio",
                                  "missing or 0: a joint that shall stand still is a fixed joint");
    if (!rbdi_finite(&b->mimic_offset, 1))
        return rbdi_refuse(report, RBD_ERR_MIMIC, i, b->name, "mimic_offset");
    return RBD_OK;
}

RBDI_LOCAL rbd_status rbdi_check_body(const rbd_body *bodies, int nb, int i, rbd_report *report) {
    rbd_status status = rbdi_check_names(bodies, i, report);
    if (!status) status = rbdi_check_joint(&bodies[i], i, report);
    if (!status) status = rbdi_check_numbers(&bodies[i], i, report);
    if (!status) status = rbdi_check_mimic(bodies, nb, i, report);
    if (status) return status;

    rbdi_check_inertia(&bodies[i], i, report);
    rbdi_check_limits(&bodies[i], i, report);
    return RBD_OK;
}

/* Every joint must move mass, inertia or armature: of its body, of bodies fixed to it or moved with it, or of
   joints that mimic it. */
RBDI_LOCAL rbd_status rbdi_check_moves(const rbd_body *bodies, int nb, rbdi_place *place,
                                       rbd_report *report) {
    rbd_status status = RBD_OK;

    for (int i = 0; i < nb; ++i) place[i].moves = bodies[i].mimic != NULL;
    for (int i = 0; i < nb; ++i)
        if (bodies[i].mimic) place[rbdi_mimic_source(bodies, nb, i)].moves = 1;

    for (int i = nb - 1; i >= 0; --i) {
        const rbd_body *b = &bodies[i];
        const int fixed = b->type == RBD_FIXED;
        if (b->mass > 0 || !rbdi_all_zero(b->inertia, 6)) place[i].moves = 1;
        if (!rbdi_all_zero(b->armature, rbdi_joint_facts((int)b->type)->nv)) place[i].moves = 1;
        if (!fixed && !place[i].moves) status = rbdi_refuse(report, RBD_ERR_LEAF, i, b->name, "mass");
        if (b->parent >= 0 && (!fixed || place[i].moves)) place[b->parent].moves = 1;
    }

    return status;
}

/* Marks the bodies whose joint moves mass or inertia, or has armature; or such a joint mimics it, or it
   mimics one. Unlike rbdi_check_moves this is strict: armature of a joint is none of the joints that carry
   it. */
RBDI_LOCAL void rbdi_mark_movers(const rbd_body *bodies, int nb, rbdi_place *place) {
    for (int i = 0; i < nb; ++i) place[i].moves = bodies[i].mass > 0 || !rbdi_all_zero(bodies[i].inertia, 6);
    for (int i = nb - 1; i >= 0; --i)
        if (bodies[i].parent >= 0 && place[i].moves) place[bodies[i].parent].moves = 1;

    for (int i = 0; i < nb; ++i)
        if (!rbdi_all_zero(bodies[i].armature, rbdi_joint_facts((int)bodies[i].type)->nv)) place[i].moves = 1;

    for (int i = 0; i < nb; ++i)
        if (bodies[i].mimic && place[i].moves) place[rbdi_mimic_source(bodies, nb, i)].moves = 1;
    for (int i = 0; i < nb; ++i)
        if (bodies[i].mimic) place[i].moves = place[rbdi_mimic_source(bodies, nb, i)].moves;
}

/* The first dof of the first body whose joint moves no mass, or of the joint that it mimics; -1 if there is
   none. */
RBDI_LOCAL int rbdi_massless_dof_of(const rbd_body *bodies, int nb, rbdi_place *place) {
    rbdi_mark_movers(bodies, nb, place);
    for (int i = 0; i < nb; ++i)
        if (bodies[i].type != RBD_FIXED && !place[i].moves)
            return place[bodies[i].mimic ? rbdi_mimic_source(bodies, nb, i) : i].iv;
    return -1;
}

/* -- the steps of the build -- */

/* Lengths of the model's arrays. */
typedef struct rbdi_counts {
    int nl, nblock, ndof, nmimic, nq, nv;
} rbdi_counts;

/* A build: the description, the model with its arrays, and scratch behind them. */
typedef struct rbdi_build {
    const rbd_body *bodies;
    int nb;
    rbdi_counts n;
    int massless; /* the first dof that moves no mass, -1: none */
    rbd_model *m;
    RBDI_MODEL_ARRAYS(RBDI_ARRAY_FIELD, 0, 0, 0, 0, 0)
} rbdi_build;

RBDI_LOCAL rbdi_counts rbdi_count(const rbd_body *bodies, int nb) {
    rbdi_counts n = {0, 0, 0, 0, 0, 0};

    for (int i = 0; i < nb; ++i) {
        const rbdi_joint_fact *fact = rbdi_joint_facts((int)bodies[i].type);

        n.nl += rbdi_links_of((int)bodies[i].type);
        n.nblock += fact->nv > 0 && !fact->axes[0];
        n.ndof += fact->nv;
        n.nmimic += bodies[i].mimic != NULL;

        if (!bodies[i].mimic) {
            n.nq += fact->nq;
            n.nv += fact->nv;
        }
    }

    return n;
}

#endif
