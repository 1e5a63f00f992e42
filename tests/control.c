/* control.c - the one object file that holds the reference data of what controllers ask. */
#define RBD_CHECK_SCALAR 0 /* the data are of no scalar */
#include "rbd.h"

#include "reference.h"

#include "control_models.h" /* written by data/unpack.py */

static const ref_control *const controls[] = {CONTROL_MODELS};

const int control_count = (int)(sizeof controls / sizeof *controls);

const ref_control *reference_control(int index) { return controls[index]; }
