#include "rbd_ik.h"

#include "models/hyq_model.h"

const rbd_model *m = &hyq_model;
unsigned char work_memory[HYQ_WORK_SIZE];
rbd_work *w;
rbd_status status;
double q[HYQ_NQ];

/* A foot at a place, with the trunk upright; the trunk's turn about z, and where it is, are free. */
void example_rbd_ik(void) {
    const rbd_ik_target targets[2] = {
        {.kind = RBD_IK_POINT,
         .body = HYQ_BODY_LF_LOWERLEG,
         .point = {0.33, 0, 0},
         .position = {0.4, 0.2, 0}},
        {.kind = RBD_IK_AXIS, .body = HYQ_BODY_BASE_LINK_0, .axis = {0, 0, 1}, .direction = {0, 0, 1}}};
    static unsigned char memory[RBD_IK_SIZE(HYQ_NB, HYQ_NV, 2)];
    rbd_ik_result result;
    char text[100];
    status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
    if (status == RBD_OK) status = rbd_neutral(m, q);
    const rbd_ik_status found = rbd_ik(m, w, targets, 2, NULL, memory, sizeof memory, q, &result);
    if (found != RBD_IK_REACHED) {
        rbd_ik_text(found, &result, text, sizeof text);
        status = RBD_ERR_INFEASIBLE;
    }
}

/* Memory at run time. */
void example_rbd_ik_size(void) {
    if (rbd_ik_size(m, 2) > RBD_IK_SIZE(HYQ_NB, HYQ_NV, 2)) status = RBD_ERR_MEMORY;
}
