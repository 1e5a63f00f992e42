/* inverse_kinematics.c - joint angles for a place of an iiwa's tool, or for its pose: damped least squares
   (Wampler 1986) with joint limits, from another start where that leads nowhere. The model is a table. */
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "rbd_spatial.h"
#include "models/iiwa_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { NV = IIWA_NV, TOOL = IIWA_BODY_LBR_IIWA_LINK_7, TARGETS = 200, STEPS = 100, STARTS = 50 };
static const double tool[3] = {0, 0, 0.15}; /* the point, axes of the last link */

static unsigned char memory[IIWA_WORK_SIZE];
static rbd_work *w;

static void check(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), EXIT_FAILURE));
}

/* The tool's pose at q. */
static rbd_placement pose(const double *q) {
    double R[9], p[3];
    check(rbd_kinematics(&iiwa_model, w, q, NULL, NULL));
    check(rbd_body_pose(&iiwa_model, w, TOOL, R, NULL));
    check(rbd_point_position(&iiwa_model, w, TOOL, tool, p));
    return rbd_placement_from_arrays(R, p, TOOL, -1);
}

/* b = A^-1 b for a positive definite matrix. */
static void solve(double A[6][6], int n, double *b) {
    for (int k = 0; k < n; k++)
        for (int i = k + 1; i < n; i++) {
            const double factor = A[i][k] / A[k][k];
            for (int j = k; j < n; j++) A[i][j] -= factor * A[k][j];
            b[i] -= factor * b[k];
        }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++) b[k] -= A[k][j] * b[j];
        b[k] /= A[k][k];
    }
}

/* One step d = J' (J J' + damping)^-1 e from q; first: row of J at which the task begins, 0 for a pose, 3
   for a place. Returns the error before it. */
static double step(double *q, rbd_placement target, int first) {
    const rbd_placement now = pose(q);
    double e[6], J[6 * NV], A[6][6], d[NV], size = 0;
    rbd_vec3_to_array(
        rbd_rotation_log(rbd_rotation_product(target.rotation, rbd_rotation_inverse(now.rotation))), e);
    rbd_vec3_to_array(target.position, e + 3);
    e[3] -= now.position.x, e[4] -= now.position.y, e[5] -= now.position.z;
    for (int i = first; i < 6; i++) size += e[i] * e[i];
    check(rbd_jacobian(&iiwa_model, w, TOOL, tool, RBD_WORLD_AXES, J));
    for (int i = first; i < 6; i++)
        for (int j = first; j < 6; j++) {
            A[i - first][j - first] =
                i == j ? 1e-3 * size + 1e-12 : 0; /* damping that fades with the error */
            for (int k = 0; k < NV; k++) A[i - first][j - first] += J[i * NV + k] * J[j * NV + k];
        }
    solve(A, 6 - first, e + first);
    for (int i = 0; i < first; i++) e[i] = 0;
    check(rbd_jacobian_transpose(&iiwa_model, w, TOOL, tool, RBD_WORLD_AXES, e, d));
    check(rbd_integrate(&iiwa_model, q, d, 1, q));
    for (int k = 0; k < NV; k++) {
        rbd_joint_info joint;
        check(rbd_joint(&iiwa_model, rbd_dof_body(&iiwa_model, k), &joint));
        q[k] = fmin(fmax(q[k], joint.lower), joint.upper);
    }
    return sqrt(size);
}

/* How many of the targets, each of a configuration within the limits, are reached. */
static int solve_all(int first) {
    uint64_t seed = 1;
    int reached = 0;
    for (int n = 0; n < TARGETS; n++) {
        double q[NV], error = 1;
        check(rbd_random(&iiwa_model, &seed, q));
        const rbd_placement target = pose(q);
        for (int start = 0; start < STARTS && error > 1e-9; start++) {
            check(rbd_random(&iiwa_model, &seed, q));
            for (int k = 0; k < STEPS && error > 1e-9; k++) error = step(q, target, first);
            if (error > 1e-9) error = 1;
        }
        reached += error <= 1e-9;
    }
    return reached;
}

int main(void) {
    check(rbd_work_init(&iiwa_model, memory, sizeof memory, &w));
    const int places = solve_all(3), poses = solve_all(0);
    printf("%d of %d places, %d of %d poses reached to 1e-9, within the joints' limits\n", places, TARGETS,
           poses, TARGETS);
    return places == TARGETS && poses == TARGETS ? EXIT_SUCCESS : EXIT_FAILURE;
}
