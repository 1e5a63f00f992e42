/* test_generated.c - rbd-bench with faults in the code generated for iiwa, by the variable FAULT: none, sign,
   nan (in one number of inverse dynamics) or status (of forward dynamics). SPDX-License-Identifier: MIT */
#define iiwa_code_id faulty_id
#define iiwa_code_fd faulty_fd
#include "../calls/library.c"
#undef iiwa_code_id
#undef iiwa_code_fd
#include <stdlib.h>
#include <string.h>

void iiwa_code_id(const double *q, const double *v, const double *a, const double *gravity, double *tau);
int iiwa_code_fd(const double *q, const double *v, const double *tau, const double *gravity, double *a);

static bool fault_is(const char *name) {
    const char *fault = getenv("FAULT");
    return fault && strcmp(fault, name) == 0;
}

void faulty_id(const double q[NQ], const double v[NV], const double a[NV], const double gravity[3],
               double tau[NV]) {
    iiwa_code_id(q, v, a, gravity, tau);
    if (fault_is("sign")) tau[NV - 1] = -tau[NV - 1];
    if (fault_is("nan")) tau[NV - 1] = nan("");
}

int faulty_fd(const double q[NQ], const double v[NV], const double tau[NV], const double gravity[3],
              double a[NV]) {
    const int status = iiwa_code_fd(q, v, tau, gravity, a);
    return fault_is("status") ? NV : status;
}
