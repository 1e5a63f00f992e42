/* estimate.c - random robots, motions and noise for rbd_estimate.h.

   usage: estimate [--problems N | --seconds N] [--seed N]     so many robots, 20

   A robot learns the friction of its joints and a payload over 10,000 ticks, or fewer of a run of a few
   robots. Torques are those of rbd_rnea of the robot with the payload, friction and noise; some ticks are at
   rest, some repeat one motion. Each solve must give a body that can exist (rbd_check_parameters), friction
   that is not negative, finite numbers. An observer runs beside it: what it feels is finite, and
   within the band, as friction is known to the share that it was told. NaN, infinity and huge numbers in
   between are refused by name, and a twin that never saw them goes the same way, to the bit. Prints a line.
   Fails if
   anything is wrong. */
#define RBD_IMPLEMENTATION
#include "rbd_estimate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../larger.h"
#include "robots.h"

enum { DOFS = 20, TICKS = 10000 };

static const int in_float = sizeof(rbd_real) == 4;

typedef struct learner {
    rbd_estimate *e;
    rbd_observer *o;
    unsigned char estimate_memory[40000], observer_memory[40000];
} learner;

/* One tick's input. */
typedef struct tick {
    rbd_real q[WORLD_COORDINATES], v[WORLD_DOFS], a[WORLD_DOFS], tau[WORLD_DOFS], push[WORLD_DOFS];
} tick;

static unsigned char model_memory[2][200000], work_memory[2][200000], derivatives_memory[400000];
static const rbd_model *m[2]; /* bare, and with the payload */
static rbd_work *w[2];
static rbd_derivatives *d;
static learner one, twin;
static sample s;
static rbd_joint_friction truth[DOFS], told[DOFS];
static double mass, noise, share, largest;
static long wrong, solves, refusals;
static uint64_t number;
static int nv, body;

static void fail(const char *what, double by) {
    if (wrong++ < 30) printf("--seed %llu: %s: %g\n", (unsigned long long)number, what, by);
}

static int below(uint64_t *seed, int n) { return (int)uniform(seed, 0, n); }

/* ---- a robot ---- */

static void draw_body(uint64_t *seed) {
    static const int classes[3] = {ORDINARY, AXES, FOLLOWERS};
    do {
        const int kind = classes[below(seed, 3)];
        draw_robot(&s, kind, below(seed, 1 << 30));
        for (int k = 0; k < 2; k++)
            if (rbd_model_build(s.bodies, s.nb, model_memory[k], sizeof model_memory[k], &m[k], NULL) !=
                RBD_OK)
                exit(2);
        nv = rbd_nv(m[0]);
    } while (nv > DOFS || nv < 1);
    for (int k = 0; k < 2; k++)
        if (rbd_work_init(m[k], work_memory[k], sizeof work_memory[k], &w[k]) != RBD_OK) exit(2);

    body = below(seed, s.nb);
    mass = uniform(seed, 0, 4);
    const double point[3] = {uniform(seed, -0.1, 0.1), uniform(seed, -0.1, 0.1), uniform(seed, -0.1, 0.1)};
    const double moment = mass * uniform(seed, 0.001, 0.01), inertia[6] = {moment, 0, 0, moment, 0, moment};
    if (rbd_add_payload(model_memory[1], body, (rbd_const)mass, point, inertia) != RBD_OK) exit(2);
    if (rbd_derivatives_init(m[0], w[0], derivatives_memory, sizeof derivatives_memory, &d) != RBD_OK)
        exit(2);
}

static void begin(learner *x, const rbd_estimate_options *options, const rbd_observer_options *observer) {
    if (rbd_estimate_init(m[0], body, options, x->estimate_memory, sizeof x->estimate_memory, &x->e, NULL) !=
            RBD_OK ||
        rbd_observer_init(m[1], observer, x->observer_memory, sizeof x->observer_memory, &x->o, NULL) !=
            RBD_OK)
        exit(2);
}

