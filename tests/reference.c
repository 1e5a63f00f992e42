/* reference.c - the one object file that holds the reference data. */
#include "rbd.h"

#include "reference.h"

#ifdef REFERENCE_SMALL /* what goes into half a megabyte of flash; no helical and no translation joint */
#include "data/iiwa.inc"
#include "data/tree01.inc"
#include "data/tree02.inc"
#include "data/tree03.inc"
#include "data/tree04.inc"
static const ref_model *const ref_models[] = {&ref_iiwa, &ref_tree01, &ref_tree02, &ref_tree03, &ref_tree04};
#define REF_MODELS ((int)(sizeof ref_models / sizeof *ref_models))
#else
#include "data/reference_models.h"
#endif

const int reference_count = REF_MODELS;

const ref_model *reference_model(int index) { return ref_models[index]; }
