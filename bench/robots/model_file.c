/* A robot from a URDF file. SPDX-License-Identifier: MIT */
#include "../bench.h"
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#ifdef BENCH_URDF
#include "rbd_urdf.h"

/* The arrays of the one file robot; they stay until the end. */
static rbd_urdf loaded;

static int load_error(const char *path) {
    if (loaded.error.status == RBD_URDF_ERR_FILE) /* its text has the path */
        fprintf(stderr, "rbd-bench: %s\n", loaded.error.text);
    else if (loaded.error.line > 0)
        fprintf(stderr, "rbd-bench: %s:%d: %s\n", path, loaded.error.line, loaded.error.text);
    else
        fprintf(stderr, "rbd-bench: %s: %s\n", path, loaded.error.text);
    return -1;
}

int robot_load(struct robot *r, const struct options *o) {
    const rbd_urdf_options options = {.root = o->floating ? RBD_FLOATING : RBD_FIXED};
    if (rbd_urdf_load(o->model, &options, &loaded) != RBD_URDF_OK) /* counts */
        return load_error(o->model);
    loaded.bodies = calloc((size_t)(loaded.bodies_max = loaded.nb), sizeof *loaded.bodies);
    loaded.names = malloc(loaded.names_max = loaded.names_size);
    if (!loaded.bodies || !loaded.names || rbd_urdf_load(o->model, &options, &loaded) != RBD_URDF_OK)
        return load_error(o->model);
    for (char *c = loaded.names; *c; c++) /* the robot's name stands first: fit for CSV and JSON */
        if (!isalnum((unsigned char)*c) && !strchr("_-.", *c)) *c = '_';
    *r = (struct robot){.name = loaded.name, .title = loaded.name, .bodies = loaded.bodies, .nb = loaded.nb};
    return robot_take_lengths(r);
}

#else

int robot_load(struct robot *r, const struct options *o) {
    (void)r;
    fprintf(stderr, "rbd-bench: %s: this build is without urdfdom and reads no URDF files\n", o->model);
    return -1;
}

#endif
