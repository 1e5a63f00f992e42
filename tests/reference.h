/* reference.h - access to the reference data, for C and C++. */
#ifndef TESTS_REFERENCE_H
#define TESTS_REFERENCE_H

#include "data/reference.h"

#ifdef __cplusplus
extern "C" {
#endif

extern const int reference_count;
const ref_model *reference_model(int index);

/* Reference data of the control quantities, on models of their own; in control.c. */
extern const int control_count;
const ref_control *reference_control(int index);

#ifdef __cplusplus
}
#endif

#endif
