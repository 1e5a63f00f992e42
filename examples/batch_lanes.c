#define RBD_LANES 4 /* for AVX; 8 with AVX-512, 2 else: see rbd_batch.h */
#define RBD_BATCH_IMPLEMENTATION
#include "rbd_batch.h"
