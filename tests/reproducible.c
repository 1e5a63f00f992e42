/* reproducible.c - RBD_REPRODUCIBLE: hashes over the results of all calls, which are the same whatever
   compiled this and whatever runs it. Prints a line for each header; with -DEACH_CALL one for each call. With
   -DALONE=NAME and -DMODEL_FILE of the table of that robot alone, with or without RBD_FEATURES.
   reproducible.sh compares them with reproducible.txt. */
#ifndef NOT_REPRODUCIBLE
#define RBD_REPRODUCIBLE
#endif
#define RBD_IMPLEMENTATION
#ifdef RBD_FEATURES
#include MODEL_FILE /* the features alone */
#endif

#include "rbd_spatial.h"

#include "rbd_qp.h"

#include "rbd_derivatives.h"

#include "rbd_contact.h"

#include "rbd_ik.h"
#include "rbd_estimate.h"
#include "rbd_actuator.h"

#include "rbd_tasks.h"

#ifdef ALONE
#include MODEL_FILE
#else
#include "models/atlas.h"
#include "models/atlas_model.h"
#include "models/hyq.h"
#include "models/hyq_model.h"
#include "models/iiwa.h"
#include "models/iiwa_model.h"
#endif

#include "all_calls.h"
#include <stdio.h>

#define WORLD_LONG_DOUBLE /* nothing is computed with it here */
#include "fuzz/robots.c"

#define QUOTE_OF(x) #x
#define QUOTE(x) QUOTE_OF(x)
#define PASTE_OF(a, b) a##b
#define PASTE(a, b) PASTE_OF(a, b)

/* Of robots.c's descriptions; world.c has them too, with all else. */
int world_nv(const rbd_body *b) { return rbdi_joint_facts(b->type)->nv; }
int world_nq(const rbd_body *b) { return rbdi_joint_facts(b->type)->nq; }

/* ---- hashes ---- */

/* FNV-1a, of Fowler, Noll and Vo, over the bytes of a word of `size` bytes, the least first. */
static void hash_word(uint64_t *hash, uint64_t word, int size) {
    for (int i = 0; i < size; i++) *hash = (*hash ^ (word >> 8 * i & 255)) * UINT64_C(0x100000001b3);
}

/* The bits of a number; all that are none count as the same one. */
static void hash_number(uint64_t *hash, rbd_real x) {
    rbdi_bit bits;
    memcpy(&bits, &x, sizeof bits);
    if (!(x - x <= 0) && !(x < 0) && !(x > 0)) bits = ~(rbdi_bit)0;
    hash_word(hash, bits, (int)sizeof bits);
}

enum { HEADERS = 10 };
static const char *const headers[HEADERS] = {
    "rbd.h",          "rbd_derivatives.h", "rbd_constraints.h", "rbd_contact.h",  "rbd_ik.h",
    "rbd_estimate.h", "rbd_spatial.h",     "rbd_qp.h",          "rbd_actuator.h", "rbd_tasks.h"};

typedef struct hashes {
    uint64_t of[HEADERS];
    int calls, each; /* whether each call is printed */
    const char *robot;
} hashes;

static void hash_call(void *to, const char *header, const char *call, rbd_status status, const rbd_real *x,
                      int n) {
    hashes *h = (hashes *)to;
    uint64_t own = UINT64_C(0xcbf29ce484222325);
    int k = 0;
    while (strcmp(headers[k], header) != 0) k++;
    hash_word(&own, (uint64_t)(int64_t)status, 8);
    for (int i = 0; i < n; i++) hash_number(&own, x[i]);
    hash_word(&h->of[k], own, 8);
    h->calls++;
    if (h->each)
        printf("%s %s %d %d %08lx%08lx %.*s\n", QUOTE(RBD_REAL), h->robot, h->calls, (int)status,
               (unsigned long)(own >> 32), (unsigned long)(own & UINT32_MAX), (int)strcspn(call, "\n"), call);
}

/* ---- what is computed ---- */

