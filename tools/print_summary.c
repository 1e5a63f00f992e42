/* The summary of a robot by rbd-model: tree, joints, masses, warnings. SPDX-License-Identifier: MIT */
#include "print.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the order of a tree ---- */

/* The frames depth first: order[k] is the frame shown in row k, depth[i] that of frame i. */
static void depth_first(const rbd_urdf *u, int *order, int *depth) {
    int *last_child = allocate((size_t)u->nframes, sizeof *last_child); /* 1 + its index, 0 = none */
    int *before = allocate((size_t)u->nframes, sizeof *before);         /* the sibling before it, likewise */
    int *stack = allocate((size_t)u->nframes, sizeof *stack);
    int rows = 0, top = 0;
    for (int i = 1; i < u->nframes; i++) {
        const int parent = u->frames[i].parent;
        before[i] = last_child[parent];
        last_child[parent] = i + 1;
        depth[i] = depth[parent] + 1;
    }
    stack[top++] = 0;
    while (top > 0) {
        const int i = order[rows++] = stack[--top];
        for (int child = last_child[i]; child; child = before[child - 1]) stack[top++] = child - 1;
    }
    free(last_child);
    free(before);
    free(stack);
}

/* ---- the cells of a row ---- */

enum { COLUMNS = 6, CELL = 160 };
static const char *const heads[COLUMNS] = {"link", "joint", "type", "axis", "limits", "mass"};
typedef char row[COLUMNS][CELL];

static void axis_cell(const rbd_body *b, char cell[CELL]) {
    for (int i = 0; i < 3; i++) {
        const double *a = b->axis;
        const double others = a[(i + 1) % 3] * a[(i + 1) % 3] + a[(i + 2) % 3] * a[(i + 2) % 3];
        if (others == 0 && a[i] != 0) {
            snprintf(cell, CELL, "%s%c", a[i] < 0 ? "-" : "", "xyz"[i]);
            return;
        }
    }
    snprintf(cell, CELL, "(%.4g %.4g %.4g)", b->axis[0], b->axis[1], b->axis[2]);
}

static void limits_cell(const rbd_body *b, char cell[CELL]) {
    int n = 0;
    if (b->lower < b->upper) n += snprintf(cell, CELL, "%.4g .. %.4g", b->lower, b->upper);
    if (b->velocity > 0) n += snprintf(cell + n, (size_t)(CELL - n), "%sv %.4g", n ? ", " : "", b->velocity);
    if (b->effort > 0) snprintf(cell + n, (size_t)(CELL - n), "%seffort %.4g", n ? ", " : "", b->effort);
}

/* "= -2 other + 0.1", the 1 and the 0 left out. */
static void mimic_text(const rbd_body *b, char text[CELL]) {
    char ratio[32] = "", offset[32] = "";
    if (b->mimic_ratio != 1) snprintf(ratio, sizeof ratio, "%.4g ", b->mimic_ratio);
    if (b->mimic_offset != 0)
        snprintf(offset, sizeof offset, " %c %.4g", b->mimic_offset < 0 ? '-' : '+', fabs(b->mimic_offset));
    snprintf(text, CELL, " = %s%s%s", ratio, b->mimic, offset);
}

static void joint_cells(const rbd_body *b, row cells) {
    char mimic[CELL] = "";
    if (b->mimic) mimic_text(b, mimic);
    snprintf(cells[2], CELL, "%s%.120s", joint_type_name(b->type), mimic);
    if (b->type != RBD_FLOATING && b->type != RBD_PLANAR && b->type != RBD_SPHERICAL) axis_cell(b, cells[3]);
    limits_cell(b, cells[4]);
}

/* The body whose own frame a link is, -1 if it is merged or the world. */
static int own_body(const rbd_urdf *u, const rbd_urdf_frame *f) {
    const rbd_body *b = f->body < 0 ? NULL : &u->bodies[f->body];
    return b && b->name && strcmp(b->name, f->link) == 0 ? f->body : -1;
}

