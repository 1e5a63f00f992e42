/* control.c - the one object file that holds the reference data of what controllers ask. */
#include "rbd.h"

#include "reference.h"

#include "data/control_models.h"

const int control_count = REF_CONTROLS;

const ref_control *reference_control(int index) { return ref_controls[index]; }
