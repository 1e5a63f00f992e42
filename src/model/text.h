#ifndef RBDI_MODEL_TEXT_H
#define RBDI_MODEL_TEXT_H
#include "api/status.h"
#include "base/pieces.h"

/* Interface: rbdi_write_finding */

/* ---- text [text code] ---- */

RBDI_MESSAGES RBDI_API const char *rbd_status_string(rbd_status status) {
    switch (status) {
    case RBD_OK: return "no error";
    case RBD_ERR_NULL: return "a required pointer is NULL, as a work or set is until its _init succeeds";
    case RBD_ERR_MEMORY:
        return "the memory given is too small: rbd_model_size, rbd_work_size or another _size has the figure";
    case RBD_ERR_VERSION: return "the built model is of another version or scalar than this rbd.h";
    case RBD_ERR_INDEX: return "no such body";
    case RBD_ERR_ORDER: return "rbd_kinematics must be called first";
    case RBD_ERR_SINGULAR: return "the mass matrix is singular";
    case RBD_ERR_COUNT: return "the number of bodies, or of constraints, is out of range";
    case RBD_ERR_NAME: return "the name stands twice";
    case RBD_ERR_PARENT: return "not the index of an earlier body, nor -1 for the world";
    case RBD_ERR_TYPE: return "unknown joint type, or missing";
    case RBD_ERR_AXIS: return "zero or not finite; axis2 of a universal joint also if parallel to axis";
    case RBD_ERR_PITCH: return "not finite";
    case RBD_ERR_POSITION: return "not finite";
    case RBD_ERR_ROTATION: return "not finite, or not an orthonormal right-handed matrix";
    case RBD_ERR_MASS: return "negative or not finite";
    case RBD_ERR_COM: return "not finite";
    case RBD_ERR_INERTIA: return "not finite";
    case RBD_ERR_LEAF:
        return "a movable leaf needs mass, inertia or armature: forward dynamics would be singular";
    case RBD_ERR_ARMATURE:
    case RBD_ERR_DAMPING:
    case RBD_ERR_FRICTION: return "negative or not finite";
    case RBD_ERR_LIMITS: return "not a number, or a negative limit";
    case RBD_ERR_MIMIC:
        return "ratio 0 or not finite, offset not finite, not a one-dof joint, or it follows one that is "
               "missing or mimics too";
    case RBD_ERR_WORK: return "made for another model or another work";
    case RBD_ERR_NAN: return "NaN in q (rbd_singular_dof says where), v, a force or a gap; or overflow";
    case RBD_ERR_RANGE: return "negative, not finite or out of range";
    case RBD_ERR_INFEASIBLE: return "the constraints contradict each other";
    case RBD_ERR_ARITHMETIC:
        return "RBD_REPRODUCIBLE: results are contracted, rounded twice or not to nearest, or denormals are "
               "0";
    case RBD_ERR_MASSLESS: return "dynamics needs masses, a joint moves none: rbd_singular_dof says which";
    case RBD_ERR_LEFT_OUT: return "the model needs code that RBD_FEATURES or RBD_NO_CHOLESKY leave out";
    case RBD_WARN_INERTIA_NEGATIVE: return "has a negative principal moment: no real body is like this";
    case RBD_WARN_INERTIA_TRIANGLE:
        return "one principal moment exceeds the sum of the others: no real body is like this";
    case RBD_WARN_INERTIA_ZERO: return "zero for a body with mass: no real body is like this";
    case RBD_WARN_MASS_ZERO: return "zero for a body with inertia: no real body is like this";
    case RBD_WARN_LIMITS: return "limits that mean none: not below upper, or of a joint that has no limits";
    }
    return "unknown status";
}

/* Writes a finding as a sentence; what: the word for a row of the description. */
RBDI_LOCAL char *rbdi_write_finding(const rbd_finding *finding, const char *what, char *text, size_t size) {
    const char *piece[12];
    char digits[12];
    int n = 0;
    if (!finding || !text || size == 0) return text;

    if (finding->body >= 0) {
        piece[n++] = what;
        piece[n++] = " ";
        piece[n++] = rbdi_decimal(finding->body, digits);

        if (finding->name) {
            piece[n++] = " '";
            piece[n++] = finding->name;
            piece[n++] = "'";
        }
        piece[n++] = ", ";
    }

    if (finding->field) {
        piece[n++] = "field '";
        piece[n++] = finding->field;
        piece[n++] = "': ";
    }

    piece[n++] = finding->text ? finding->text : rbd_status_string(finding->status);
    return rbdi_join(piece, n, text, size);
}

RBDI_API char *rbd_finding_text(const rbd_finding *finding, char *text, size_t size) {
    return rbdi_write_finding(finding, "body", text, size);
}

#endif