/* Which dofs have friction: not those of floating joints. */
static void draw_friction(uint64_t *seed) {
    share = uniform(seed, 0, 0.3);
    memset(truth, 0, sizeof truth);
    for (int i = 0, iv = 0; i < s.nb; i++) {
        if (s.bodies[i].mimic) continue;
        for (int k = 0; k < world_nv(&s.bodies[i]); k++, iv++) {
            if (s.bodies[i].type == RBD_FLOATING) continue;
            truth[iv].coulomb = (rbd_real)uniform(seed, 0, 3);
            truth[iv].viscous = (rbd_real)uniform(seed, 0, 1);
            truth[iv].offset = (rbd_real)uniform(seed, -0.5, 0.5);
        }
    }
    for (int i = 0; i < nv; i++) { /* truth is within the share of what is told */
        const double off = 1 + share * uniform(seed, -0.99, 0.99);
        told[i] = truth[i];
        told[i].coulomb = (rbd_real)((double)truth[i].coulomb / off);
        told[i].viscous = (rbd_real)((double)truth[i].viscous / off);
    }
}

static void draw_learner(uint64_t *seed) {
    const rbd_observer_options observer = {.gain = (rbd_real)uniform(seed, 1, 200),
                                           .slow = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 0.001, 0.1),
                                           .share = (rbd_real)share,
                                           .friction = told};
    rbd_real deviation[DOFS];
    rbd_estimate_options options = {.forgetting = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 0.9, 1),
                                    .mass = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 1, 10),
                                    .reach = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 0.05, 1),
                                    .friction = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 10, 1000),
                                    .slow = below(seed, 2) ? 0 : (rbd_real)uniform(seed, 0.001, 0.1)};
    noise = below(seed, 2) ? 0 : pow(10, uniform(seed, -3, 0));
    for (int i = 0; i < nv; i++) deviation[i] = (rbd_real)uniform(seed, 0.01, 1);
    if (below(seed, 2)) options.noise = deviation;
    begin(&one, &options, &observer);
    begin(&twin, &options, &observer);
}

/* ---- motion ---- */

/* The state after a tick of dt: v changes by steps, is 0 for a while, or stays. */
static void advance(uint64_t *seed, double dt, int rests, int repeats, tick *x) {
    rbd_real next[WORLD_COORDINATES];
    for (int i = 0; i < nv; i++) {
        const double before = (double)x->v[i], to = rests ? 0 : uniform(seed, -3, 3);
        const double after =
            repeats || rests ? (rests ? 0 : before) : before + fmin(1, 20 * dt) * (to - before);
        x->v[i] = (rbd_real)after;
        x->a[i] = (rbd_real)((after - before) / dt);
    }
    rbd_integrate(m[0], x->q, x->v, (rbd_real)dt, next);
    memcpy(x->q, next, sizeof next);
}

static void put_torques(uint64_t *seed, tick *x) {
    if (rbd_rnea(m[1], w[1], x->q, x->v, x->a, NULL, x->tau) != RBD_OK) fail("rbd_rnea", 0);
    for (int i = 0; i < nv; i++) {
        const double v = (double)x->v[i], way = v > 0 ? 1 : v < 0 ? -1 : 0;
        const double torque =
            (double)truth[i].coulomb * way + (double)truth[i].viscous * v + (double)truth[i].offset;
        x->tau[i] += (rbd_real)(torque + noise * uniform(seed, -1.7, 1.7));
    }
}

/* ---- judgement ---- */

static void solve(learner *x, rbd_const payload[10], rbd_joint_friction *friction, rbd_real *misfit) {
    if (rbd_estimate_solve(x->e, payload, friction, misfit) != RBD_OK) fail("rbd_estimate_solve", 0);
}

