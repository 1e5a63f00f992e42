/* reference_models.h - all models with reference results. Include rbd.h before.
   SPDX-License-Identifier: MIT. Written by convert.py: change that instead. */
#ifndef REFERENCE_MODELS_H
#define REFERENCE_MODELS_H

#include "atlas.inc"
#include "hyq.inc"
#include "iiwa.inc"
#include "tree01.inc"
#include "tree02.inc"
#include "tree03.inc"
#include "tree04.inc"
#include "tree05.inc"
#include "tree06.inc"
#include "tree07.inc"
#include "tree08.inc"
#include "tree09.inc"
#include "tree10.inc"
#include "tree11.inc"
#include "tree12.inc"

#define REF_MODELS 15

/* clang-format off */
static const ref_model *const ref_models[REF_MODELS] = {
    &ref_atlas,
    &ref_hyq,
    &ref_iiwa,
    &ref_tree01,
    &ref_tree02,
    &ref_tree03,
    &ref_tree04,
    &ref_tree05,
    &ref_tree06,
    &ref_tree07,
    &ref_tree08,
    &ref_tree09,
    &ref_tree10,
    &ref_tree11,
    &ref_tree12,
};
/* clang-format on */

#endif
