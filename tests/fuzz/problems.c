/* problems.c - see problems.h */
#include "problems.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const problem_names[PROBLEM_CLASSES] = {"contacts",  "dependent", "stances",  "brakes",
                                                    "loops",     "both",      "limbs",    "contradictory",
                                                    "following", "any",       "stretched"};

enum { SEEDS = 10 }; /* between those of two problems of a class; more classes share them */

int below(uint64_t *seed, int n) { return (int)uniform(seed, 0, n); }

static void vector(uint64_t *seed, double size, double *x, int n) {
    for (int k = 0; k < n; k++) x[k] = uniform(seed, -size, size);
}

static double power_of_ten(int n) {
    double x = 1;
    for (; n > 0; n--) x *= 10;
    for (; n < 0; n++) x /= 10;
    return x;
}

/* ---- trees ---- */

static void count(sample *s) {
    s->nq = s->nv = 0;
    for (int i = 0; i < s->nb; i++) {
        s->nq += world_nq(&s->bodies[i]);
        s->nv += world_nv(&s->bodies[i]);
    }
}

/* Robots of robots.h, mostly of up to 12 bodies, often with a free base, sometimes with further roots. */
static void draw_tree(problem *p, int class_number, int number, int followers) {
    sample *s = &p->robot;
    const int of = followers ? FOLLOWERS : below(&p->seed, 4) ? ORDINARY : AXES;
    draw_robot(s, of, number * SEEDS + class_number);
    const int most = below(&p->seed, 8) ? 12 : 20;
    if (s->nb > most) s->nb = most;
    if (!followers && below(&p->seed, 2)) s->bodies[0].type = RBD_FLOATING;
    for (int i = 1; i < s->nb; i++)
        if (!below(&p->seed, 12)) s->bodies[i].parent = -1;
    count(s);
}

/* ---- robots with legs ---- */

/* Where the legs are: first body, joints, and the knee. The last body of a leg has its foot. */
typedef struct leg {
    int first, joints, knee;
    double foot[3];
} leg;
enum { MOST_LEGS = 4 };
static leg legs[MOST_LEGS];
static int leg_count;

static rbd_body *add_body(sample *s, int parent, rbd_joint_type type) {
    static char names[WORLD_BODIES][16];
    rbd_body *b = &s->bodies[s->nb];
    memset(b, 0, sizeof *b);
    snprintf(names[s->nb], sizeof names[s->nb], "j%d", s->nb);
    b->joint = names[s->nb];
    b->parent = parent, b->type = type;
    s->length[s->nb] = s->mass[s->nb] = 1;
    s->nb++;
    return b;
}

static void give_mass(problem *p, rbd_body *b, double mass, double size) {
    b->mass = mass * uniform(&p->seed, 0.5, 2);
    vector(&p->seed, 0.3 * size, b->com, 3);
    const double moment = b->mass * size * size;
    b->inertia[0] = moment * uniform(&p->seed, 0.05, 0.1);
    b->inertia[3] = moment * uniform(&p->seed, 0.05, 0.1);
    b->inertia[5] = moment * uniform(&p->seed, 0.05, 0.1);
}

/* Axes of the joints from the hip on: like HyQ's, like a human's, any coordinate axes, or any at all. */
static void draw_leg_axis(problem *p, int kind, int joint, int joints, double axis[3]) {
    static const int human[7] = {2, 0, 1, 1, 1, 0, 2};
    axis[0] = axis[1] = axis[2] = 0;
    if (kind == 0)
        axis[joint == 0 && joints > 2 ? 0 : joint == joints - 1 && joints > 4 ? 0 : 1] = 1;
    else if (kind == 1)
        axis[human[joint + (joints < 5)]] = 1;
    else if (kind == 2)
        axis[below(&p->seed, 3)] = below(&p->seed, 2) ? 1 : -1;
    else
        vector(&p->seed, 1, axis, 3);
    if (!(fabs(axis[0]) + fabs(axis[1]) + fabs(axis[2]) > 0.1)) axis[1] = 1;
}

