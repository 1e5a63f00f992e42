/* actuator_scalars.c - rbd_actuator.h in double and in float: friction beside the published formula,
   exponentials, inverse and forward, limits, heat, energy, rods that close. */
#define RBD_STATIC
#define RBD_IMPLEMENTATION
#include "larger.h"
#include "rbd_actuator.h"

#include "models/iiwa.h"
#include "servos.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { IN_FLOAT = sizeof(rbd_real) == 4 };

static int failures;
static void expect(int holds, const char *what, double value) {
    if (holds) return;
    failures++;
    printf("FAILED: %s: %g\n", what, value);
}

/* A bound for double, or for float. */
static double bound(double exact, double rough) { return IN_FLOAT ? rough : exact; }

static uint64_t seed = 1;
static rbd_real draw(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (rbd_real)(low + (high - low) * ldexp((double)(seed >> 11), -53));
}

static const rbd_model *m;
static rbd_work *w;
static rbd_actuators *a;
static unsigned char model_memory[100000], work_memory[200000], memory[100000];

static void build(const rbd_body *bodies, int nb, const rbd_motor *motors, int n, const rbd_transmission *t,
                  int groups) {
    rbd_report report;
    char text[200];
    if (rbd_model_build(bodies, nb, model_memory, sizeof model_memory, &m, &report) != RBD_OK ||
        rbd_work_init(m, work_memory, sizeof work_memory, &w) != RBD_OK)
        exit(2);
    if (rbd_actuators_init(m, motors, n, t, groups, memory, sizeof memory, &a, &report) != RBD_OK) {
        puts(rbd_actuators_finding_text(&report.error, n, text, sizeof text));
        exit(2);
    }
}

static const rbd_body wheel[1] = {{.joint = "axle",
                                   .parent = -1,
                                   .type = RBD_REVOLUTE,
                                   .axis = {0, 0, 1},
                                   .mass = 1,
                                   .inertia = {0.1, 0, 0, 0.1, 0, 0.1}}};

/* A step of second order; how often it was repeated. */
static int step(const rbd_command *commands, const rbd_real *other, rbd_real *q, rbd_real *v, rbd_real dt) {
    rbd_real tau[7], damping[7], q_next[7], v_next[7];
    rbd_actuator_state s;
    rbd_status status = rbd_actuators_begin(a, commands, q, v, dt, 0, tau, damping);
    do {
        for (int k = 0; k < rbd_nv(m); k++) tau[k] += other[k];
        if (status == RBD_OK) status = rbd_free_step(m, w, q, v, tau, NULL, damping, dt, q_next, v_next);
    } while (status == RBD_OK && rbd_actuators_again(a, v_next, tau, damping));
    expect(status == RBD_OK, "a step", status);
    memcpy(q, q_next, (size_t)rbd_nq(m) * sizeof *q);
    memcpy(v, v_next, (size_t)rbd_nv(m) * sizeof *v);
    rbd_actuators_get(a, 0, &s);
    return s.repeats;
}

/* ---- functions ---- */

static void check_exponentials(void) {
    double worst = 0, worst_log = 0;
    for (int k = 0; k < 100000; k++) {
        const rbd_real x = draw(-79, 79), y = (rbd_real)exp((double)draw(-60, 60));
        worst = larger(worst, fabs((double)rbdi_act_exponential(x) / exp((double)x) - 1) /
                                  (1 + fabs((double)x) / 8));
        worst_log = larger(worst_log,
                           fabs((double)rbdi_act_logarithm(y) - log((double)y)) / (1 + fabs(log((double)y))));
    }
    expect(worst < bound(1e-15, 4e-7), "exponential", worst);
    expect(worst_log < bound(1e-15, 4e-7), "logarithm", worst_log);
    expect(rbdi_act_exponential(-1000) <= 0, "exponential of -1000", 0);
}

static double published(const rbd_gear_friction *f, double x, double t_m, double t_x) {
    const int opposed = (t_x > 0) - (t_x < 0) != (t_m > 0) - (t_m < 0);
    const double S = exp(-pow(fabs(x / (double)f->speed), (double)f->power));
    double rest = (double)f->rest + fabs((double)f->rest_joint * t_x - (double)f->rest_motor * t_m);
    if (opposed && fabs(t_x) < fabs(t_m)) rest += (double)f->square_joint * t_x * t_x;
    if (opposed && fabs(t_x) > fabs(t_m)) rest += (double)f->square_motor * t_m * t_m;
    return (double)f->coulomb + fabs((double)f->load_joint * t_x - (double)f->load_motor * t_m) + S * rest;
}

