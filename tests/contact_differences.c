/* contact_differences.c - see contact_differences.h */
#include "rbd_contact.h"

#include "contact_differences.h"

#include <stdlib.h>
#include <string.h>

static const rbd_model *model;
static rbd_contact_set *set;

static void must(int holds) {
    if (!holds) exit(2);
}

static void open_set(void) {
    static unsigned char model_memory[RBD_MODEL_SIZE(HYQ_NB)], work_memory[RBD_WORK_SIZE(HYQ_NB, HYQ_NV)];
    static unsigned char memory[RBD_CONTACT_SET_SIZE(HYQ_NV, FEET, 0)];
    const rbd_contact_options options = {.slop = 1e-3, .tolerance = 1e-13, .iterations = 2000};
    rbd_contact foot[FEET];
    rbd_work *w;
    must(rbd_model_build(hyq_bodies, HYQ_NB, model_memory, sizeof model_memory, &model, NULL) == RBD_OK);
    must(rbd_work_init(model, work_memory, sizeof work_memory, &w) == RBD_OK);
    for (int i = 0; i < FEET; i++)
        foot[i] = (rbd_contact){
            .body1 = HYQ_BODY_LF_LOWERLEG + i, .body2 = -1, .point = {0.33, 0, 0}, .friction = 0.7};
    must(rbd_contact_set_init(model, w, foot, FEET, NULL, 0, &options, memory, sizeof memory, &set, NULL) ==
         RBD_OK);
}

/* The step after component k of q, v or tau (x = 0, 1, 2) has moved by t. */
static void moved_step(const hyq_step *x, int of, int k, double t, double *q_next, double *v_next) {
    double q[HYQ_NQ], v[HYQ_NV], tau[HYQ_NV], unit[HYQ_NV] = {0};
    memcpy(q, x->q, sizeof q), memcpy(v, x->v, sizeof v), memcpy(tau, x->tau, sizeof tau);
    unit[k] = 1;
    if (of == 0) rbd_integrate(model, x->q, unit, t, q);
    if (of == 1) v[k] += t;
    if (of == 2) tau[k] += t;
    rbd_contact_reset(set);
    must(rbd_contact_step(model, set, q, v, tau, NULL, x->damping, x->dt, q_next, v_next) == RBD_OK);
}

/* Of order four. */
void differentiate_hyq(hyq_step *x) {
    static const double steps[3] = {1e-5, 1e-4, 1e-3}, factor[4] = {1, -8, 8, -1};
    double q[HYQ_NQ], v[HYQ_NV], q_next[HYQ_NQ], v_next[HYQ_NV], d[HYQ_NV];
    if (!set) open_set();
    memset(x->by, 0, sizeof x->by);
    moved_step(x, 0, 0, 0, q, v);
    for (int i = 0; i < FEET; i++) x->state[i] = (int)rbd_contact_get(set, i, NULL, NULL);
    for (int of = 0; of < 3; of++)
        for (int k = 0; k < HYQ_NV; k++)
            for (int j = 0; j < 4; j++) {
                moved_step(x, of, k, steps[of] * (j < 2 ? j - 2 : j - 1), q_next, v_next);
                rbd_difference(model, q, q_next, d);
                for (int i = 0; i < HYQ_NV; i++) {
                    x->by[of][i * HYQ_NV + k] += factor[j] * d[i] / (12 * steps[of]);
                    x->by[3 + of][i * HYQ_NV + k] += factor[j] * v_next[i] / (12 * steps[of]);
                }
            }
}
