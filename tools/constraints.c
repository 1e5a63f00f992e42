/* constraints.c - see constraints.h. SPDX-License-Identifier: MIT */
#include "constraints.h"
#include "csv.h"
#include "nearest.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The columns: twelve numbers of either frame, and these. */
enum { BODY1 = 24, BODY2, AXES, KP, KD, COLUMNS };

static void column_name(int i, char name[24]) {
    static const char *const others[] = {"body1", "body2", "axes", "kp", "kd"};
    const int body = i / 12 + 1, k = i % 12;
    if (i >= BODY1)
        snprintf(name, 24, "%s", others[i - BODY1]);
    else if (k < 3)
        snprintf(name, 24, "%c%d", "xyz"[k], body);
    else
        snprintf(name, 24, "r%d_%d", body, k - 3);
}

static int report_unknown(const csv *header, const char *cell) {
    nearest n = nearest_to(cell);
    char name[24], hint[140];
    for (int i = 0; i < COLUMNS; i++) {
        column_name(i, name);
        nearest_see(&n, name, strlen(name));
    }
    return csv_error(header, "column '%s' is unknown%s", cell, nearest_hint(&n, hint));
}

/* where[i]: the cell of column i, -1 if the table has none. */
static int find_cells(const csv *header, int where[COLUMNS]) {
    char name[24];
    for (int i = 0; i < COLUMNS; i++) where[i] = -1;
    for (int k = 0; k < header->n; k++) {
        int i = 0;
        for (; i < COLUMNS; i++) {
            column_name(i, name);
            if (strcmp(header->cells[k], name) == 0) break;
        }
        if (i == COLUMNS) return report_unknown(header, header->cells[k]);
        if (where[i] >= 0) return csv_error(header, "column '%s' stands twice", name);
        where[i] = k;
    }
    if (where[BODY1] < 0) return csv_error(header, "column 'body1' is missing");
    if (where[AXES] < 0) return csv_error(header, "column 'axes' is missing");
    return 0;
}

/* The cell of column i, "" if there is none. */
static const char *cell_of(const csv *row, const int where[COLUMNS], int i) {
    return where[i] < 0 ? "" : row->cells[where[i]];
}

/* Leaves x as it is where the cell is empty. */
static int read_number(const csv *row, const int where[COLUMNS], int i, double *x) {
    const char *cell = cell_of(row, where, i);
    char *end, name[24];
    if (!*cell) return 0;
    *x = strtod(cell, &end);
    if (end != cell && !*end && isfinite(*x)) return 0;
    column_name(i, name);
    return csv_error(row, "column '%s': '%s' is not a finite number", name, cell);
}

/* first: column of the frame's x. The rotation: none of the nine or all. */
static int read_frame(const csv *row, const int where[COLUMNS], int first, double p[3], double R[9]) {
    int given = 0;
    char name[24];
    for (int k = 0; k < 9; k++) R[k] = k % 4 == 0;
    for (int k = 0; k < 12; k++)
        if (read_number(row, where, first + k, k < 3 ? &p[k] : &R[k - 3]) != 0) return -1;
    for (int k = 3; k < 12; k++) given += *cell_of(row, where, first + k) != 0;
    for (int k = 3; k < 12 && given; k++) {
        column_name(first + k, name);
        if (!*cell_of(row, where, first + k))
            return csv_error(row, "column '%s' is missing or empty: a rotation has nine numbers, or none",
                             name);
    }
    return 0;
}

/* Of no name: the world, if it may be. */
static int read_link(const csv *row, const int where[COLUMNS], int i, const robot *r, int *body) {
    const char *link = cell_of(row, where, i);
    char reason[REASON], name[24];
    *body = -1;
    if (strcmp(link, "world") == 0 || (!*link && i == BODY2)) return 0;
    *body = robot_link(r, link, reason);
    if (*body >= 0) return 0;
    column_name(i, name);
    return csv_error(row, "column '%s': %s", name, reason);
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

static int read_row(const csv *row, const int where[COLUMNS], int width, const robot *r, rbd_constraint *k) {
    memset(k, 0, sizeof *k);
    if (row->n != width)
        return csv_error(row, "it has %d cell%s, the header %d", row->n, row->n == 1 ? "" : "s", width);
    if (read_frame(row, where, 0, k->position1, k->rotation1) != 0) return -1;
    if (read_frame(row, where, 12, k->position2, k->rotation2) != 0) return -1;
    if (read_number(row, where, KP, &k->kp) != 0 || read_number(row, where, KD, &k->kd) != 0) return -1;
    if (read_link(row, where, BODY1, r, &k->body1) != 0) return -1;
    if (read_link(row, where, BODY2, r, &k->body2) != 0) return -1;
    return read_axes(row, cell_of(row, where, AXES), k->axes);
}

/* rows[i]: where constraint i stands in the table. */
static int read_all(csv *table, const robot *r, rbd_constraint **list, int **rows) {
    int where[COLUMNS], n = 0, room = 0, width, status = csv_read(table);
    if (status == 0) return csv_error(table, "no header: the table is empty");
    if (status < 0 || find_cells(table, where) != 0) return -1;
    width = table->n;
    for (; (status = csv_read(table)) > 0; n++) {
        if (n == room) {
            *list = grown(*list, (size_t)(room = 2 * room + 16) * sizeof **list);
            *rows = grown(*rows, (size_t)room * sizeof **rows);
        }
        (*rows)[n] = table->line;
        if (read_row(table, where, width, r, &(*list)[n]) != 0) return -1;
    }
    return status < 0 ? -1 : n;
}

/* Prepares the set. Returns 0, or -1 after a message. */
static int prepare(csv *table, const rbd_model *m, rbd_work *w, const rbd_constraint *list, int n,
                   const int *rows, void **memory, rbd_constraint_set **c) {
    const size_t size = rbd_constraint_set_size(m, list, n);
    const rbd_finding *f;
    rbd_report report;
    *memory = allocate(size + 1, 1);
    if (rbd_constraint_set_init(m, w, list, n, *memory, size, c, &report) == RBD_OK) return 0;
    f = &report.error;
    table->line = f->body < 0 ? 1 : rows[f->body];
    return csv_error(table, "%s%s%s", f->field ? f->field : "", f->field ? ": " : "",
                     f->text ? f->text : rbd_status_string(f->status));
}

int constraints_read(const char *path, const robot *r, rbd_work *w, rbd_constraint **list, void **memory,
                     rbd_constraint_set **c) {
    csv table = {0};
    int n, *rows = NULL;
    *list = NULL, *memory = NULL;
    table.name = path;
    table.from = fopen(path, "r");
    if (!table.from) {
        fprintf(stderr, "%s: %s: %s\n", program, path, strerror(errno));
        return -1;
    }
    n = read_all(&table, r, list, &rows);
    fclose(table.from);
    if (n >= 0 && prepare(&table, r->model, w, *list, n, rows, memory, c) != 0) n = -1;
    csv_free(&table);
    free(rows);
    return n;
}