/* From what rbd_describe says of the model, every robot a second time. */
static void hash_described(const rbd_model *m, hashes *h) {
    rbd_real x[64];
    for (int i = 0; i < rbd_nb(m); i++) {
        rbd_body row;
        const rbd_status status = rbd_describe(m, i, &row);
        int n = 0;
        for (int k = 0; k < 3; k++) x[n++] = (rbd_real)row.axis[k], x[n++] = (rbd_real)row.position[k];
        for (int k = 0; k < 3; k++) x[n++] = (rbd_real)row.axis2[k], x[n++] = (rbd_real)row.com[k];
        for (int k = 0; k < 9; k++) x[n++] = (rbd_real)row.rotation[k];
        for (int k = 0; k < 6; k++) x[n++] = (rbd_real)row.inertia[k];
        x[n++] = (rbd_real)row.mass, x[n++] = (rbd_real)row.pitch;
        hash_call(h, "rbd.h", "rbd_describe", status, x, n);
    }
}

static void hash_model(const char *name, const rbd_model *m, int states, hashes *h) {
    h->robot = name;
    hash_described(m, h);
    all_calls_of(m, states, hash_call, h);
}

/* Every third joint held at a pose. */
static void hash_locked(const rbd_body *bodies, int nb, const rbd_model *m, hashes *h) {
    rbd_body *rows = (rbd_body *)malloc(sizeof *rows * (size_t)nb);
    unsigned char *locked = (unsigned char *)malloc((size_t)nb);
    double *q = (double *)malloc(sizeof *q * (size_t)(rbd_nq(m) + 1));
    rbd_real x[12];
    for (int i = 0; i < nb; i++) locked[i] = i % 3 == 0;
    for (int k = 0; k < rbd_nq(m); k++) q[k] = 0.375 * (k % 9 - 4) + 0.0625;
    const rbd_status status = rbd_lock_joints(bodies, nb, locked, q, rows, NULL);
    for (int i = 0; i < nb; i++) {
        for (int k = 0; k < 3; k++) x[k] = (rbd_real)rows[i].position[k];
        for (int k = 0; k < 9; k++) x[3 + k] = (rbd_real)rows[i].rotation[k];
        hash_call(h, "rbd.h", "rbd_lock_joints", status, x, 12);
    }
    free(rows), free(locked), free(q);
}

/* The last body's pose in a model for kinematics alone. */
static void hash_kinematic(const rbd_body *bodies, int nb, hashes *h) {
    const size_t size = rbd_model_size(bodies, nb);
    void *memory = malloc(size), *work_memory = NULL;
    uint64_t seed = 5;
    const rbd_model *m;
    rbd_work *w;
    rbd_real x[12] = {0};
    rbd_status status = rbd_model_build_kinematic(bodies, nb, memory, size, &m, NULL);
    if (!status) {
        rbd_real *q = (rbd_real *)malloc(sizeof *q * (size_t)(rbd_nq(m) + 1));
        work_memory = malloc(rbd_work_size(m));
        rbd_random(m, &seed, q);
        status = rbd_work_init(m, work_memory, rbd_work_size(m), &w);
        if (!status) status = rbd_kinematics(m, w, q, NULL, NULL);
        if (!status) status = rbd_body_pose(m, w, nb - 1, x, x + 9);
        free(q);
    }
    hash_call(h, "rbd.h", "rbd_model_build_kinematic", status, x, 12);
    free(work_memory), free(memory);
}

static void hash_description(const char *name, const rbd_body *bodies, int nb, int states, hashes *h) {
    const size_t size = rbd_model_size(bodies, nb);
    void *memory = malloc(size);
    const rbd_model *m;
    rbd_report report;
    rbd_status status = rbd_model_build(bodies, nb, memory, size, &m, &report);
    h->robot = name;
    hash_call(h, "rbd.h", "rbd_model_build", status, NULL, 0);
    if (!status) hash_model(name, m, states, h);
    if (!status) {
        const double com[3] = {0.125, 0.25, -0.5}, inertia[6] = {0.5, 0, 0.125, 0.5, 0, 0.25};
        hash_call(h, "rbd.h", "rbd_add_payload", rbd_add_payload(memory, nb - 1, 1.5, com, inertia), NULL, 0);
        hash_described(m, h);
    }
    if (!status) hash_locked(bodies, nb, m, h);
    hash_kinematic(bodies, nb, h);
    free(memory);
}

