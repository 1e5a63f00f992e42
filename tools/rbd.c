/* The library, for the tools. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"
#include "rbd_contact.h"
