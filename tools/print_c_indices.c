/* Sizes of a robot and indices by name, as both C tables have them. SPDX-License-Identifier: MIT */
#include "print.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct constant {
    char *identifier; /* what follows the robot and the kind */
    const char *name; /* what it was made of */
    int value, odd;   /* odd: the identifier does not say the name */
} constant;

typedef struct constants {
    constant *list;
    int n;
} constants;

/* Letters and digits in upper case; "_" stands for all that is between two of them. The index stands for a
   name that has none. */
static char *identifier_of(const char *name, int index) {
    const size_t room = strlen(name) + 32; /* and a part of the joint */
    char *text = allocate(room, 1), *end = text;
    for (; *name; name++) {
        const unsigned char c = (unsigned char)*name;
        if (c < 0x80 && isalnum(c))
            *end++ = (char)toupper(c);
        else if (end > text && end[-1] != '_')
            *end++ = '_';
    }
    if (end > text && end[-1] == '_') end[-1] = 0;
    if (!*text) snprintf(text, room, "%d", index);
    return text;
}

static int says(const char *identifier, const char *name) {
    while (*name && toupper((unsigned char)*name) == *identifier) name++, identifier++;
    return *name == *identifier;
}

/* part: of a joint of several coordinates, or "". */
static void add(constants *c, const char *name, const char *part, int value) {
    constant k = {identifier_of(name, value), name, value, 0};
    char *end = k.identifier + strlen(k.identifier);
    k.odd = !says(k.identifier, name);
    if (*part) *end++ = '_';
    while (*part) *end++ = (char)toupper((unsigned char)*part++);
    c->list = grown(c->list, (size_t)(c->n + 1) * sizeof *c->list);
    c->list[c->n++] = k;
}

/* By one of the first n. */
static int is_taken(const constants *c, int n, const char *identifier) {
    for (int i = 0; i < n; i++)
        if (strcmp(c->list[i].identifier, identifier) == 0) return 1;
    return 0;
}

/* Of constants with one identifier the first keeps it; the others get _2, _3 and so on, past what is taken.
 */
static void make_unique(constants *c) {
    for (int i = 0; i < c->n; i++) {
        char *base = c->list[i].identifier, *other;
        const size_t room = strlen(base) + 16;
        if (!is_taken(c, i, base)) continue;
        other = allocate(room, 1);
        for (int k = 2; k == 2 || is_taken(c, c->n, other); k++) snprintf(other, room, "%s_%d", base, k);
        c->list[i].identifier = other;
        c->list[i].odd = 1;
        free(base);
    }
}

static void print_constants(const char *robot, const char *kind, constants *c) {
    make_unique(c);
    for (int i = 0; i < c->n; i++) {
        printf("    ");
        print_upper(robot);
        printf("_%s_%s = %d,", kind, c->list[i].identifier, c->list[i].value);
        if (c->list[i].odd) {
            printf(" /* ");
            print_in_comment(c->list[i].name);
            printf(" */");
        }
        printf("\n");
        free(c->list[i].identifier);
    }
    free(c->list);
}

static void print_bodies(const char *robot, const rbd_model *m) {
    constants c = {0};
    for (int b = 0; b < rbd_nb(m); b++)
        if (rbd_body_name(m, b)) add(&c, rbd_body_name(m, b), "", b);
    print_constants(robot, "BODY", &c);
}

/* Of q or of v; a joint that mimics has none. */
static void print_coordinates(const char *robot, const rbd_model *m, int of_q) {
    constants c = {0};
    for (int b = 0; b < rbd_nb(m); b++) {
        rbd_joint_info j;
        rbd_joint(m, b, &j);
        for (int k = 0; k < (of_q ? j.nq : j.nv) && rbd_joint_name(m, b); k++) {
            const char *part = of_q ? coordinate_names(j.type)[k] : dof_names(j.type)[k];
            add(&c, rbd_joint_name(m, b), part, (of_q ? j.iq : j.iv) + k);
        }
    }
    print_constants(robot, of_q ? "Q" : "DOF", &c);
}

static void print_size(const char *robot, const char *what, int n, const char *comment) {
    printf("#define ");
    print_upper(robot);
    printf("_%s %d /* %s */\n", what, n, comment);
}

void print_c_indices(const robot *r, const char *name) {
    print_size(name, "NB", r->urdf.nb, "bodies");
    print_size(name, "NQ", rbd_nq(r->model), "length of q");
    print_size(name, "NV", rbd_nv(r->model), "degrees of freedom: length of v, a and tau");
    printf("\n#ifndef ");
    print_upper(name);
    printf("_INDICES /* the description and the built model have the same */\n#define ");
    print_upper(name);
    printf("_INDICES\nenum { /* bodies; Q: in q; DOF: in v, a and tau */\n");
    print_bodies(name, r->model);
    print_coordinates(name, r->model, 1);
    print_coordinates(name, r->model, 0);
    printf("};\n#endif\n");
}
