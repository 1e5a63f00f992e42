/* rbd_qp.h - small convex quadratic programs, for control. SPDX-License-Identifier: MIT, see rbd.h. */
#include "api/configuration.h"
#ifndef RBD_QP_H
#define RBD_QP_H
#include "api/qp.h"
#endif
#ifdef RBD_IMPLEMENTATION
#include "base/compiler.h"
RBDI_CODE_BEGIN
#include "qp/solve.h"
RBDI_CODE_END
#endif