/* Random robots of the fuzzer: all types of joints, mimic joints, massless links, axes in every position. */
static void hash_random(int each_class, hashes *h) {
    static sample s;
    for (int class_number = 0; class_number < CLASSES; class_number++)
        for (int i = 0; i < each_class; i++) {
            char name[32];
            draw_robot(&s, class_number, i);
            snprintf(name, sizeof name, "%s-%d", class_names[class_number], i);
            hash_description(name, s.bodies, s.nb, 2, h);
        }
}

static rbd_real *put_rotation(rbd_rotation r, rbd_real *x) {
    rbd_rotation_to_array(r, x);
    return x + 9;
}

/* Rotations and placements from and to turns; what is made of single vectors and arrays. */
static void hash_spatial_log(const rbd_real *in, hashes *h) {
    rbd_real out[128], *x = out;
    const rbd_vec3 turn = rbd_vec3_of(in[0], in[1], in[2]), shift = rbd_vec3_from_array(in + 3);
    const rbd_motion v = rbd_motion_of(turn, shift, 1);
    const rbd_force f = rbd_force_of(shift, turn, 1);
    const rbd_rotation R = rbd_rotation_exp(turn), S = rbd_rotation_from_axis_angle(shift, in[6]),
                       back = rbd_rotation_product(rbd_rotation_inverse(S), R);
    const rbd_placement p = rbd_placement_exp(v, 2);
    rbd_const com[3], inertia[6];
    rbd_vec3 axis;
    for (int k = 0; k < 3; k++) com[k] = (rbd_const)in[k];
    for (int k = 0; k < 6; k++) inertia[k] = (rbd_const)in[6 + k];
    x = put_rotation(back, put_rotation(S, put_rotation(R, x)));
    x = put_rotation(rbd_rotation_from_array(out), put_rotation(rbd_rotation_identity(), x));
    rbd_vec3_to_array(rbd_rotation_log(S), x), x += 3;
    *x++ = rbd_rotation_to_axis_angle(back, &axis);
    rbd_vec3_to_array(rbd_rotate_back(S, rbd_rotate(R, axis)), x), x += 3;
    x = put_rotation(p.rotation, x);
    rbd_motion_to_array(rbd_placement_log(rbd_placement_compose(p, rbd_placement_identity(2, 2))), x), x += 6;
    x = put_rotation(rbd_placement_from_arrays(out, in, 1, 2).rotation, x);
    rbd_force_to_array(rbd_force_add(f, rbd_force_scale(in[7], f)), x), x += 6;
    rbd_inertia_to_parameters(rbd_inertia_of((rbd_const)2.5, com, inertia, 1), x), x += 10;
    hash_call(h, "rbd_spatial.h", "turns and placements", RBD_OK, out, (int)(x - out));
}

