#ifndef RBDI_TASKS_TEXT_H
#define RBDI_TASKS_TEXT_H
#include "base/pieces.h"
#include "api/tasks.h"

/* ---- text [text of tasks] ---- */

RBDI_MESSAGES RBDI_PART const char *rbdi_tasks_sentence(rbd_tasks_status status) {
    switch (status) {
    case RBD_TASKS_OK: return "all limits are kept, and the tasks done as well as they allow";
    case RBD_TASKS_INEXACT: return "the quadratic program of a level did not end well";
    case RBD_TASKS_INFEASIBLE: return "contacts and limits contradict each other";
    case RBD_TASKS_ERROR: return "an error, and no result that says which";
    }
    return "unknown status";
}

/* A part, before the number of its dof or contact. */
RBDI_MESSAGES RBDI_PART const char *rbdi_tasks_part_name(rbd_tasks_part part) {
    switch (part) {
    case RBD_TASKS_NOTHING: break;
    case RBD_TASKS_HELD: return "the hold of contact ";
    case RBD_TASKS_FRICTION: return "the friction of contact ";
    case RBD_TASKS_FORCE: return "the least or largest force of contact ";
    case RBD_TASKS_PASSIVE: return "the missing motor of dof ";
    case RBD_TASKS_TORQUE_LIMIT: return "the torque limit of dof ";
    case RBD_TASKS_MOTION_LIMIT: return "the limit of motion of dof ";
    }
    return "nothing ";
}

/* The sentence of an error, where that of rbd_status_string speaks of a model. */
RBDI_MESSAGES RBDI_PART const char *rbdi_tasks_error_text(rbd_status error) {
    switch ((int)error) {
    case RBD_ERR_COUNT: return "below 0 or above 1000, or more than 20000 rows in all";
    case RBD_ERR_TYPE: return "unknown kind of task";
    case RBD_ERR_POSITION: return "not finite, or farther than 1e9 m";
    case RBD_ERR_AXIS: return "not finite, or of a length out of 1e-9 to 1e9";
    case RBD_ERR_MASS: return "a centre of mass or momentum, but the robot has no mass";
    case RBD_ERR_LIMITS: return "not a number, or the lower limit is above the upper one";
    case RBD_ERR_RANGE: return "not finite, negative, or out of range";
    case RBD_ERR_NAN: return "not finite, or the result overflows";
    default: return rbd_status_string(error);
    }
}

RBDI_API char *rbd_tasks_text(rbd_tasks_status status, const rbd_tasks_result *result, char *text,
                              size_t size) {
    const int failed = status == RBD_TASKS_ERROR && result;
    const int blamed = status == RBD_TASKS_INFEASIBLE && result && result->part[0] != RBD_TASKS_NOTHING;
    const char *piece[8];
    char digits[2][12];
    int n = 0;
    if (!text || size == 0) return text;

    if (failed && (result->task >= 0 || result->contact >= 0 || result->dof >= 0)) {
        const int at = result->task >= 0      ? result->task
                       : result->contact >= 0 ? result->contact
                                              : result->dof;
        piece[n++] = result->task >= 0 ? "task " : result->contact >= 0 ? "contact " : "dof ";
        piece[n++] = rbdi_decimal(at, digits[0]);
        piece[n++] = ", ";
    }
    if (failed && result->field) {
        piece[n++] = "field '";
        piece[n++] = result->field;
        piece[n++] = "': ";
    }
    if (blamed) {
        const int both = result->part[1] != RBD_TASKS_NOTHING;
        piece[n++] = rbdi_tasks_part_name(result->part[0]);
        piece[n++] = rbdi_decimal(result->at[0], digits[0]);
        piece[n++] = both ? " contradicts " : " cannot be kept";
        if (both) piece[n++] = rbdi_tasks_part_name(result->part[1]);
        if (both) piece[n++] = rbdi_decimal(result->at[1], digits[1]);
    } else {
        piece[n++] = failed ? rbdi_tasks_error_text(result->error) : rbdi_tasks_sentence(status);
    }
    return rbdi_join(piece, n, text, size);
}

#endif