static void check_servos(void) {
    double worst = 0;
    for (int k = 0; k < 100000; k++) {
        const rbd_gear_friction *f = &servos[k % 7].friction;
        const rbd_real x = draw(-10, 10), t_m = draw(-9, 9), t_x = draw(-9, 9);
        const double expected = published(f, (double)x, (double)t_m, (double)t_x);
        worst = larger(worst, fabs((double)rbd_friction_level(f, x, t_m, t_x) - expected) / (1 + expected));
    }
    expect(worst < bound(1e-14, 2e-6), "friction of servos", worst);
}

/* ---- inverse ---- */

static void check_inverse(void) {
    rbd_motor motor = {.joint = "axle", .gear = 50, .constant = RBD_C(0.05), .resistance = RBD_C(0.5)};
    const rbd_real q[1] = {0};
    double worst = 0;
    int jumps = 0;
    build(wheel, 1, &motor, 1, NULL, 0);
    for (int k = 0; k < 100000; k++) {
        const rbd_real v[1] = {draw(-3, 3)}, acc[1] = {draw(-10, 10)}, tau[1] = {draw(-20, 20)};
        rbd_drive o;
        motor.friction = servos[k % 7].friction;
        motor.inertia = draw(1e-5, 2e-5);
        motor.gear = draw(20, 100);
        expect(rbd_actuators_inverse(a, q, v, acc, tau, &o) == RBD_OK, "inverse", 0);
        const double level = published(&motor.friction, (double)v[0], (double)o.torque, (double)-tau[0]);
        const double J = (double)motor.gear * (double)motor.gear * (double)motor.inertia;
        const double out = (double)o.torque - J * (double)acc[0] -
                           (double)motor.friction.viscous * (double)v[0] - (v[0] > 0 ? level : -level);
        const double error = fabs(out - (double)tau[0]) / (1 + fabs((double)tau[0]) + fabs((double)o.torque));
        if (!(error <= bound(1e-13, 1e-5)))
            jumps++;
        else
            worst = larger(worst, error);
    }
    expect(jumps <= 100, "motors on the jump of the squares", jumps);
    expect(worst < bound(1e-13, 1e-5), "forward of the inverse", worst);
}

static void check_limits(void) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 50,
                             .constant = RBD_C(0.03),
                             .resistance = RBD_C(0.6),
                             .voltage = 24,
                             .current = 15};
    const double line[5] = {22.5, 22.5, 22.5, 15, 0};
    build(wheel, 1, &motor, 1, NULL, 0);
    for (int k = 0; k < 5; k++) {
        const rbd_command c = {.torque = 1000};
        const rbd_real q[1] = {0}, v[1] = {(rbd_real)(4 * k)};
        rbd_real tau[1], damping[1];
        rbd_actuators_begin(a, &c, q, v, RBD_C(1e-3), 0, tau, damping);
        expect(fabs((double)(tau[0] - damping[0] * v[0]) - line[k]) < bound(1e-12, 1e-4), "torque-speed line",
               k);
    }
}

/* ---- steps ---- */

static void check_heat(void) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 1,
                             .constant = 1,
                             .resistance = RBD_C(0.5),
                             .heat_winding = 20,
                             .heat_case = 300,
                             .flow_winding = RBD_C(1.5),
                             .flow_case = 3};
    const rbd_command c = {.torque = 4};
    const rbd_real none[1] = {0};
    rbd_real q[1] = {0}, v[1] = {0};
    rbd_actuator_state s;
    build(wheel, 1, &motor, 1, NULL, 0);
    for (int k = 0; k < 8000; k++) {
        v[0] = 0;
        step(&c, none, q, v, 10);
    }
    rbd_actuators_get(a, 0, &s);
    expect(fabs((double)s.winding - 61) < bound(1e-6, 0.02), "winding", (double)s.winding);
    expect(fabs((double)s.housing - 49) < bound(1e-6, 0.02), "housing", (double)s.housing);
}

