/* The description of a robot as URDF: fixed links merged, all figures as rbd reads them.
   SPDX-License-Identifier: MIT */
#include "print.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static void escaped(const char *s) {
    for (; *s; s++) {
        switch (*s) {
        case '&': printf("&amp;"); break;
        case '<': printf("&lt;"); break;
        case '>': printf("&gt;"); break;
        case '"': printf("&quot;"); break;
        default: putchar(*s);
        }
    }
}

static void attribute(const char *name, const double *x, int n) {
    char text[NUMBER_SIZE];
    printf(" %s=\"", name);
    for (int i = 0; i < n; i++) printf("%s%s", i ? " " : "", number_text(x[i], text));
    putchar('"');
}

/* URDF's angles, R = Rz(yaw) Ry(pitch) Rx(roll); at pitch = +-pi/2 with yaw = 0. Near there yaw is found to
   few digits. So roll and pitch are those of R turned back by that yaw: Rz(-yaw) R = Ry(pitch) Rx(roll), with
   second row (0, cos roll, -sin roll) and first column (cos pitch, 0, -sin pitch). */
static void roll_pitch_yaw(const double R[9], double rpy[3]) {
    const double yaw = hypot(R[0], R[3]) > 1e-15 ? atan2(R[3], R[0]) : 0;
    const double c = cos(yaw), s = sin(yaw);
    rpy[0] = atan2(s * R[2] - c * R[5], c * R[4] - s * R[1]);
    rpy[1] = atan2(-R[6], c * R[0] + s * R[3]);
    rpy[2] = yaw;
}

static void origin(const char *indent, const double position[3], const double R[9]) {
    double rpy[3];
    roll_pitch_yaw(R, rpy);
    printf("%s<origin", indent);
    attribute("xyz", position, 3);
    attribute("rpy", rpy, 3);
    printf("/>\n");
}

/* ---- a planar joint about another axis than z: it moves a nameless body, on which a nameless joint sets the
   link upright; both need names here ---- */

static int is_made_of(const char *name, const char *base, const char *suffix, size_t underscores) {
    const size_t n = strlen(base), k = strlen(suffix);
    return strncmp(name, base, n) == 0 && strncmp(name + n, suffix, k) == 0 &&
           strspn(name + n + k, "_") == underscores && name[n + k + underscores] == 0;
}

/* Prints base and suffix, and underscores until no link and no joint is called so. */
static void new_name(const rbd_urdf *u, const char *base, const char *suffix) {
    size_t underscores = 0;
    for (int i = 0; i < u->nframes; i++) {
        const rbd_urdf_frame *f = &u->frames[i];
        if (is_made_of(f->link, base, suffix, underscores) ||
            (f->joint && is_made_of(f->joint, base, suffix, underscores))) {
            underscores++;
            i = -1; /* look at all again */
        }
    }
    escaped(base);
    printf("%s", suffix);
    while (underscores-- > 0) putchar('_');
}

static void link_name(const robot *r, const rbd_body *b) {
    if (b->name)
        escaped(b->name);
    else
        new_name(&r->urdf, b->joint, "_plane");
}

static void joint_name(const robot *r, const rbd_body *b) {
    if (b->joint)
        escaped(b->joint);
    else
        new_name(&r->urdf, b->name, "_upright");
}

static void print_link(const robot *r, const rbd_body *b) {
    static const char *const entries[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
    static const double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const double zero[6] = {0, 0, 0, 0, 0, 0};
    printf("\n  <link name=\"");
    link_name(r, b);
    const int massless = b->mass == 0 && memcmp(b->inertia, zero, sizeof zero) == 0;
    if (massless && b->type == RBD_FIXED) { /* of others it is said, or the reader would ask */
        printf("\"/>\n");
        return;
    }
    printf("\">\n    <inertial>\n");
    origin("      ", b->com, upright);
    printf("      <mass");
    attribute("value", &b->mass, 1);
    printf("/>\n      <inertia");
    for (int i = 0; i < 6; i++) attribute(entries[i], &b->inertia[i], 1);
    printf("/>\n    </inertial>\n  </link>\n");
}

static void print_limit(const rbd_body *b) {
    printf("    <limit");
    if (b->type != RBD_CONTINUOUS) {
        attribute("lower", &b->lower, 1);
        attribute("upper", &b->upper, 1);
    }
    attribute("velocity", &b->velocity, 1);
    attribute("effort", &b->effort, 1);
    printf("/>\n");
}

static void print_dynamics(const rbd_body *b) {
    if (b->damping[0] == 0 && b->friction[0] == 0 && b->armature[0] == 0) return;
    printf("    <dynamics");
    attribute("damping", b->damping, 1);
    attribute("friction", b->friction, 1);
    if (b->armature[0] != 0) attribute("armature", b->armature, 1);
    printf("/>\n");
}

static void print_joint(const robot *r, const rbd_body *b) {
    static const double z[3] = {0, 0, 1};
    const int one_dof = b->type != RBD_FIXED && b->type != RBD_FLOATING && b->type != RBD_PLANAR;
    printf("  <joint name=\"");
    joint_name(r, b);
    printf("\" type=\"%s\">\n    <parent link=\"", joint_type_name(b->type));
    if (b->parent < 0)
        escaped(r->urdf.frames[0].link);
    else
        link_name(r, &r->urdf.bodies[b->parent]);
    printf("\"/>\n    <child link=\"");
    link_name(r, b);
    printf("\"/>\n");
    origin("    ", b->position, b->rotation);
    if (one_dof || b->type == RBD_PLANAR) {
        printf("    <axis");
        attribute("xyz", one_dof ? b->axis : z, 3);
        printf("/>\n");
    }
    if (one_dof) print_limit(b);
    print_dynamics(b);
    if (b->mimic) {
        printf("    <mimic joint=\"");
        escaped(b->mimic);
        putchar('"');
        attribute("multiplier", &b->mimic_ratio, 1);
        attribute("offset", &b->mimic_offset, 1);
        printf("/>\n");
    }
    printf("  </joint>\n");
}

void print_urdf(const robot *r) {
    const rbd_urdf *u = &r->urdf;
    printf(
        "<?xml version=\"1.0\"?>\n<!-- Written by rbd-model: what dynamics needs, fixed links merged. -->\n"
        "<robot name=\"");
    escaped(u->name);
    printf("\">\n");
    if (u->frames[0].body < 0) {
        printf("\n  <link name=\"");
        escaped(u->frames[0].link);
        printf("\"/>\n");
    }
    for (int i = 0; i < u->nb; i++) {
        print_link(r, &u->bodies[i]);
        if (i > 0 || u->frames[0].body < 0) /* the root link's joint is the reader's option */
            print_joint(r, &u->bodies[i]);
    }
    printf("\n</robot>\n");
}