static void add_leg(problem *p, int trunk, int joints, int stretched) {
    sample *s = &p->robot;
    leg *l = &legs[leg_count++];
    const int kind = stretched ? joints == 6 : below(&p->seed, 4), knee_type = below(&p->seed, 4);
    l->first = s->nb, l->joints = joints, l->knee = joints > 4 ? 3 : joints - 1;
    for (int j = 0; j < joints; j++) {
        rbd_body *b = add_body(s, j == 0 ? trunk : s->nb - 1, RBD_REVOLUTE);
        draw_leg_axis(p, kind, j, joints, b->axis);
        if (j == 0) {
            vector(&p->seed, 0.4, b->position, 3);
        } else if (j == l->knee || j + 1 == l->knee || (stretched && j == l->knee + 1) ||
                   !below(&p->seed, 3)) {
            b->position[2] = -uniform(&p->seed, 0.05, 0.4); /* straight below: the leg can be stretched */
        } else {
            vector(&p->seed, 0.1, b->position, 3);
        }
        if (j == l->knee && knee_type == 0) b->type = RBD_HELICAL, b->pitch = uniform(&p->seed, 0.02, 0.1);
        if (j == l->knee && knee_type == 1 && !below(&p->seed, 3)) b->type = RBD_PRISMATIC;
        if (!stretched && !below(&p->seed, 16)) b->type = below(&p->seed, 2) ? RBD_SPHERICAL : RBD_UNIVERSAL;
        if (b->type == RBD_UNIVERSAL)
            b->axis2[0] = b->axis[1], b->axis2[1] = b->axis[2], b->axis2[2] = -b->axis[0];
        give_mass(p, b, 1, 0.2);
        if (below(&p->seed, 2)) b->armature[0] = uniform(&p->seed, 0, 0.2);
    }
    memset(l->foot, 0, sizeof l->foot);
    l->foot[2] = -uniform(&p->seed, 0.05, 0.35);
    if (!stretched && !below(&p->seed, 3)) vector(&p->seed, 0.2, l->foot, 3);
    if (!below(&p->seed, 6)) { /* a foot of its own, fixed */
        rbd_body *b = add_body(s, s->nb - 1, RBD_FIXED);
        memcpy(b->position, l->foot, sizeof l->foot);
        give_mass(p, b, 0.2, 0.05);
        memset(l->foot, 0, sizeof l->foot);
    }
}

/* A base, perhaps a back, and one to four legs; on several roots if `apart`. */
static void draw_legged(problem *p, int apart, int fixed, int stretched) {
    static const rbd_joint_type bases[8] = {RBD_FLOATING, RBD_FLOATING, RBD_FLOATING,  RBD_FIXED,
                                            RBD_FIXED,    RBD_PLANAR,   RBD_PRISMATIC, RBD_SPHERICAL};
    sample *s = &p->robot;
    memset(s, 0, sizeof *s);
    s->seed = p->seed + 1;
    leg_count = 0;
    rbd_body *base = add_body(s, -1, fixed ? RBD_FIXED : bases[below(&p->seed, 8)]);
    give_mass(p, base, 20, 0.6);
    base->axis[2] = base->type != RBD_FIXED;
    int back = 0;
    for (int n = below(&p->seed, 3) ? 0 : 1 + below(&p->seed, 2); n > 0; n--) {
        rbd_body *b = add_body(s, back, RBD_REVOLUTE);
        b->axis[below(&p->seed, 3)] = 1;
        vector(&p->seed, 0.3, b->position, 3);
        give_mass(p, b, 10, 0.4);
        back = s->nb - 1;
    }
    for (int n = 1 + below(&p->seed, MOST_LEGS), joints = 2 + below(&p->seed, 6); n > 0; n--) {
        if (!below(&p->seed, 3)) joints = 2 + below(&p->seed, 6);
        if (stretched) joints = below(&p->seed, 3) ? 3 : 6;
        if (s->nb + joints + 1 > 24) break;
        add_leg(p, apart && !below(&p->seed, 3) ? -1 : below(&p->seed, 3) ? 0 : back, joints, stretched);
    }
    count(s);
}

/* Where the coordinates of a body begin. */
static int first_coordinate(const sample *s, int body) {
    int iq = 0;
    for (int i = 0; i < body; i++) iq += world_nq(&s->bodies[i]);
    return iq;
}

/* Knees near straight, or legs as they come. */
static void bend(problem *p, int straight) {
    for (int i = 0; i < leg_count; i++) {
        const int iq = first_coordinate(&p->robot, legs[i].first + legs[i].knee);
        const rbd_joint_type type = p->robot.bodies[legs[i].first + legs[i].knee].type;
        if (!straight || type == RBD_SPHERICAL || type == RBD_UNIVERSAL) continue;
        const int digits = below(&p->seed, 14);
        p->state.q[iq] = digits == 0 ? 0 : uniform(&p->seed, -1, 1) * power_of_ten(-digits);
    }
}

