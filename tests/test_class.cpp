// test_class.cpp - the library with a C++ class as its scalar: dual numbers, value + slope e, e e = 0.
// What the class has is exactly what rbd.h asks for, and no more. Derivatives that fall out of it are
// compared with the reference's.
#include <cmath>

namespace test {

class dual {
  public:
    double value, slope;
    dual() = default; // trivial: the library's memory is raw
    dual(double constant) : value(constant), slope(0) {}
    dual(double value_, double slope_) : value(value_), slope(slope_) {}
};

inline dual operator+(dual a, dual b) { return dual(a.value + b.value, a.slope + b.slope); }
inline dual operator-(dual a, dual b) { return dual(a.value - b.value, a.slope - b.slope); }
inline dual operator-(dual a) { return dual(-a.value, -a.slope); }
inline dual operator*(dual a, dual b) {
    return dual(a.value * b.value, a.slope * b.value + a.value * b.slope);
}
inline dual operator/(dual a, dual b) {
    const double ratio = a.value / b.value;
    return dual(ratio, (a.slope - ratio * b.slope) / b.value);
}
inline bool operator<(dual a, dual b) { return a.value < b.value; }
inline dual sin(dual a) { return dual(std::sin(a.value), std::cos(a.value) * a.slope); }
inline dual cos(dual a) { return dual(std::cos(a.value), -std::sin(a.value) * a.slope); }
inline dual sqrt(dual a) {
    const double root = std::sqrt(a.value);
    return dual(root, a.slope > 0 || a.slope < 0 ? a.slope / (2 * root) : 0);
}

} // namespace test

#define RBD_REAL test::dual
#define RBD_REAL_CUSTOM
#define SCALAR_CLASS
#define SCALAR_NAME "C++ class"
#define SCALAR_GET(x) ((x).value)
#include "scalars.c"

#include "rbd_spatial.h"

// One column of d tau / dv and of d qdd / dv a call.
static void check_velocity_derivatives() {
    const int nv = reference->nv;
    const ref_state *s = lane_state[0];
    static double dtau[MAX_M], dqdd[MAX_M];
    for (int k = 0; k < nv; k++) {
        v[k].slope = 1;
        RUN(rbd_rnea(model, work, q, v, a, NULL, found));
        for (int i = 0; i < nv; i++) dtau[i * nv + k] = found[i].slope;
        RUN(rbd_aba(model, work, q, v, tau, NULL, found));
        for (int i = 0; i < nv; i++) dqdd[i * nv + k] = found[i].slope;
        v[k].slope = 0;
    }
    static rbd_real x[MAX_M];
    for (int i = 0; i < nv * nv; i++) x[i] = dtau[i];
    compare("d tau / dv", 0, x, s->dtau_dv, nv * nv, CANCELLED);
    for (int i = 0; i < nv * nv; i++) x[i] = dqdd[i];
    compare("d qdd / dv", 0, x, s->dqdd_dv, nv * nv, INVERSE(s->cond_M));
}

// d tau / dq along tangent steps: integrate differentiates itself too.
static void check_configuration_derivatives() {
    const int nv = reference->nv;
    static rbd_real step[MAX_V], moved[MAX_Q], x[MAX_M];
    for (int k = 0; k < nv; k++) step[k] = 0;
    for (int k = 0; k < nv; k++) {
        step[k].slope = 1;
        RUN(rbd_integrate(model, q, step, 1, moved));
        step[k].slope = 0;
        RUN(rbd_rnea(model, work, moved, v, a, NULL, found));
        for (int i = 0; i < nv; i++) x[i * nv + k] = found[i].slope;
    }
    compare("d tau / dq", 0, x, lane_state[0]->dtau_dq, nv * nv, DIRECT);
}

START_TEST(derivatives_by_velocity_match_the_reference) { for_models(check_velocity_derivatives); }
END_TEST

START_TEST(derivatives_by_configuration_match_the_reference) { for_models(check_configuration_derivatives); }
END_TEST

// A frame carried along by v: the derivative of what goes up is the cross product.
START_TEST(spatial_vectors_carried_along_change_by_the_cross_products) {
    const rbd_real t(0, 1);
    const rbd_motion v = rbd_motion_of(rbd_vec3_of(0.3, -0.2, 0.7), rbd_vec3_of(1, 2, -3), 0);
    const rbd_motion m = rbd_motion_of(rbd_vec3_of(0.5, 0.1, -2), rbd_vec3_of(-1, 0.2, 3), 1);
    const rbd_force f = rbd_force_of(m.linear, m.angular, 1);
    const rbd_placement x = rbd_placement_exp(rbd_motion_scale(t, v), 1);
    rbd_real rate[6], cross[6];
    rbd_motion_to_array(rbd_motion_up(x, m), rate);
    rbd_motion_to_array(rbd_motion_cross(v, m), cross);
    for (int k = 0; k < 6; k++) ck_assert(std::fabs(rate[k].slope - cross[k].value) <= 1e-14);
    rbd_force_to_array(rbd_force_up(x, f), rate);
    rbd_force_to_array(rbd_force_cross(v, f), cross);
    for (int k = 0; k < 6; k++) ck_assert(std::fabs(rate[k].slope - cross[k].value) <= 1e-14);
}
END_TEST

static void add_more_tests(TCase *c) {
    tcase_add_test(c, spatial_vectors_carried_along_change_by_the_cross_products);
    tcase_add_test(c, derivatives_by_velocity_match_the_reference);
    tcase_add_test(c, derivatives_by_configuration_match_the_reference);
}
