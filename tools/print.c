/* Numbers, strings and names, as the writers of rbd-model share them. SPDX-License-Identifier: MIT */
#include "print.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *number_text(double x, char text[NUMBER_SIZE]) {
    if (x > -1e6 && x < 1e6 && x == (int)x) {
        snprintf(text, NUMBER_SIZE, "%d", (int)x);
        return text;
    }
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(text, NUMBER_SIZE, "%.*g", digits, x);
        if (strtod(text, NULL) == x) break;
    }
    return text;
}

void print_c_string(const char *s) {
    if (!s) {
        printf("NULL");
        return;
    }
    putchar('"');
    for (; *s; s++) {
        const unsigned char c = (unsigned char)*s;
        if (c < 0x20 || c >= 0x7f || c == '?') /* a question mark may begin a trigraph */
            printf("\\%03o", (unsigned)c);
        else if (c == '"' || c == '\\')
            printf("\\%c", c);
        else
            putchar(c);
    }
    putchar('"');
}

void print_upper(const char *s) {
    for (; *s; s++) putchar(toupper((unsigned char)*s));
}

void print_in_comment(const char *s) {
    for (; *s; s++)
        if (!strchr("*?\\", *s)) /* what may end the comment, or begin a trigraph */
            putchar(*s);
}

const char *file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

void print_origin(const robot *r, const char *writer) {
    printf("   Written by %s from ", writer);
    print_in_comment(strcmp(r->path, "-") == 0 ? "standard input" : file_name(r->path));
    printf(": change that instead.\n");
    if (r->command) printf("       %s\n", r->command);
}

/* What is printed of a joint type: its name in files (spherical: of MJCF alone) and in the summary, "" where
   no file has it; in C; of joints with several coordinates or dofs what their names end in. A type without
   parts of v has those of q. */
typedef struct type_text {
    const char *name, *constant;
    const char *parts_of_q[7], *parts_of_v[6];
} type_text;

static const type_text types[RBD_JOINT_TYPES] = {
    [RBD_FIXED] = {"fixed", "RBD_FIXED", {""}, {""}},
    [RBD_REVOLUTE] = {"revolute", "RBD_REVOLUTE", {""}, {""}},
    [RBD_CONTINUOUS] = {"continuous", "RBD_CONTINUOUS", {""}, {""}},
    [RBD_CONTINUOUS_CS] = {"", "RBD_CONTINUOUS_CS", {"cos", "sin"}, {""}},
    [RBD_PRISMATIC] = {"prismatic", "RBD_PRISMATIC", {""}, {""}},
    [RBD_HELICAL] = {"", "RBD_HELICAL", {""}, {""}},
    [RBD_CYLINDRICAL] = {"", "RBD_CYLINDRICAL", {"angle", "length"}, {NULL}},
    [RBD_UNIVERSAL] = {"", "RBD_UNIVERSAL", {"first", "second"}, {NULL}},
    [RBD_SPHERICAL] = {"spherical", "RBD_SPHERICAL", {"qx", "qy", "qz", "qw"}, {"wx", "wy", "wz"}},
    [RBD_EULER_ZYX] = {"", "RBD_EULER_ZYX", {"z", "y", "x"}, {NULL}},
    [RBD_EULER_XYZ] = {"", "RBD_EULER_XYZ", {"x", "y", "z"}, {NULL}},
    [RBD_EULER_YXZ] = {"", "RBD_EULER_YXZ", {"y", "x", "z"}, {NULL}},
    [RBD_EULER_ZXY] = {"", "RBD_EULER_ZXY", {"z", "x", "y"}, {NULL}},
    [RBD_PLANAR] = {"planar", "RBD_PLANAR", {"x", "y", "angle"}, {"w", "vx", "vy"}},
    [RBD_TRANSLATION] = {"", "RBD_TRANSLATION", {"x", "y", "z"}, {NULL}},
    [RBD_FLOATING] = {"floating",
                      "RBD_FLOATING",
                      {"x", "y", "z", "qx", "qy", "qz", "qw"},
                      {"wx", "wy", "wz", "vx", "vy", "vz"}},
};

const char *joint_type_name(rbd_joint_type type) { return types[type].name; }
const char *joint_type_constant(rbd_joint_type type) { return types[type].constant; }
const char *const *coordinate_names(rbd_joint_type type) { return types[type].parts_of_q; }
const char *const *dof_names(rbd_joint_type type) {
    return types[type].parts_of_v[0] ? types[type].parts_of_v : types[type].parts_of_q;
}
