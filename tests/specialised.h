/* specialised.h - what specialised_calls.c gives; include rbd.h before. */
#ifndef SPECIALISED_H
#define SPECIALISED_H

rbd_status special_rnea(const double *q, const double *v, const double *a, const double *f_ext, double *tau);
rbd_status special_crba(const double *q, double *M);
rbd_status special_aba(const double *q, const double *v, const double *tau, const double *f_ext, double *a);
rbd_status special_hybrid(const double *q, const double *v, const unsigned char *given, double *a,
                          double *tau);
const rbd_model *special_model(void);

#endif