/* What its friction holds moves by no more than the creep. */
static void check_holding(void) {
    rbd_motor motors[7];
    const rbd_command none[7] = {{0}};
    const rbd_real other[7] = {0},
                   start[7] = {0, (rbd_real)0.7, (rbd_real)0.2, -1, (rbd_real)0.3, (rbd_real)0.6, 0};
    rbd_real q[7], v[7] = {0}, g[7];
    double moved = 0;
    memset(motors, 0, sizeof motors);
    for (int i = 0; i < 7; i++)
        motors[i] = (rbd_motor){.joint = iiwa_bodies[i].joint, .gear = 1, .constant = 1};
    build(iiwa_bodies, 7, motors, 7, NULL, 0);
    rbd_gravity_torque(m, w, start, g);
    for (int i = 0; i < 7; i++)
        motors[i].friction.coulomb = (rbd_const)fabs(1.001 * (double)g[i]) + (i % 6 ? 0 : RBD_C(0.1));
    memcpy(q, start, sizeof q);
    for (int k = 0; k < 1000; k++) step(none, other, q, v, RBD_C(1e-3));
    for (int i = 0; i < 7; i++) moved = larger(moved, fabs((double)(q[i] - start[i])));
    expect(moved < bound(2e-9, 5e-6), "held by friction, moved by", moved);
}

/* Two masses, spring, play, friction: the energy never grows. */
static void check_energy(double stiffness, double backlash, double dt) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 50,
                             .constant = 1,
                             .inertia = RBD_C(2e-5),
                             .stiffness = (rbd_const)stiffness,
                             .damping = RBD_C(0.01),
                             .backlash = (rbd_const)backlash,
                             .friction = {.coulomb = backlash > 0 ? 0 : RBD_C(0.02)}};
    const rbd_command c = {0};
    const rbd_real none[1] = {0};
    rbd_real q[1] = {0}, v[1] = {2};
    double last = 1e9, grown = 0;
    build(wheel, 1, &motor, 1, NULL, 0);
    for (int k = 0; k < (int)(2 / dt); k++) {
        rbd_actuator_state s;
        step(&c, none, q, v, (rbd_real)dt);
        rbd_actuators_get(a, 0, &s);
        const double wound = larger(0, fabs((double)s.angle - (double)q[0]) - backlash / 2);
        const double energy = 0.05 * (double)v[0] * (double)v[0] + 0.025 * (double)s.speed * (double)s.speed +
                              0.5 * stiffness * wound * wound;
        grown = larger(grown, energy - last);
        last = energy;
    }
    expect(grown < bound(1e-14, 1e-5 * (1 + stiffness * 1e-5)), "energy grown by", grown);
}

/* ---- rods ---- */

static const rbd_body shank[2] = {{.joint = "pitch",
                                   .parent = -1,
                                   .type = RBD_REVOLUTE,
                                   .axis = {0, 1, 0},
                                   .position = {0.02, 0, -0.4},
                                   .mass = 0.1,
                                   .inertia = {1e-3, 0, 0, 1e-3, 0, 1e-3}},
                                  {.joint = "roll",
                                   .parent = 0,
                                   .type = RBD_REVOLUTE,
                                   .axis = {1, 0, 0},
                                   .position = {0, 0, -0.03},
                                   .mass = 1,
                                   .inertia = {1e-3, 0, 0, 1e-3, 0, 1e-3}}};

