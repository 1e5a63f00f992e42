/* model.c - for Frama-C: the build, the work and the index functions stay in their arrays for all
   descriptions of NB bodies with these joint types, all parents and all following of joints, whatever numbers
   (NaN and infinity too) stand in the other fields; and the sizes that rbd.h states suffice. See
   README.md. */
#include "__fc_builtin.h"

#include <stdint.h>
#include <stdlib.h>

static void *own_array(size_t bytes) {
    void *array = malloc(bytes); /* never NULL: an option of the proof */
#ifdef ALGORITHMS
    Frama_C_make_unknown(array, bytes); /* which of it is written where is for valgrind: tests/meson.build */
#endif
    return array;
}
#include "arrays.h"

#ifdef ALL_TYPES
#define TYPES 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15
#else /* one of each shape: links, coordinates, dofs, whether it can follow */
#define TYPES \
    RBD_FIXED, RBD_REVOLUTE, RBD_CONTINUOUS_CS, RBD_UNIVERSAL, RBD_SPHERICAL, RBD_EULER_ZYX, RBD_PLANAR, \
        RBD_FLOATING
#endif

static const int types[] = {TYPES};
enum { TYPE_COUNT = sizeof types / sizeof types[0], MAX_V = 6 * NB, MAX_Q = 7 * NB };
#ifndef FIRST /* of two bodies: a pair of types by itself; without, every pair */
#define FIRST 0
#define SECOND 0
enum { FIRST_COUNT = TYPE_COUNT, SECOND_COUNT = TYPE_COUNT };
#else
enum { FIRST_COUNT = 1, SECOND_COUNT = 1 };
#endif
static rbd_body bodies[NB];
static unsigned char memory[1]; /* only its address counts */

/* Eva proves the annotation where it proves that the condition holds. */
static void claim(int condition) {
    //@ assert holds: condition != 0;
}

static void unknown(void *array, size_t bytes) { Frama_C_make_unknown(array, bytes); }

static void indices(const rbd_model *m) {
    const int nv = rbd_nv(m), size = rbd_packed_size(m);
    claim(nv >= 0 && nv <= MAX_V && rbd_nq(m) >= nv && rbd_nq(m) <= MAX_Q);
    claim(size >= nv && size <= nv * (nv + 1) / 2);
    for (int i = 0; i < nv; i++) {
        claim(rbd_dof_body(m, i) >= 0 && rbd_dof_body(m, i) < NB);
        for (int j = 0; j < nv; j++) {
            const int at = rbd_packed_index(m, i, j);
            claim(at >= -1 && at < size && (i != j || at >= 0));
        }
    }
    for (int b = 0; b < NB; b++) {
        rbd_joint_info joint;
        claim(rbd_joint(m, b, &joint) == RBD_OK);
        claim(joint.nv == 0 || (joint.iq >= 0 && joint.iq + joint.nq <= rbd_nq(m)));
        claim(joint.nv == 0 || (joint.iv >= 0 && joint.iv + joint.nv <= nv));
    }
}

/* Exactly as long as the model's: what is written beyond its end is found. */
static void configurations(const rbd_model *m) {
    uint64_t seed = Frama_C_unsigned_long_interval(0, UINT64_MAX);
    rbd_real *q = own_array((size_t)rbd_nq(m) * sizeof *q);
    claim(rbd_neutral(m, q) == RBD_OK);
    claim(rbd_random(m, &seed, q) == RBD_OK);
}

/* Every algorithm, on states that are any bits at all. */
static void algorithms(const rbd_model *m, rbd_work *w) {
    const size_t nq = (size_t)rbd_nq(m) * sizeof(rbd_real), nv = (size_t)rbd_nv(m) * sizeof(rbd_real);
    rbd_real *q = own_array(nq), *v = own_array(nv), *f = own_array(6 * NB * sizeof *f),
             *next = own_array(nq), *a = own_array(nv), *M = own_array((size_t)rbd_nv(m) * nv),
             *H = own_array((size_t)rbd_packed_size(m) * sizeof *H), R[9], p[3], velocity[6], kinetic,
             potential;
    unknown(q, nq), unknown(v, nv), unknown(f, 6 * NB * sizeof *f);
    rbd_rnea(m, w, q, v, v, f, a);
    rbd_bias(m, w, q, v, NULL, a);
    rbd_gravity_torque(m, w, q, a);
    rbd_aba(m, w, q, v, v, f, a);
    rbd_fd_cholesky(m, w, q, v, v, f, a);
    rbd_crba(m, w, q, M);
    rbd_crba_packed(m, w, q, H);
    rbd_cholesky_factor_packed(m, w, H);
    rbd_cholesky_factor(m, w, M, H);
    rbd_cholesky_solve(m, w, H, v, a);
    rbd_body_kinematics(m, w, NB - 1, q, v, NULL);
    rbd_kinematics(m, w, q, v, v);
    for (int b = -1; b < NB; b++)
        rbd_body_pose(m, w, b, R, p), rbd_body_velocity(m, w, b, velocity),
            rbd_body_acceleration(m, w, b, velocity), rbd_body_acceleration_classical(m, w, b, velocity);
    rbd_energy(m, w, &kinetic, &potential);
    rbd_com(m, w, R, p, NULL);
    rbd_integrate(m, q, v, kinetic, next);
    rbd_difference(m, q, next, v);
    rbd_passive(m, w, v, a);
}

static void prove_one(void) {
    const rbd_model *m;
    rbd_work *w;
    rbd_report report;
    size_t size = rbd_model_size(bodies, NB);
    claim(size > 0 && size <= RBD_MODEL_SIZE(NB));
    taken = 0;
    if (rbd_model_build(bodies, NB, memory, size, &m, &report) != RBD_OK) return;
    claim(taken + RBDI_ALIGN <= size);
    indices(m);
    configurations(m);
    size = rbd_work_size(m);
    taken = 0;
    claim(rbd_work_init(m, memory, size, &w) == RBD_OK);
    claim(taken + RBDI_ALIGN <= size);
#ifdef ALGORITHMS
    algorithms(m, w);
#endif
    Frama_C_show_each_proved(NB);
}

/* Descriptions whose joint types, parents and names are given, and nothing else. */
static void describe(int i, int type, int parent, int follows) {
    static const char *const names[3] = {"a", "b", "c"};
    Frama_C_make_unknown((char *)&bodies[i], sizeof bodies[i]);
    bodies[i].parent = parent;
    bodies[i].type = (rbd_joint_type)type;
    bodies[i].name = bodies[i].joint = names[i];
    bodies[i].mimic = follows < 0 ? NULL : names[follows];
}

int main(void) {
    for (int t = FIRST; t < FIRST + FIRST_COUNT; t++) {
        describe(0, types[t], -1, -1);
#if NB == 1
        prove_one();
#else
        for (int u = SECOND; u < SECOND + SECOND_COUNT; u++)
            for (int p = -1; p < 1; p++)
                for (int f = -1; f < 1; f++) {
                    describe(1, types[u], p, f);
#if NB == 2
                    prove_one();
#else
                    for (int x = 0; x < TYPE_COUNT; x++)
                        for (int o = -1; o < 2; o++) {
                            describe(2, types[x], o, -1);
                            prove_one();
                        }
#endif
                }
#endif
    }
    return 0;
}
