/* constraints.c - see constraints.h. SPDX-License-Identifier: MIT */
#include "constraints.h"
#include "csv.h"
#include "nearest.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The columns of a table: their names, ended by NULL; at first those that must be there. */
typedef struct kind {
    const char *const *names;
    int needed;
} kind;

enum { COLUMNS = 29 }; /* of a table at most */

/* Constraints: these, then twelve numbers of either frame. */
enum { BODY1, AXES, BODY2, KP, KD, FRAME1, FRAME2 = FRAME1 + 12 };
static const char *const constraint_names[COLUMNS + 1] = {
    "body1", "axes", "body2", "kp",   "kd",   "x1",   "y1",   "z1",   "r1_0", "r1_1",
    "r1_2",  "r1_3", "r1_4",  "r1_5", "r1_6", "r1_7", "r1_8", "x2",   "y2",   "z2",
    "r2_0",  "r2_1", "r2_2",  "r2_3", "r2_4", "r2_5", "r2_6", "r2_7", "r2_8", NULL};
static const kind constraints = {constraint_names, 2};

/* Contacts: body1 and body2 stand at BODY1 and BODY2. */
enum { NAME = 1, POINT = 3, NORMAL = 6, NUMBERS = 9 };
static const char *const contact_names[] = {
    "body1", "name",   "body2",  "x",        "y",           "z",         "nx",      "ny",
    "nz",    "height", "radius", "friction", "restitution", "stiffness", "damping", NULL};
static const kind contacts = {contact_names, 1};

static int report_unknown(const csv *header, const kind *k, const char *cell) {
    nearest n = nearest_to(cell);
    char hint[140];
    if (header->n == 1 && strpbrk(cell, ";\t")) return csv_separators(header);
    for (int i = 0; k->names[i]; i++) nearest_see(&n, k->names[i], strlen(k->names[i]));
    return csv_error(header, "column '%s' is unknown%s", cell, nearest_hint(&n, hint));
}

/* where[i]: the cell of column i, -1 if the table has none. */
static int find_cells(const csv *header, const kind *k, int where[COLUMNS]) {
    for (int i = 0; i < COLUMNS; i++) where[i] = -1;
    for (int cell = 0; cell < header->n; cell++) {
        int i = 0;
        while (k->names[i] && strcmp(header->cells[cell], k->names[i]) != 0) i++;
        if (!k->names[i]) return report_unknown(header, k, header->cells[cell]);
        if (where[i] >= 0) return csv_error(header, "column '%s' stands twice", k->names[i]);
        where[i] = cell;
    }
    for (int i = 0; i < k->needed; i++)
        if (where[i] < 0) return csv_error(header, "column '%s' is missing", k->names[i]);
    return 0;
}

/* The cell of column i, "" if there is none. */
static const char *cell_of(const csv *row, const int where[COLUMNS], int i) {
    return where[i] < 0 ? "" : row->cells[where[i]];
}

/* Leaves x as it is where the cell is empty. */
static int read_number(const csv *row, const kind *k, const int where[COLUMNS], int i, double *x) {
    const char *cell = cell_of(row, where, i);
    char *end;
    if (!*cell) return 0;
    *x = strtod(cell, &end);
    if (end != cell && !*end && isfinite(*x)) return 0;
    return csv_error(row, "column '%s': '%s' is not a finite number", k->names[i], cell);
}

/* first: column of the frame's x. The rotation: none of the nine or all. */
static int read_frame(const csv *row, const int where[COLUMNS], int first, double p[3], double R[9]) {
    int given = 0;
    for (int k = 0; k < 9; k++) R[k] = k % 4 == 0;
    for (int k = 0; k < 12; k++)
        if (read_number(row, &constraints, where, first + k, k < 3 ? &p[k] : &R[k - 3]) != 0) return -1;
    for (int k = 3; k < 12; k++) given += *cell_of(row, where, first + k) != 0;
    for (int k = 3; k < 12 && given; k++)
        if (!*cell_of(row, where, first + k))
            return csv_error(row, "column '%s' is missing or empty: a rotation has nine numbers, or none",
                             constraint_names[first + k]);
    return 0;
}

