/* sines.c - the sine and cosine of generated code, which CODE names, are rbd.h's, bit by bit. */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd.h"

#include CODE

#include <stdio.h>
#include <string.h>

int main(void) {
    const rbd_real scale[4] = {1, 10, 1000, (rbd_real)0.9 * SINES_LIMIT};
    uint64_t seed = 1;
    for (int k = 0; k < 40000; k++) {
        rbd_real s, c, angle[4], sine[4], cosine[4], *const x = angle;
        batch squares = {0};
        seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        x[0] = scale[k % 4] * (rbd_real)(int32_t)(seed >> 32) / (rbd_real)2147483648.0;
        rbdi_sincos(x[0], &s, &c);
        sines4(1, x[0], x[0], x[0], x[0], 0, angle, sine, cosine, &squares);
        SINES_OF(1, 0);
        if (!are_inside(squares) || memcmp(&s, &sine[0], sizeof s) != 0 ||
            memcmp(&c, &cosine[0], sizeof c) != 0) {
            printf("of %.17g: %.17g %.17g, not %.17g %.17g\n", (double)x[0], (double)sine[0],
                   (double)cosine[0], (double)s, (double)c);
            return 1;
        }
    }
    return 0;
}
