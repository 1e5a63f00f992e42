/* The libraries and algorithms, and the calls that are timed. SPDX-License-Identifier: MIT */
#include "../bench.h"
#include "../robots/contacts.h"
#include <ctype.h>
#include <string.h>

extern const struct library library_double, library_float, library_quad, library_lanes_double,
    library_lanes_double_4, library_lanes_float, library_blocks_double, library_blocks_float,
    library_iiwa_code, library_hyq_code, library_atlas_code, library_iiwa_fixed, library_hyq_fixed,
    library_atlas_fixed, library_iiwa_code_lanes, library_hyq_code_lanes, library_atlas_code_lanes,
    library_iiwa_code_blocks, library_hyq_code_blocks, library_atlas_code_blocks, library_mujoco, library_kdl,
    library_pinocchio, library_pinocchio_pv, library_pinocchio_avx512f, library_pinocchio_pv_avx512f,
    library_pinocchio_code_iiwa, library_pinocchio_code_hyq, library_pinocchio_code_atlas, library_rbdl,
    library_dynibo, library_robcogen_iiwa, library_robcogen_hyq, library_robcogen_atlas;

const struct library *const libraries[LIBRARIES] = {
    [DOUBLE] = &library_double,
    [FLOAT] = &library_float,
    [LANES_DOUBLE] = &library_lanes_double,
#ifdef BENCH_LANES_4
    [LANES_DOUBLE_4] = &library_lanes_double_4,
#endif
    [LANES_FLOAT] = &library_lanes_float,
    [BLOCKS_DOUBLE] = &library_blocks_double,
    [BLOCKS_FLOAT] = &library_blocks_float,
#ifdef BENCH_GENERATED
    [IIWA_CODE] = &library_iiwa_code,
    [HYQ_CODE] = &library_hyq_code,
    [ATLAS_CODE] = &library_atlas_code,
    [IIWA_FIXED] = &library_iiwa_fixed,
#ifdef BENCH_FIXED
    [HYQ_FIXED] = &library_hyq_fixed,
    [ATLAS_FIXED] = &library_atlas_fixed,
#endif
    [IIWA_CODE_LANES] = &library_iiwa_code_lanes,
    [HYQ_CODE_LANES] = &library_hyq_code_lanes,
    [ATLAS_CODE_LANES] = &library_atlas_code_lanes,
    [IIWA_CODE_BLOCKS] = &library_iiwa_code_blocks,
    [HYQ_CODE_BLOCKS] = &library_hyq_code_blocks,
    [ATLAS_CODE_BLOCKS] = &library_atlas_code_blocks,
#endif
#ifdef BENCH_MUJOCO
    [MUJOCO] = &library_mujoco,
#endif
#ifdef BENCH_KDL
    [KDL] = &library_kdl,
#endif
#ifdef BENCH_RBDL
    [RBDL] = &library_rbdl,
#endif
#ifdef BENCH_PINOCCHIO
    [PINOCCHIO] = &library_pinocchio,
    [PINOCCHIO_PV] = &library_pinocchio_pv,
#endif
#ifdef BENCH_PINOCCHIO_AVX512F
    [PINOCCHIO_AVX512F] = &library_pinocchio_avx512f,
    [PINOCCHIO_PV_AVX512F] = &library_pinocchio_pv_avx512f,
#endif
#ifdef BENCH_PINOCCHIO_CODE
    [PINOCCHIO_CODE_IIWA] = &library_pinocchio_code_iiwa,
    [PINOCCHIO_CODE_HYQ] = &library_pinocchio_code_hyq,
    [PINOCCHIO_CODE_ATLAS] = &library_pinocchio_code_atlas,
#endif
#ifdef BENCH_DYNIBO
    [DYNIBO] = &library_dynibo,
#endif
#ifdef BENCH_ROBCOGEN_IIWA
    [ROBCOGEN_IIWA] = &library_robcogen_iiwa,
#endif
#ifdef BENCH_ROBCOGEN_HYQ
    [ROBCOGEN_HYQ] = &library_robcogen_hyq,
#endif
#ifdef BENCH_ROBCOGEN_ATLAS
    [ROBCOGEN_ATLAS] = &library_robcogen_atlas,
#endif
#ifdef BENCH_QUAD
    [QUAD] = &library_quad,
#endif
};

