/* features.c - RBD_FEATURES: a library with the features of one robot alone gives the results of the whole
   library, and refuses models that need more. Compiled twice: with -DROBOT=iiwa
   -DROBOT_FEATURES=IIWA_FEATURES it is that library, without them the test. */
#ifdef ROBOT_FEATURES
#define RBD_STATIC
#define RBD_FEATURES ROBOT_FEATURES
#define HEADER_OF(robot) ROBOT_HEADER(robot)
#define ROBOT_HEADER(robot) <models/robot##_model.h>
#include HEADER_OF(ROBOT)
#endif
#ifndef WHOLE_IS_LINKED
#define RBD_IMPLEMENTATION
#endif
#include "rbd_derivatives.h"

#include "rbd_contact.h"
#include "rbd_ik.h"
#include "rbd_estimate.h"

#include "rbd_actuator.h"

#include "all_calls.h"
#include "larger.h"
#include <math.h>
#include <stdio.h>

typedef rbd_status work_for(const rbd_model *m, void *memory, size_t size, rbd_work **w);
typedef rbd_status torque_by(const rbd_model *m, rbd_work *w, const rbd_real *q, rbd_real *tau);
typedef rbd_status motion_of(const rbd_model *m, rbd_work *w, const rbd_real *q, const rbd_real *v,
                             const rbd_real *a);
void calls_with_features(const rbd_model *m, int states, all_calls_sink *sink, void *to);
extern work_for *const work_with_features;
extern torque_by *const torque_with_features;
extern motion_of *const kinematics_with_features;

#ifdef ROBOT_FEATURES
void calls_with_features(const rbd_model *m, int states, all_calls_sink *sink, void *to) {
    all_calls_of(m, states, sink, to);
}
work_for *const work_with_features = rbd_work_init;
torque_by *const torque_with_features = rbd_gravity_torque;
motion_of *const kinematics_with_features = rbd_kinematics;
#else
#include "models/atlas.h"
#include "models/cart_pole.h"
#include "models/hyq.h"
#include "models/iiwa.h"

enum { MOST = 1 << 22 };

typedef struct results {
    rbd_real *x;
    int n, calls;
    const char *call[MOST / 64];
    int first[MOST / 64];
    rbd_status status[MOST / 64];
} results;

static void keep(void *to, const char *header, const char *call, rbd_status status, const rbd_real *x,
                 int n) {
    results *r = (results *)to;
    (void)header;
    r->call[r->calls] = call, r->first[r->calls] = r->n, r->status[r->calls++] = status;
    memcpy(r->x + r->n, x, sizeof *x * (size_t)n);
    r->n += n;
    if (r->n > MOST / 2 || r->calls > MOST / 128) abort();
}

static int failures;

/* Both libraries agree to rounding, relative to the largest result of the call. */
static void compare(const char *name, const results *a, const results *b) {
    int zeros = 0;
    if (a->calls != b->calls || a->n != b->n || a->calls < 100) failures++, printf("%s: other calls\n", name);
    for (int i = 0; i < a->calls && !failures; i++) {
        const int end = i + 1 < a->calls ? a->first[i + 1] : a->n;
        double largest = 0, error = 0;
        for (int k = a->first[i]; k < end; k++) {
            largest = larger(largest, fabs(a->x[k]));
            error = larger(error, fabs(a->x[k] - b->x[k]));
        }
        zeros += end > a->first[i] && !(largest > 0);
        if (a->status[i] == b->status[i] && error <= 1e-10 * largest && largest < HUGE_VAL) continue;
        failures++;
        printf("%s: %s: status %d and %d, error %g of %g\n", name, a->call[i], a->status[i], b->status[i],
               error, largest);
    }
    if (zeros > a->calls / 4) failures++, printf("%s: most results are 0\n", name);
    printf("%s: %d calls, %d results\n", name, a->calls, a->n);
}

