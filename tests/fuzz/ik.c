/* ik.c - random poses for rbd_ik.h, each judged by forward kinematics.

   usage: ik [--poses N | --seconds N] [--seed N]     so many poses of each arm, 10,000

   Each pose is that of a random state within limits; the search begins at another one. Then places beyond the
   reach of an iiwa, whose distance is known. Prints a table. Fails if fewer than 99.9 % of the poses are
   reached, an answer is out of limits or its error is not what the result says, or a distance is off by more
   than 1e-4 m. Each pose that is not reached is printed with its number. */
#define RBD_IMPLEMENTATION
#include "rbd_ik.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../ik_robots.h"
#include "../larger.h"
#include "models/iiwa.h"

enum { MOST_Q = 8 };

static const struct {
    const char *name;
    const rbd_body *bodies;
    int nb;
    const rbd_real *tool;
} arm[] = {{"iiwa", iiwa_bodies, 7, iiwa_tool},
           {"UR10e", ur10e, 6, ur10e_tool},
           {"Panda", panda, 7, panda_tool},
           {"hobby arm", hobby_arm, 5, hobby_tool}};
enum { ARMS = sizeof arm / sizeof *arm };

static const rbd_model *m;
static rbd_work *w;
static unsigned char model_memory[100000], work_memory[100000], memory[20000];

typedef struct tally {
    long poses, reached, first, evaluations, wrong;
    int most;
} tally;

static void build(int a) {
    if (rbd_model_build(arm[a].bodies, arm[a].nb, model_memory, sizeof model_memory, &m, NULL) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK)
        exit(2);
}

/* Whether q is within limits and has the errors that the result says. */
static int is_right(int a, const rbd_ik_target *t, const rbd_real *q, const rbd_ik_result *result) {
    const double rounding = sizeof(rbd_real) == 4 ? 1e-5 : 1e-12;
    double metres = 0, turn = 0;
    rbd_real R[9], p[3];
    for (int i = 0; i < arm[a].nb; i++)
        if (!(q[i] >= (rbd_real)arm[a].bodies[i].lower && q[i] <= (rbd_real)arm[a].bodies[i].upper)) return 0;
    rbd_kinematics(m, w, q, NULL, NULL);
    rbd_body_pose(m, w, t->body, R, NULL);
    rbd_point_position(m, w, t->body, t->point, p);
    for (int i = 0; i < 3; i++) metres += pow((double)(p[i] - t->position[i]), 2);
    for (int i = 0; i < 9; i++) turn += pow((double)(R[i] - t->rotation[i]), 2);
    turn = t->kind == RBD_IK_POSE ? 2 * asin(fmin(1, sqrt(turn / 8))) : 0;
    return fabs(sqrt(metres) - (double)result->metres) < rounding &&
           fabs(turn - (double)result->radians) < 10 * rounding;
}

static void try_pose(int a, uint64_t seed, tally *t) {
    rbd_ik_target target = {.kind = RBD_IK_POSE, .body = arm[a].nb - 1};
    const uint64_t start = seed;
    rbd_real q[MOST_Q];
    rbd_ik_result result;
    rbd_ik_status status;

    memcpy(target.point, arm[a].tool, sizeof target.point);
    rbd_random(m, &seed, q);
    rbd_kinematics(m, w, q, NULL, NULL);
    rbd_body_pose(m, w, target.body, target.rotation, NULL);
    rbd_point_position(m, w, target.body, target.point, target.position);
    rbd_random(m, &seed, q);
    status = rbd_ik(m, w, &target, 1, NULL, memory, sizeof memory, q, &result);

    t->poses++;
    t->reached += status == RBD_IK_REACHED;
    t->first += status == RBD_IK_REACHED && result.starts == 1;
    t->evaluations += result.evaluations;
    t->most = result.evaluations > t->most ? result.evaluations : t->most;
    t->wrong += status == RBD_IK_ERROR || !is_right(a, &target, q, &result);
    if (status != RBD_IK_REACHED)
        printf("%s, --seed %llu: status %d, %g m, %g rad\n", arm[a].name, (unsigned long long)start,
               (int)status, (double)result.metres, (double)result.radians);
}

/* Places beyond the sphere of the iiwa's stretched arm: the distance is known. Returns by how much it is off.
   */
static double try_far(uint64_t seed, tally *t) {
    rbd_ik_target target = {
        .kind = RBD_IK_POINT, .body = 6, .point = {iiwa_tool[0], iiwa_tool[1], iiwa_tool[2]}};
    rbd_real q[MOST_Q] = {0}, shoulder[3], end[3];
    double reach, beyond, up, turn;
    rbd_ik_result result;

    rbd_kinematics(m, w, q, NULL, NULL);
    rbd_body_pose(m, w, 1, NULL, shoulder);
    rbd_point_position(m, w, 6, target.point, end);
    reach = (double)(end[2] - shoulder[2]);
    rbd_random(m, &seed, q);
    beyond = 0.001 + 0.5 * fabs(sin(3 * (double)q[0]));
    up = fabs(sin(3 * (double)q[1]));
    turn = (double)q[2] * 1.06;
    target.position[0] = (rbd_real)((reach + beyond) * sqrt(1 - up * up) * cos(turn));
    target.position[1] = (rbd_real)((reach + beyond) * sqrt(1 - up * up) * sin(turn));
    target.position[2] = shoulder[2] + (rbd_real)((reach + beyond) * up);
    rbd_random(m, &seed, q);
    t->wrong += rbd_ik(m, w, &target, 1, NULL, memory, sizeof memory, q, &result) <= RBD_IK_REACHED;
    t->wrong += !is_right(0, &target, q, &result);
    t->poses++;
    t->evaluations += result.evaluations;
    t->most = result.evaluations > t->most ? result.evaluations : t->most;
    return fabs((double)result.metres - beyond);
}

int main(int count, char **arguments) {
    static tally tallies[ARMS], far;
    long poses = 10000, seconds = 0, failed = 0;
    uint64_t start = 1;
    double worst = 0;

    for (int i = 1; i + 1 < count; i += 2) {
        if (!strcmp(arguments[i], "--poses")) poses = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seconds")) seconds = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seed")) start = strtoull(arguments[i + 1], NULL, 10);
    }

    printf("%-10s %9s %9s %10s %12s %12s %6s %6s\n", "arm", "poses", "reached", "first", "evaluations",
           "at most", "wrong", "");
    for (int a = 0; a < ARMS; a++) {
        tally *t = &tallies[a];
        const time_t begin = time(NULL);
        build(a);
        for (long k = 0; seconds ? time(NULL) - begin < seconds / (ARMS + 1) : k < poses; k++)
            try_pose(a, start + (uint64_t)k, t);
        printf("%-10s %9ld %7.2f %% %8.1f %% %12.1f %12d %6ld\n", arm[a].name, t->poses,
               100. * (double)t->reached / (double)t->poses, 100. * (double)t->first / (double)t->poses,
               (double)t->evaluations / (double)t->poses, t->most, t->wrong);
        failed += t->wrong > 0 || t->poses == 0 || (double)t->reached < 0.999 * (double)t->poses;
    }

    build(0);
    for (long k = 0; k < (poses + 19) / 20; k++) worst = larger(worst, try_far(start + (uint64_t)k, &far));
    printf("%-10s %9ld %20s %12.1f %12d %6ld  distance off by %.1e m at most\n", "too far", far.poses, "",
           (double)far.evaluations / (double)far.poses, far.most, far.wrong, worst);
    return failed > 0 || far.wrong > 0 || far.poses == 0 || !(worst <= 1e-4);
}
