/* Loads MJCF files and compares rbd with MuJoCo on each: a table, one row a file.
   usage: compare_files FILE.xml... SPDX-License-Identifier: MIT */
#include "compare.h"

#include <stdio.h>
#include <string.h>

#include <mujoco/mujoco.h>

static const char *one_line(char *text) {
    for (char *c = text; *c; c++)
        if (*c == '\n' || *c == ',') *c = ' ';
    return text;
}

int main(int argc, char **argv) {
    printf("file,nb,nv,constraints,warnings,M,bias,poses,kinetic,potential,coordinates,reason\n");
    for (int i = 1; i < argc; i++) {
        char error[1000] = "";
        mjModel *m = mj_loadXML(argv[i], NULL, error, sizeof error);
        if (!m) {
            printf("%s,,,,,,,,,,,MuJoCo: %s\n", argv[i], one_line(error));
        } else {
            differences x = compare(m, NULL, 10);
            printf("%s,%d,%d,%d,%d,%.1e,%.1e,%.1e,%.1e,%.1e,%.1e,%s\n", argv[i], x.nb, x.nv, x.nconstraints,
                   x.nwarnings, x.mass, x.bias, x.poses, x.kinetic, x.potential, x.coordinates,
                   one_line(x.reason));
            mj_deleteModel(m);
        }
        fflush(stdout);
    }
    return 0;
}
