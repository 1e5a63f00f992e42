#ifndef RBDI_ESTIMATE_TEXT_H
#define RBDI_ESTIMATE_TEXT_H
#include "base/pieces.h"
#include "api/estimate.h"

/* ---- estimate text [estimate text] ---- */

/* The sentence of an error, where that of rbd_status_string speaks of a model. */
RBDI_MESSAGES RBDI_PART const char *rbdi_est_sentence(rbd_status status) {
    switch ((int)status) {
    case RBD_ERR_RANGE: return "out of range";
    case RBD_ERR_NAN: return "not finite";
    case RBD_ERR_MEMORY: return "the memory is too small";
    case RBD_ERR_WORK: return "the memory is of another model";
    default: return rbd_status_string(status);
    }
}

RBDI_API char *rbd_estimate_text(rbd_status status, const rbd_estimate_fault *fault, char *text,
                                 size_t size) {
    const int named = status != RBD_OK && fault && fault->field;
    const char *piece[8];
    char digits[12];
    int n = 0;
    if (!text || size == 0) return text;

    if (named) {
        piece[n++] = fault->field;
        if (fault->at >= 0) {
            piece[n++] = "[";
            piece[n++] = rbdi_decimal(fault->at, digits);
            piece[n++] = "]";
        }
        piece[n++] = ": ";
    }
    piece[n++] = rbdi_est_sentence(status);
    return rbdi_join(piece, n, text, size);
}

#endif
