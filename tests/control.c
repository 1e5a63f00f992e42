/* control.c - the one object file that holds the reference data of what controllers ask. */
#define RBD_CHECK_SCALAR 0 /* the data are of no scalar */
#include "rbd.h"

#include "reference.h"

#ifdef CONTROL_SMALL /* what goes into a microcontroller's flash beside the other data */
#include "data/control_iiwa.inc"
#include "data/control_tree03.inc"
static const ref_control *const ref_controls[] = {&ref_control_iiwa, &ref_control_tree03};
#define REF_CONTROLS ((int)(sizeof ref_controls / sizeof *ref_controls))
#else
#include "data/control_models.h"
#endif

const int control_count = REF_CONTROLS;

const ref_control *reference_control(int index) { return ref_controls[index]; }
