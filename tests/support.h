/* support.h - what the test files share: models in memory, random trees and states, comparison. */
#ifndef SUPPORT_H
#define SUPPORT_H

#include "quiet_check.h"
#include <stdlib.h>

#include "rbd.h"

#include "larger.h"
#include "reference.h"
#include "textbook.h"

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))

enum { MAX_BODIES = TB_MAX_BODIES, MAX_V = 64, MAX_Q = 80 };

extern const double earth[3]; /* gravity (0, 0, -9.81) */

/* ---- models ---- */

/* A built model with its work memory. */
typedef struct robot {
    const char *name;
    const rbd_body *bodies;
    int nb, nq, nv;
    const rbd_model *m;
    rbd_work *w;
    void *memory[2];
} robot;

/* Builds and fails the test if the library refuses. The bodies must stay. */
robot robot_build(const char *name, const rbd_body *bodies, int nb);
robot robot_build_any(const char *name, const rbd_body *bodies, int nb); /* nq > MAX_Q or nv > MAX_V too */
void robot_free(robot *r);
#define BUILD(bodies) robot_build(#bodies, bodies, LENGTH(bodies))

/* ---- random numbers, states and trees ---- */

double uniform(uint64_t *seed, double low, double high);
int below(uint64_t *seed, int n); /* 0 ... n - 1 */

/* A state; the arrays are large enough for every robot of the tests. */
typedef struct state {
    double gravity[3];
    double q[MAX_Q], v[MAX_V], a[MAX_V], tau[MAX_V], f_ext[6 * MAX_BODIES];
} state;

/* Draws a state, all values of order one, and sets its gravity in the work structure. */
void draw_state(const robot *r, uint64_t *seed, state *s);

/* A random proper rotation; a random body that is physical; a random joint of this type, whose axes
   and place are often degenerate: parallel to the parent's, antiparallel, crossing, coincident. */
void random_rotation(uint64_t *seed, double R[9]);
void random_mass(uint64_t *seed, rbd_body *b);
void random_joint(uint64_t *seed, rbd_body *bodies, int index, rbd_joint_type type);

/* nb bodies on random joints with random parents, at most MAX_V degrees of freedom, every leaf with
   mass; now and then without mass between, with armature, or following another joint. */
void random_tree(uint64_t *seed, rbd_body *bodies, int nb);

/* ---- loops over models and states ---- */

typedef void state_check(const robot *r, const state *s, int number);
typedef void reference_check(const robot *r, const ref_model *model, const ref_state *s, int number);
typedef void control_check(const robot *r, const ref_control_state *s, int number);

/* A case for tests that take a third of a second and more, not optimised: ./run quick leaves them out. */
TCase *slow_tests(Suite *suite);

/* On every reference model, `count` random states. */
void for_random_states(int count, state_check *check);

/* A part of the random trees, the first of them, is enough every day, under the sanitizers, for coverage,
   and for ./run quick; ./run test --all has all of them. */
#ifndef PART_OF_TREES
#define PART_OF_TREES 1
#endif

/* How many of n events on all random trees a part of them must have at least: half of its share, for it is no
   average. */
enum { LEAST_SHARE = PART_OF_TREES == 1 ? 1 : 2 * PART_OF_TREES };
#define OF_TREES(n) ((n) / LEAST_SHARE)

/* On `trees` random trees of 1 to 25 bodies, two random states each; on a part of them as above. */
void for_random_trees(int trees, state_check *check);
/* On every state of every reference model, with its gravity set; on those of what controllers ask. */
void for_reference_states(reference_check *check);
void for_control_states(control_check *check);

/* ---- comparison ---- */

/* Largest difference over max(largest entry of expected, 1e-3); infinite if anything is not finite. */
double relative_error(const double *found, const double *expected, int n);

/* What is wrong, as a sentence, or NULL. */
const char *why_not_close(const char *what, const robot *r, int number, const double *found,
                          const double *expected, int n, double bound);
const char *why_not_close_tb(const char *what, const robot *r, int number, const double *found,
                             const tb_real *expected, int n, double bound);
const char *why_not_small(const char *what, const robot *r, int number, double error, double bound);
const char *why_not_ok(const char *what, const robot *r, int number, rbd_status status);

/* Fails the test at the line where this stands: the message names the test's file and line. */
#define FAIL_IF(sentence) \
    do { \
        const char *what_is_wrong = (sentence); \
        if (what_is_wrong) ck_abort_msg("%s", what_is_wrong); \
    } while (0)

/* Each takes the arguments of its function above. The relative error, of doubles or beside the textbook, or
   a single figure's absolute error is at most the bound; a call gives RBD_OK. */
#define expect_close(...) FAIL_IF(why_not_close(__VA_ARGS__))
#define expect_close_tb(...) FAIL_IF(why_not_close_tb(__VA_ARGS__))
#define expect_small(...) FAIL_IF(why_not_small(__VA_ARGS__))
#define expect_ok(...) FAIL_IF(why_not_ok(__VA_ARGS__))
/* A call that must succeed, for functions that have `r` and `number`. */
#define RUN(call) expect_ok(#call, r, number, call)

/* From now on the largest error of each quantity and robot is kept; prints them: `tests --errors`. */
void record_errors(void);
void print_errors(void);

/* Fails unless a figure is within `bound` of what is expected. The one that is furthest off is kept of each
   item of a list and words, and printed in the list's order: `tests --contacts`. */
const char *why_not_figure(int item, const char *what, double found, double expected, double bound);
#define expect_figure(...) FAIL_IF(why_not_figure(__VA_ARGS__))
void record_figures(void);
int figures_are_recorded(void);
void print_figures(void);

double largest(const double *x, int n); /* magnitude; infinite if anything is not finite */
double dot(const double *a, const double *b, int n);
void multiply(const double *M, const double *x, int rows, int columns, double *out);

/* The bound for what needs the inverse of a matrix of this condition number. */
double inverse_bound(double condition);

typedef rbd_status forward_dynamics(const rbd_model *m, rbd_work *w, const double *q, const double *v,
                                    const double *tau, const double *f_ext, double *a);

/* The call gives the textbook's accelerations, or an error where the system is singular: random trees may be,
   e.g. two coincident axes with nothing between. */
const char *why_not_textbook_forward(const char *what, forward_dynamics *call, const robot *r, const state *s,
                                     int number);
#define expect_textbook_forward(...) FAIL_IF(why_not_textbook_forward(__VA_ARGS__))

#endif
