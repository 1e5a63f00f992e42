#include "rbd_ik.h"

#include "models/iiwa_model.h"

const rbd_model *m = &iiwa_model;
unsigned char work_memory[IIWA_WORK_SIZE];
rbd_work *w;
rbd_status status;
double q[IIWA_NQ];

/* The tool of an arm at a place, pointing down; the turn about the tool is free. */
void example_rbd_ik(void) {
    const rbd_ik_target tool[2] = {
        {.kind = RBD_IK_POINT, .body = 6, .point = {0, 0, 0.15}, .position = {0.5, 0.2, 0.4}},
        {.kind = RBD_IK_AXIS, .body = 6, .axis = {0, 0, 1}, .direction = {0, 0, -1}}};
    static unsigned char memory[RBD_IK_SIZE(IIWA_NB, IIWA_NV, 2)];
    rbd_ik_result result;
    char text[100];
    status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
    const rbd_ik_status found = rbd_ik(m, w, tool, 2, NULL, memory, sizeof memory, q, &result);
    if (found != RBD_IK_REACHED) {
        rbd_ik_text(found, &result, text, sizeof text);
        status = RBD_ERR_INFEASIBLE;
    }
}

/* Memory at run time. */
void example_rbd_ik_size(void) {
    if (rbd_ik_size(m, 2) > RBD_IK_SIZE(IIWA_NB, IIWA_NV, 2)) status = RBD_ERR_MEMORY;
}
