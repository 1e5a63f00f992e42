/* no_cuda.h - what CUDA's headers give, for clang -x cuda without them. */
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))
#define __global__ __attribute__((global))
#define __forceinline__ inline __attribute__((always_inline))
#define __launch_bounds__(...) __attribute__((launch_bounds(__VA_ARGS__)))

struct coordinate {
    unsigned x;
};
#define threadIdx (coordinate{unsigned(__nvvm_read_ptx_sreg_tid_x())})
#define blockIdx (coordinate{unsigned(__nvvm_read_ptx_sreg_ctaid_x())})
#define blockDim (coordinate{unsigned(__nvvm_read_ptx_sreg_ntid_x())})