/* The ends of crank and rod are a rod's length apart, at every angle; power is the same on both sides. */
static void check_rods(int elbow) {
    const rbd_transmission t = {.kind = RBD_BY_RODS,
                                .n = 2,
                                .joint = {"pitch", "roll"},
                                .rod = {{.place = {0, RBD_C(0.05), RBD_C(-0.1)},
                                         .axis = {0, 1, 0},
                                         .zero = {-1, 0, 0},
                                         .crank = RBD_C(0.06),
                                         .length = RBD_C(0.3),
                                         .point = {RBD_C(-0.05), RBD_C(0.045), RBD_C(0.01)},
                                         .elbow = elbow},
                                        {.place = {0, RBD_C(-0.05), RBD_C(-0.15)},
                                         .axis = {0, 1, 0},
                                         .zero = {-1, 0, 0},
                                         .crank = RBD_C(0.065),
                                         .length = RBD_C(0.26),
                                         .point = {RBD_C(-0.055), RBD_C(-0.045), RBD_C(0.015)},
                                         .elbow = elbow}}};
    const rbd_motor motors[2] = {{.gear = 1, .constant = 1}, {.gear = 1, .constant = 1}};
    double open = 0, power = 0;
    build(shank, 2, motors, 2, &t, 1);
    for (int k = 0; k < 1000; k++) {
        const rbd_real q[2] = {draw(-0.3, 0.3), draw(-0.2, 0.2)}, v[2] = {draw(-2, 2), draw(-2, 2)};
        const rbd_real tau[2] = {draw(-5, 5), draw(-5, 5)}, zero[2] = {0, 0};
        rbd_real angle[2], speed[2];
        rbd_drive o[2];
        expect(rbd_actuators_map(a, q, v, angle, speed) == RBD_OK, "map of rods", k);
        rbd_kinematics(m, w, q, NULL, NULL);
        for (int i = 0; i < 2; i++) {
            const rbd_rod *rod = &t.rod[i];
            const rbd_real at[3] = {rod->point[0], rod->point[1], rod->point[2]};
            rbd_real P[3];
            double square = 0;
            rbd_point_position(m, w, 1, at, P);
            const double c = (double)rod->crank, s = (double)angle[i];
            const double C[3] = {-c * cos(s), (double)rod->place[1], (double)rod->place[2] + c * sin(s)};
            for (int j = 0; j < 3; j++) square += ((double)P[j] - C[j]) * ((double)P[j] - C[j]);
            open = larger(open, fabs(sqrt(square) - (double)rod->length));
        }
        expect(rbd_actuators_inverse(a, q, v, zero, tau, o) == RBD_OK, "inverse of rods", k);
        power = larger(power, fabs((double)(o[0].torque * speed[0] + o[1].torque * speed[1] - tau[0] * v[0] -
                                            tau[1] * v[1])));
    }
    expect(open < bound(1e-14, 1e-6), "rods open by", open);
    expect(power < bound(1e-12, 1e-3), "power lost in rods", power);
}

/* A mass that a step guesses anew, because it finds no speeds with the one before, is learnt as the first
   one: three shafts that slide in series have a constant one, which three answers tell. */
static void check_guess_anew(void) {
    static const char *const joints[3] = {"x", "y", "z"};
    const rbd_transmission t = {.kind = RBD_BY_MATRIX,
                                .n = 3,
                                .joint = {joints[0], joints[1], joints[2]},
                                .matrix = {2, 1, 0, -1, 2, 1, 1, 0, 2}};
    const rbd_real dt = (rbd_real)1e-2, q[3] = {0}, v[3] = {1, -2, 3};
    rbd_real tau[3], damping[3], q_next[3], v_next[3];
    rbd_body bodies[3];
    rbd_motor motors[3];
    rbd_command commands[3];
    int spoilt = 0, guessed = 0;
    memset(bodies, 0, sizeof bodies);
    memset(motors, 0, sizeof motors);
    memset(commands, 0, sizeof commands);
    for (int i = 0; i < 3; i++) {
        bodies[i].joint = joints[i];
        bodies[i].parent = i - 1;
        bodies[i].type = RBD_PRISMATIC;
        bodies[i].axis[i] = 1;
        bodies[i].axis[(i + 1) % 3] = 0.5;
        bodies[i].mass = 1 + i;
        motors[i].gear = motors[i].constant = 1;
        motors[i].friction.viscous = (rbd_const)(20 * (i + 1));
    }
    build(bodies, 3, motors, 3, &t, 1);

    expect(rbd_actuators_begin(a, commands, q, v, dt, 0, tau, damping) == RBD_OK, "begin", 0);
    do {
        if (a->pairs == 1 && !spoilt) {
            for (int i = 0; i < 9; i += 4) a->mass[i] = -1000000;
            spoilt = 1;
        }
        if (spoilt && !a->known) guessed = a->repeats + 1;
        expect(rbd_free_step(m, w, q, v, tau, NULL, damping, dt, q_next, v_next) == RBD_OK, "a free step", 0);
    } while (rbd_actuators_again(a, v_next, tau, damping));
    expect(IN_FLOAT || guessed > 0, "a mass guessed anew", guessed); /* float: the step settles before */
    expect(a->repeats <= guessed + 3, "answers after a guess", a->repeats - guessed);
}

/* ---- inside of coupled shafts ---- */

static const rbd_transmission coupling = {
    .kind = RBD_BY_MATRIX, .n = 2, .joint = {"pitch", "roll"}, .matrix = {1, 0, 1, 1}};

