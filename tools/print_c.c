/* The description of a robot as a C table that a person can read and edit. SPDX-License-Identifier: MIT */
#include "print.h"
#include <stdio.h>

static void number(double x) {
    char text[NUMBER_SIZE];
    printf("%s", number_text(x, text));
}

static void numbers(const double *x, int n) {
    printf("{");
    for (int i = 0; i < n; i++) {
        if (i) printf(", ");
        number(x[i]);
    }
    printf("}");
}

/* Of six numbers, those up to the last that is not zero, one at least. */
static void leading_numbers(const double x[6]) {
    int n = 6;
    while (n > 1 && x[n - 1] == 0) n--;
    numbers(x, n);
}

static void print_joint(const rbd_body *b, int index, const rbd_body *bodies) {
    printf("    {");
    print_c_string(b->name);
    printf(", ");
    print_c_string(b->joint);
    printf(", %d, %s, /* body %d, parent ", b->parent, joint_type_constant(b->type), index);
    print_in_comment(b->parent < 0 ? "world" : bodies[b->parent].name ? bodies[b->parent].name : "nameless");
    printf(" */\n     ");
    numbers(b->axis, 3);
    printf(", ");
    numbers(b->axis2, 3);
    printf(", ");
    number(b->pitch);
    printf(",\n     ");
    numbers(b->position, 3);
    printf(",\n     ");
    numbers(b->rotation, 9);
    printf(",\n     ");
}

static void print_body(const rbd_body *b, int index, const rbd_body *bodies) {
    const double *const passive[] = {b->armature, b->damping, b->friction};
    const double limits[] = {b->lower, b->upper, b->velocity, b->effort};
    print_joint(b, index, bodies);
    number(b->mass);
    printf(", ");
    numbers(b->com, 3);
    printf(",\n     ");
    numbers(b->inertia, 6);
    printf(",\n     ");
    for (int i = 0; i < 3; i++) {
        leading_numbers(passive[i]);
        printf(i < 2 ? ", " : ",\n     ");
    }
    for (int i = 0; i < 4; i++) {
        number(limits[i]);
        printf(i < 3 ? ", " : ",\n     ");
    }
    print_c_string(b->mimic);
    printf(", ");
    number(b->mimic_ratio);
    printf(", ");
    number(b->mimic_offset);
    printf("},\n");
}

static void print_head(const robot *r, const char *name) {
    const int floating = r->urdf.bodies[0].type == RBD_FLOATING;
    printf("/* %s.h - ", name);
    print_in_comment(r->urdf.name);
    printf(", %s: the description that %s takes.\n", floating ? "on a floating joint" : "fixed to the world",
           r->kinematic ? "rbd_model_build_kinematic" : "rbd_model_build");
    print_origin(r, "rbd-model");
    printf("   Include rbd.h before. */\n");
}

void print_c(const robot *r, const char *name) {
    print_head(r, name);
    printf("#ifndef ");
    print_upper(name);
    printf("_H\n#define ");
    print_upper(name);
    printf("_H\n\n");
    printf("/* clang-format off */\n\n");
    print_c_indices(r, name);
    printf("\n"
           "/* A row: {link, joint, parent, type,\n"
           "           axis, axis2, pitch,\n"
           "           position,\n"
           "           rotation,\n"
           "           mass, com,\n"
           "           inertia,\n"
           "           armature, damping, friction,\n"
           "           lower, upper, velocity, effort,\n"
           "           mimic, mimic_ratio, mimic_offset}, as rbd_body says. */\n"
           "static const rbd_body %s_bodies[",
           name);
    print_upper(name);
    printf("_NB] = {\n");
    for (int i = 0; i < r->urdf.nb; i++) print_body(&r->urdf.bodies[i], i, r->urdf.bodies);
    printf("};\n/* clang-format on */\n\n#endif\n");
}

static void print_frame(const rbd_constraint *k, int second, const rbd_body *bodies) {
    const int body = second ? k->body2 : k->body1;
    printf("     ");
    numbers(second ? k->rotation2 : k->rotation1, 9);
    printf(", ");
    numbers(second ? k->position2 : k->position1, 3);
    printf(", /* ");
    print_in_comment(body < 0 ? "world" : bodies[body].name ? bodies[body].name : "nameless");
    printf(" */\n");
}

/* A table of constraints, for rbd_constraint_set_init. */
void print_c_constraints(const robot *r, const char *name, const rbd_constraint *list, int n) {
    int rows = 0;
    for (int i = 0; i < 6 * n; i++) rows += list[i / 6].axes[i % 6];
    printf("\n#ifndef ");
    print_upper(name);
    printf("_CONSTRAINTS_H\n#define ");
    print_upper(name);
    printf("_CONSTRAINTS_H\n"
           "#include \"rbd_constraints.h\"\n\n"
           "/* clang-format off */\n"
           "/* A row: {name, body1, body2,\n"
           "           rotation1, position1,\n"
           "           rotation2, position2,\n"
           "           axes, kp, kd}, as rbd_constraint says. */\n");
    printf("enum { ");
    print_upper(name);
    printf("_CONSTRAINTS = %d, ", n);
    print_upper(name);
    printf("_ROWS = %d };\nstatic const rbd_constraint %s_constraints[] = {\n", rows, name);
    for (int i = 0; i < n; i++) {
        printf("    {");
        print_c_string(list[i].name);
        printf(", %d, %d,\n", list[i].body1, list[i].body2);
        for (int side = 0; side < 2; side++) print_frame(&list[i], side, r->urdf.bodies);
        printf("     {%d, %d, %d, %d, %d, %d}, ", list[i].axes[0], list[i].axes[1], list[i].axes[2],
               list[i].axes[3], list[i].axes[4], list[i].axes[5]);
        number(list[i].kp);
        printf(", ");
        number(list[i].kd);
        printf("},\n");
    }
    if (n == 0) printf("    {0}\n");
    printf("};\n/* clang-format on */\n\n#endif\n");
}
