#ifndef RBDI_ACTUATOR_EXPONENTIAL_H
#define RBDI_ACTUATOR_EXPONENTIAL_H
#include "base/scalar.h"

/* ---- exponential [exponential] ----
   Exponential and logarithm from sums and products alone, as libm's differ between machines. Errors are below
   4 roundings. */

#define RBDI_LOG2_HIGH RBD_C(0.693145751953125) /* log 2 in two parts: multiples of the first are exact */
#define RBDI_LOG2_LOW RBD_C(1.42860682030941723e-6)
#if RBDI_REAL_KIND == 2
#define RBDI_EXP_TERMS 7
#define RBDI_LOG_TERMS 5
#else
#define RBDI_EXP_TERMS 14
#define RBDI_LOG_TERMS 12
#endif

/* 2^k for |k| <= 127. */
RBDI_PART rbd_real rbdi_act_power_of_two(int k) {
    rbd_real power = rbdi_set(RBD_C(1)), base = rbdi_set(k < 0 ? RBD_C(0.5) : RBD_C(2));
    for (int n = k < 0 ? -k : k; n > 0; n /= 2) {
        if (n % 2) power = power * base;
        base = base * base;
    }
    return power;
}

/* exp(x) for x up to 80; 0 below -80: 2^k and the result are finite and normal in float. */
RBDI_PART rbd_real rbdi_act_exponential(rbd_real x) {
    rbd_real r, sum = rbdi_set(RBD_C(1));
    int k;
    if (!(x > RBD_C(-80))) return rbdi_zero();

    /* x = k log 2 + r, |r| <= log(2) / 2;  exp(r) = 1 + r (1 + r/2 (1 + r/3 (...))) */
    k = (int)(x * RBD_C(1.4426950408889634) + (x < 0 ? RBD_C(-0.5) : RBD_C(0.5)));
    r = (x - (rbd_real)k * RBDI_LOG2_HIGH) - (rbd_real)k * RBDI_LOG2_LOW;
    for (int n = RBDI_EXP_TERMS; n > 0; --n) sum = 1 + sum * r / (rbd_real)n;
    return sum * rbdi_act_power_of_two(k);
}

/* log(x) for x from 1e-30 to 1e30. */
RBDI_PART rbd_real rbdi_act_logarithm(rbd_real x) {
    const rbd_const power[7] = {RBD_C(18446744073709551616.0), RBD_C(4294967296.0), 65536, 256, 16, 4, 2};
    rbd_real f, square, sum = rbdi_zero();
    int k = 0;

    /* x = 2^k y, y from sqrt(1/2) to sqrt(2); power[i] = 2^(64 >> i) */
    for (int i = 0; i < 7; ++i) {
        if (x >= power[i]) {
            x = x / power[i];
            k += 64 >> i;
        } else if (x * power[i] < 2) {
            x = x * power[i];
            k -= 64 >> i;
        }
    }
    if (x > RBD_C(1.4142135623730951)) {
        x = x / 2;
        k += 1;
    }

    /* log y = 2 (f + f^3/3 + f^5/5 + ...), f = (y - 1) / (y + 1) */
    f = (x - 1) / (x + 1);
    square = f * f;
    for (int n = RBDI_LOG_TERMS; n >= 0; --n) sum = sum * square + 1 / (rbd_real)(2 * n + 1);
    return (2 * f * sum + (rbd_real)k * RBDI_LOG2_LOW) + (rbd_real)k * RBDI_LOG2_HIGH;
}

#endif