static void judge(void) {
    rbd_const payload[2][10], deviation[10];
    rbd_joint_friction friction[2][DOFS], spread[DOFS];
    rbd_real misfit[2];
    memset(friction, 0, sizeof friction);
    solve(&one, payload[0], friction[0], &misfit[0]);
    solve(&twin, payload[1], friction[1], &misfit[1]);
    solves++;

    if (rbd_check_parameters(payload[0]) != RBD_OK) fail("no body is like that", (double)payload[0][0]);
    for (int k = 0; k < 10; k++)
        if (!(fabs((double)payload[0][k]) < 1e9)) fail("payload", (double)payload[0][k]);
    for (int i = 0; i < nv; i++) {
        const rbd_joint_friction *f = &friction[0][i];
        if (!(f->coulomb >= 0 && f->coulomb < 1e9)) fail("coulomb", (double)f->coulomb);
        if (!(f->viscous >= 0 && f->viscous < 1e9)) fail("viscous", (double)f->viscous);
        if (!(fabs((double)f->offset) < 1e9)) fail("offset", (double)f->offset);
    }
    if (!(misfit[0] >= 0 && misfit[0] < 1e9)) fail("misfit", (double)misfit[0]);
    if (memcmp(payload[0], payload[1], sizeof payload[0]) ||
        memcmp(friction[0], friction[1], sizeof friction[0]))
        fail("a refusal left a trace", 0);

    if (rbd_estimate_deviations(one.e, deviation, spread) != RBD_OK) fail("rbd_estimate_deviations", 0);
    for (int k = 0; k < 10; k++)
        if (!(deviation[k] >= 0 && deviation[k] < 1e9))
            fail("deviation of the payload", (double)deviation[k]);
    for (int i = 0; i < nv; i++)
        if (!(spread[i].coulomb >= 0 && spread[i].viscous >= 0 && spread[i].offset >= 0 &&
              spread[i].coulomb < 1e9))
            fail("deviation of friction", (double)spread[i].coulomb);
}

/* The observer of both robots. tau is constant in a tick: that of the momentum, so that nothing but friction
   is felt. */
static void observe(const tick *x, double dt, rbd_real *r, rbd_real *band) {
    rbd_real other[DOFS];
    const rbd_status status =
        rbd_observer_step(m[1], w[1], one.o, x->q, x->v, x->push, (rbd_real)dt, r, band, NULL);
    if (status != RBD_OK) fail("rbd_observer_step", status);
    rbd_observer_step(m[1], w[1], twin.o, x->q, x->v, x->push, (rbd_real)dt, other, NULL, NULL);
    if (memcmp(r, other, (size_t)nv * sizeof *r)) fail("a refusal left a trace in the observer", 0);
    for (int i = 0; i < nv; i++) {
        const double by = fabs((double)r[i]) - (double)band[i];
        if (!(fabs((double)r[i]) < 1e9 && band[i] >= 0 && band[i] < 1e9)) fail("felt", (double)r[i]);
        if (!(by <= (in_float ? 1e-2 : 1e-8) * largest)) fail("felt beyond the band", by);
    }
}

/* Motor torques by which the momentum changes as it does, by the observer's own rule of a mean of both ends,
   with the true friction. At rest it is anything within the dry part. */
static void push(uint64_t *seed, double dt, const rbd_real *last_p, const rbd_real *last_rate,
                 const rbd_real *p, const rbd_real *rate, tick *x) {
    for (int i = 0; i < nv; i++) {
        const double v = (double)x->v[i], dry = (double)truth[i].coulomb;
        const double way = v > 0 ? 1 : v < 0 ? -1 : uniform(seed, -1, 1);
        const double friction = dry * way + (double)truth[i].viscous * v + (double)truth[i].offset;
        const double mean = ((double)last_rate[i] + (double)rate[i]) / 2;
        x->push[i] = (rbd_real)(((double)p[i] - (double)last_p[i]) / dt - mean + friction);
        largest =
            larger(largest, fabs((double)p[i]) / dt + fabs(mean) + fabs(friction) + fabs((double)x->push[i]));
    }
}

/* Momentum, and C'v - g. */
static void momentum(const tick *x, rbd_real *p, rbd_real *rate) {
    rbd_real gravity[DOFS];
    if (rbd_generalized_momentum(m[1], w[1], x->q, x->v, p, rate) != RBD_OK)
        fail("rbd_generalized_momentum", 0);
    rbd_gravity_torque(m[1], w[1], x->q, gravity);
    for (int i = 0; i < nv; i++) rate[i] -= gravity[i];
}

/* ---- bad input ---- */

