/* reference.c - the one object file that holds the reference data. */
#define RBD_CHECK_SCALAR 0 /* the data are of no scalar */
#include "rbd.h"

#include "reference.h"

#include "reference_models.h" /* written by data/unpack.py */

static const ref_model *const models[] = {REFERENCE_MODELS};

const int reference_count = (int)(sizeof models / sizeof *models);

const ref_model *reference_model(int index) { return models[index]; }