static void hash_spatial(hashes *h) {
    uint64_t seed = 7;
    h->robot = "spatial";
    for (int n = 0; n < 20; n++) {
        rbd_real in[64], out[128], *x = out;
        all_calls_numbers(&seed, 2, in, 64);
        const rbd_rotation R = rbd_rotation_from_quaternion(in),
                           S = rbd_rotation_from_rpy(in[4], in[5], in[6]);
        const rbd_placement p = rbd_placement_of(rbd_rotation_product(R, S), rbd_vec3_from_array(&in[7]), 1,
                                                 2),
                            back = rbd_placement_inverse(p);
        const rbd_motion v = rbd_motion_up(p, rbd_motion_from_array(&in[10], 1)), u = rbd_motion_down(p, v);
        const rbd_force f = rbd_force_up(p, rbd_force_from_array(&in[16], 1)), g = rbd_force_down(p, f);
        const rbd_inertia I = rbd_inertia_from_parameters((const rbd_const *)&in[22], 1);
        x = put_rotation(rbd_placement_compose(p, back).rotation, x);
        x = put_rotation(p.rotation, x);
        rbd_rotation_to_quaternion(p.rotation, x), x += 4;
        rbd_rotation_to_rpy(p.rotation, x), x += 3;
        rbd_motion_to_array(rbd_motion_cross(v, rbd_motion_scale(in[32], v)), x), x += 6;
        rbd_motion_to_array(rbd_motion_add(u, u), x), x += 6;
        rbd_force_to_array(rbd_force_cross(u, g), x), x += 6;
        rbd_force_to_array(rbd_inertia_times(I, u), x), x += 6;
        rbd_inertia_to_parameters(rbd_inertia_down(p, rbd_inertia_up(p, rbd_inertia_add(I, I))), x), x += 10;
        rbd_vec3_to_array(rbd_point_down(p, rbd_point_up(back, rbd_vec3_from_array(in))), x), x += 3;
        *x++ = rbd_power(u, g);
        hash_call(h, "rbd_spatial.h", "frames, velocities, forces, inertias", RBD_OK, out, (int)(x - out));
        hash_spatial_log(in, h);
    }
}

/* Quadratic programs of 7 variables: definite and not, with equalities, soft rows, and rows that contradict
   each other; each solved again, warm, with another f. */
static void hash_qp(hashes *h) {
    enum { QP_N = 7, QP_ROWS = 9, QP_ALL = QP_N + QP_ROWS };
    static unsigned char memory[RBD_QP_SIZE(QP_N, QP_N, QP_ROWS, QP_ALL)];
    uint64_t seed = 11;
    h->robot = "qp";
    for (int n = 0; n < 60; n++) {
        rbd_real B[QP_N * QP_N], H[QP_N * QP_N] = {0}, f[2 * QP_N], C[QP_ROWS * QP_N];
        rbd_real ends[2 * QP_ALL], lower[QP_ALL], upper[QP_ALL], soft[QP_ALL], out[QP_N + QP_ALL];
        signed char side[QP_ALL];
        rbd_qp_problem p = {QP_N, QP_N, QP_ROWS, H, f, C, lower, upper, soft};
        rbd_qp_options o = {0, 0, 0, 0};
        all_calls_numbers(&seed, 2, B, QP_N * QP_N);
        all_calls_numbers(&seed, 2, f, 2 * QP_N);
        all_calls_numbers(&seed, 2, C, QP_ROWS * QP_N);
        all_calls_numbers(&seed, 1, ends, 2 * QP_ALL);
        for (int i = 0; i < QP_N; i++)
            for (int j = 0; j < QP_N; j++)
                for (int k = 0; k < QP_N - n % 3; k++) H[i * QP_N + j] += B[k * QP_N + i] * B[k * QP_N + j];
        for (int i = 0; i < QP_ALL; i++) {
            const rbd_real a = ends[2 * i], b = ends[2 * i + 1];
            lower[i] = i % 5 == 0 && n % 4 ? -(rbd_real)RBD_QP_NONE : a < b ? a : b;
            upper[i] = i == QP_N + n % 2 ? lower[i] : a < b ? b : a;
            soft[i] = i % 4 == n % 5 ? (rbd_real)(1 + i) : 0;
        }
        for (int warm = 0; warm < 2; warm++) {
            rbd_qp_status status;
            o.warm = warm;
            p.f = f + warm * QP_N;
            status = rbd_qp_solve(&p, &o, memory, sizeof memory, out, out + QP_N, side, NULL);
            hash_call(h, "rbd_qp.h", "rbd_qp_solve", (rbd_status)status, out, QP_N + QP_ALL);
        }
    }
}

/* Tasks of all kinds but rows of one's own on two levels, with two contacts: velocities, then accelerations
   cold and warm. */
