/* derivatives_quad.c - derivatives of inverse and forward dynamics against differences of rbd_rnea and
   rbd_aba themselves, in quad precision: random robots of every joint type, with wrenches, rotors,
   joints that mimic others and several roots; each also on a floating base, with joints of its own. */
#define RBD_REAL __float128
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "rbd_derivatives.h"

#include "fuzz/robots.h"
#include "larger.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 24, ROBOTS = 24, WRT_Q = 0, WRT_V = 1 };
#define H 1e-12     /* of central differences: the error goes with its square */
#define BOUND 1e-12 /* relative to the largest entry */

static const rbd_model *m;
static rbd_work *w;
static rbd_derivatives *d;
static rbd_real q[WORLD_COORDINATES], v[MOST], x[MOST], f_ext[6 * WORLD_BODIES]; /* x: a or tau */
static int failures, compared, with_base;
static double worst;

static void run(rbd_status status) {
    if (status != RBD_OK) exit((fprintf(stderr, "%s\n", rbd_status_string(status)), 1));
}

static double size(rbd_real y) { return (double)(y < 0 ? -y : y); }

/* Column k of a derivative of tau or a, from both sides. */
static void difference(int forward, int by, int k, rbd_real *column) {
    rbd_real to[WORLD_COORDINATES], speed[MOST], y[2][MOST];
    for (int side = 0; side < 2; side++) {
        rbd_real step[MOST] = {0};
        step[k] = side ? -H : H;
        for (int i = 0; i < rbd_nv(m); i++) speed[i] = v[i] + (by == WRT_V ? step[i] : 0);
        if (by == WRT_Q)
            run(rbd_integrate(m, q, step, 1, to));
        else
            memcpy(to, q, sizeof to);
        run(forward ? rbd_aba(m, w, to, speed, x, f_ext, y[side])
                    : rbd_rnea(m, w, to, speed, x, f_ext, y[side]));
    }
    for (int i = 0; i < rbd_nv(m); i++) column[i] = (y[0][i] - y[1][i]) / (2 * (rbd_real)H);
}

static void compare(const char *what, const char *robot, int forward, int by, const rbd_real *found) {
    const int nv = rbd_nv(m);
    rbd_real column[MOST];
    double error = 0, largest = 0;
    for (int k = 0; k < nv; k++) {
        difference(forward, by, k, column);
        for (int i = 0; i < nv; i++) {
            error = larger(error, size(column[i] - found[i * nv + k]));
            largest = larger(largest, size(column[i]));
        }
    }
    error = largest > 0 ? error / largest : error;
    worst = larger(worst, error);
    compared++;
    if (error <= BOUND) return;
    failures++;
    printf("%s, %s: error %.2g of the largest entry\n", robot, what, error);
}

/* Unless it has too many joints, or is singular. */
static void check(sample *s, const char *name, uint64_t seed) {
    static rbd_real by_q[MOST * MOST], by_v[MOST * MOST];
    void *model_memory = malloc(rbd_model_size(s->bodies, s->nb)), *work_memory, *memory;
    run(rbd_model_build(s->bodies, s->nb, model_memory, rbd_model_size(s->bodies, s->nb), &m, NULL));
    work_memory = malloc(rbd_work_size(m)), memory = malloc(rbd_derivatives_size(m));
    run(rbd_work_init(m, work_memory, rbd_work_size(m), &w));
    run(rbd_derivatives_init(m, w, memory, rbd_derivatives_size(m), &d));
    if (rbd_nv(m) > 0 && rbd_nv(m) <= MOST) {
        run(rbd_random(m, &seed, q));
        for (int i = 0; i < rbd_nv(m); i++) v[i] = uniform(&seed, -2, 2), x[i] = uniform(&seed, -3, 3);
        for (int i = 0; i < 6 * s->nb; i++) f_ext[i] = uniform(&seed, -5, 5);
        with_base += d->base > 0;
        run(rbd_id_derivatives(m, d, q, v, x, f_ext, by_q, by_v, NULL));
        compare("dtau/dq", name, 0, WRT_Q, by_q);
        compare("dtau/dv", name, 0, WRT_V, by_v);
        if (rbd_fd_derivatives(m, d, q, v, x, f_ext, NULL, by_q, by_v, NULL) == RBD_OK) {
            compare("da/dq", name, 1, WRT_Q, by_q);
            compare("da/dv", name, 1, WRT_V, by_v);
        }
    }
    free(memory), free(work_memory), free(model_memory);
}

int main(void) {
    static const int classes[] = {ORDINARY, AXES, FOLLOWERS};
    static sample s;
    for (int k = 0; k < ROBOTS; k++) {
        char name[64];
        const int class_number = classes[k % 3];
        draw_robot(&s, class_number, k);
        snprintf(name, sizeof name, "%s %d", class_names[class_number], k);
        check(&s, name, (uint64_t)k + 1);
        s.bodies[0].type = RBD_FLOATING;
        for (int b = 0; b < s.nb; b++) {
            s.bodies[b].mimic = NULL;
            if (b > 0 && s.bodies[b].parent < 0) s.bodies[b].parent = 0;
        }
        snprintf(name, sizeof name, "%s %d, floating", class_names[class_number], k);
        check(&s, name, (uint64_t)k + 1);
    }
    printf("%d matrices, %d robots on a free base; largest error %.2g\n", compared, with_base, worst);
    return failures > 0 || compared < 2 * ROBOTS || with_base < ROBOTS / 4;
}
