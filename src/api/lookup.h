#ifndef RBDI_API_LOOKUP_H
#define RBDI_API_LOOKUP_H
#include "api/symbols.h"
#include "api/types.h"
#include "api/status.h"

/* ---- lookup [lookup] ---- */

RBDI_API int rbd_nb(const rbd_model *m); /* number of bodies */
RBDI_API int rbd_nq(const rbd_model *m); /* length of q */
RBDI_API int rbd_nv(const rbd_model *m); /* length of v, a, tau: degrees of freedom */

/* Index of the body with this name of its link, or of its joint; -1 if there is none. */
RBDI_API int rbd_body_index(const rbd_model *m, const char *name);
RBDI_API int rbd_joint_index(const rbd_model *m, const char *name);

/* Names of a body's link and of its joint; NULL if it is nameless or there is no such body. */
RBDI_API const char *rbd_body_name(const rbd_model *m, int body);
RBDI_API const char *rbd_joint_name(const rbd_model *m, int body);

/* The joint of a body: its type, its entries of q and v, its limits. Errors: RBD_ERR_NULL, _INDEX. */
typedef struct rbd_joint_info {
    rbd_joint_type type;
    int iq, nq, iv, nv;     /* q[iq] .. q[iq + nq - 1], v likewise; mimic, fixed: nq = nv = 0, iq = iv = -1 */
    rbd_const lower, upper; /* rad or m; both 0: none */
    rbd_const velocity, effort; /* as in rbd_body */
} rbd_joint_info;
RBDI_API rbd_status rbd_joint(const rbd_model *m, int body, rbd_joint_info *info);

/* The body whose joint has this degree of freedom, -1 if there is none. */
RBDI_API int rbd_dof_body(const rbd_model *m, int dof);

#ifndef RBD_NO_BUILD /* because it computes in double */
/* Reads a body back from any model, tables too, as a row from which rbd_model_build makes the same, to
   rounding. Its parent is the next body towards the root whose joint moves; bodies fixed between them are
   left out. Axes have unit length. Errors: RBD_ERR_NULL, _INDEX. */
RBDI_API rbd_status rbd_describe(const rbd_model *m, int body, rbd_body *row);
#endif

#endif
