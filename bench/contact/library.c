/* The library, compiled as the rest of the bench is. SPDX-License-Identifier: MIT */
#define RBD_IMPLEMENTATION
#include "rbd_contact.h"
