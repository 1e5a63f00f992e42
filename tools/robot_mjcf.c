/* Robots from MJCF files, as those from URDF files. SPDX-License-Identifier: MIT */
#include "robot.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef RBD_TOOLS_MJCF
#include "rbd_mjcf.h"
#endif

/* Behind a comment, a declaration or a space that begins here; p itself if there is none. */
static const char *behind(const char *p, const char *end) {
    static const char *const pairs[][2] = {{"<!--", "-->"}, {"<?", "?>"}, {"<!", ">"}, {"\xef\xbb\xbf", ""}};
    if (p < end && strchr(" \t\r\n", *p)) return p + 1;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        const size_t open = strlen(pairs[i][0]), close = strlen(pairs[i][1]);
        if ((size_t)(end - p) < open || memcmp(p, pairs[i][0], open) != 0) continue;
        for (p += open; (size_t)(end - p) >= close; p++)
            if (memcmp(p, pairs[i][1], close) == 0) return p + close;
        return end;
    }
    return p;
}

int is_mjcf(const char *text, size_t length) {
    static const char root[] = "<mujoco";
    const char *p = text, *const end = text + length;
    for (const char *next = behind(p, end); next != p; next = behind(p, end)) p = next;
    return (size_t)(end - p) > strlen(root) && memcmp(p, root, strlen(root)) == 0 &&
           strchr(" \t\r\n>/", p[strlen(root)]) != NULL;
}

static int refuse(robot *r, const char *text) {
    r->urdf.error.status = RBD_URDF_ERR_OPTION;
    r->urdf.error.line = 0;
    snprintf(r->urdf.error.text, sizeof r->urdf.error.text, "%s", text);
    return EXIT_BAD;
}

#ifndef RBD_TOOLS_MJCF

int load_mjcf(robot *r, const char *text, size_t length, const settings *s) {
    (void)text;
    (void)length;
    (void)s;
    return refuse(
        r, "it is MJCF, the format of MuJoCo, and this command was built without MuJoCo: install it (Debian: "
           "libmujoco-dev) and build rbd anew");
}

#else

static const char *unfit_option(const settings *s) {
    if (s->urdf.root == RBD_FLOATING)
        return "--floating: an MJCF file says itself whether its root is free, by <freejoint/>";
    if (s->urdf.root_joint) return "--root-joint: an MJCF file names its joints itself";
    if (s->urdf.root_link) return "--root: only of URDF files a part can be taken";
    return NULL;
}

static void take_finding(const rbd_mjcf_finding *from, rbd_urdf_finding *to) {
    to->status = from->status < 0   ? RBD_URDF_ERR_ROBOT
                 : from->status > 0 ? RBD_URDF_WARN_UNREAD
                                    : RBD_URDF_OK;
    to->line = from->line;
    memcpy(to->text, from->text, sizeof to->text);
}

static void take_frames(const rbd_mjcf *from, rbd_urdf *to) {
    to->nframes = from->nframes;
    to->frames = allocate((size_t)from->nframes, sizeof *to->frames);
    for (int i = 0; i < from->nframes; i++) {
        const rbd_mjcf_frame *f = &from->frames[i];
        rbd_urdf_frame *u = &to->frames[i];
        u->link = f->link;
        u->joint = f->joint;
        u->parent = f->parent;
        u->body = f->body;
        memcpy(u->position, f->position, sizeof u->position);
        memcpy(u->rotation, f->rotation, sizeof u->rotation);
    }
}

/* The result of rbd_mjcf.h as one of rbd_urdf.h, which takes over bodies, names and constraints. */
static void take(robot *r, const rbd_mjcf *from) {
    rbd_urdf *to = &r->urdf;
    to->bodies = from->bodies;
    to->names = from->names;
    to->name = from->name;
    to->nb = from->nb;
    to->names_size = from->names_size;
    to->fixed_mass = from->fixed_mass;
    memcpy(to->gravity, from->gravity, sizeof to->gravity);
    take_finding(&from->error, &to->error);
    take_frames(from, to);
    r->constraints = from->constraints;
    r->nconstraints = from->nconstraints;
}

static void take_warnings(rbd_urdf *to, const rbd_mjcf *from) {
    to->nwarnings = from->nwarnings < from->warnings_max ? from->nwarnings : from->warnings_max;
    to->warnings = allocate((size_t)to->nwarnings, sizeof *to->warnings);
    for (int i = 0; i < to->nwarnings; i++) take_finding(&from->warnings[i], &to->warnings[i]);
}

/* Room for a robot of any size that rbd takes: MuJoCo may compile meshes for seconds, so once must do. */
static void make_room(rbd_mjcf *to, size_t length) {
    enum { FRAMES = 20000, CONSTRAINTS = RBD_MAX_CONSTRAINTS, WARNINGS = 1000 };
    to->bodies = allocate((size_t)(to->bodies_max = RBD_MAX_BODIES), sizeof *to->bodies);
    to->names = allocate(to->names_max = 1000000 + 2 * length, 1);
    to->frames = allocate((size_t)(to->frames_max = FRAMES), sizeof *to->frames);
    to->constraints = allocate((size_t)(to->constraints_max = CONSTRAINTS), sizeof *to->constraints);
    to->warnings = allocate((size_t)(to->warnings_max = WARNINGS), sizeof *to->warnings);
}

int load_mjcf(robot *r, const char *text, size_t length, const settings *s) {
    rbd_mjcf_lock *locks = allocate((size_t)s->nlock + 1, sizeof *locks);
    const rbd_mjcf_options options = {.gravity = s->urdf.gravity,
                                      .keep = s->urdf.keep,
                                      .keep_all = s->urdf.keep_all,
                                      .strict = s->urdf.strict,
                                      .free_mimics = s->urdf.free_mimics,
                                      .lock = locks};
    rbd_mjcf from = {0};
    rbd_mjcf_status status;
    if (unfit_option(s)) {
        free(locks);
        return refuse(r, unfit_option(s));
    }
    for (int i = 0; i < s->nlock; i++) {
        locks[i].joint = s->urdf.lock[i].joint;
        locks[i].value = s->urdf.lock[i].value;
    }
    make_room(&from, length);
    status = strcmp(r->path, "-") == 0 ? rbd_mjcf_parse(text, length, &options, &from)
                                       : rbd_mjcf_load(r->path, &options, &from);
    take_warnings(&r->urdf, &from);
    if (status == RBD_MJCF_OK) {
        take(r, &from);
    } else {
        take_finding(&from.error, &r->urdf.error);
        robot_print_warnings(r);
        free(from.bodies);
        free(from.names);
        free(from.constraints);
    }
    free(from.frames);
    free(from.warnings);
    free(locks);
    return status == RBD_MJCF_OK ? 0 : EXIT_BAD;
}

#endif