static void fill_row(const rbd_urdf *u, int i, int depth, row cells) {
    const rbd_urdf_frame *f = &u->frames[i];
    const int own = own_body(u, f), moving = rbd_urdf_joint_index(u, f->joint);
    memset(cells, 0, sizeof(row));
    snprintf(cells[0], CELL, "%*s%s", depth > 20 ? 40 : 2 * depth, "", f->link);
    if (f->joint) snprintf(cells[1], CELL, "%s", f->joint);
    if (moving >= 0)
        joint_cells(&u->bodies[moving], cells);
    else if (f->joint)
        snprintf(cells[2], CELL, own >= 0 ? "fixed, kept" : "fixed");
    else
        snprintf(cells[2], CELL, "%s",
                 f->body < 0 ? "(the world)" : joint_type_name(u->bodies[f->body].type));
    if (own >= 0 && u->bodies[own].mass > 0) snprintf(cells[5], CELL, "%.4g kg", u->bodies[own].mass);
}

/* Characters, not bytes: those that continue one in UTF-8 do not count. */
static int width(const char *text) {
    int n = 0;
    for (; *text; text++) n += ((unsigned char)*text & 0xc0) != 0x80;
    return n;
}

static void print_row(const char *index, const char *const cells[COLUMNS], const int widths[COLUMNS]) {
    int spaces = 0; /* those at the end of a line are left out */
    printf("%4s", index);
    for (int k = 0; k < COLUMNS; k++) {
        spaces += 2;
        if (cells[k][0]) {
            printf("%*s%s", spaces, "", cells[k]);
            spaces = 0;
        }
        spaces += widths[k] - (cells[k][0] ? width(cells[k]) : 0);
    }
    printf("\n");
}

static void print_table(const rbd_urdf *u) {
    const size_t n = (size_t)u->nframes;
    int *order = allocate(n, sizeof *order), *depth = allocate(n, sizeof *depth);
    row *rows = allocate(n, sizeof *rows);
    int widths[COLUMNS];
    depth_first(u, order, depth);
    for (int k = 0; k < COLUMNS; k++) widths[k] = width(heads[k]);
    for (size_t i = 0; i < n; i++) {
        fill_row(u, order[i], depth[order[i]], rows[i]);
        for (int k = 0; k < COLUMNS; k++)
            widths[k] = width(rows[i][k]) > widths[k] ? width(rows[i][k]) : widths[k];
    }
    print_row("body", heads, widths);
    for (size_t i = 0; i < n; i++) {
        const int body = own_body(u, &u->frames[order[i]]);
        const char *cells[COLUMNS];
        char index[16] = "";
        for (int k = 0; k < COLUMNS; k++) cells[k] = rows[i][k];
        if (body >= 0) snprintf(index, sizeof index, "%d", body);
        print_row(index, cells, widths);
    }
    free(order);
    free(depth);
    free(rows);
}

/* ---- all ---- */

static const char *plural(int n) { return n == 1 ? "" : "s"; }

/* Of a robot for kinematics alone: the first joint that moves no mass. */
static void print_massless(const rbd_model *m) {
    const size_t size = rbd_work_size(m);
    void *memory = allocate(size, 1);
    rbd_work *w;
    rbd_work_init(m, memory, size, &w);
    if (rbd_singular_dof(w) >= 0) {
        const int body = rbd_dof_body(m, rbd_singular_dof(w));
        printf("for kinematics alone: joint %s moves no mass\n",
               rbd_joint_name(m, body) ? rbd_joint_name(m, body) : "");
    }
    free(memory);
}

void print_summary(const robot *r) {
    const rbd_urdf *u = &r->urdf;
    const int nv = rbd_nv(r->model), nq = rbd_nq(r->model);
    printf("%s: %d link%s, %d bod%s, %d degree%s of freedom (q has %d number%s)\n", u->name, u->nframes,
           plural(u->nframes), u->nb, u->nb == 1 ? "y" : "ies", nv, plural(nv), nq, plural(nq));
    print_massless(r->model);
    printf("moving mass %.6g kg", rbd_mass(r->model));
    if (u->fixed_mass > 0)
        printf("; fixed to the world %.6g kg%s", u->fixed_mass,
               strcmp(u->frames[0].link, "world") ? " (--floating for a free base)" : "");
    printf("\n\n");
    print_table(u);
    if (r->nconstraints > 0) printf("\n");
    for (int i = 0; i < r->nconstraints; i++)
        printf("constraint %s: %s\n", r->constraints[i].name, r->constraints[i].axes[0] ? "weld" : "connect");
    printf("\n%d warning%s\n", u->nwarnings, plural(u->nwarnings));
    for (int i = 0; i < u->nwarnings; i++) {
        if (u->warnings[i].line) printf("line %d: ", u->warnings[i].line);
        printf("%s\n", u->warnings[i].text);
    }
}