/* Two coupled shafts of which M = ((4, 1), (1, 3)) was learnt, at rest in a step of 1/4 s. */
static void build_coupled(void) {
    static const rbd_motor motors[2] = {{.gear = 1, .constant = 1}, {.gear = 1, .constant = 1}};
    const rbd_real M[4] = {4, 1, 1, 3}, still[2] = {0, 0};
    const rbd_command commands[2] = {{0}};
    rbd_real tau[2], damping[2];
    build(shank, 2, motors, 2, &coupling, 1);
    expect(rbd_actuators_begin(a, commands, still, still, RBD_C(0.25), 0, tau, damping) == RBD_OK, "begin",
           0);
    memcpy(a->mass, M, sizeof M);
    a->known = 1;
}

/* Speeds by pieces: M x / dt + slope x = start. None is beyond 1e9, no torque beyond 1e12. */
static void check_speeds_in_bounds(void) {
    build_coupled();
    a->shaft[0].start = 46; /* of the speeds (2, 3): 4 M (2, 3) + (1 * 2, 0) */
    a->shaft[0].slope = 1;
    a->shaft[1].start = 44;
    expect(rbdi_act_solve_pieces(a), "speeds of pieces", 0);
    expect(fabs((double)a->shaft[0].next - 2) < bound(1e-14, 1e-5), "speed 0", (double)a->shaft[0].next);
    expect(fabs((double)a->shaft[1].next - 3) < bound(1e-14, 1e-5), "speed 1", (double)a->shaft[1].next);
    expect(fabs((double)a->shaft[0].force - 44) < bound(1e-13, 1e-4), "torque", (double)a->shaft[0].force);

    a->shaft[0].start = RBD_C(1e11); /* 5e9 rad/s, 8e10 N m */
    expect(!rbdi_act_solve_pieces(a), "a speed beyond 1e9", (double)a->shaft[0].next);
    for (int i = 0; i < 4; i++) a->mass[i] *= RBD_C(1e6);
    a->shaft[0].start = RBD_C(1e13); /* 6e5 rad/s */
    expect(!rbdi_act_solve_pieces(a), "a torque beyond 1e12", (double)a->shaft[0].force);
    expect(fabs((double)a->shaft[0].next) < 1e9, "its speed", (double)a->shaft[0].next);
    for (int i = 0; i < 4; i++) a->mass[i] = -a->mass[i];
    expect(!rbdi_act_solve_pieces(a), "a mass below 0", 0);
}

/* M as it was, times `times` in the direction (1, -2); across it, where M (5, 2) = (22, 11), it stays. */
static void expect_mass(double times, const char *what) {
    const double M_p[2] = {2, -5}, M_across[2] = {22, 11};
    for (int i = 0; i < 2; i++) {
        const double M_0 = (double)a->mass[2 * i], M_1 = (double)a->mass[2 * i + 1];
        expect(fabs(M_0 - 2 * M_1 - times * M_p[i]) < bound(1e-13, 1e-4), what, M_0 - 2 * M_1);
        expect(fabs(5 * M_0 + 2 * M_1 - M_across[i]) < bound(1e-13, 1e-4), what, 5 * M_0 + 2 * M_1);
    }
    expect(a->pairs == 0, what, a->pairs);
}

/* Speeds that did not change, or against the impulse, where (1, -2) was foretold: M is ten times as large in
   this direction. Where no change was foretold either, nothing is learnt. */
static void check_stiffening(int against) {
    build_coupled();
    a->pairs = 1;
    rbdi_act_learn(a);
    expect_mass(1, "nothing foretold");

    a->shaft[0].point = 1;
    a->shaft[1].point = -2;
    a->shaft[0].next = (rbd_real)against;
    a->shaft[0].force = (rbd_real)-against;
    rbdi_act_learn(a);
    expect_mass(10, "stiffer");
}

/* Springs so stiff that in float their rounding hides whether the pieces hold: the search ends all the same,
   and the joints are told what the laws have there, within rounding. */
