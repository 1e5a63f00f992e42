#ifndef RBDI_IK_TEXT_H
#define RBDI_IK_TEXT_H
#include "base/pieces.h"
#include "api/ik.h"

/* ---- text [text code] ---- */

RBDI_MESSAGES RBDI_PART const char *rbdi_ik_sentence(rbd_ik_status status) {
    switch (status) {
    case RBD_IK_REACHED: return "all targets are reached";
    case RBD_IK_AT_LIMIT: return "not reached: the limit of this joint keeps the targets away";
    case RBD_IK_NEAREST: return "not reached: no small motion comes nearer";
    case RBD_IK_EVALUATIONS: return "not reached: more evaluations might come nearer";
    case RBD_IK_ERROR: return "an error, and no result that says which";
    }
    return "unknown status";
}

/* The sentence of an error, where that of rbd_status_string speaks of a model. */
RBDI_MESSAGES RBDI_PART const char *rbdi_ik_error(rbd_status error) {
    switch ((int)error) {
    case RBD_ERR_COUNT: return "fewer than 1 target, or more than 1000";
    case RBD_ERR_TYPE: return "no kind of target";
    case RBD_ERR_POSITION: return "not finite, or farther than 1e9 m";
    case RBD_ERR_AXIS: return "not finite, or of a length out of 1e-9 to 1e9";
    case RBD_ERR_INFEASIBLE: return "only a part of a spherical, planar or floating joint is held";
    case RBD_ERR_MASS: return "a centre of mass, but the robot has no mass";
    case RBD_ERR_NAN: return "not finite, or the errors overflow";
    default: return rbd_status_string(error);
    }
}

RBDI_API char *rbd_ik_text(rbd_ik_status status, const rbd_ik_result *result, char *text, size_t size) {
    const int failed = status == RBD_IK_ERROR && result;
    const char *piece[8];
    char digits[12];
    int n = 0;
    if (!text || size == 0) return text;

    if (failed && result->target >= 0) {
        piece[n++] = "target ";
        piece[n++] = rbdi_decimal(result->target, digits);
        piece[n++] = ", ";
    }
    if (failed && result->field) {
        piece[n++] = "field '";
        piece[n++] = result->field;
        piece[n++] = "': ";
    }
    if (status == RBD_IK_AT_LIMIT && result && result->limit >= 0) {
        piece[n++] = "dof ";
        piece[n++] = rbdi_decimal(result->limit, digits);
        piece[n++] = ": ";
    }
    piece[n++] = failed ? rbdi_ik_error(result->error) : rbdi_ik_sentence(status);
    return rbdi_join(piece, n, text, size);
}

#endif
