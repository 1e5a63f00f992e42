#ifndef RBDI_QP_TEXT_H
#define RBDI_QP_TEXT_H
#include "base/pieces.h"
#include "api/qp.h"

/* ---- text [text code] ---- */

RBDI_MESSAGES RBDI_PART const char *rbdi_qp_sentence(rbd_qp_status status) {
    switch (status) {
    case RBD_QP_OK: return "no error";
    case RBD_QP_INFEASIBLE: return "contradicts the other rows whose lambda is not 0";
    case RBD_QP_UNBOUNDED: return "unbounded: f falls along a way that H does not bend and no row ends";
    case RBD_QP_ITERATIONS: return "more steps or rounds would be needed";
    case RBD_QP_INACCURATE: return "solved, but not to the accuracy that the options ask for";
    case RBD_QP_CONVEX: return "H has a negative eigenvalue";
    case RBD_QP_SYMMETRIC: return "H is not symmetric";
    case RBD_QP_NAN: return "not a number, not finite, or too large";
    case RBD_QP_RANGE: return "negative or out of range";
    case RBD_QP_MEMORY: return "the memory is too small: RBD_QP_SIZE has the figure";
    case RBD_QP_NULL: return "a required pointer is NULL";
    case RBD_QP_SIDES: return "above upper";
    }
    return "unknown status";
}

RBDI_API char *rbd_qp_text(rbd_qp_status status, const rbd_qp_result *result, char *text, size_t size) {
    const char *piece[8];
    char digits[12];
    int n = 0;
    if (!text || size == 0) return text;

    if (result && result->at >= 0) {
        const int variable = !result->field || result->field[0] == 'H' || result->field[0] == 'f';
        piece[n++] = variable ? "variable " : "row ";
        piece[n++] = rbdi_decimal(result->at, digits);
        piece[n++] = ", ";
    }
    if (result && result->field) {
        piece[n++] = "field '";
        piece[n++] = result->field;
        piece[n++] = "': ";
    }
    piece[n++] = rbdi_qp_sentence(status);
    return rbdi_join(piece, n, text, size);
}

#endif