static void check_search_cut_short(void) {
    static const rbd_motor motors[2] = {{.gear = 1,
                                         .constant = 1,
                                         .inertia = RBD_C(0.00620412128),
                                         .current = RBD_C(5.52774191),
                                         .voltage = RBD_C(1.54119587),
                                         .resistance = 1,
                                         .stiffness = RBD_C(23693.0938),
                                         .damping = RBD_C(2.19551468),
                                         .backlash = RBD_C(0.01),
                                         .friction = {.coulomb = RBD_C(0.0194064528)}},
                                        {.gear = 1,
                                         .constant = 1,
                                         .inertia = RBD_C(0.0398348309),
                                         .current = RBD_C(2.62774086),
                                         .voltage = RBD_C(0.59370774),
                                         .resistance = 1,
                                         .stiffness = RBD_C(96452.6562),
                                         .damping = RBD_C(5.90066147),
                                         .backlash = RBD_C(0.01),
                                         .friction = {.coulomb = RBD_C(0.0205295198)}}};
    const rbd_command commands[2] = {
        {.q = RBD_C(-0.377616435),
         .kp = RBD_C(8.71860409),
         .kd = RBD_C(0.602784753),
         .torque = RBD_C(-0.0429688841)},
        {.q = RBD_C(-0.0208768006), .kp = RBD_C(74.4206085), .torque = RBD_C(0.78009367)}};
    const rbd_real q[2] = {RBD_C(0.760957301), RBD_C(0.416975915)};
    const rbd_real v[2] = {RBD_C(0.30125773), RBD_C(-0.587870896)};
    const rbd_real angle[2] = {RBD_C(-0.602526367), RBD_C(-0.206861943)};
    const rbd_real speed[2] = {RBD_C(1.21424794), RBD_C(0.489307135)};
    const rbd_real torque[2] = {RBD_C(18.29286), RBD_C(9.34378338)};
    const rbd_real M[4] = {RBD_C(0.00386555609), RBD_C(-0.0052638445), RBD_C(-0.0052638445),
                           RBD_C(0.0342369042)};
    rbd_real tau[2], damping[2];
    build(shank, 2, motors, 2, &coupling, 1);
    for (int i = 0; i < 2; i++) {
        a->shaft[i].angle = angle[i];
        a->shaft[i].speed = speed[i];
    }
    expect(rbd_actuators_begin(a, commands, q, v, RBD_C(0.0651988909), 0, tau, damping) == RBD_OK, "begin",
           0);

    memcpy(a->mass, M, sizeof M);
    for (int i = 0; i < 2; i++) a->shaft[i].base = a->shaft[i].seen_T = torque[i];
    expect(rbdi_act_foretell(a), "foretold", 0);
    for (int i = 0; i < 2; i++) {
        const rbdi_act_shaft *s = &a->shaft[i];
        const double off = fabs((double)(s->base - rbdi_act_law_at(&motors[i], s, s->point, a)));
        expect(off < bound(1e-9, 1e-4), "off its law", off);
    }
}

/* Where two lines of a motor meet at the rotor's speed, but for rounding, either has this speed. */
static void check_lines_that_meet(void) {
    const rbd_motor motor = {.joint = "axle",
                             .gear = 1,
                             .constant = 1,
                             .inertia = RBD_C(0.05),
                             .current = 2,
                             .stiffness = 300,
                             .damping = 1};
    const rbd_command c = {.kd = 3};
    const rbd_real q[1] = {0};
    rbd_real tau[1], damping[1];
    double worst = 0;
    build(wheel, 1, &motor, 1, NULL, 0);
    for (int k = 0; k < 20000; k++) {
        rbdi_act_shaft *s = a->shaft;
        const rbd_real v[1] = {draw(-3, 3)};
        rbdi_act_spring found, limited;
        expect(rbd_actuators_begin(a, &c, q, v, RBD_C(1e-2), 0, tau, damping) == RBD_OK, "begin", k);
        limited = rbdi_act_spring_by(&motor, s, rbdi_act_line_of(s, 1), v[0], a);
        s->t = s->most + s->braking * limited.y;
        found = rbdi_act_spring_at(&motor, s, v[0], a);
        worst = larger(worst, fabs((double)(found.y - limited.y)) / (1 + fabs((double)limited.y)));
    }
    expect(worst < bound(1e-14, 1e-5), "speed where lines meet", worst);
}

