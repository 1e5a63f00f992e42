/* States and results for a program that times another library, such as peers/rigid_body_dynamics.jl.
   SPDX-License-Identifier: MIT */
#include "../bench.h"

/* Where each joint that moves stands: "NAME iq iv", between tabs. */
static void write_joints(FILE *f, const struct robot *r) {
    for (int b = 0; b < r->nb; b++) {
        rbd_joint_info joint;
        if (rbd_joint(r->instances[DOUBLE].model, b, &joint) != RBD_OK || joint.nv == 0) continue;
        fprintf(f, "%s %d %d\t", r->bodies[b].joint, joint.iq, joint.iv);
    }
    fputc('\n', f);
}

static void write_numbers(FILE *f, const void *x, int n, int samples) {
    fwrite(x, sizeof(double), (size_t)n * (size_t)samples, f);
}

/* A line "robot algorithm samples nq nv results", one of joints; then all q, v, a, tau and results, as the
   machine has its doubles, sample after sample. */
static int write_row(FILE *f, const struct row *row, int samples) {
    const struct instance *r = row->instance;
    const struct worker *w = &r->worker[0];
    const int results = algorithm_results(row->algorithm, r->robot);

    fprintf(f, "%s %s %d %d %d %d\n", r->robot->name, algorithms[row->algorithm].name, samples, r->nq, r->nv,
            results);
    write_joints(f, r->robot);

    write_numbers(f, r->states.q, r->nq, samples);
    write_numbers(f, r->states.v, r->nv, samples);
    write_numbers(f, r->states.a, r->nv, samples);
    write_numbers(f, r->states.tau, r->nv, samples);

    for (int k = 0; k < samples; k++) {
        const rbd_status status = algorithm_run(row->algorithm, r, w, &r->states, k, 1);
        if (status != RBD_OK) return row_error(row, "%s", rbd_status_string(status));
        write_numbers(f, w->out, results, 1);
    }
    return 0;
}

int write_states(FILE *f, const struct options *o, const struct row *rows, int n) {
    for (int i = 0; i < n; i++)
        if (rows[i].instance->library == libraries[DOUBLE] && write_row(f, &rows[i], o->samples) != 0)
            return -1;
    return 0;
}
