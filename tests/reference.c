/* reference.c - the one object file that holds the reference data. */
#define RBD_CHECK_SCALAR 0 /* the data are of no scalar */
#include "rbd.h"

#include "reference.h"

#include "data/reference_models.h"

const int reference_count = REF_MODELS;

const ref_model *reference_model(int index) { return ref_models[index]; }