/* ---- constraints ---- */

/* The body that a body is fixed to, itself where it can move. */
static int carrier(const problem *p, int body) {
    while (body >= 0 && p->robot.bodies[body].type == RBD_FIXED) body = p->robot.bodies[body].parent;
    return body;
}

static void add(problem *p, rbd_constraint k) {
    int rows = 0;
    for (int i = 0; i < 6; i++) rows += k.axes[i] != 0;
    if (carrier(p, k.body1) == carrier(p, k.body2)) return;
    if (p->n == PROBLEM_CONSTRAINTS || p->rows + rows > PROBLEM_ROWS || rows == 0) return;
    p->list[p->n++] = k;
    p->rows += rows;
}

static void draw_rotation(uint64_t *seed, double R[9]) {
    double u[4], square;
    do {
        vector(seed, 1, u, 4);
        square = u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + u[3] * u[3];
    } while (!(square > 0.1 && square < 1));
    for (int k = 0; k < 4; k++) u[k] /= sqrt(square);
    const double x = u[0], y = u[1], z = u[2], w = u[3];
    const double of_unit[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                               2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                               2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(R, of_unit, sizeof of_unit);
}

static void draw_frames(problem *p, rbd_constraint *k) {
    vector(&p->seed, 0.3, k->position1, 3);
    vector(&p->seed, 0.3, k->position2, 3);
    if (below(&p->seed, 2)) draw_rotation(&p->seed, k->rotation1);
    if (below(&p->seed, 2)) draw_rotation(&p->seed, k->rotation2);
}

/* Point, surface, line, plane, or any axes. */
static void draw_axes(problem *p, rbd_constraint *k) {
    static const int kinds[6][6] = {{0, 0, 0, 1, 1, 1}, {0, 0, 0, 1, 1, 1}, {1, 1, 1, 1, 1, 1},
                                    {0, 0, 0, 0, 0, 1}, {1, 1, 0, 1, 1, 1}, {0, 0, 1, 1, 1, 0}};
    const int kind = below(&p->seed, 8);
    for (int i = 0; i < 6; i++) k->axes[i] = kind < 6 ? kinds[kind][i] : below(&p->seed, 2);
}

static int moving_body(problem *p) {
    for (int tries = 0; tries < 20; tries++) {
        const int body = below(&p->seed, p->robot.nb);
        if (carrier(p, body) >= 0) return body;
    }
    return p->robot.nb - 1;
}

static void add_contacts(problem *p, int n) {
    for (; n > 0; n--) {
        const int body = moving_body(p);
        rbd_constraint k = rbd_point_contact(body, NULL, NULL);
        draw_frames(p, &k);
        draw_axes(p, &k);
        add(p, k);
    }
}

static void add_loops(problem *p, int n) {
    for (; n > 0; n--) {
        const int one = moving_body(p), two = below(&p->seed, p->robot.nb);
        rbd_constraint k = rbd_ball_loop(one, NULL, two, NULL);
        draw_frames(p, &k);
        switch (below(&p->seed, 4)) {
        case 0: k.axes[0] = k.axes[1] = 1; break;             /* hinge */
        case 1: k.axes[0] = k.axes[1] = k.axes[2] = 1; break; /* rigid */
        case 2: draw_axes(p, &k); break;
        default: break; /* ball */
        }
        add(p, k);
    }
}

/* Further points of a body that is held, as of its heel, or of one fixed to it; or the same constraint
   again. */
static void add_dependent(problem *p, int n) {
    for (; n > 0 && p->n > 0; n--) {
        rbd_constraint k = p->list[below(&p->seed, p->n)];
        if (below(&p->seed, 4)) {
            vector(&p->seed, 0.2, k.position1, 3);
            if (!below(&p->seed, 3)) vector(&p->seed, power_of_ten(-below(&p->seed, 4)), k.position1, 1);
            if (below(&p->seed, 2)) draw_axes(p, &k);
        }
        add(p, k);
    }
}

static void add_feet(problem *p) {
    for (int i = 0; i < leg_count; i++) {
        const int body =
            carrier(p, legs[i].first + legs[i].joints - 1) == legs[i].first + legs[i].joints - 1 &&
                    legs[i].first + legs[i].joints < p->robot.nb &&
                    p->robot.bodies[legs[i].first + legs[i].joints].type == RBD_FIXED
                ? legs[i].first + legs[i].joints
                : legs[i].first + legs[i].joints - 1;
        if (i > 0 && !below(&p->seed, 5)) continue; /* in the air */
        rbd_constraint k = below(&p->seed, 3) ? rbd_point_contact(body, legs[i].foot, NULL)
                                              : rbd_flat_contact(body, legs[i].foot, NULL);
        if (!below(&p->seed, 4)) draw_rotation(&p->seed, k.rotation2);
        add(p, k);
    }
}

/* One axis held between links of a leg: mostly the joint's own, between its two links; else any axis, or
   links further apart. */
static void add_brakes(problem *p, int n) {
    for (; n > 0 && leg_count > 0; n--) {
        const leg *l = &legs[below(&p->seed, leg_count)];
        const int joint = below(&p->seed, l->joints), body = l->first + joint;
        const rbd_body *b = &p->robot.bodies[body];
        rbd_constraint k = rbd_ball_loop(body, NULL, b->parent, b->position);
        const int slides = b->type == RBD_PRISMATIC || (b->type == RBD_HELICAL && below(&p->seed, 2));
        int axis = 0;
        memset(k.axes, 0, sizeof k.axes);
        for (int i = 1; i < 3; i++)
            if (fabs(b->axis[i]) > fabs(b->axis[axis])) axis = i;
        k.axes[axis + 3 * slides] = 1;
        switch (below(&p->seed, 6)) {
        case 0: draw_frames(p, &k); break;
        case 1: k.axes[below(&p->seed, 6)] = 1; break;
        case 2: k.body2 = l->first + below(&p->seed, l->joints); break; /* anywhere in the leg */
        default: break;
        }
        if (!below(&p->seed, 3)) {
            const int other = k.body1;
            k.body1 = k.body2, k.body2 = other;
        }
        add(p, k);
    }
}

static void add_between_legs(problem *p, int n) {
    for (; n > 0 && leg_count > 0; n--) {
        const leg *l = &legs[below(&p->seed, leg_count)], *m = &legs[below(&p->seed, leg_count)];
        rbd_constraint k = rbd_ball_loop(l->first + below(&p->seed, l->joints), NULL,
                                         m->first + below(&p->seed, m->joints), NULL);
        draw_frames(p, &k);
        if (below(&p->seed, 2)) draw_axes(p, &k);
        add(p, k);
    }
}

/* The world as the first body. */
static void turn_round(problem *p) {
    for (int i = 0; i < p->n; i++) {
        rbd_constraint *k = &p->list[i];
        if (below(&p->seed, 2)) continue;
        rbd_constraint other = *k;
        k->body1 = other.body2, k->body2 = other.body1;
        memcpy(k->rotation1, other.rotation2, sizeof k->rotation1);
        memcpy(k->rotation2, other.rotation1, sizeof k->rotation1);
        memcpy(k->position1, other.position2, sizeof k->position1);
        memcpy(k->position2, other.position1, sizeof k->position1);
    }
}

static void add_of_any_kind(problem *p) {
    if (below(&p->seed, 2)) add_feet(p);
    if (!below(&p->seed, 2)) add_contacts(p, 1 + below(&p->seed, 2));
    if (!below(&p->seed, 2)) add_loops(p, 1 + below(&p->seed, 2));
    if (!below(&p->seed, 2)) add_brakes(p, 1 + below(&p->seed, 2));
    if (!below(&p->seed, 3)) add_between_legs(p, 1);
    if (!below(&p->seed, 3)) add_dependent(p, 1 + below(&p->seed, 2));
    if (!below(&p->seed, 4)) turn_round(p);
}

/* Often none; the same for all; each its own. */
static void draw_gains(problem *p) {
    const int kind = below(&p->seed, 4);
    const double kd = uniform(&p->seed, 0, 20), kp = below(&p->seed, 2) ? uniform(&p->seed, 0, 50) : 0;
    for (int i = 0; i < p->n; i++) {
        p->list[i].kd = kind < 2 ? 0 : kind == 2 ? kd : uniform(&p->seed, 0, 20);
        p->list[i].kp = kind < 2 ? 0 : kind == 2 ? kp : uniform(&p->seed, 0, 50);
    }
}

/* ---- problems ---- */

static void draw_set(problem *p, int class_number) {
    switch (class_number) {
    case CONTACTS: add_contacts(p, 1 + below(&p->seed, 4)); break;
    case DEPENDENT:
        if (leg_count > 0)
            add_feet(p);
        else
            add_contacts(p, 1 + below(&p->seed, 2));
        add_dependent(p, 1 + below(&p->seed, 3));
        break;
    case STANCES:
    case STRETCHED:
        add_feet(p);
        if (!below(&p->seed, 3)) add_dependent(p, 1 + below(&p->seed, 2));
        break;
    case BRAKES:
        add_feet(p);
        add_brakes(p, 1 + below(&p->seed, 3));
        if (!below(&p->seed, 4)) add_between_legs(p, 1);
        break;
    case LOOPS: add_loops(p, 1 + below(&p->seed, 4)); break;
    case LOOPS_AND_CONTACTS:
        add_loops(p, 1 + below(&p->seed, 2));
        add_contacts(p, 1 + below(&p->seed, 2));
        break;
    case LIMBS:
        add_feet(p);
        add_between_legs(p, 1 + below(&p->seed, 3));
        turn_round(p);
        break;
    default: add_of_any_kind(p);
    }
    if (p->n == 0) add_contacts(p, 3);
    if (p->n == 0) add(p, rbd_point_contact(moving_body(p), NULL, NULL));
}

static void draw_motion(problem *p) {
    static const int kinds[8] = {RESTING, RESTING, NEARLY_RESTING, HELD, HELD, HELD, MOVING, MOVING};
    sample_state *x = &p->state;
    p->motion = kinds[below(&p->seed, 8)];
    for (int k = 0; k < p->robot.nv; k++) {
        x->tau[k] *= 20;
        if (p->motion == RESTING) x->v[k] = 0;
        if (p->motion == NEARLY_RESTING) x->v[k] *= below(&p->seed, 2) ? 0 : 1e-17;
    }
}

void draw_problem(problem *p, int class_number, int number) {
    memset(p, 0, sizeof *p);
    p->seed = (uint64_t)number * SEEDS + (uint64_t)class_number + (UINT64_C(1) << 40);
    for (int i = 0; i < 4; i++) uniform(&p->seed, 0, 1);
    leg_count = 0;
    const int legged = class_number == STANCES || class_number == STRETCHED || class_number == BRAKES ||
                       class_number == LIMBS ||
                       ((class_number == DEPENDENT || class_number == CONTRADICTORY || class_number == ANY) &&
                        below(&p->seed, 2));
    if (legged)
        draw_legged(p, class_number == LIMBS || class_number == ANY,
                    class_number == STRETCHED || (class_number == STANCES && below(&p->seed, 2)),
                    class_number == STRETCHED);
    else
        draw_tree(p, class_number, number,
                  class_number == FOLLOWING || (class_number == ANY && below(&p->seed, 2)));
    draw_state(&p->robot, &p->state);
    draw_motion(p);
    draw_set(p, class_number);
    draw_gains(p);
    if (class_number == CONTRADICTORY) {
        add_dependent(p, 1 + below(&p->seed, 2));
        draw_gains(p);
    }
    bend(p, class_number == STANCES || class_number == STRETCHED || (legged && !below(&p->seed, 4)));
}

/* ---- as C source ---- */

static void print_values(const char *name, const double *x, int n) {
    printf("%s{", name);
    for (int i = 0; i < n; i++) printf("%s%.17g", i ? ", " : "", x[i]);
    printf("}");
}

void print_problem(const problem *p) {
    print_robot(&p->robot);
    printf("static const rbd_constraint list[%d] = {\n", p->n);
    for (int i = 0; i < p->n; i++) {
        const rbd_constraint *k = &p->list[i];
        printf("    {.body1 = %d, .body2 = %d", k->body1, k->body2);
        print_values(", .rotation1 = ", k->rotation1, 9);
        print_values(", .position1 = ", k->position1, 3);
        print_values(", .rotation2 = ", k->rotation2, 9);
        print_values(", .position2 = ", k->position2, 3);
        printf(", .axes = {%d, %d, %d, %d, %d, %d}, .kp = %.17g, .kd = %.17g},\n", k->axes[0], k->axes[1],
               k->axes[2], k->axes[3], k->axes[4], k->axes[5], k->kp, k->kd);
    }
    printf("};\nstatic const double");
    print_values(" gravity[3] = ", p->state.gravity, 3);
    print_values(",\n    q[] = ", p->state.q, p->robot.nq);
    print_values(",\n    v[] = ", p->state.v, p->robot.nv);
    print_values(",\n    tau[] = ", p->state.tau, p->robot.nv);
    print_values(",\n    f_ext[] = ", p->state.f_ext, 6 * p->robot.nb);
    printf(";\n");
}
