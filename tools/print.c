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

static const char *const types[RBD_JOINT_TYPES][2] = {
    {"fixed", "RBD_FIXED"},       {"revolute", "RBD_REVOLUTE"},   {"continuous", "RBD_CONTINUOUS"},
    {"", "RBD_CONTINUOUS_CS"},    {"prismatic", "RBD_PRISMATIC"}, {"", "RBD_HELICAL"},
    {"", "RBD_CYLINDRICAL"},      {"", "RBD_UNIVERSAL"},          {"", "RBD_SPHERICAL"},
    {"", "RBD_EULER_ZYX"},        {"", "RBD_EULER_XYZ"},          {"", "RBD_EULER_YXZ"},
    {"", "RBD_EULER_ZXY"},        {"planar", "RBD_PLANAR"},       {"", "RBD_TRANSLATION"},
    {"floating", "RBD_FLOATING"},
};
const char *joint_type_name(rbd_joint_type type) { return types[type][0]; }
const char *joint_type_constant(rbd_joint_type type) { return types[type][1]; }

/* Names of the coordinates and degrees of freedom of joints with several, by type. */
static const char *const parts_of_q[RBD_JOINT_TYPES][7] = {
    [RBD_CONTINUOUS_CS] = {"cos", "sin"},
    [RBD_CYLINDRICAL] = {"angle", "length"},
    [RBD_UNIVERSAL] = {"first", "second"},
    [RBD_SPHERICAL] = {"qx", "qy", "qz", "qw"},
    [RBD_EULER_ZYX] = {"z", "y", "x"},
    [RBD_EULER_XYZ] = {"x", "y", "z"},
    [RBD_EULER_YXZ] = {"y", "x", "z"},
    [RBD_EULER_ZXY] = {"z", "x", "y"},
    [RBD_PLANAR] = {"x", "y", "angle"},
    [RBD_TRANSLATION] = {"x", "y", "z"},
    [RBD_FLOATING] = {"x", "y", "z", "qx", "qy", "qz", "qw"},
};
static const char *const parts_of_v[RBD_JOINT_TYPES][6] = {
    [RBD_SPHERICAL] = {"wx", "wy", "wz"},
    [RBD_PLANAR] = {"w", "vx", "vy"},
    [RBD_FLOATING] = {"wx", "wy", "wz", "vx", "vy", "vz"},
};
static const char *const one[] = {""};

const char *const *coordinate_names(rbd_joint_type type) {
    return parts_of_q[type][0] ? parts_of_q[type] : one;
}
const char *const *dof_names(rbd_joint_type type) {
    if (parts_of_v[type][0]) return parts_of_v[type];
    return type == RBD_CONTINUOUS_CS ? one : coordinate_names(type);
}