/* A light rotor that slides on a stiff spring: at the step's end the spring has the torque of its winding. */
static void check_light_rotors(void) {
    rbd_motor motor = {.joint = "axle", .gear = 10, .constant = 1, .stiffness = RBD_C(1e8)};
    const rbd_command none = {0};
    double worst = 0;
    for (int k = 0; k < 2000; k++) {
        const rbd_real other[1] = {0}, dt = draw(1e-3, 1e-2);
        rbd_real q[1] = {draw(-1, 1)}, v[1] = {draw(2, 5)};
        rbd_actuator_state s;
        motor.inertia = (rbd_const)(1e-2 * pow(10, (double)draw(-6, -2)));
        motor.friction.coulomb = draw(1, 10);
        build(wheel, 1, &motor, 1, NULL, 0);
        expect(rbd_actuators_reset(a, q, 25) == RBD_OK, "reset", k);
        step(&none, other, q, v, dt);
        rbd_actuators_get(a, 0, &s);
        worst = larger(worst, fabs((double)s.angle - (double)q[0] - (double)s.joint / 1e8));
        expect(s.speed > RBD_C(0.5), "it does not slide", (double)s.speed);
    }
    expect(worst < bound(1e-14, 1e-6), "winding of a stiff spring", worst);
}

/* What a step adds at most to the energy of two slides behind a matrix, as a share of the first energy. Their
   springs have dt^2 stiffness of `ratio` times a slide's mass, and light rotors. */
static double stiff_gain(double ratio, int friction) {
    static const rbd_body slides[2] = {
        {.joint = "a", .parent = -1, .type = RBD_PRISMATIC, .axis = {1, 0, 0}, .mass = RBD_C(1e-2)},
        {.joint = "b", .parent = -1, .type = RBD_PRISMATIC, .axis = {0, 1, 0}, .mass = RBD_C(1e-2)}};
    const rbd_command none[2] = {{0}};
    const rbd_real other[2] = {0};
    double most = 0;
    for (int k = 0; k < 100; k++) {
        const rbd_real dt = draw(3e-3, 1e-2);
        const rbd_transmission t = {
            .n = 2, .joint = {"a", "b"}, .matrix = {1, draw(-0.5, 0.5), draw(-0.5, 0.5), 1}};
        rbd_motor motors[2] = {{.gear = 10, .constant = 1}, {.gear = 10, .constant = 1}};
        rbd_real q[2] = {0}, v[2] = {draw(1, 3), draw(-3, -1)};
        double first = 0, last = 0;
        for (int i = 0; i < 2; i++) {
            motors[i].inertia = (rbd_const)(1e-4 * pow(10, (double)draw(-4, 0)));
            motors[i].stiffness = (rbd_const)(1e-2 * ratio / (double)(dt * dt));
            if (friction) motors[i].friction.coulomb = (rbd_const)(1e-2 * pow(10, (double)draw(-1, 1)));
        }
        build(slides, 2, motors, 2, &t, 1);
        expect(rbd_actuators_reset(a, q, 25) == RBD_OK, "reset", k);
        for (int n = 0; n <= 100; n++) {
            rbd_real angle[2], speed[2];
            double energy = 0;
            if (n > 0) step(none, other, q, v, dt);
            expect(rbd_actuators_map(a, q, v, angle, speed) == RBD_OK, "map", n);
            for (int i = 0; i < 2; i++) {
                rbd_actuator_state s;
                rbd_actuators_get(a, i, &s);
                const double wound = (double)s.angle - (double)angle[i], J = 100 * (double)motors[i].inertia;
                energy += 0.5e-2 * (double)v[i] * (double)v[i] + 0.5 * J * (double)s.speed * (double)s.speed +
                          0.5 * (double)motors[i].stiffness * wound * wound;
            }
            if (n == 0) first = energy;
            if (n > 0) most = larger(most, (energy - last) / first);
            last = energy;
        }
    }
    return most;
}

/* docs/actuators.md says how much that is in float, where torques behind a transmission are rounded. */
static void check_stiff_coupled(void) {
    static const double smooth[6] = {1e-5, 1e-5, 1e-5, 1e-5, 1e-4, 1e-3},
                        dry[6] = {1e-5, 1e-5, 1e-5, 3e-3, 3e-2, 1e-1};
    for (int power = 0; power < 6; power++) {
        double gain = stiff_gain(pow(10, power), 0);
        expect(gain <= bound(1e-12, smooth[power]), "gain of stiff springs behind a matrix", gain);
        gain = stiff_gain(pow(10, power), 1);
        expect(gain <= bound(1e-12, dry[power]), "the same with friction", gain);
    }
}

