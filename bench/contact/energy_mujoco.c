/* energy_mujoco.c - the scenes of examples/contact/energy.c by MuJoCo's integrators: tables for energy.gp.
       energy_mujoco FOLDER      with tumbling_box.xml and swinging_arm.xml */
#include <mujoco/mujoco.h>

#include <stdio.h>
#include <stdlib.h>

enum { WAYS = 3 };
static const int ways[WAYS] = {mjINT_EULER, mjINT_IMPLICIT, mjINT_RK4};

static mjModel *load(const char *folder, const char *name) {
    char path[1000], error[1000] = "";
    snprintf(path, sizeof path, "%s/%s", folder, name);
    mjModel *m = mj_loadXML(path, NULL, error, sizeof error);
    if (m) return m;
    fprintf(stderr, "%s: %s\n", path, error);
    exit(EXIT_FAILURE);
}

static double energy(const mjModel *m, mjData *d) {
    mj_forward(m, d);
    return d->energy[0] + d->energy[1];
}

/* So many steps of all integrators, from q (or NULL) and v; every tenth is a row of changes of energy, as
   shares if so. A run that has made three times its energy ends: MuJoCo would start it anew. */
static void print_table(mjModel *m, const double *q, const double *v, int steps, int shares) {
    mjData *d[WAYS];
    double start[WAYS];
    int lost[WAYS] = {0};
    for (int i = 0; i < WAYS; i++) {
        d[i] = mj_makeData(m);
        for (int k = 0; q && k < m->nq; k++) d[i]->qpos[k] = q[k];
        for (int k = 0; k < m->nv; k++) d[i]->qvel[k] = v[k];
        start[i] = energy(m, d[i]);
    }
    puts("t s,MuJoCo Euler,MuJoCo implicit,MuJoCo RK4");
    for (int n = 0; n <= steps; n++) {
        if (n % 10 == 0) printf("%.2f", n * m->opt.timestep);
        for (int i = 0; n % 10 == 0 && i < WAYS; i++) {
            const double change = energy(m, d[i]) - start[i];
            lost[i] = lost[i] || change > 3 * start[i];
            printf(",");
            if (!lost[i]) printf("%.9f", change / (shares ? start[i] : 1));
        }
        if (n % 10 == 0) puts("");
        for (int i = 0; i < WAYS; i++) {
            m->opt.integrator = ways[i];
            mj_step(m, d[i]);
        }
    }
    for (int i = 0; i < WAYS; i++) mj_deleteData(d[i]);
    mj_deleteModel(m);
}

int main(int argc, char **argv) {
    static const double turn[6] = {0, 0, 0, 0.1, 30, 0.1}, rates[8] = {0, 0, 0, 0, 0, 0, 2, 3},
                        arm[9] = {0, 0, 0, 1, 0, 0, 0, 1.2, 0.5};
    if (argc != 2) return EXIT_FAILURE;
    print_table(load(argv[1], "tumbling_box.xml"), NULL, turn, 4000, 1);
    puts("\n");
    print_table(load(argv[1], "swinging_arm.xml"), arm, rates, 2000, 0);
    return EXIT_SUCCESS;
}