static void hash_tasks(const char *name, const rbd_model *m, hashes *h) {
    enum { TASKS = RBD_TASK_POSTURE, CONTACTS = 2 };
    const int nq = rbd_nq(m), nv = rbd_nv(m), nb = rbd_nb(m);
    rbd_real *x = (rbd_real *)calloc((size_t)(2 * nq + 4 * nv + 3 * CONTACTS), sizeof *x);
    rbd_real *q = x, *home = q + nq, *v = home + nq, *out = v + nv;
    rbd_task task[TASKS] = {{0}};
    rbd_task_contact contact[CONTACTS] = {{0}};
    rbd_tasks p = {0};
    uint64_t seed = 12;
    h->robot = name;
    rbd_neutral(m, home);
    for (int i = 0; i < TASKS; i++) {
        task[i].kind = (rbd_task_kind)(i + 1), task[i].level = i % 2, task[i].gain = 3;
        task[i].body = nb - 1 - i % 3, task[i].reference = nb / 2, task[i].q = home;
        task[i].axis[i % 3] = task[i].direction[1] = 1;
        task[i].position[2] = (rbd_real)0.5;
    }
    for (int i = 0; i < CONTACTS; i++) {
        contact[i].body = nb - 1 - 2 * i, contact[i].friction = (rbd_real)0.75, contact[i].sides = 4 + 4 * i;
        contact[i].point[i] = (rbd_real)0.25, contact[i].normal[i + 1] = 2;
    }
    p.task = task, p.tasks = TASKS, p.contact = contact, p.contacts = CONTACTS, p.dt = (rbd_real)0.0078125;

    const size_t size = rbd_tasks_size(m, &p), work_size = rbd_work_size(m);
    void *memory = malloc(size), *work_memory = malloc(work_size);
    rbd_tasks_result result;
    rbd_work *w;
    rbd_work_init(m, work_memory, work_size, &w);
    for (int n = 0; n < 4; n++) {
        all_calls_numbers(&seed, (rbd_real)0.5, v, nv);
        rbd_integrate(m, home, v, 1, q);
        rbd_tasks_status status = rbd_tasks_velocity(m, w, &p, q, memory, size, out, &result);
        hash_call(h, "rbd_tasks.h", "rbd_tasks_velocity", (rbd_status)status, out, nv);
        for (p.warm = 0; p.warm < 2; p.warm++) {
            status =
                rbd_tasks_acceleration(m, w, &p, q, v, memory, size, out, out + 2 * nv, out + nv, &result);
            hash_call(h, "rbd_tasks.h", "rbd_tasks_acceleration", (rbd_status)status, out,
                      2 * nv + 3 * CONTACTS);
        }
        p.warm = 0;
    }
    free(memory), free(work_memory), free(x);
}

int main(void) {
    static hashes h;
#ifdef EACH_CALL
    h.each = 1;
#endif
#ifdef ALONE
    hash_model(QUOTE(ALONE), &PASTE(ALONE, _model), 4, &h);
#else
    hash_model("iiwa-table", &iiwa_model, 4, &h);
    hash_model("hyq-table", &hyq_model, 4, &h);
    hash_model("atlas-table", &atlas_model, 4, &h);
    hash_description("iiwa", iiwa_bodies, IIWA_NB, 2, &h);
    hash_description("hyq", hyq_bodies, HYQ_NB, 2, &h);
    hash_description("atlas", atlas_bodies, ATLAS_NB, 2, &h);
    hash_random(3, &h);
    hash_spatial(&h);
    hash_qp(&h);
    hash_tasks("iiwa-tasks", &iiwa_model, &h);
    hash_tasks("hyq-tasks", &hyq_model, &h);
    hash_tasks("atlas-tasks", &atlas_model, &h);
#endif
    for (int k = 0; !h.each && k < HEADERS; k++)
        printf("%s %s %08lx%08lx\n", QUOTE(RBD_REAL), headers[k], (unsigned long)(h.of[k] >> 32),
               (unsigned long)(h.of[k] & UINT32_MAX));
    return 0;
}