/* Of no name: the world, if it may be. */
static int read_link(const csv *row, const int where[COLUMNS], int i, const robot *r, int *body) {
    const char *link = cell_of(row, where, i);
    char reason[REASON];
    *body = -1;
    if (strcmp(link, "world") == 0 || (!*link && i == BODY2)) return 0;
    *body = robot_link(r, link, reason);
    return *body >= 0 ? 0 : csv_error(row, "column '%s': %s", constraint_names[i], reason);
}

static int read_axes(const csv *row, const char *cell, int axes[6]) {
    if (strlen(cell) != 6 || strspn(cell, "01") != 6)
        return csv_error(row, "column 'axes': '%s' is not six characters 0 or 1%s", cell,
                         *cell && strlen(cell) < 6 && strspn(cell, "01") == strlen(cell)
                             ? "; did a spreadsheet take leading zeros away?"
                             : "");
    for (int i = 0; i < 6; i++) axes[i] = cell[i] == '1';
    return 0;
}

static int read_constraint(const csv *row, const int where[COLUMNS], const robot *r, rbd_constraint *k) {
    memset(k, 0, sizeof *k);
    if (read_frame(row, where, FRAME1, k->position1, k->rotation1) != 0) return -1;
    if (read_frame(row, where, FRAME2, k->position2, k->rotation2) != 0) return -1;
    if (read_number(row, &constraints, where, KP, &k->kp) != 0) return -1;
    if (read_number(row, &constraints, where, KD, &k->kd) != 0) return -1;
    if (read_link(row, where, BODY1, r, &k->body1) != 0) return -1;
    if (read_link(row, where, BODY2, r, &k->body2) != 0) return -1;
    return read_axes(row, cell_of(row, where, AXES), k->axes);
}

static int read_contact(const csv *row, const int where[COLUMNS], const robot *r, rbd_contact *a) {
    double *const numbers[] = {&a->height,      &a->radius,    &a->friction,
                               &a->restitution, &a->stiffness, &a->damping};
    memset(a, 0, sizeof *a);
    for (int j = 0; j < 3; j++) {
        if (read_number(row, &contacts, where, POINT + j, &a->point[j]) != 0) return -1;
        if (read_number(row, &contacts, where, NORMAL + j, &a->normal[j]) != 0) return -1;
    }
    for (int j = 0; j < 6; j++)
        if (read_number(row, &contacts, where, NUMBERS + j, numbers[j]) != 0) return -1;
    if (read_link(row, where, BODY1, r, &a->body1) != 0) return -1;
    if (read_link(row, where, BODY2, r, &a->body2) != 0) return -1;
    a->on_body = a->body2 >= 0;
    return 0;
}

/* A table of either kind: its items, of this size; names, of contacts; rows[i]: where item i stands. */
typedef struct items {
    const kind *kind;
    void *list;
    size_t size;
    char (*name)[ITEM_NAME];
    int *rows, n;
} items;

/* Item x->n, a contact, is called as its cell says, or by its number. */
static int read_name(const csv *row, const int where[COLUMNS], items *x) {
    const char *cell = cell_of(row, where, NAME);
    char *name = x->name[x->n];
    if (strlen(cell) >= ITEM_NAME)
        return csv_error(row, "column 'name': it has more than %d characters", ITEM_NAME - 1);
    strcpy(name, cell);
    if (!*name) snprintf(name, ITEM_NAME, "%d", x->n);
    for (int i = 0; i < x->n; i++)
        if (strcmp(x->name[i], name) == 0) return csv_error(row, "column 'name': '%s' stands twice", name);
    return 0;
}