/* A shaft that its friction stops within a step settles at once, whatever its speed was. */
static void check_stopping(void) {
    static const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1, .friction = {.coulomb = 200}};
    const rbd_command none = {0};
    const rbd_real other[1] = {0};
    int most = 0;
    build(wheel, 1, &motor, 1, NULL, 0);
    for (int k = 0; k < 5000; k++) {
        rbd_real q[1] = {0}, v[1] = {draw(-20, 20)};
        const double creep = bound(1e-9, 1e-6) + bound(1e-14, 1e-5) * fabs((double)v[0]);
        const int repeats = step(&none, other, q, v, RBD_C(1e-2));
        if (repeats > most) most = repeats;
        expect(fabs((double)v[0]) <= creep, "a shaft that stops creeps", (double)v[0]);
    }
    expect(most <= 5, "repeats of a shaft that stops", most);
}

/* The phase of cogging is an angle of the shaft: turned by it, the motion is the same. */
static void check_phase(void) {
    rbd_motor motor = {.joint = "axle", .gear = 10, .constant = 1, .teeth = 4, .cogging = RBD_C(0.05)};
    const rbd_command none = {0};
    const rbd_real other[1] = {0};
    double worst = 0;
    for (int k = 0; k < 20; k++) {
        const rbd_real at = draw(-1, 1), speed = draw(1, 2);
        double end[2];
        for (int turned = 0; turned < 2; turned++) {
            rbd_real q[1] = {turned ? at - RBD_C(0.03) : at}, v[1] = {speed};
            motor.phase = turned ? RBD_C(1.2) : 0;
            build(wheel, 1, &motor, 1, NULL, 0);
            expect(rbd_actuators_reset(a, q, 25) == RBD_OK, "reset", k);
            for (int n = 0; n < 200; n++) step(&none, other, q, v, RBD_C(1e-2));
            end[turned] = (double)v[0];
        }
        worst = larger(worst, fabs(end[1] - end[0]));
    }
    expect(worst < bound(1e-10, 1e-2), "phase of cogging", worst);
}

/* A limit of half a newton metre cuts each larger torque to it, with its sign. */
static void check_small_limit(void) {
    static const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1, .current = RBD_C(0.5)};
    const rbd_real other[1] = {0};
    build(wheel, 1, &motor, 1, NULL, 0);
    for (int sign = -1; sign <= 1; sign += 2) {
        const rbd_command c = {.torque = RBD_C(0.8) * (rbd_real)sign};
        rbd_real q[1] = {0}, v[1] = {0};
        rbd_actuator_state s;
        step(&c, other, q, v, RBD_C(1e-2));
        rbd_actuators_get(a, 0, &s);
        expect(fabs((double)s.motor - 0.5 * sign) < 1e-6 && s.saturated == sign, "small limit",
               (double)s.motor);
    }
}

/* A model with what this program has not. */
static void check_other_features(void) {
    static const rbd_motor motor = {.joint = "axle", .gear = 1, .constant = 1};
    rbd_actuators *none = a;
    rbd_report report;
    char text[100];
    build(wheel, 1, &motor, 1, NULL, 0);
    rbd_model other = *m;
    other.features |= UINT32_C(1) << 31;
    expect(rbd_actuators_init(&other, &motor, 1, NULL, 0, memory, sizeof memory, &none, &report) ==
               RBD_ERR_WORK,
           "a model with other features", report.error.status);
    expect(!none && report.error.status == RBD_ERR_WORK && report.error.body == -1, "refused", 0);
    rbd_actuators_finding_text(&report.error, 1, text, sizeof text);
    expect(strstr(text, rbd_status_string(RBD_ERR_WORK)) != NULL, text, 0);
}

int main(void) {
    const double stiffness[3] = {100, 1e4, 1e6}, dt[3] = {5e-4, 1e-3, 1e-2};
    check_exponentials();
    check_servos();
    check_inverse();
    check_limits();
    check_heat();
    check_holding();
    for (int i = 0; i < 18; i++) check_energy(stiffness[i / 6], i % 2 ? 0.01 : 0, dt[i / 2 % 3]);
    check_rods(1);
    check_rods(-1);
    check_guess_anew();
    check_speeds_in_bounds();
    check_stiffening(0);
    check_stiffening(1);
    check_search_cut_short();
    check_lines_that_meet();
    check_phase();
    check_small_limit();
    check_light_rotors();
    check_stiff_coupled();
    check_stopping();
    check_other_features();
    printf("%s\n", failures ? "FAILED" : "rbd_actuator.h: ok");
    return failures > 0;
}
