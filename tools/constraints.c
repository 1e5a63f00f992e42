/* constraints.c - see constraints.h. SPDX-License-Identifier: MIT */
#include "constraints.h"
#include "csv.h"
#include "robot.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NUMBERS = 24, COLUMNS = NUMBERS + 5 };

/* The columns: numbers of body 1, of body 2, then the others, of which the last two may be missing. */
static void column_name(int i, char name[24]) {
    static const char *const others[] = {"body1", "body2", "axes", "kp", "kd"};
    const int body = i / 12 + 1, k = i % 12;
    if (i >= NUMBERS)
        snprintf(name, 24, "%s", others[i - NUMBERS]);
    else if (k < 3)
        snprintf(name, 24, "%c%d", "xyz"[k], body);
    else
        snprintf(name, 24, "r%d_%d", body, k - 3);
}

static int find_cells(const csv *header, int where[COLUMNS]) {
    for (int i = 0; i < COLUMNS; i++) {
        char name[24];
        column_name(i, name);
        where[i] = -1;
        for (int k = 0; k < header->n; k++) {
            if (strcmp(header->cells[k], name) != 0) continue;
            if (where[i] >= 0) return csv_error(header, "column '%s' stands twice", name);
            where[i] = k;
        }
        if (where[i] < 0 && i < COLUMNS - 2) return csv_error(header, "column '%s' is missing", name);
    }
    return 0;
}

static int read_number(const csv *row, const int where[COLUMNS], int i, double *x) {
    const char *cell = where[i] < 0 ? "0" : row->cells[where[i]];
    char *end, name[24];
    *x = strtod(cell, &end);
    if (end != cell && !*end && isfinite(*x)) return 0;
    column_name(i, name);
    return csv_error(row, "column '%s': '%s' is not a finite number", name, cell);
}

static int read_link(const csv *row, const char *name, const rbd_model *m, int *body) {
    *body = strcmp(name, "world") == 0 ? -1 : rbd_body_index(m, name);
    if (*body >= 0 || strcmp(name, "world") == 0) return 0;
    return csv_error(row, "the robot has no link '%s' (one on a fixed joint needs --keep)", name);
}

static int read_axes(const csv *row, const char *cell, int axes[6]) {
    if (strlen(cell) != 6 || strspn(cell, "01") != 6)
        return csv_error(row, "column 'axes': '%s' is not six characters 0 or 1", cell);
    for (int i = 0; i < 6; i++) axes[i] = cell[i] == '1';
    return 0;
}

static int read_row(const csv *row, const int where[COLUMNS], int width, const rbd_model *m,
                    rbd_constraint *k) {
    double x[NUMBERS], gains[2];
    memset(k, 0, sizeof *k);
    if (row->n != width) return csv_error(row, "it has %d cells, the header %d", row->n, width);
    for (int i = 0; i < NUMBERS; i++)
        if (read_number(row, where, i, &x[i]) != 0) return -1;
    for (int i = 0; i < 2; i++)
        if (read_number(row, where, COLUMNS - 2 + i, &gains[i]) != 0) return -1;
    memcpy(k->position1, x, sizeof k->position1);
    memcpy(k->rotation1, x + 3, sizeof k->rotation1);
    memcpy(k->position2, x + 12, sizeof k->position2);
    memcpy(k->rotation2, x + 15, sizeof k->rotation2);
    k->kp = gains[0], k->kd = gains[1];
    if (read_link(row, row->cells[where[NUMBERS]], m, &k->body1) != 0) return -1;
    if (read_link(row, row->cells[where[NUMBERS + 1]], m, &k->body2) != 0) return -1;
    return read_axes(row, row->cells[where[NUMBERS + 2]], k->axes);
}

static int read_all(csv *table, const rbd_model *m, rbd_constraint **list) {
    int where[COLUMNS], n = 0, room = 0, width, status = csv_read(table);
    if (status == 0) return csv_error(table, "no header: the table is empty");
    if (status < 0 || find_cells(table, where) != 0) return -1;
    width = table->n;
    while ((status = csv_read(table)) > 0) {
        if (n == room) *list = grown(*list, (size_t)(room = 2 * room + 16) * sizeof **list);
        if (read_row(table, where, width, m, &(*list)[n++]) != 0) return -1;
    }
    return status < 0 ? -1 : n;
}

int constraints_read(const char *path, const rbd_model *m, rbd_work *w, rbd_constraint **list, void **memory,
                     rbd_constraints **c) {
    csv table = {0};
    rbd_report report;
    char text[200];
    size_t size;
    int n;
    *list = NULL, *memory = NULL;
    table.name = path;
    table.from = fopen(path, "r");
    if (!table.from) {
        fprintf(stderr, "%s: %s: %s\n", program, path, strerror(errno));
        return -1;
    }
    n = read_all(&table, m, list);
    fclose(table.from);
    csv_free(&table);
    if (n < 0) return -1;
    size = rbd_constraints_size(m, *list, n);
    *memory = allocate(size + 1, 1);
    if (rbd_constraints_init(m, w, *list, n, *memory, size, c, &report) == RBD_OK) return n;
    fprintf(stderr, "%s: %s: %s\n", program, path,
            rbd_constraint_finding_text(&report.error, text, sizeof text));
    return -1;
}