static void refuse(tick *x, double dt, uint64_t *seed) {
    const double bad[3] = {NAN, INFINITY, -INFINITY};
    const char *const names[4] = {"q", "v", "a", "tau"};
    rbd_real *const arrays[4] = {x->q, x->v, x->a, x->tau};
    const int k = below(seed, 4), at = below(seed, k ? nv : rbd_nq(m[0]));
    const rbd_real kept = arrays[k][at];
    rbd_estimate_fault fault;
    rbd_real r[DOFS];
    arrays[k][at] = (rbd_real)bad[below(seed, 3)];
    rbd_status status = rbd_estimate_add(m[0], d, one.e, x->q, x->v, x->a, x->tau, &fault);
    if (status != RBD_ERR_NAN || !fault.field || strcmp(fault.field, names[k]) != 0 || fault.at != at)
        fail("the estimate does not refuse by name", k);
    if (k < 2) {
        status = rbd_observer_step(m[1], w[1], one.o, x->q, x->v, x->push, (rbd_real)dt, r, NULL, &fault);
        if (status != RBD_ERR_NAN || !fault.field || strcmp(fault.field, names[k]) != 0 || fault.at != at)
            fail("the observer does not refuse by name", k);
    }
    arrays[k][at] = kept;

    const rbd_real tau = x->tau[at % nv];
    x->tau[at % nv] = (rbd_real)1e30;
    status = rbd_estimate_add(m[0], d, one.e, x->q, x->v, x->a, x->tau, &fault);
    x->tau[at % nv] = tau;
    if (status == RBD_OK) { /* it is at rest: the number tells nothing; the twin takes it in too */
        x->tau[at % nv] = (rbd_real)1e30;
        rbd_estimate_add(m[0], d, twin.e, x->q, x->v, x->a, x->tau, NULL);
        x->tau[at % nv] = tau;
    } else if (status != RBD_ERR_RANGE) {
        fail("a huge torque is not refused", status);
    }
    status = rbd_observer_step(m[1], w[1], one.o, x->q, x->v, x->push, (rbd_real)-1, r, NULL, &fault);
    if (status != RBD_ERR_RANGE || strcmp(fault.field, "dt") != 0)
        fail("a negative dt is not refused", status);
    refusals += 3;
}

/* ---- run ---- */

static void try_robot(uint64_t start, int ticks) {
    static tick x;
    rbd_real p[2][DOFS], rate[2][DOFS], r[DOFS], band[DOFS];
    uint64_t seed = number = start;
    memset(&x, 0, sizeof x);
    draw_body(&seed);
    draw_friction(&seed);
    draw_learner(&seed);
    rbd_random(m[0], &seed, x.q);
    const double dt = pow(10, uniform(&seed, -3.3, -2));
    largest = 1;
    momentum(&x, p[1], rate[1]);
    observe(&x, dt, r, band);

    for (int k = 0; k < ticks; k++) {
        const int phase = k / 100 % 5;
        memcpy(p[0], p[1], sizeof p[0]);
        memcpy(rate[0], rate[1], sizeof rate[0]);
        advance(&seed, dt, phase == 3, phase == 4, &x);
        put_torques(&seed, &x);
        momentum(&x, p[1], rate[1]);
        push(&seed, dt, p[0], rate[0], p[1], rate[1], &x);
        if (k % 50 == 7) refuse(&x, dt, &seed);
        observe(&x, dt, r, band);
        for (int n = 0; n < 2; n++)
            if (rbd_estimate_add(m[0], d, n ? twin.e : one.e, x.q, x.v, x.a, x.tau, NULL) != RBD_OK)
                fail("rbd_estimate_add", k);
        if (k % 1500 == 1400)
            for (int n = 0; n < 2; n++)
                (k % 3000 == 1400 ? rbd_estimate_grip : rbd_estimate_release)(n ? twin.e : one.e);
        if (k % 10 == 0) judge();
    }
}

int main(int count, char **arguments) {
    long problems = 20, seconds = 0, tried = 0;
    const time_t started = time(NULL);
    uint64_t start = 1;

    for (int i = 1; i + 1 < count; i += 2) {
        if (!strcmp(arguments[i], "--problems")) problems = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seconds")) seconds = atol(arguments[i + 1]);
        if (!strcmp(arguments[i], "--seed")) start = strtoull(arguments[i + 1], NULL, 10);
    }
    for (; seconds ? time(NULL) - started < seconds : tried < problems; tried++)
        try_robot(start + (uint64_t)tried, problems < 20 ? TICKS / 20 : TICKS);
    printf("%ld robots, %ld solves, %ld refusals, wrong: %ld\n", tried, solves, refusals, wrong);
    return wrong > 0 || solves == 0;
}
