/* robots.c - see robots.h. Nothing but + - * / and sqrt of IEEE 754, so that all machines draw the same. */
#include "robots.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const class_names[CLASSES] = {"ordinary", "axes",  "nearly", "far",       "scaled",
                                          "mixed",    "light", "turned", "followers", "all"};

/* ---- numbers ---- */

static uint64_t next(uint64_t *seed) { /* splitmix64 (Steele, Lea, Flood 2014) */
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static int below(uint64_t *seed, int n) { return (int)(next(seed) % (uint64_t)n); }

double uniform(uint64_t *seed, double low, double high) {
    return low + (high - low) * (double)(next(seed) >> 11) / 9007199254740992.0;
}

/* 2^n to 2^(n + 1), n from low to high - 1: a magnitude */
static double magnitude(uint64_t *seed, int low, int high) {
    const int n = low + below(seed, high - low);
    return ldexp(uniform(seed, 1, 2), n);
}

static double sign(uint64_t *seed) { return below(seed, 2) ? 1 : -1; }

/* A random direction times a length. */
static void direction(uint64_t *seed, double length, double *x, int n) {
    double square;
    do {
        square = 0;
        for (int i = 0; i < n; i++) {
            x[i] = uniform(seed, -1, 1);
            square += x[i] * x[i];
        }
    } while (square > 1 || square < 0.01);
    for (int i = 0; i < n; i++) x[i] *= length / sqrt(square);
}

/* ---- frames and axes ---- */

static void rotation_of(const double *u, double R[9]) {
    const double x = u[0], y = u[1], z = u[2], w = u[3];
    const double of_unit[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                               2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                               2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(R, of_unit, sizeof of_unit);
}

static void random_rotation(uint64_t *seed, double R[9]) {
    double u[4];
    direction(seed, 1, u, 4);
    rotation_of(u, R);
}

/* Axes to axes: one of the 24. */
static void quarter_turns(uint64_t *seed, double R[9]) {
    const int x = below(seed, 3), y = (x + 1 + below(seed, 2)) % 3, z = 3 - x - y;
    const double first = sign(seed), second = sign(seed);
    memset(R, 0, 9 * sizeof *R);
    R[x] = first;
    R[3 + y] = second;
    R[6 + z] = first * second * ((y - x + 3) % 3 == 1 ? 1 : -1);
}

/* A turn by 1e-1 to 1e-9 rad after that. */
static void nearly_quarter_turns(uint64_t *seed, double R[9]) {
    double Q[9], S[9], u[4], half = 0.05;
    for (int n = below(seed, 9); n > 0; n--) half /= 10;
    quarter_turns(seed, Q);
    if (below(seed, 2)) {
        direction(seed, half, u, 3);
    } else {
        u[0] = u[1] = u[2] = 0;
        u[below(seed, 3)] = half;
    }
    u[3] = sqrt(1 - u[0] * u[0] - u[1] * u[1] - u[2] * u[2]);
    rotation_of(u, S);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            R[3 * i + j] = Q[3 * i] * S[j] + Q[3 * i + 1] * S[3 + j] + Q[3 * i + 2] * S[6 + j];
}

static int has(const sample *s, int trait) { return (s->traits >> trait & 1) != 0; }

static void coordinate_axis(uint64_t *seed, double axis[3]) {
    const int k = below(seed, 3);
    axis[0] = axis[1] = axis[2] = 0;
    axis[k] = sign(seed);
}

static void draw_axis(sample *s, double axis[3]) {
    if ((has(s, AXES) || has(s, NEARLY)) && below(&s->seed, 4))
        coordinate_axis(&s->seed, axis);
    else
        direction(&s->seed, 1, axis, 3);
    const double length = below(&s->seed, 3) ? 1 : magnitude(&s->seed, -3, 3);
    for (int k = 0; k < 3; k++) axis[k] *= length;
}

/* Universal: at a right angle to the first, nearly, or anywhere that is not near it. */
static void draw_second_axis(sample *s, rbd_body *b) {
    const double *a = b->axis;
    double cosine, length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    do {
        draw_axis(s, b->axis2);
        const double *c = b->axis2, l2 = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        cosine = (a[0] * c[0] + a[1] * c[1] + a[2] * c[2]) / (length * l2);
    } while (!(fabs(cosine) < 0.8));
}

/* Where the joint frame stands: degenerate axes may have it at the origin, on the parent's axis or on its
 * own. */
static void draw_place(sample *s, int i) {
    rbd_body *b = &s->bodies[i];
    const int degenerate = has(s, AXES) || has(s, NEARLY), kind = degenerate ? below(&s->seed, 5) : 4;
    const double length = s->length[i] * uniform(&s->seed, 0.1, 1);
    if (degenerate && below(&s->seed, 6))
        (has(s, NEARLY) && below(&s->seed, 2) ? nearly_quarter_turns : quarter_turns)(&s->seed, b->rotation);
    else if (below(&s->seed, 8))
        random_rotation(&s->seed, b->rotation);
    switch (kind) {
    case 0: break;
    case 1:
        for (int k = 0; b->parent >= 0 && k < 3; k++) b->position[k] = length * s->bodies[b->parent].axis[k];
        break;
    case 2:
        for (int k = 0; k < 3; k++)
            b->position[k] = length * (b->rotation[3 * k] * b->axis[0] + b->rotation[3 * k + 1] * b->axis[1] +
                                       b->rotation[3 * k + 2] * b->axis[2]);
        break;
    case 3:
        coordinate_axis(&s->seed, b->position);
        for (int k = 0; k < 3; k++) b->position[k] *= length;
        break;
    default: direction(&s->seed, length, b->position, 3);
    }
    if (has(s, FAR) && b->parent < 0) direction(&s->seed, magnitude(&s->seed, 0, 20), b->position, 3);
}

/* ---- masses and joints ---- */

/* Positive second moments of mass along turned axes: the triangle inequality holds. Light robots have bodies
   with none (points), one (rods), or no mass at all. */
static void draw_mass(sample *s, int i) {
    rbd_body *b = &s->bodies[i];
    const double l = s->length[i];
    const int light = has(s, LIGHT) ? below(&s->seed, 4) : 3; /* massless, point, rod, body */
    double R[9], S[9] = {0};
    if (light == 0) return;
    b->mass = s->mass[i] * magnitude(&s->seed, -3, 3);
    direction(&s->seed, l * uniform(&s->seed, 0, 0.5), b->com, 3);
    if (light == 1) return;
    if (has(s, AXES) || has(s, LIGHT))
        quarter_turns(&s->seed, R);
    else
        random_rotation(&s->seed, R);
    for (int k = 0; k < (light == 2 ? 1 : 3); k++) {
        const double moment = b->mass * l * l * uniform(&s->seed, 0.001, 0.05);
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 3; column++)
                S[3 * row + column] += R[3 * row + k] * moment * R[3 * column + k];
    }
    const double inertia[6] = {S[4] + S[8], -S[1], -S[2], S[0] + S[8], -S[5], S[0] + S[4]};
    memcpy(b->inertia, inertia, sizeof inertia);
}

static const char *joint_name(int index) {
    static char names[WORLD_BODIES][16];
    snprintf(names[index], sizeof names[index], "j%d", index);
    return names[index];
}

static int can_follow(const rbd_body *b) {
    return !b->mimic && (b->type == RBD_REVOLUTE || b->type == RBD_CONTINUOUS || b->type == RBD_PRISMATIC ||
                         b->type == RBD_HELICAL);
}

static void maybe_follow(sample *s, int i) {
    rbd_body *b = &s->bodies[i];
    const int leader = below(&s->seed, i + 1);
    if (leader == i || !below(&s->seed, 3) || !can_follow(b) || !can_follow(&s->bodies[leader])) return;
    b->mimic = joint_name(leader);
    b->mimic_ratio = sign(&s->seed);
    b->mimic_ratio *= magnitude(&s->seed, -3, 2);
    b->mimic_offset =
        b->type == RBD_PRISMATIC ? s->length[i] * uniform(&s->seed, -1, 1) : uniform(&s->seed, -3, 3);
}

static void draw_joint(sample *s, int i, int one_dof) {
    rbd_body *b = &s->bodies[i];
    memset(b, 0, sizeof *b);
    b->joint = joint_name(i);
    b->parent = below(&s->seed, 3) ? i - 1 : below(&s->seed, i + 1) - 1;
    if (!has(s, FAR) && i > 0 && b->parent < 0) b->parent = i - 1;
    b->type = (rbd_joint_type)(one_dof || s->nv > WORLD_DOFS - 6 - (s->nb - i)
                                   ? RBD_REVOLUTE + below(&s->seed, RBD_HELICAL)
                                   : below(&s->seed, RBD_JOINT_TYPES));
    if (one_dof == 2) b->type = RBD_REVOLUTE;
    if (b->type != RBD_FIXED) draw_axis(s, b->axis);
    if (b->type == RBD_UNIVERSAL) draw_second_axis(s, b);
    if (b->type == RBD_HELICAL) b->pitch = s->length[i] * uniform(&s->seed, -0.5, 0.5);
    draw_place(s, i);
    draw_mass(s, i);
    const double armature = s->mass[i] * (b->type == RBD_PRISMATIC ? 1 : s->length[i] * s->length[i]);
    for (int k = 0; k < 6 && !below(&s->seed, 4); k++) b->armature[k] = armature * uniform(&s->seed, 0, 0.5);
    if (has(s, FOLLOWERS)) maybe_follow(s, i);
}

static int is_leaf(const sample *s, int i) {
    for (int k = i + 1; k < s->nb; k++)
        if (s->bodies[k].parent == i) return 0;
    return 1;
}

void draw_robot(sample *s, int class_number, int number) {
    s->seed = (uint64_t)number * CLASSES + (uint64_t)class_number;
    s->seed = next(&s->seed);
    s->traits = class_number == ALL ? (unsigned)below(&s->seed, 1 << ALL) : 1U << class_number;
    if (class_number == FAR && below(&s->seed, 2)) /* a common normal far away must not follow the base */
        s->traits |= 1U << NEARLY;
    s->nb = 1 + below(&s->seed, below(&s->seed, 4) ? 8 : WORLD_BODIES);
    s->nq = s->nv = 0;
    const double mass = has(s, SCALED) ? magnitude(&s->seed, -20, 20) : 1;
    const double length = has(s, SCALED) ? magnitude(&s->seed, -20, 20) : 1;
    const int one_dof = below(&s->seed, 3);
    for (int i = 0; i < s->nb; i++) {
        s->mass[i] = mass * (has(s, MIXED) ? magnitude(&s->seed, -20, 20) : 1);
        s->length[i] = length * (has(s, MIXED) ? magnitude(&s->seed, -20, 20) : 1);
        draw_joint(s, i, one_dof);
        s->nq += world_nq(&s->bodies[i]);
        s->nv += world_nv(&s->bodies[i]);
    }
    for (int i = 0; i < s->nb; i++)
        while (is_leaf(s, i) && !(s->bodies[i].mass > 0)) draw_mass(s, i);
}

/* ---- states ---- */

static double to_float(double x) { return (double)(float)x; }

/* n numbers within +-size; large angles if turned */
static void draw_angles(sample *s, double *x, int n) {
    for (int k = 0; k < n; k++) {
        x[k] = uniform(&s->seed, -4, 4);
        if (has(s, TURNED)) x[k] *= magnitude(&s->seed, -1, 18);
    }
}

static void draw_lengths(sample *s, double length, double *x, int n) {
    for (int k = 0; k < n; k++) x[k] = length * uniform(&s->seed, -1, 1);
}

static void draw_direction(sample *s, double *x, int n) {
    direction(&s->seed, has(s, TURNED) ? magnitude(&s->seed, -20, 20) : 1, x, n);
}

static void draw_coordinates(sample *s, int i, double *q) {
    const rbd_body *b = &s->bodies[i];
    const double length = s->length[i];
    switch (b->type) {
    case RBD_PRISMATIC: draw_lengths(s, length, q, 1); break;
    case RBD_TRANSLATION: draw_lengths(s, length, q, 3); break;
    case RBD_CYLINDRICAL:
        draw_angles(s, q, 1);
        draw_lengths(s, length, q + 1, 1);
        break;
    case RBD_PLANAR:
        draw_lengths(s, length, q, 2);
        draw_angles(s, q + 2, 1);
        break;
    case RBD_FLOATING:
        draw_lengths(s, length, q, 3);
        draw_direction(s, q + 3, 4);
        break;
    case RBD_SPHERICAL: draw_direction(s, q, 4); break;
    case RBD_CONTINUOUS_CS: draw_direction(s, q, 2); break;
    default: draw_angles(s, q, world_nq(b));
    }
}

/* Rates, or accelerations, of the order of size; shifts times the length of the link. */
static void draw_rates(sample *s, int i, double size, double *v) {
    const rbd_body *b = &s->bodies[i];
    const double length = size * s->length[i];
    switch (b->type) {
    case RBD_PRISMATIC: draw_lengths(s, length, v, 1); break;
    case RBD_TRANSLATION: draw_lengths(s, length, v, 3); break;
    case RBD_CYLINDRICAL:
        draw_lengths(s, size, v, 1);
        draw_lengths(s, length, v + 1, 1);
        break;
    case RBD_PLANAR:
        draw_lengths(s, size, v, 1);
        draw_lengths(s, length, v + 1, 2);
        break;
    case RBD_FLOATING:
        draw_lengths(s, size, v, 3);
        draw_lengths(s, length, v + 3, 3);
        break;
    default: draw_lengths(s, size, v, world_nv(b));
    }
}

void draw_state(sample *s, sample_state *x) {
    const double rate = below(&s->seed, 4) ? 3 : magnitude(&s->seed, -10, 10);
    const double pull = below(&s->seed, 3) ? 0 : 10;
    memset(x, 0, sizeof *x);
    if (below(&s->seed, 4)) direction(&s->seed, 9.81, x->gravity, 3);
    for (int i = 0, iq = 0, iv = 0; i < s->nb; i++) {
        draw_lengths(s, pull * s->mass[i] * s->length[i], x->f_ext + 6 * i, 3);
        draw_lengths(s, pull * s->mass[i], x->f_ext + 6 * i + 3, 3);
        if (s->bodies[i].mimic) continue;
        draw_coordinates(s, i, x->q + iq);
        draw_coordinates(s, i, x->q1 + iq);
        draw_rates(s, i, rate, x->v + iv);
        draw_rates(s, i, rate * rate, x->a + iv);
        iq += world_nq(&s->bodies[i]);
        iv += world_nv(&s->bodies[i]);
    }
    draw_lengths(s, 1, x->tau, s->nv);
    double *all[] = {x->gravity, x->q, x->q1, x->v, x->a, x->tau, x->f_ext};
    const int counts[] = {3, s->nq, s->nq, s->nv, s->nv, s->nv, 6 * s->nb};
    for (int k = 0; k < 7; k++)
        for (int i = 0; i < counts[k]; i++) all[k][i] = to_float(all[k][i]);
}

/* ---- as C source ---- */

static void print_row(const char *name, const double *x, int n) {
    int given = 0;
    for (int i = 0; i < n; i++) given |= x[i] < 0 || x[i] > 0;
    if (!given) return;
    printf("%s{", name);
    for (int i = 0; i < n; i++) printf("%s%.17g", i ? ", " : "", x[i]);
    printf("}");
}

void print_robot(const sample *s) {
#define NAME_OF(type) [type] = #type
    static const char *const types[RBD_JOINT_TYPES] = {
        NAME_OF(RBD_FIXED),     NAME_OF(RBD_REVOLUTE),  NAME_OF(RBD_CONTINUOUS),  NAME_OF(RBD_CONTINUOUS_CS),
        NAME_OF(RBD_PRISMATIC), NAME_OF(RBD_HELICAL),   NAME_OF(RBD_CYLINDRICAL), NAME_OF(RBD_UNIVERSAL),
        NAME_OF(RBD_SPHERICAL), NAME_OF(RBD_EULER_ZYX), NAME_OF(RBD_EULER_XYZ),   NAME_OF(RBD_EULER_YXZ),
        NAME_OF(RBD_EULER_ZXY), NAME_OF(RBD_PLANAR),    NAME_OF(RBD_TRANSLATION), NAME_OF(RBD_FLOATING)};
#undef NAME_OF
    printf("static const rbd_body bodies[%d] = {\n", s->nb);
    for (int i = 0; i < s->nb; i++) {
        const rbd_body *b = &s->bodies[i];
        printf("    {.joint = \"%s\", .parent = %d, .type = %s", b->joint, b->parent, types[b->type]);
        print_row(", .axis = ", b->axis, 3);
        print_row(", .axis2 = ", b->axis2, 3);
        if (b->type == RBD_HELICAL) printf(", .pitch = %.17g", b->pitch);
        print_row(", .position = ", b->position, 3);
        print_row(", .rotation = ", b->rotation, 9);
        printf(", .mass = %.17g", b->mass);
        print_row(", .com = ", b->com, 3);
        print_row(", .inertia = ", b->inertia, 6);
        print_row(", .armature = ", b->armature, 6);
        if (b->mimic)
            printf(", .mimic = \"%s\", .mimic_ratio = %.17g, .mimic_offset = %.17g", b->mimic, b->mimic_ratio,
                   b->mimic_offset);
        printf("},\n");
    }
    printf("};\n");
}

void print_state(const sample *s, const sample_state *x) {
    print_row("gravity = ", x->gravity, 3);
    print_row("\nq = ", x->q, s->nq);
    print_row("\nv = ", x->v, s->nv);
    print_row("\na = ", x->a, s->nv);
    print_row("\nf_ext = ", x->f_ext, 6 * s->nb);
    printf("\n");
}
