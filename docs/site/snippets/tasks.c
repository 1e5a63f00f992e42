#include "rbd_tasks.h"

#include "models/hyq_model.h"

enum { NV = HYQ_NV, FEET = 4 };

const rbd_model *m = &hyq_model;
unsigned char work_memory[HYQ_WORK_SIZE], memory[RBD_TASKS_SIZE(HYQ_NV, 6 + HYQ_NV, 4, 0)];
rbd_work *w;
rbd_status status;
double q[HYQ_NQ], v[HYQ_NV];
rbd_task_contact feet[4];

/* HyQ, its legs bent, on the feet. */
static void stand(void) {
    status = rbd_work_init(m, work_memory, sizeof work_memory, &w);
    if (status == RBD_OK) status = rbd_neutral(m, q);
    for (int i = 0; i < FEET; i++) {
        q[HYQ_Q_LF_HFE_JOINT + i] = i < 2 ? 0.7 : -0.7;
        q[HYQ_Q_LF_KFE_JOINT + i] = i < 2 ? -1.4 : 1.4;
        feet[i].body = HYQ_BODY_LF_LOWERLEG + i;
        feet[i].point[0] = 0.33;
        feet[i].friction = 0.5;
    }
}

/* The trunk rises at 0.1 m/s, and the feet stay where they are. */
void example_rbd_tasks_velocity(void) {
    stand();
    const rbd_task wishes[2] = {
        {.kind = RBD_TASK_POSE, .body = HYQ_BODY_BASE_LINK_0, .velocity = {0, 0, 0, 0, 0, 0.1}},
        {.kind = RBD_TASK_POSTURE, .level = 1, .q = q}};
    const rbd_tasks problem = {.task = wishes, .tasks = 2, .contact = feet, .contacts = FEET, .dt = 1e-3};
    rbd_tasks_result result;
    if (rbd_tasks_velocity(m, w, &problem, q, memory, sizeof memory, v, &result) < 0)
        status = RBD_ERR_INFEASIBLE;
}

/* It stands: accelerations, forces of the feet, torques of the motors. */
void example_rbd_tasks_acceleration(void) {
    double a[NV], forces[3 * FEET], tau[NV];
    const double rest[NV] = {0};
    stand();
    const rbd_task wishes[2] = {{.kind = RBD_TASK_POSE, .body = HYQ_BODY_BASE_LINK_0, .gain = 10},
                                {.kind = RBD_TASK_POSTURE, .q = q, .gain = 10, .weight = 1e-3}};
    const rbd_tasks problem = {.task = wishes, .tasks = 2, .contact = feet, .contacts = FEET, .dt = 1e-3};
    rbd_tasks_result result;
    const rbd_tasks_status found =
        rbd_tasks_acceleration(m, w, &problem, q, rest, memory, sizeof memory, a, forces, tau, &result);
    char text[100];
    if (found < 0) {
        rbd_tasks_text(found, &result, text, sizeof text);
        status = RBD_ERR_INFEASIBLE;
    }
}

/* Memory at run time. */
void example_rbd_tasks_size(void) {
    const rbd_task wish = {.kind = RBD_TASK_COM};
    const rbd_tasks problem = {.task = &wish, .tasks = 1, .contact = feet, .contacts = FEET, .dt = 1e-3};
    if (rbd_tasks_size(m, &problem) > sizeof memory) status = RBD_ERR_MEMORY;
}
