/* control_models.h - all models with control results. Include rbd.h before.
   SPDX-License-Identifier: MIT. Written by convert.py: change that instead. */
#ifndef CONTROL_MODELS_H
#define CONTROL_MODELS_H

#include "control_atlas.inc"
#include "control_hyq.inc"
#include "control_iiwa.inc"
#include "control_tree01.inc"
#include "control_tree02.inc"
#include "control_tree03.inc"
#include "control_tree04.inc"
#include "control_tree05.inc"
#include "control_tree06.inc"
#include "control_tree07.inc"
#include "control_tree08.inc"

#define REF_CONTROLS 11

/* clang-format off */
static const ref_control *const ref_controls[REF_CONTROLS] = {
    &ref_control_atlas,
    &ref_control_hyq,
    &ref_control_iiwa,
    &ref_control_tree01,
    &ref_control_tree02,
    &ref_control_tree03,
    &ref_control_tree04,
    &ref_control_tree05,
    &ref_control_tree06,
    &ref_control_tree07,
    &ref_control_tree08,
};
/* clang-format on */

#endif
