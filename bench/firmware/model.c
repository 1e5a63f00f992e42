/* model.c - a robot's built model alone, to see its size in flash. SPDX-License-Identifier: MIT */
#include "rbd.h"
#include ROBOT_HEADER

extern const rbd_model *const the_model;
const rbd_model *const the_model = &ROBOT_MODEL;
