// autodiff.cpp - rbd with an automatic-differentiation class as its scalar: one call of inverse dynamics
// gives the torques of the iiwa and all their derivatives by q; checked against central differences.
#include <cmath>
#include <cstdio>
enum { N = 7 }; // IIWA_NV, which the class must know before rbd.h

// A value and its derivatives by N variables. The default constructor must be trivial: rbd's memory is raw.
struct dual {
    double x, d[N];
    dual() = default;
    dual(double constant) : x(constant), d() {}
};

// f(a, b) with the derivatives fa and fb by its arguments: the chain rule.
static dual chain(double f, double fa, const dual &a, double fb, const dual &b) {
    dual result(f);
    for (int i = 0; i < N; i++) result.d[i] = fa * a.d[i] + fb * b.d[i];
    return result;
}

static dual operator+(const dual &a, const dual &b) { return chain(a.x + b.x, 1, a, 1, b); }
static dual operator-(const dual &a, const dual &b) { return chain(a.x - b.x, 1, a, -1, b); }
static dual operator*(const dual &a, const dual &b) { return chain(a.x * b.x, b.x, a, a.x, b); }
static dual operator/(const dual &a, const dual &b) {
    return chain(a.x / b.x, 1 / b.x, a, -a.x / (b.x * b.x), b);
}
static dual operator-(const dual &a) { return chain(-a.x, -1, a, 0, a); }
static bool operator<(const dual &a, const dual &b) { return a.x < b.x; }
static dual sin(const dual &a) { return chain(std::sin(a.x), std::cos(a.x), a, 0, a); }
static dual cos(const dual &a) { return chain(std::cos(a.x), -std::sin(a.x), a, 0, a); }
static dual sqrt(const dual &a) { return chain(std::sqrt(a.x), 0.5 / std::sqrt(a.x), a, 0, a); }

#define RBD_REAL dual
#define RBD_REAL_CUSTOM
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "models/iiwa_model.h"
#include "larger.h"
static_assert(N == IIWA_NQ && N == IIWA_NV, "as many variables as joints");

static unsigned char memory[IIWA_WORK_SIZE];
static const double q0[N] = {0.3, -0.7, 1.1, 1.4, -0.2, 0.9, 0.5};
static const dual v[N] = {0.5, 1.0, -0.8, 0.3, 2.0, -1.5, 0.7}, a[N] = {1, -2, 3, -4, 5, -6, 7};

// Central differences of the torques by q[k].
static void differences(rbd_work *w, int k, double *slope) {
    const double h = 1e-6;
    dual q[N], ahead[N], behind[N];
    for (int i = 0; i < N; i++) q[i] = q0[i];
    q[k] = q0[k] + h;
    rbd_rnea(&iiwa_model, w, q, v, a, NULL, ahead);
    q[k] = q0[k] - h;
    rbd_rnea(&iiwa_model, w, q, v, a, NULL, behind);
    for (int i = 0; i < N; i++) slope[i] = (ahead[i].x - behind[i].x) / (2 * h);
}

int main() {
    rbd_work *w;
    dual q[N], tau[N];
    for (int i = 0; i < N; i++) {
        q[i] = q0[i];
        q[i].d[i] = 1; // q[i] is the i-th variable
    }
    if (rbd_work_init(&iiwa_model, memory, sizeof memory, &w) != RBD_OK ||
        rbd_rnea(&iiwa_model, w, q, v, a, NULL, tau) != RBD_OK)
        return std::puts("inverse dynamics failed"), 1;
    double worst = 0, slope[N];
    for (int k = 0; k < N; k++) {
        differences(w, k, slope);
        std::printf("by q%d:%9.4f%9.4f%9.4f   differences:%9.4f%9.4f%9.4f\n", k + 1, tau[0].d[k], tau[1].d[k],
                    tau[2].d[k], slope[0], slope[1], slope[2]);
        for (int i = 0; i < N; i++) worst = larger(worst, std::fabs(tau[i].d[k] - slope[i]));
    }
    std::printf("all 49 agree to 1e-6: %s\n", worst < 1e-6 ? "yes" : "no");
    return worst < 1e-6 ? 0 : 1;
}