const struct algorithm algorithms[ALGORITHMS] = {
    [ID] = {"id", "inverse dynamics (RNEA)", ACCELERATION},
    [MM] = {"mm", "mass matrix (CRBA)", NOTHING},
    [MM_PACKED] = {"mm_packed", "mass matrix, packed", NOTHING},
    [FD] = {"fd", "forward dynamics (ABA)", TORQUE},
    [FD_CHOLESKY] = {"fd_cholesky", "forward dynamics (Cholesky)", TORQUE},
    [HYBRID] = {"hybrid", "hybrid dynamics, the base free", ACCELERATION},
    [FREE_BASE] = {"id_free_base", "inverse dynamics, the base free", ACCELERATION},
    [MINV] = {"minv", "inverse of the mass matrix", NOTHING},
    [JACOBIAN] = {"jacobian", "kinematics and Jacobian of the last body", NOTHING},
    [BODY_JACOBIAN] = {"body_jacobian", "pose and Jacobian of the last body alone", NOTHING},
    [MOMENTUM_MATRIX] = {"momentum_matrix", "centroidal momentum matrix", NOTHING},
    [CORIOLIS] = {"coriolis", "Coriolis matrix", NOTHING},
    [REGRESSOR] = {"regressor", "torque regressor", ACCELERATION},
    [ID_DERIVATIVES] = {"id_derivatives", "derivatives of inverse dynamics", ACCELERATION},
    [ID_DERIVATIVES_MM] = {"id_derivatives_mm", "derivatives of inverse dynamics, and M", ACCELERATION},
    [FD_DERIVATIVES] = {"fd_derivatives", "derivatives of forward dynamics", TORQUE},
    [CONSTRAINED] = {"constrained_fd", "constrained dynamics, on feet", TORQUE},
    [CONSTRAINED_HAND] = {"constrained_fd_hand", "constrained dynamics, a hand too", TORQUE},
};

const char *const scalar_names[] = {[DOUBLE] = "double", [FLOAT] = "float", NULL};

const char *const variant_names[] = {[RUN_TIME] = "run-time",
                                     [GENERATED] = "generated",
                                     [LANES] = "lanes",
                                     [BLOCKS] = "blocks",
                                     [GENERATED_LANES] = "generated-lanes",
                                     [GENERATED_BLOCKS] = "generated-blocks",
                                     [THREADS] = "threads",
                                     NULL};

const char *const library_names[] = {"rbd", "mujoco", "kdl", "rbdl", "pinocchio", "robcogen", "dynibo", NULL};

bool library_is_ours(const struct library *library) { return !library->conventions; }

/* Case apart. */
static bool same_name(const char *a, const char *b) {
    while (*a && tolower((unsigned char)*a) == tolower((unsigned char)*b)) a++, b++;
    return *a == *b;
}

/* Code for one robot knows it with its own base, that of the reference, or with a fixed one. */
static bool knows(const struct library *library, const struct robot *r, const struct options *o) {
    if (!library->robot) return true;
    return strcmp(library->robot, r->name) == 0 &&
           (library->fixed_base ? o->fixed_base : r->reference != NULL);
}

bool library_wanted(const struct library *library, const struct robot *r, const struct options *o) {
    if (!library || !knows(library, r, o)) return false;
    const bool name = o->library == ALL || same_name(library->name, library_names[o->library]);
    const bool scalar = o->scalar == ALL || strcmp(library->scalar, scalar_names[o->scalar]) == 0;
    const bool variant = o->variant == ALL || o->variant == library->variant ||
                         (o->variant == THREADS && library->variant == LANES);
    return name && scalar && variant;
}

rbd_status algorithm_run(int algorithm, const struct instance *r, const struct worker *w,
                         const struct states *s, int first, int count) {
    const struct library *l = r->library;
    library_call *call = l->call[algorithm];
    const size_t q_size = (size_t)r->nq * l->size, v_size = (size_t)r->nv * l->size;
    const size_t end = (size_t)first + (size_t)count, width = (size_t)l->width;
    const char *q = s->q, *v = s->v, *x = algorithms[algorithm].input == ACCELERATION ? s->a : s->tau;
    for (size_t k = (size_t)first; k < end; k += width) {
        const int n = (int)(end - k < width ? end - k : width);
        rbd_status status =
            call(r->model, w->work, n, q + k * q_size, v + k * v_size, x + k * v_size, w->out);
        if (status != RBD_OK) return status;
    }
    return RBD_OK;
}

int algorithm_parts(int algorithm, const struct robot *r, int size[MAX_PARTS]) {
    const int nv = r->nv;
    const struct contact_set *contacts = contact_set_of(r->bodies, r->nb, algorithm);
    for (int k = 0; k < MAX_PARTS; k++) size[k] = nv;
    switch (algorithm) {
    case HYBRID:
    case FREE_BASE: return 2;
    case CONSTRAINED:
    case CONSTRAINED_HAND: size[1] = contacts ? contacts->rows : 0; return 2;
    case ID_DERIVATIVES: size[0] = size[1] = nv * nv; return 2;
    case ID_DERIVATIVES_MM:
    case FD_DERIVATIVES: size[0] = size[1] = size[2] = nv * nv; return 3;
    case MM:
    case MINV:
    case CORIOLIS: size[0] = nv * nv; return 1;
    case MM_PACKED: size[0] = r->packed; return 1;
    case JACOBIAN:
    case MOMENTUM_MATRIX: size[0] = 6 * nv; return 1;
    case BODY_JACOBIAN: size[0] = 6 * nv, size[1] = 12; return 2;
    case REGRESSOR: size[0] = nv * 10 * r->nb; return 1;
    default: return 1;
    }
}

int algorithm_results(int algorithm, const struct robot *r) {
    int size[MAX_PARTS], sum = 0;
    for (int k = algorithm_parts(algorithm, r, size) - 1; k >= 0; k--) sum += size[k];
    return sum;
}

int algorithm_largest(const struct robot *r) {
    int most = 0;
    for (int i = 0; i < ALGORITHMS; i++)
        if (algorithm_results(i, r) > most) most = algorithm_results(i, r);
    return most;
}