/* A base that is turned, and a ball joint within the tree, need code that HyQ does not. */
static void refuse_other_blocks(const rbd_model *hyq) {
    static unsigned char memory[RBD_MODEL_SIZE(HYQ_NB)];
    for (int i = 0; i < 2; i++) {
        rbd_body bodies[HYQ_NB];
        const rbd_model *m;
        rbd_work *w;
        void *work;
        memcpy(bodies, hyq_bodies, sizeof bodies);
        if (i)
            bodies[HYQ_NB - 1].type = RBD_SPHERICAL;
        else
            memcpy(bodies[0].rotation, (const double[9]){0, -1, 0, 1, 0, 0, 0, 0, 1},
                   sizeof bodies[0].rotation);
        if (rbd_model_build(bodies, HYQ_NB, memory, sizeof memory, &m, NULL)) failures++;
        work = malloc(rbd_work_size(m));
        if ((m->features & ~hyq->features) == 0 ||
            work_with_features(m, work, rbd_work_size(m), &w) != RBD_ERR_LEFT_OUT)
            failures++, printf("hyq with another block is not refused: %d\n", i);
        free(work);
    }
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        const rbd_body *bodies;
        int nb;
    } robots[] = {{"iiwa", iiwa_bodies, IIWA_NB},
                  {"hyq", hyq_bodies, HYQ_NB},
                  {"atlas", atlas_bodies, ATLAS_NB},
                  {"cart_pole", cart_pole_bodies, CART_POLE_NB}};
    static unsigned char memory[RBD_MODEL_SIZE(ATLAS_NB)], armed[RBD_MODEL_SIZE(ATLAS_NB)];
    static results whole, few;
    int refused = 0, own = 0;
    whole.x = (rbd_real *)malloc(sizeof *whole.x * MOST), few.x = (rbd_real *)malloc(sizeof *few.x * MOST);
    for (size_t i = 0; i < sizeof robots / sizeof *robots; i++) {
        const rbd_model *m, *other;
        rbd_body bodies[ATLAS_NB];
        rbd_work *w;
        rbd_real q[ATLAS_NQ] = {0}, tau[ATLAS_NV];
        rbd_status status;
        void *work;
        if (rbd_model_build(robots[i].bodies, robots[i].nb, memory, sizeof memory, &m, NULL)) return 2;
        work = malloc(rbd_work_size(m));
        status = work_with_features(m, work, rbd_work_size(m), &w);
        refused += status == RBD_ERR_LEFT_OUT;
        if (status == RBD_OK) {
            own += argc > 1 && strcmp(argv[1], robots[i].name) == 0;
            whole.n = whole.calls = few.n = few.calls = 0;
            all_calls_of(m, 4, keep, &whole);
            calls_with_features(m, 4, keep, &few);
            compare(robots[i].name, &whole, &few);
            if (robots[i].bodies == hyq_bodies) refuse_other_blocks(m);
            /* The same robot with a heavy rotor has a work of the same size, and other features. */
            memcpy(bodies, robots[i].bodies, sizeof *bodies * (size_t)robots[i].nb);
            bodies[robots[i].nb - 1].armature[0] = 1;
            if (rbd_model_build(bodies, robots[i].nb, armed, sizeof armed, &other, NULL)) return 2;
            if ((other->features & ~m->features) == 0) continue;
            if (torque_with_features(other, w, q, tau) != RBD_ERR_WORK ||
                kinematics_with_features(other, w, q, NULL, NULL) != RBD_ERR_WORK)
                failures++, printf("%s: a model with other features uses its work\n", robots[i].name);
        } else if (status != RBD_ERR_LEFT_OUT) {
            failures++, printf("%s: status %d\n", robots[i].name, status);
        }
        free(work);
    }
    printf("%d of 4 robots refused\n", refused);
    free(whole.x), free(few.x);
    return failures || (argc > 1 && own != 1) || refused == 0;
}
#endif
