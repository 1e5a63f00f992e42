/* cold.c - one call of a robot at rest, for cold.py, which sees what it fetches.
   SPDX-License-Identifier: MIT */
#include "rbd.h"
#include ROBOT_HEADER

#define PASTE(a, b) a##b
#define JOIN(a, b) PASTE(a, b)
#define ROBOT(name) JOIN(ROBOT_PREFIX, name)

unsigned char memory[ROBOT(_WORK_SIZE)];
rbd_real q[ROBOT(_NQ)], v[ROBOT(_NV)], a[ROBOT(_NV)], tau[ROBOT(_NV)], out[ROBOT(_NV) * ROBOT(_NV)];

#define CALL_id(m, w) rbd_rnea(m, w, q, v, a, NULL, out)
#define CALL_mm(m, w) rbd_crba(m, w, q, out)
#define CALL_fd(m, w) rbd_aba(m, w, q, v, tau, NULL, out)

int main(void) {
    rbd_work *w;
    for (int k = 0; k < ROBOT(_NQ); k++) q[k] = (rbd_real)0.25;
    if (rbd_work_init(&ROBOT_MODEL, memory, sizeof memory, &w)) return 1;
    return JOIN(CALL_, CALL)(&ROBOT_MODEL, w) ? 1 : 0;
}
