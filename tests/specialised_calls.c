/* specialised_calls.c - straight-line calls for one robot, by the pattern that rbd.h documents at
   RBD_LOCAL_WORK. Compiled with -DROBOT_MODEL=iiwa_model and the like. */
#define RBD_STATIC
#define RBD_SPECIALISE
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include ROBOT_HEADER

#include "specialised.h"

#define WORK RBD_LOCAL_WORK(w, ROBOT_MODEL, ROBOT_WORK_SIZE)

rbd_status special_rnea(const double *q, const double *v, const double *a, const double *f_ext, double *tau) {
    WORK;
    return rbd_rnea(&ROBOT_MODEL, w, q, v, a, f_ext, tau);
}

rbd_status special_crba(const double *q, double *M) {
    WORK;
    return rbd_crba(&ROBOT_MODEL, w, q, M);
}

rbd_status special_aba(const double *q, const double *v, const double *tau, const double *f_ext, double *a) {
    WORK;
    return rbd_aba(&ROBOT_MODEL, w, q, v, tau, f_ext, a);
}

#ifdef ROBOT_HYBRID
rbd_status special_hybrid(const double *q, const double *v, const unsigned char *given, double *a,
                          double *tau) {
    WORK;
    return rbd_hybrid(&ROBOT_MODEL, w, q, v, given, NULL, a, tau);
}
#endif

const rbd_model *special_model(void) { return &ROBOT_MODEL; }