/* Returns 0, or -1 after a message. */
static int read_all(csv *table, const robot *r, items *x) {
    int where[COLUMNS], room = 0, width, status = csv_read(table);
    if (status == 0) return csv_error(table, "no header: the table is empty");
    if (status < 0 || find_cells(table, x->kind, where) != 0) return -1;
    width = table->n;
    for (; (status = csv_read(table)) > 0; x->n++) {
        if (x->n == room) {
            x->list = grown(x->list, (size_t)(room = 2 * room + 16) * x->size);
            x->rows = grown(x->rows, (size_t)room * sizeof *x->rows);
            x->name = grown(x->name, (size_t)room * sizeof *x->name);
        }
        x->rows[x->n] = table->line;
        if (table->n != width)
            return csv_error(table, "it has %d cell%s, the header %d", table->n, table->n == 1 ? "" : "s",
                             width);
        if (x->kind == &constraints)
            status = read_constraint(table, where, r, (rbd_constraint *)x->list + x->n);
        else if ((status = read_contact(table, where, r, (rbd_contact *)x->list + x->n)) == 0)
            status = read_name(table, where, x);
        if (status != 0) return -1;
    }
    return status;
}

/* Opens and reads. The caller closes. */
static int read_file(csv *table, const char *path, const robot *r, items *x) {
    int status;
    table->name = path;
    table->from = fopen(path, "r");
    if (!table->from) {
        fprintf(stderr, "%s: %s: %s\n", program, path, strerror(errno));
        return -1;
    }
    status = read_all(table, r, x);
    fclose(table->from);
    return status;
}

/* Prints a finding about item f->body, with the row of its table. */
static int report_finding(csv *table, const items *x, const rbd_finding *f) {
    table->line = f->body < 0 || f->body >= x->n ? 1 : x->rows[f->body];
    return csv_error(table, "%s%s%s", f->field ? f->field : "", f->field ? ": " : "",
                     f->text ? f->text : rbd_status_string(f->status));
}

/* Those of the robot's own MJCF file. */
static int take_constraints(const robot *r, rbd_work *w, rbd_constraint **list, void **memory,
                            rbd_constraint_set **c) {
    const int n = r->nconstraints;
    const size_t size = rbd_constraint_set_size(r->model, r->constraints, n);
    rbd_report report;
    char text[REASON];
    *list = allocate((size_t)n, sizeof **list);
    if (n > 0) memcpy(*list, r->constraints, (size_t)n * sizeof **list);
    *memory = allocate(size + 1, 1);
    if (rbd_constraint_set_init(r->model, w, *list, n, *memory, size, c, &report) == RBD_OK) return n;
    fprintf(stderr, "%s: %s: %s\n", program, r->path,
            rbd_constraint_finding_text(&report.error, text, sizeof text));
    return -1;
}

int constraints_read(const char *path, const robot *r, rbd_work *w, rbd_constraint **list, void **memory,
                     rbd_constraint_set **c) {
    if (r->constraints && strcmp(path, r->path) == 0) return take_constraints(r, w, list, memory, c);
    csv table = {0};
    items x = {&constraints, NULL, sizeof **list, NULL, NULL, 0};
    rbd_report report;
    int status = read_file(&table, path, r, &x);
    *list = x.list, *memory = NULL;
    if (status == 0) {
        const size_t size = rbd_constraint_set_size(r->model, *list, x.n);
        *memory = allocate(size + 1, 1);
        if (rbd_constraint_set_init(r->model, w, *list, x.n, *memory, size, c, &report) != RBD_OK)
            status = report_finding(&table, &x, &report.error);
    }
    csv_free(&table);
    free(x.rows);
    free(x.name);
    return status == 0 ? x.n : -1;
}

int contacts_read(const char *path, const robot *r, rbd_work *w, const rbd_constraint *held, int n_held,
                  char (**name)[ITEM_NAME], void **memory, rbd_contact_set **c) {
    csv table = {0};
    items x = {&contacts, NULL, sizeof(rbd_contact), NULL, NULL, 0};
    rbd_report report;
    int status = read_file(&table, path, r, &x);
    *name = x.name, *memory = NULL;
    if (status == 0) {
        const size_t size = rbd_contact_set_size(r->model, x.n, held, n_held, NULL);
        *memory = allocate(size + 1, 1);
        if (rbd_contact_set_init(r->model, w, x.list, x.n, held, n_held, NULL, *memory, size, c, &report) !=
            RBD_OK)
            status = report_finding(&table, &x, &report.error);
    }
    csv_free(&table);
    free(x.rows);
    free(x.list);
    return status == 0 ? x.n : -1;
}
