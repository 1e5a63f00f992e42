/* The tree of links as a drawing for Graphviz. SPDX-License-Identifier: MIT */
#include "print.h"
#include <stdio.h>

static void quoted(const char *s) {
    for (; *s; s++) {
        if (*s == '"' || *s == '\\') putchar('\\');
        putchar(*s);
    }
}

void print_dot(const robot *r) {
    const rbd_urdf *u = &r->urdf;
    printf("digraph \"");
    quoted(u->name);
    printf("\" {\n  node [shape=box];\n");
    for (int i = 0; i < u->nframes; i++) {
        const rbd_urdf_frame *f = &u->frames[i];
        const int body = rbd_urdf_joint_index(u, f->joint);
        printf("  n%d [label=\"", i);
        quoted(f->link);
        if (body >= 0 && u->bodies[body].mass > 0) printf("\\n%.4g kg", u->bodies[body].mass);
        printf("\"%s];\n", body < 0 && f->parent >= 0 ? ", style=dashed" : "");
        if (f->parent < 0) continue;
        printf("  n%d -> n%d [label=\"", f->parent, i);
        quoted(f->joint);
        printf("\\n%s\"];\n", joint_type_name(body < 0 ? RBD_FIXED : u->bodies[body].type));
    }
    printf("}\n");
}
