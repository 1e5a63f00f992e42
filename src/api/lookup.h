#ifndef RBDI_API_LOOKUP_H
#define RBDI_API_LOOKUP_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- lookup [lookup] ---- */

RBDI_API int rbd_nb(const rbd_model *m); /* number of bodies */
RBDI_API int rbd_nq(const rbd_model *m); /* length of q */
RBDI_API int rbd_nv(const rbd_model *m); /* length of v, a, tau: degrees of freedom */

/* Index of a body by the name of its link, or of the joint that carries it; -1 if there is none. */
RBDI_API int rbd_body_index(const rbd_model *m, const char *name);
RBDI_API int rbd_joint_index(const rbd_model *m, const char *name);

/* Names, NULL if nameless or no such body. */
RBDI_API const char *rbd_body_name(const rbd_model *m, int body);
RBDI_API const char *rbd_joint_name(const rbd_model *m, int body);

/* Where the joint of a body lies in q and in v, and how much of them it has.
   Errors: RBD_ERR_NULL, _INDEX. */
typedef struct rbd_joint_info {
    rbd_joint_type type;
    int iq, nq, iv, nv;     /* a mimic or fixed joint has nq = nv = 0, iq = iv = -1 */
    rbd_const lower, upper; /* none if lower >= upper */
    rbd_const velocity, effort;
} rbd_joint_info;
RBDI_API rbd_status rbd_joint(const rbd_model *m, int body, rbd_joint_info *info);

/* The body whose joint has this degree of freedom, -1 if there is none. */
RBDI_API int rbd_dof_body(const rbd_model *m, int dof);

#ifndef RBD_NO_BUILD /* it computes in double */
/* Reads a body back from the model, of a table in flash too: a row from which rbd_model_build makes the same,
   to rounding. Its parent is the body whose joint carries it: bodies fixed between are left out. Axes are of
   unit length. Errors: RBD_ERR_NULL, _INDEX. */
RBDI_API rbd_status rbd_describe(const rbd_model *m, int body, rbd_body *row);
#endif

#endif
