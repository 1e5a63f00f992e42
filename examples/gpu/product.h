/* product.h - da/dq and da/dv of a large robot from M^-1 and the derivatives of its inverse dynamics:

       da = -M^-1 dtau

   One function that computes it all at once keeps too many numbers for a thread's registers if a robot has
   more than some 20 degrees of freedom. So generated code makes the matrices, a state a thread, and this
   kernel multiplies them, a tile of a state a thread. Include it behind the generated code.
   SPDX-License-Identifier: MIT */
#ifndef PRODUCT_H
#define PRODUCT_H

/* Rows and columns of a tile: both divide the degrees of freedom. */
template <int NV> struct product_tile {
    enum {
        TILE_ROWS = NV % 3 == 0   ? 3
                    : NV % 2 == 0 ? 2
                                  : 1,
        TILE_COLUMNS = NV % 2 == 0 && NV > 18 ? NV / 2 : NV,
        WARPS = NV / TILE_ROWS
    };
};

/* da = -Minv dtau in rows from `row` on and columns from `column` on; matrices NV x NV. */
template <int NV, class S, class A, class B, class C>
RBD_HD void product_of_tile(A Minv, B dtau, C da, int row, int column) {
    enum { TILE_ROWS = product_tile<NV>::TILE_ROWS, TILE_COLUMNS = product_tile<NV>::TILE_COLUMNS };
    S sum[TILE_ROWS][TILE_COLUMNS] = {};
    for (int k = 0; k < NV; ++k) {
        S factor[TILE_COLUMNS];
        for (int c = 0; c < TILE_COLUMNS; ++c) factor[c] = dtau[k * NV + column + c];
        for (int r = 0; r < TILE_ROWS; ++r) {
            const S own = Minv[(row + r) * NV + k];
            for (int c = 0; c < TILE_COLUMNS; ++c) sum[r][c] -= own * factor[c];
        }
    }
    for (int r = 0; r < TILE_ROWS; ++r)
        for (int c = 0; c < TILE_COLUMNS; ++c) da[(row + r) * NV + column + c] = sum[r][c];
}

#ifdef __CUDACC__
/* 32 states a block, a lane for each; the warps share the rows. Lanes of a warp read side by side in
   rbd::blocks. */
template <class L, int NV, class S>
__global__ void __launch_bounds__(32 * product_tile<NV>::WARPS)
    product_kernel(int n, const S *__restrict__ Minv, const S *__restrict__ dtau_dq,
                   const S *__restrict__ dtau_dv, S *__restrict__ da_dq, S *__restrict__ da_dv) {
    enum { SIZE = NV * NV, TILE_COLUMNS = product_tile<NV>::TILE_COLUMNS };
    const int i = (int)(32 * blockIdx.x + threadIdx.x);
    const int row = product_tile<NV>::TILE_ROWS * (int)threadIdx.y;
    if (i >= n) return;
    const auto inverse = L::at(Minv, SIZE, n, i);
    for (int column = 0; column < NV; column += TILE_COLUMNS) {
        product_of_tile<NV, S>(inverse, L::at(dtau_dq, SIZE, n, i), L::at(da_dq, SIZE, n, i), row, column);
        product_of_tile<NV, S>(inverse, L::at(dtau_dv, SIZE, n, i), L::at(da_dv, SIZE, n, i), row, column);
    }
}

template <class L, int NV, class S>
void multiply(int n, const S *Minv, const S *dtau_dq, const S *dtau_dv, S *da_dq, S *da_dv,
              cudaStream_t stream = 0) {
    const dim3 threads(32, product_tile<NV>::WARPS);
    product_kernel<L, NV, S><<<(n + 31) / 32, threads, 0, stream>>>(n, Minv, dtau_dq, dtau_dv, da_dq, da_dv);
}
#else
template <class L, int NV, class S>
void multiply(int n, const S *Minv, const S *dtau_dq, const S *dtau_dv, S *da_dq, S *da_dv) {
    enum { SIZE = NV * NV };
    for (int i = 0; i < n; ++i)
        for (int row = 0; row < NV; row += product_tile<NV>::TILE_ROWS)
            for (int column = 0; column < NV; column += product_tile<NV>::TILE_COLUMNS) {
                const auto inverse = L::at(Minv, SIZE, n, i);
                product_of_tile<NV, S>(inverse, L::at(dtau_dq, SIZE, n, i), L::at(da_dq, SIZE, n, i), row,
                                       column);
                product_of_tile<NV, S>(inverse, L::at(dtau_dv, SIZE, n, i), L::at(da_dv, SIZE, n, i), row,
                                       column);
            }
}
#endif
#endif
