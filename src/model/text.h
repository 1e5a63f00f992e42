#ifndef RBDI_MODEL_TEXT_H
#define RBDI_MODEL_TEXT_H
#include "api/status.h"

/* Interface: rbdi_append, rbdi_append_number */

/* ---- text [text code] ---- */

RBDI_API const char *rbd_status_string(rbd_status status) {
    switch (status) {
    case RBD_OK: return "no error";
    case RBD_ERR_NULL: return "a required pointer is NULL";
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
        return "ratio 0 or not finite, offset not finite, not a one-dof joint, or it follows a joint that is "
               "missing or mimics too";
    case RBD_ERR_WORK: return "made for another model or another work";
    case RBD_ERR_NAN: return "the mass matrix is not a number: so is q, or something overflowed";
    case RBD_ERR_RANGE: return "negative, not finite or out of range";
    case RBD_ERR_INFEASIBLE: return "the constraints contradict each other";
    case RBD_ERR_LEFT_OUT:
        return "the model has mimic joints, but RBD_NO_CHOLESKY leaves out what rbd_aba needs for them";
    case RBD_WARN_INERTIA_NEGATIVE: return "has a negative principal moment: no real body is like this";
    case RBD_WARN_INERTIA_TRIANGLE:
        return "one principal moment exceeds the sum of the others: no real body is like this";
    case RBD_WARN_INERTIA_ZERO: return "zero for a body with mass: no real body is like this";
    case RBD_WARN_MASS_ZERO: return "zero for a body with inertia: no real body is like this";
    }
    return "unknown status";
}

static size_t rbdi_append(char *text, size_t size, size_t at, const char *more) {
    for (; *more && at + 1 < size; ++more) text[at++] = *more;
    text[at] = 0;
    return at;
}

static size_t rbdi_append_number(char *text, size_t size, size_t at, int number) {
    char digits[12];
    int n = 11;
    digits[n] = 0;
    do {
        digits[--n] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    return rbdi_append(text, size, at, &digits[n]);
}

RBDI_API char *rbd_finding_text(const rbd_finding *finding, char *text, size_t size) {
    size_t at = 0;
    if (!finding || !text || size == 0) return text;
    if (finding->body >= 0) {
        at = rbdi_append(text, size, at, "body ");
        at = rbdi_append_number(text, size, at, finding->body);
        if (finding->name) {
            at = rbdi_append(text, size, at, " '");
            at = rbdi_append(text, size, at, finding->name);
            at = rbdi_append(text, size, at, "'");
        }
        at = rbdi_append(text, size, at, ", ");
    }
    if (finding->field) {
        at = rbdi_append(text, size, at, "field '");
        at = rbdi_append(text, size, at, finding->field);
        at = rbdi_append(text, size, at, "': ");
    }
    rbdi_append(text, size, at, finding->text ? finding->text : rbd_status_string(finding->status));
    return text;
}

#endif
