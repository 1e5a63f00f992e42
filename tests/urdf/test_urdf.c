/* test_urdf.c - rbd_urdf.h: what it makes of good, odd and broken URDF files.
   usage: test_urdf, with the folder of the project in the environment as RBD_ROOT. */
#define _POSIX_C_SOURCE 200809L
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "rbd_urdf.h"

#include "models/atlas.h"
#include "models/cart_pole.h"
#include "models/double_pendulum.h"
#include "models/hyq.h"
#include "models/iiwa.h"
#include "models/pendulum.h"

#include "../larger.h"
#include "comma_locale.h"

/* Of the files of thousands of links: with 10, as under the sanitizers every day, a tenth of them. */
#ifndef PART_OF_LINKS
#define PART_OF_LINKS 1
#endif

enum { MAX_NB = 60, MAX_FRAMES = 60, MAX_NAMES = 10000, MAX_WARNINGS = 40, MAX_NV = 64 };

/* ---- robots ---- */

/* Arrays for a robot that is loaded. */
typedef struct room {
    rbd_body bodies[MAX_NB];
    rbd_urdf_frame frames[MAX_FRAMES];
    rbd_urdf_finding warnings[MAX_WARNINGS];
    char names[MAX_NAMES];
} room;

static rbd_urdf with_room(room *x) {
    rbd_urdf robot;
    memset(&robot, 0, sizeof robot);
    robot.bodies = x->bodies, robot.bodies_max = MAX_NB;
    robot.names = x->names, robot.names_max = MAX_NAMES;
    robot.frames = x->frames, robot.frames_max = MAX_FRAMES;
    robot.warnings = x->warnings, robot.warnings_max = MAX_WARNINGS;
    return robot;
}

static rbd_urdf_status parse(rbd_urdf *robot, const char *text, const rbd_urdf_options *options) {
    return rbd_urdf_parse(text, strlen(text), options, robot);
}

/* Parses what must be good. */
static rbd_urdf parsed(room *x, const char *text, const rbd_urdf_options *options) {
    rbd_urdf robot = with_room(x);
    ck_assert_msg(parse(&robot, text, options) == RBD_URDF_OK, "%s", robot.error.text);
    return robot;
}

static const char *path_of(const char *folder, const char *name, const char *suffix) {
    static char path[1000];
    snprintf(path, sizeof path, "%s/%s/%s%s", getenv("RBD_ROOT"), folder, name, suffix);
    return path;
}

/* ---- texts ---- */

#define LINK(name) "<link name='" name "'/>"
#define UNIT_LINK(name) \
    "<link name='" name "'><inertial><mass value='1'/>" \
    "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
#define BARE_JOINT(name, type, parent, child, inside) \
    "<joint name='" name "' type='" type "'><parent link='" parent "'/><child link='" child "'/>" inside \
    "</joint>"
#define JOINT(name, type, parent, child, inside) \
    BARE_JOINT(name, type, parent, child, "<axis xyz='1 0 0'/>" inside)
#define LIMIT "<limit lower='-1' upper='2' velocity='3' effort='4'/>"
#define ROBOT(inside) "<robot name='r'>" inside "</robot>"

/* ---- results of a model ---- */

typedef struct results {
    int nq, nv;
    double tau[MAX_NV], M[MAX_NV * MAX_NV], a[MAX_NV], energy[2], com[3];
} results;

/* All that two descriptions of one robot must agree on, in one random state. */
static results compute(const rbd_body *bodies, int nb, uint64_t seed) {
    static results out;
    double q[MAX_NV + 8], v[MAX_NV], a[MAX_NV];
    const rbd_model *m;
    rbd_work *w;
    size_t size = rbd_model_size(bodies, nb);
    void *memory = malloc(size), *work;
    memset(&out, 0, sizeof out);
    ck_assert_int_eq(rbd_model_build(bodies, nb, memory, size, &m, NULL), RBD_OK);
    out.nq = rbd_nq(m), out.nv = rbd_nv(m);
    ck_assert_int_le(out.nv, MAX_NV);
    work = malloc(rbd_work_size(m));
    ck_assert_int_eq(rbd_work_init(m, work, rbd_work_size(m), &w), RBD_OK);
    rbd_random(m, &seed, q);
    for (int i = 0; i < out.nv; i++) {
        v[i] = cos(i + (double)seed);
        a[i] = 3 * sin(2 * i + (double)seed);
    }
    ck_assert_int_eq(rbd_rnea(m, w, q, v, a, NULL, out.tau), RBD_OK);
    ck_assert_int_eq(rbd_crba(m, w, q, out.M), RBD_OK);
    ck_assert_int_eq(rbd_aba(m, w, q, v, out.tau, NULL, out.a), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(m, w, q, v, a), RBD_OK);
    rbd_energy(m, w, &out.energy[0], &out.energy[1]);
    rbd_com(m, w, out.com, NULL, NULL);
    free(memory);
    free(work);
    return out;
}

static void expect_close(const char *what, const double *x, const double *y, int n, double bound) {
    double scale = 1e-3;
    for (int i = 0; i < n; i++) scale = larger(scale, fabs(y[i]));
    for (int i = 0; i < n; i++)
        ck_assert_msg(fabs(x[i] - y[i]) <= bound * scale, "%s[%d]: %.17g, not %.17g", what, i, x[i], y[i]);
}

static void expect_same_results(const rbd_body *x, int nx, const rbd_body *y, int ny) {
    for (uint64_t seed = 1; seed <= 5; seed++) {
        const results a = compute(x, nx, seed), b = compute(y, ny, seed);
        ck_assert_int_eq(a.nv, b.nv);
        expect_close("tau", a.tau, b.tau, a.nv, 1e-13);
        expect_close("M", a.M, b.M, a.nv * a.nv, 1e-13);
        expect_close("a", a.a, b.a, a.nv, 1e-11);
        expect_close("energy", a.energy, b.energy, 2, 1e-13);
        expect_close("com", a.com, b.com, 3, 1e-13);
    }
}

/* ---- the robots of models/ ---- */

static const struct {
    const char *name;
    const rbd_body *bodies;
    int nb;
    rbd_joint_type root;
} tables[] = {
    {"iiwa", iiwa_bodies, IIWA_NB, RBD_FIXED},
    {"hyq", hyq_bodies, HYQ_NB, RBD_FLOATING},
    {"atlas", atlas_bodies, ATLAS_NB, RBD_FLOATING},
    {"pendulum", pendulum_bodies, PENDULUM_NB, RBD_FIXED},
    {"double_pendulum", double_pendulum_bodies, DOUBLE_PENDULUM_NB, RBD_FIXED},
    {"cart_pole", cart_pole_bodies, CART_POLE_NB, RBD_FIXED},
};
enum { TABLES = sizeof tables / sizeof tables[0] };

START_TEST(urdf_files_give_the_bits_of_the_tables) {
    static room x;
    rbd_urdf_options options = {.root = tables[_i].root};
    rbd_urdf robot = with_room(&x);
    rbd_urdf_load(path_of("models", tables[_i].name, ".urdf"), &options, &robot);
    ck_assert_msg(robot.error.status == RBD_URDF_OK, "%s", robot.error.text);
    ck_assert_str_eq(robot.name, tables[_i].name);
    ck_assert_int_eq(robot.nwarnings, 0);
    ck_assert_int_eq(robot.nb, tables[_i].nb);
    for (int i = 0; i < robot.nb; i++) {
        ck_assert_str_eq(robot.bodies[i].name, tables[_i].bodies[i].name);
        ck_assert_str_eq(robot.bodies[i].joint, tables[_i].bodies[i].joint);
        ck_assert_int_eq(robot.bodies[i].parent, tables[_i].bodies[i].parent);
        ck_assert_int_eq(robot.bodies[i].type, tables[_i].bodies[i].type);
        ck_assert_double_eq(robot.bodies[i].lower, tables[_i].bodies[i].lower);
        ck_assert_double_eq(robot.bodies[i].upper, tables[_i].bodies[i].upper);
        ck_assert_double_eq(robot.bodies[i].velocity, tables[_i].bodies[i].velocity);
        ck_assert_double_eq(robot.bodies[i].effort, tables[_i].bodies[i].effort);
    }
    for (uint64_t seed = 1; seed <= 20; seed++) {
        const results a = compute(robot.bodies, robot.nb, seed),
                      b = compute(tables[_i].bodies, robot.nb, seed);
        ck_assert_int_eq(memcmp(&a, &b, sizeof a), 0);
    }
}
END_TEST

/* ---- broken files ---- */

static int count_files(const char *folder) {
    char command[1100];
    int n = 0;
    FILE *list;
    snprintf(command, sizeof command, "ls %s | grep -c '[.]urdf$'", path_of(folder, "", ""));
    list = popen(command, "r");
    ck_assert(list && fscanf(list, "%d", &n) == 1);
    pclose(list);
    return n;
}

/* broken/expected.txt has a row for each file: name|line|text of the error. */
START_TEST(broken_files_give_the_sentence_expected) {
    char row[600], path[1000];
    int rows = 0;
    FILE *expected;
    snprintf(path, sizeof path, "%s", path_of("tests/urdf/broken", "expected.txt", ""));
    expected = fopen(path, "r");
    ck_assert(expected != NULL);
    for (; fgets(row, sizeof row, expected); rows++) {
        static room x;
        rbd_urdf robot = with_room(&x);
        const char *file = strtok(row, "|"), *line = strtok(NULL, "|"), *text = strtok(NULL, "\n");
        ck_assert_int_lt(rbd_urdf_load(path_of("tests/urdf/broken", file, ""), NULL, &robot), 0);
        ck_assert_msg(strcmp(robot.error.text, text) == 0, "%s: %s", file, robot.error.text);
        ck_assert_msg(robot.error.line == atoi(line), "%s: line %d", file, robot.error.line);
        ck_assert_str_ne(rbd_urdf_status_string(robot.error.status), "unknown status");
        ck_assert_int_eq(robot.nb, 0);
    }
    fclose(expected);
    ck_assert_int_eq(rows, count_files("tests/urdf/broken"));
}
END_TEST

static const struct {
    const char *text;
    rbd_urdf_status status;
} kinds[] = {
    {"", RBD_URDF_ERR_XML},
    {"<sdf/>", RBD_URDF_ERR_ROBOT},
    {ROBOT("<link/>"), RBD_URDF_ERR_NAME},
    {ROBOT(LINK("a") LINK("b")), RBD_URDF_ERR_TREE},
    {ROBOT(LINK("a") LINK("b") JOINT("j", "knee", "a", "b", "")), RBD_URDF_ERR_JOINT},
    {ROBOT("<link name='a'><inertial/></link>"), RBD_URDF_ERR_INERTIAL},
    {ROBOT(LINK("a") UNIT_LINK("b") BARE_JOINT("j", "continuous", "a", "b", "<axis xyz='0 0 0'/>")),
     RBD_URDF_ERR_AXIS},
    {ROBOT(LINK("a") UNIT_LINK("b") BARE_JOINT("j", "continuous", "a", "b", "<axis xyz='0 0 x'/>")),
     RBD_URDF_ERR_NUMBER},
    {ROBOT(LINK("a") UNIT_LINK("b") JOINT("j", "continuous", "a", "b", "<mimic joint='k'/>")),
     RBD_URDF_ERR_MIMIC},
    {ROBOT(LINK("a") LINK("b") JOINT("j", "continuous", "a", "b", "")), RBD_URDF_ERR_MODEL},
};

START_TEST(errors_have_their_status) {
    static room x;
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, kinds[_i].text, NULL), kinds[_i].status);
    ck_assert_int_eq(robot.error.status, kinds[_i].status);
}
END_TEST

START_TEST(arguments_are_checked) {
    static room x;
    static const char good[] = ROBOT(LINK("a") UNIT_LINK("b") JOINT("root", "continuous", "a", "b", ""));
    const char *const keep[] = {"b", "c", NULL};
    const double gravity[3] = {0, 0, NAN};
    rbd_urdf_options options = {.keep = keep};
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(rbd_urdf_load("r.urdf", NULL, NULL), RBD_URDF_ERR_NULL);
    ck_assert_int_eq(rbd_urdf_load(NULL, NULL, &robot), RBD_URDF_ERR_NULL);
    ck_assert_int_eq(rbd_urdf_parse(NULL, 3, NULL, &robot), RBD_URDF_ERR_NULL);
    ck_assert_int_eq(rbd_urdf_load("/no/such.urdf", NULL, &robot), RBD_URDF_ERR_FILE);
    ck_assert_str_eq(robot.error.text, "the file '/no/such.urdf' cannot be read: No such file or directory");
    ck_assert_int_eq(rbd_urdf_load("/", NULL, &robot), RBD_URDF_ERR_FILE);
    ck_assert_str_eq(robot.error.text, "the file '/' cannot be read: Is a directory");
    ck_assert_int_eq(rbd_urdf_load("/dev/null", NULL, &robot), RBD_URDF_ERR_XML);
    ck_assert_str_eq(robot.error.text, "it is empty");
    ck_assert_int_eq(parse(&robot, good, &options), RBD_URDF_ERR_OPTION);
    ck_assert_str_eq(robot.error.text, "there is no link 'c' to keep");
    const char *const misspelt[] = {"B", NULL};
    options.keep = misspelt;
    ck_assert_int_eq(parse(&robot, good, &options), RBD_URDF_ERR_OPTION);
    ck_assert_str_eq(robot.error.text, "there is no link 'B' to keep; did you mean 'b'?");
    options = (rbd_urdf_options){.gravity = gravity};
    ck_assert_int_eq(parse(&robot, good, &options), RBD_URDF_ERR_OPTION);
    options = (rbd_urdf_options){.root = RBD_SPHERICAL};
    ck_assert_int_eq(parse(&robot, good, &options), RBD_URDF_ERR_OPTION);
    options = (rbd_urdf_options){.root = RBD_FLOATING};
    ck_assert_int_eq(parse(&robot, good, &options), RBD_URDF_ERR_NAME);
    options.root_joint = "free";
    ck_assert_int_eq(parse(&robot, good, &options), RBD_URDF_OK);
    ck_assert_str_eq(robot.bodies[0].joint, "free");
}
END_TEST

/* A text of n times the unit, in memory of its own. */
static char *repeated(const char *head, const char *unit, int n, const char *tail) {
    const size_t length = strlen(unit);
    char *text = malloc(strlen(head) + length * (size_t)n + strlen(tail) + 1), *p = text;
    p += sprintf(p, "%s", head);
    for (int i = 0; i < n; i++, p += length) memcpy(p, unit, length);
    strcpy(p, tail);
    return text;
}

START_TEST(deep_nesting_is_an_error_and_no_crash) {
    static room x;
    static const char *const openings[] = {"<a>", "<a b='/>'>", "<a><!-- </a> -->", "<a><![CDATA[</a>]]>"};
    rbd_urdf robot = with_room(&x);
    char *text = repeated("<robot name='r'>", openings[_i], 100000, "");
    ck_assert_int_eq(parse(&robot, text, NULL), RBD_URDF_ERR_XML);
    ck_assert_str_eq(robot.error.text, "elements are nested more than 100 deep");
    free(text);
}
END_TEST

/* Links fixed one to another, 100,000 of them: neither the parser nor its end may recurse along them. */
START_TEST(long_chains_are_no_crash) {
    enum { LINKS = 100000 / PART_OF_LINKS };
    char *text = malloc((size_t)LINKS * 150 + 500), *p = text;
    rbd_urdf robot;
    memset(&robot, 0, sizeof robot);
    p += sprintf(p, "<robot name='r'>" LINK("base"));
    for (int i = 0; i < LINKS; i++) p += sprintf(p, "<link name='%d'/>", i);
    for (int i = 1; i < LINKS; i++) p += sprintf(p, JOINT("%d", "fixed", "%d", "%d", ""), i, i - 1, i);
    sprintf(p,
            UNIT_LINK("end") JOINT("a", "continuous", "base", "0", "")
                JOINT("b", "fixed", "%d", "end", "") "</robot>",
            LINKS - 1);
    ck_assert_msg(parse(&robot, text, NULL) == RBD_URDF_OK, "%s", robot.error.text);
    ck_assert_int_eq(robot.nb, 1);
    ck_assert_int_eq(robot.nframes, LINKS + 2);
    free(text);
}
END_TEST

START_TEST(too_many_bodies_are_an_error) {
    char *text = malloc(1001 * 400 + 100), *p = text;
    rbd_urdf robot;
    memset(&robot, 0, sizeof robot);
    p += sprintf(p, "<robot name='r'>" LINK("base"));
    for (int i = 0; i < 1001; i++)
        p += sprintf(p, UNIT_LINK("%d") JOINT("%d", "continuous", "base", "%d", ""), i, i, i);
    sprintf(p, "</robot>");
    ck_assert_int_eq(parse(&robot, text, NULL), RBD_URDF_ERR_MODEL);
    ck_assert_str_eq(robot.error.text, "the model: 1001 moving joints are more than RBD_MAX_BODIES, 1000");
    free(text);
}
END_TEST

/* A star of n joints, each of which mimics the next; the last mimics the named one, or none. */
static char *chain_of_mimics(int n, const char *last) {
    char *text = malloc((size_t)n * 400 + 300), *p = text;
    p += sprintf(p, "<robot name='r'>" LINK("base"));
    for (int i = 0; i < n; i++) p += sprintf(p, UNIT_LINK("%d"), i);
    for (int i = 0; i + 1 < n; i++)
        p += sprintf(p, JOINT("%d", "continuous", "base", "%d", "<mimic joint='%d'/>"), i, i, i + 1);
    p += sprintf(p, "<joint name='%d' type='continuous'><parent link='base'/><child link='%d'/>", n - 1,
                 n - 1);
    if (last) p += sprintf(p, "<mimic joint='%s'/>", last);
    sprintf(p, "</joint></robot>");
    return text;
}

START_TEST(chains_of_mimic_joints_end_at_the_one_that_leads) {
    static rbd_body bodies[RBD_MAX_BODIES];
    static char names[100000];
    rbd_urdf robot;
    char *good = chain_of_mimics(RBD_MAX_BODIES, NULL), *circle = chain_of_mimics(RBD_MAX_BODIES, "7");
    memset(&robot, 0, sizeof robot);
    robot.bodies = bodies, robot.bodies_max = RBD_MAX_BODIES;
    robot.names = names, robot.names_max = sizeof names;
    ck_assert_msg(parse(&robot, good, NULL) == RBD_URDF_OK, "%s", robot.error.text);
    ck_assert_int_eq(robot.nb, RBD_MAX_BODIES);
    for (int i = 0; i < RBD_MAX_BODIES - 1; i++) ck_assert_str_eq(robot.bodies[i].mimic, "999");
    ck_assert_ptr_null(robot.bodies[RBD_MAX_BODIES - 1].mimic);
    ck_assert_int_eq(parse(&robot, circle, NULL), RBD_URDF_ERR_MIMIC);
    ck_assert_str_eq(robot.error.text,
                     "joint '0': it mimics joints that mimic each other in a circle; to hold it "
                     "still: options.lock, rbd-model --lock '0'; to let all such joints move freely: "
                     "options.free_mimics, rbd-model --free-mimics");

    const rbd_urdf_options free_mimics = {.free_mimics = 1}; /* one of the circle leads the others */
    ck_assert_msg(parse(&robot, circle, &free_mimics) == RBD_URDF_OK, "%s", robot.error.text);
    ck_assert_int_eq(robot.nwarnings, 2); /* and the last has no axis */
    int leaders = 0;
    for (int i = 0; i < RBD_MAX_BODIES; i++) leaders += robot.bodies[i].mimic == NULL;
    ck_assert_int_eq(leaders, 1);
    free(good);
    free(circle);
}
END_TEST

/* Refused before the chains are followed, and before urdfdom, whose time grows faster than the file. */
START_TEST(too_many_mimic_joints_are_an_error) {
    rbd_urdf robot;
    enum { JOINTS = 40000 / PART_OF_LINKS };
    char *text = chain_of_mimics(JOINTS, NULL), expected[100];
    memset(&robot, 0, sizeof robot);
    ck_assert_int_eq(parse(&robot, text, NULL), RBD_URDF_ERR_MODEL);
    snprintf(expected, sizeof expected, "the model: %d moving joints are more than RBD_MAX_BODIES, 1000",
             JOINTS);
    ck_assert_str_eq(robot.error.text, expected);
    free(text);
}
END_TEST

/* ---- counting and room ---- */

START_TEST(the_first_call_counts) {
    static room x;
    rbd_urdf count, full = with_room(&x);
    memset(&count, 0, sizeof count);
    const char *path = path_of("models", "atlas", ".urdf");
    ck_assert_int_eq(rbd_urdf_load(path, NULL, &count), RBD_URDF_OK);
    ck_assert_int_eq(rbd_urdf_load(path, NULL, &full), RBD_URDF_OK);
    ck_assert_int_eq(count.nb, 30);
    ck_assert_int_eq(count.nb, full.nb);
    ck_assert_int_eq(count.nframes, 31);
    ck_assert_uint_eq(count.names_size, full.names_size);
    ck_assert_ptr_null(count.name);

    full.names_max = count.names_size; /* exactly enough is enough */
    full.bodies_max = count.nb;
    full.frames_max = count.nframes;
    ck_assert_int_eq(rbd_urdf_load(path, NULL, &full), RBD_URDF_OK);
    full.bodies_max--;
    ck_assert_int_eq(rbd_urdf_load(path, NULL, &full), RBD_URDF_ERR_ROOM);
    ck_assert_str_eq(full.error.text, "room for 30 bodies is needed");
    full.bodies_max++, full.names_max--;
    ck_assert_int_eq(rbd_urdf_load(path, NULL, &full), RBD_URDF_ERR_ROOM);
    full.names_max++, full.frames_max--;
    ck_assert_int_eq(rbd_urdf_load(path, NULL, &full), RBD_URDF_ERR_ROOM);
    ck_assert_str_eq(full.error.text, "room for 31 frames is needed");
}
END_TEST

/* The arrays hold what an earlier call wrote, the counts what this one did not write. */
START_TEST(nothing_is_found_in_what_was_not_filled) {
    static room x;
    static const char text[] = ROBOT(LINK("a") UNIT_LINK("b") JOINT("j", "continuous", "a", "b", ""));
    rbd_urdf robot = parsed(&x, text, NULL);
    ck_assert_int_eq(rbd_urdf_joint_index(&robot, "j"), 0);
    ck_assert_int_eq(rbd_urdf_link_index(&robot, "b"), 1);
    ck_assert_int_eq(rbd_urdf_link_index(&robot, NULL), -1);
    ck_assert_int_eq(rbd_urdf_joint_index(NULL, "j"), -1);
    robot.bodies_max = 0;
    ck_assert_int_eq(parse(&robot, text, NULL), RBD_URDF_ERR_ROOM);
    ck_assert_int_eq(robot.nb, 1);
    ck_assert_int_eq(rbd_urdf_joint_index(&robot, "j"), -1);
    ck_assert_int_eq(rbd_urdf_link_index(&robot, "b"), -1);
    robot.bodies = NULL, robot.names = NULL; /* to count */
    ck_assert_int_eq(parse(&robot, text, NULL), RBD_URDF_OK);
    ck_assert_int_eq(rbd_urdf_joint_index(&robot, "j"), -1);
    ck_assert_int_eq(rbd_urdf_link_index(&robot, "b"), -1);
}
END_TEST

static void expect_cleared(const rbd_urdf *robot) {
    ck_assert_ptr_null(robot->name);
    ck_assert_int_eq(robot->nb, 0);
    ck_assert_int_eq(robot->nframes, 0);
    ck_assert_int_eq(robot->nwarnings, 0);
    ck_assert_uint_eq(robot->names_size, 0);
    ck_assert(robot->fixed_mass == 0);
}

START_TEST(a_file_that_cannot_be_read_leaves_nothing_of_the_robot_before) {
    static room x;
    static const char text[] = ROBOT(UNIT_LINK("a") UNIT_LINK("b") JOINT("j", "revolute", "a", "b", ""));
    rbd_urdf robot = parsed(&x, text, NULL);
    ck_assert_int_eq(robot.nwarnings, 1);
    ck_assert_int_eq(rbd_urdf_load("/no/such.urdf", NULL, &robot), RBD_URDF_ERR_FILE);
    expect_cleared(&robot);
    robot = parsed(&x, text, NULL);
    ck_assert_int_eq(rbd_urdf_load(NULL, NULL, &robot), RBD_URDF_ERR_NULL);
    expect_cleared(&robot);
    robot = parsed(&x, text, NULL);
    ck_assert_int_eq(rbd_urdf_parse(NULL, 3, NULL, &robot), RBD_URDF_ERR_NULL);
    expect_cleared(&robot);
}
END_TEST

/* ---- what becomes of links and joints ---- */

START_TEST(the_order_is_that_of_the_file_but_parents_go_first) {
    static room x;
    rbd_urdf robot =
        parsed(&x,
               ROBOT(UNIT_LINK("d") UNIT_LINK("c") LINK("a") UNIT_LINK("b") UNIT_LINK("e")
                         JOINT("cd", "continuous", "c", "d", "") JOINT("ae", "continuous", "a", "e", "")
                             JOINT("ab", "continuous", "a", "b", "") JOINT("bc", "continuous", "b", "c", "")),
               NULL);
    const char *const order[] = {"ae", "ab", "bc", "cd"};
    ck_assert_int_eq(robot.nb, 4);
    for (int i = 0; i < 4; i++) {
        ck_assert_str_eq(robot.bodies[i].joint, order[i]);
        ck_assert_int_eq(rbd_urdf_joint_index(&robot, order[i]), i);
    }
    ck_assert_int_eq(rbd_urdf_joint_index(&robot, "ba"), -1);
    ck_assert_int_eq(rbd_urdf_joint_index(&robot, NULL), -1);
    ck_assert_int_eq(robot.bodies[3].parent, 2);
}
END_TEST

START_TEST(joints_keep_type_axis_limits_and_dynamics) {
    static room x;
    rbd_urdf robot =
        parsed(&x,
               ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") UNIT_LINK("d") UNIT_LINK("e") BARE_JOINT(
                   "r", "revolute", "a", "b",
                   "<axis xyz='0 1 0'/>" LIMIT "<dynamics damping='0.5' friction='0.25' armature='2'/>")
                         BARE_JOINT("c", "continuous", "b", "c", LIMIT "<dynamics armature='3'/>")
                             BARE_JOINT("p", "prismatic", "c", "d", "<axis xyz='0 0 -1'/>" LIMIT)
                                 JOINT("f", "floating", "d", "e", "<origin xyz='1 2 3'/>")),
               NULL);
    const rbd_body *b = robot.bodies;
    ck_assert_int_eq(b[0].type, RBD_REVOLUTE);
    ck_assert(b[0].axis[0] == 0 && b[0].axis[1] == 1 && b[0].axis[2] == 0);
    ck_assert(b[0].lower == -1 && b[0].upper == 2 && b[0].velocity == 3 && b[0].effort == 4);
    ck_assert(b[0].damping[0] == 0.5 && b[0].friction[0] == 0.25 && b[0].armature[0] == 2);
    ck_assert_int_eq(b[1].type, RBD_CONTINUOUS);
    ck_assert(b[1].axis[0] == 1 && b[1].axis[1] == 0 && b[1].axis[2] == 0); /* URDF's default */
    ck_assert(b[1].lower == 0 && b[1].upper == 0 && b[1].velocity == 3 && b[1].effort == 4);
    ck_assert(b[1].armature[0] == 3 && b[1].damping[0] == 0);
    ck_assert_int_eq(b[2].type, RBD_PRISMATIC);
    ck_assert(b[2].axis[2] == -1 && b[2].lower == -1 && b[2].upper == 2);
    ck_assert_int_eq(b[3].type, RBD_FLOATING);
    ck_assert(b[3].position[0] == 1 && b[3].position[1] == 2 && b[3].position[2] == 3);
    ck_assert_int_eq(robot.nwarnings, 2);
    ck_assert_str_eq(robot.warnings[0].text, "joint 'c': it has no <axis>; read as 1 0 0");
    ck_assert_str_eq(robot.warnings[1].text,
                     "joint 'c': it is continuous, but has limits, -1 .. 2; read as none");
}
END_TEST

START_TEST(mimic_joints_follow_through_others) {
    static room x;
    rbd_urdf robot = parsed(
        &x,
        ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") UNIT_LINK("d")
                  JOINT("k", "continuous", "a", "b", "<mimic joint='j' multiplier='2' offset='0.5'/>")
                      JOINT("j", "continuous", "b", "c", "<mimic joint='i' multiplier='-3' offset='0.25'/>")
                          JOINT("i", "continuous", "c", "d", "")),
        NULL);
    /* k = 2 j + 0.5 = 2 (-3 i + 0.25) + 0.5 */
    ck_assert_str_eq(robot.bodies[0].mimic, "i");
    ck_assert_double_eq(robot.bodies[0].mimic_ratio, -6);
    ck_assert_double_eq(robot.bodies[0].mimic_offset, 1);
    ck_assert_str_eq(robot.bodies[1].mimic, "i");
    ck_assert_double_eq(robot.bodies[1].mimic_ratio, -3);
    ck_assert_ptr_null(robot.bodies[2].mimic);
}
END_TEST

/* Several levels of fixed links with inertias turned about, on a moving link and on the world. */
#define HEAVY(name, m, xyz, rpy) \
    "<link name='" name "'><inertial><origin xyz='" xyz "' rpy='" rpy "'/><mass value='" m "'/>" \
    "<inertia ixx='0.3' ixy='0.01' ixz='-0.02' iyy='0.25' iyz='0.03' izz='0.2'/></inertial></link>"
static const char fixed_links[] = ROBOT(
    HEAVY("base", "5", "0 0 0", "0 0 0") HEAVY("arm", "2", "0.1 0.2 0.3", "0.4 0.5 0.6") HEAVY(
        "plate", "3", "-0.2 0.1 0", "1 -1 2") LINK("bracket") HEAVY("tool", "0.5", "0 0 0.1", "0 0 0")
        HEAVY("hand", "1", "0 0.1 0", "0 1 0") HEAVY("pedestal", "7", "0 0 0", "0 0 0") BARE_JOINT(
            "b", "fixed", "plate", "bracket", "<origin xyz='0.1 0 0' rpy='0.3 0.2 0.1'/><axis xyz='0 0 0'/>")
            JOINT("t", "fixed", "bracket", "tool", "<origin xyz='0 0.2 0' rpy='1 0 0'/>")
                BARE_JOINT("s", "revolute", "pedestal", "arm", "<axis xyz='0 1 0'/>" LIMIT)
                    JOINT("p", "fixed", "arm", "plate", "<origin xyz='0 0 1' rpy='0 1.5707963267948966 0'/>")
                        JOINT("h", "prismatic", "tool", "hand", "<origin xyz='1 1 1'/>" LIMIT)
                            JOINT("w", "fixed", "base", "pedestal", "<origin xyz='0 0 0.5'/>"));

START_TEST(fixed_links_are_merged_or_kept_with_the_same_dynamics) {
    static room x, y;
    const rbd_urdf_options all = {.keep_all = 1};
    rbd_urdf merged = parsed(&x, fixed_links, NULL), kept = parsed(&y, fixed_links, &all);
    ck_assert_int_eq(merged.nb, 2);
    ck_assert_int_eq(kept.nb, 7);
    ck_assert_int_eq(merged.nframes, 7);
    ck_assert_double_eq(merged.fixed_mass, 12);
    ck_assert_double_eq(kept.fixed_mass, 12);
    ck_assert_double_eq_tol(merged.bodies[0].mass, 5.5, 1e-15);
    expect_same_results(merged.bodies, merged.nb, kept.bodies, kept.nb);
}
END_TEST

START_TEST(a_tool_frame_can_be_asked_for_by_name) {
    static room x, y;
    const char *const keep[] = {"tool", NULL};
    const rbd_urdf_options options = {.keep = keep};
    static unsigned char memory[RBD_MODEL_SIZE(4)], work[RBD_WORK_SIZE(4, 4)];
    const double q[2] = {0.7, 0.3};
    double R[9], p[3], own[9], origin[3];
    const rbd_model *m;
    rbd_work *w;
    rbd_urdf kept = parsed(&x, fixed_links, &options), merged = parsed(&y, fixed_links, NULL);
    const rbd_urdf_frame *f = &merged.frames[rbd_urdf_link_index(&merged, "tool")];
    ck_assert_int_eq(kept.nb, 3);
    ck_assert_int_eq(rbd_urdf_link_index(&merged, "nothing"), -1);
    ck_assert_int_eq(rbd_model_build(kept.bodies, kept.nb, memory, sizeof memory, &m, NULL), RBD_OK);
    ck_assert_int_eq(rbd_work_init(m, work, sizeof work, &w), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(m, w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(m, w, rbd_body_index(m, "tool"), R, p), RBD_OK);
    /* the same from the frame of the merged description, on body 0, the arm */
    ck_assert_int_eq(f->body, 0);
    ck_assert_str_eq(f->joint, "t");
    ck_assert_str_eq(merged.frames[f->parent].link, "bracket");
    ck_assert_int_eq(rbd_body_pose(m, w, rbd_body_index(m, "arm"), own, origin), RBD_OK);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            ck_assert_double_eq_tol(R[3 * i + j],
                                    own[3 * i] * f->rotation[j] + own[3 * i + 1] * f->rotation[3 + j] +
                                        own[3 * i + 2] * f->rotation[6 + j],
                                    1e-15);
        ck_assert_double_eq_tol(p[i],
                                origin[i] + own[3 * i] * f->position[0] + own[3 * i + 1] * f->position[1] +
                                    own[3 * i + 2] * f->position[2],
                                1e-15);
    }
}
END_TEST

/* Where a planar joint about an axis puts its link, at q = (1, 2, pi/2). */
static void planar_pose(const char *axis, double R[9], double p[3]) {
    static room x;
    static unsigned char memory[RBD_MODEL_SIZE(2)], work[RBD_WORK_SIZE(2, 3)];
    const double q[3] = {1, 2, 2 * atan(1)};
    char text[800];
    const rbd_model *m;
    rbd_work *w;
    snprintf(text, sizeof text,
             ROBOT(LINK("a") UNIT_LINK("b") BARE_JOINT("j", "planar", "a", "b", "<axis xyz='%s'/>")), axis);
    rbd_urdf robot = parsed(&x, text, NULL);
    ck_assert_int_eq(rbd_model_build(robot.bodies, robot.nb, memory, sizeof memory, &m, NULL), RBD_OK);
    ck_assert_int_eq(rbd_nq(m), 3);
    ck_assert_int_eq(rbd_work_init(m, work, sizeof work, &w), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(m, w, q, NULL, NULL), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(m, w, rbd_body_index(m, "b"), R, p), RBD_OK);
}

START_TEST(a_planar_joint_moves_across_its_axis) {
    static const struct {
        const char *axis;
        double R[9], p[3];
    } cases[] = {
        {"0 0 1", {0, -1, 0, 1, 0, 0, 0, 0, 1}, {1, 2, 0}},
        {"1 0 0", {1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 1, 2}},
        {"0 1 0", {0, 0, 1, 0, 1, 0, -1, 0, 0}, {2, 0, 1}},
        {"0 0 -1", {0, 1, 0, -1, 0, 0, 0, 0, 1}, {1, -2, 0}},
        /* axis (0.6, 0, 0.8): the largest component is z, so the first coordinate lies along x, made square
           to the axis: (0.8, 0, -0.6); the second is y */
        {"0.6 0 0.8", {0.36, -0.8, 0.48, 0.8, 0, -0.6, 0.48, 0.6, 0.64}, {0.8, 2, -0.6}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double R[9], p[3];
        planar_pose(cases[k].axis, R, p);
        expect_close(cases[k].axis, R, cases[k].R, 9, 1e-15);
        expect_close(cases[k].axis, p, cases[k].p, 3, 1e-15);
    }
}
END_TEST

START_TEST(inertias_are_turned_by_their_origin) {
    static room x;
    rbd_urdf robot = parsed(
        &x,
        ROBOT(LINK("a") "<link name='b'><inertial><origin rpy='0 0 1.5707963267948966'/>"
                        "<mass value='1'/><inertia ixx='1' ixy='0.1' ixz='0.2' iyy='2' "
                        "iyz='0.3' izz='2.5'/></inertial></link>" JOINT("j", "continuous", "a", "b", "")),
        NULL);
    /* a quarter turn about z: x becomes y, y becomes -x */
    const double turned[6] = {2, -0.1, -0.3, 1, 0.2, 2.5};
    for (int i = 0; i < 6; i++) ck_assert_double_eq_tol(robot.bodies[0].inertia[i], turned[i], 1e-15);
}
END_TEST

START_TEST(a_floating_root_link_is_body_zero) {
    static room x;
    const double moon[3] = {0, 0, -1.62};
    rbd_urdf_options options = {.root = RBD_FLOATING, .gravity = moon};
    rbd_urdf robot = parsed(&x, fixed_links, &options);
    ck_assert_int_eq(robot.bodies[0].type, RBD_FLOATING);
    ck_assert_str_eq(robot.bodies[0].name, "base");
    ck_assert_str_eq(robot.bodies[0].joint, "root");
    ck_assert_double_eq(robot.bodies[0].mass, 12);
    ck_assert_double_eq(robot.fixed_mass, 0);
    ck_assert_double_eq(robot.gravity[2], -1.62);
    ck_assert_int_eq(robot.frames[0].body, 0);
    ck_assert_int_eq(parse(&robot,
                           ROBOT(LINK("world") UNIT_LINK("b") JOINT("j", "continuous", "world", "b", "")),
                           &options),
                     RBD_URDF_OK);
    ck_assert_int_eq(robot.nwarnings, 1);
    ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_ROOT);
    ck_assert_str_eq(robot.warnings[0].text, "link 'world': the floating root link has no mass");
    ck_assert_int_eq(parse(&robot,
                           ROBOT(LINK("world") UNIT_LINK("b") JOINT("free", "floating", "world", "b", "")),
                           &options),
                     RBD_URDF_OK);
    ck_assert_int_eq(robot.nwarnings, 1);
    ck_assert_str_eq(robot.warnings[0].text,
                     "link 'world': the floating root link has no mass; joint 'free' floats already: leave "
                     "out options.root, rbd-model --floating");
}
END_TEST

START_TEST(geometry_and_extensions_are_left_unread) {
    static room x;
    rbd_urdf robot =
        parsed(&x,
               "\xef\xbb\xbf<?xml version='1.0' encoding='UTF-8'?>\n<!DOCTYPE robot>\n"
               "<robot name='r &amp; &#x41;&#228;' xmlns:xacro='x' version='2.0'><material/>"
               "<gazebo reference='b'><mu1>0.2</mu1></gazebo>" LINK(
                   "a\\&quot;") "<link name='b'>"
                                "<visual><geometry><mesh/></geometry></visual><inertial><mass value=' 1\t'/>"
                                "<inertia ixx='1.' ixy='0' ixz='0' iyy='+1e0' iyz='0' izz='1'/></inertial>"
                                "<collision><origin xyz='?'/></collision></link>\n" JOINT(
                                    "j", "continuous", "a\\&quot;", "b",
                                    "<origin xyz='1\n2  3 '/><safety_controller/>") "</robot>\n",
               NULL);
    ck_assert_str_eq(robot.name, "r & A\xc3\xa4");
    ck_assert_str_eq(robot.frames[0].link, "a\\\"");
    ck_assert(robot.bodies[0].position[0] == 1 && robot.bodies[0].position[1] == 2 &&
              robot.bodies[0].position[2] == 3);
    ck_assert_double_eq(robot.bodies[0].mass, 1);
}
END_TEST

/* Elements and attributes that others read, that have a prefix, or say 0: none gives a warning. */
START_TEST(what_is_known_to_say_nothing_of_dynamics_gives_no_warning) {
    static room x;
    rbd_urdf robot = parsed(
        &x,
        "<robot name='r' version='1.0' xmlns='x' xmlns:drake='y'>"
        "<material name='m'/><gazebo><plugin/></gazebo><transmission/><sensor/><ros2_control/><mujoco/>"
        "<frame/><drake:proximity_properties/>"
        "<link name='a' type='camera' drake:x='1'><visual><orgin/></visual><collision/><contact/><sensor/>"
        "<self_collision_checking/><origin xyz='0 0 0' rpy='0.0 -0 0'/><drake:inertial/></link>" UNIT_LINK(
            "b") JOINT("j", "revolute", "a", "b",
                       "<limit lower='-1' upper='2' velocity='3' effort='4' drake:acceleration='5' jerk='6'/>"
                       "<safety_controller k_velocity='1'/><calibration rising='1'/><anchor xyz='0 0 0'/>"
                       "<joint_properties damping='0.0' friction='0'/>") "</robot>",
        NULL);
    ck_assert_int_eq(robot.nwarnings, 0);
}
END_TEST

/* The same slip in many places is told once, another hint or another name apart. */
START_TEST(slips_are_told_once_each_with_their_first_line) {
    static room x;
    rbd_urdf robot = parsed(
        &x,
        "<robot name='r'>" LINK("a") UNIT_LINK("b") UNIT_LINK("c")
            UNIT_LINK("d") "\n" JOINT("j", "continuous", "a", "b", "<dynamcs damping='1'/>") "\n" JOINT(
                "k", "continuous", "b", "c",
                "<dynamcs damping='2'/><orgin xyz='0 0 1'/>") "\n" JOINT("l", "continuous", "c", "d",
                                                                         "<dynamcs/><Origin xyz='0 0 "
                                                                         "1'/>") "</robot>",
        NULL);
    static const struct {
        int line;
        const char *text;
    } expected[] = {{2, "joint 'j': <dynamcs> is not read (3 times in the file); did you mean <dynamics>?"},
                    {3, "joint 'k': <orgin> is not read; did you mean <origin>?"},
                    {4, "joint 'l': <Origin> is not read; did you mean <origin>?"}};
    ck_assert_int_eq(robot.nwarnings, 3);
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(robot.warnings[i].status, RBD_URDF_WARN_UNREAD);
        ck_assert_int_eq(robot.warnings[i].line, expected[i].line);
        ck_assert_str_eq(robot.warnings[i].text, expected[i].text);
    }
}
END_TEST

/* A whole robot, and each of its names. */
static const char all_names[] =
    "<robot name='r'><link name='a'/><link name='b'><inertial><origin xyz='0 0 1' rpy='1 0 0'/><mass "
    "value='1'/>"
    "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>" UNIT_LINK("c") UNIT_LINK(
        "d") "<joint name='j' type='revolute'><parent link='a'/><child link='c'/><axis xyz='0 0 1'/>" LIMIT
             "</joint>"
             "<joint name='k' type='revolute'><parent link='a'/><child link='d'/><axis xyz='0 0 1'/>" LIMIT
             "</joint>"
             "<joint type='revolute' name='l'><origin xyz='0 1 0' rpy='0 1 0'/><parent link='a'/><child "
             "link='b'/>"
             "<axis xyz='0 1 0'/><limit lower='-1' upper='2' velocity='3' effort='4'/>"
             "<dynamics damping='1' friction='2' armature='3'/><mimic joint='j' multiplier='2' "
             "offset='1'/></joint>"
             "</robot>";
static const char *const names_read[] = {
    " name=",   " type=",       "<origin ",   "<mass ",   "<inertia ", " xyz=",      " rpy=",
    " value=",  " ixx=",        " ixy=",      " ixz=",    " iyy=",     " iyz=",      " izz=",
    "<parent ", "<child ",      " link=",     "<axis ",   "<limit ",   "<dynamics ", "<mimic ",
    " lower=",  " upper=",      " velocity=", " effort=", " damping=", " friction=", " armature=",
    " joint=",  " multiplier=", " offset=",
};

/* Misspelt by a letter more, anywhere in the file, each name is told by a hint at the right one, whatever
   error follows. */
START_TEST(no_slip_is_dropped) {
    static room x;
    const char *name = names_read[_i];
    const int length = (int)strlen(name);
    int places = 0;
    for (const char *at = all_names; (at = strstr(at, name)) != NULL; at++, places++) {
        char text[2000], hint[60];
        rbd_urdf robot = with_room(&x);
        const int end = (int)(at - all_names) + length - 1; /* of the name */
        snprintf(text, sizeof text, "%.*ss%s", end, all_names, all_names + end);
        snprintf(hint, sizeof hint, *name == '<' ? "; did you mean <%.*s>?" : "; did you mean '%.*s'?",
                 length - 2, name + 1);
        parse(&robot, text, NULL);
        ck_assert_msg(robot.nwarnings >= 1, "%s", text);
        ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_UNREAD);
        ck_assert_msg(strstr(robot.warnings[0].text, hint) != NULL, "%s: %s", name, robot.warnings[0].text);
    }
    ck_assert_int_gt(places, 0);
}
END_TEST

/* Said before the error that follows, and instead of it if warnings are errors. */
START_TEST(a_misspelt_link_is_told_before_it_is_missing) {
    static room x;
    static const char text[] =
        ROBOT(LINK("a") "<lnk name='b'/><jont name='k'/>" JOINT("j", "continuous", "a", "b", ""));
    static const char told[] = "<lnk> is not read; did you mean <link>?";
    const rbd_urdf_options strict = {.strict = 1};
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, text, NULL), RBD_URDF_ERR_JOINT);
    ck_assert_str_eq(robot.error.text, "joint 'j': its child link 'b' is missing");
    ck_assert_int_eq(robot.nwarnings, 2);
    ck_assert_str_eq(robot.warnings[0].text, told);
    ck_assert_str_eq(robot.warnings[1].text, "<jont> is not read; did you mean <joint>?");
    ck_assert_int_eq(parse(&robot, text, &strict), RBD_URDF_WARN_UNREAD);
    ck_assert_str_eq(robot.error.text, told);
}
END_TEST

/* A link without mass between joints at one place, as those of a universal joint, is meant so. */
START_TEST(crosses_and_robots_without_mass_give_no_warning) {
    static room x;
    static const char armature[] = "<dynamics armature='1'/>";
    char text[900];
    rbd_urdf robot = parsed(&x,
                            ROBOT(LINK("a") LINK("b") UNIT_LINK("c") JOINT("j", "continuous", "a", "b", "")
                                      JOINT("k", "continuous", "b", "c", "<origin rpy='1 0 0'/>")),
                            NULL);
    ck_assert_int_eq(robot.nwarnings, 0);
    snprintf(text, sizeof text,
             ROBOT(LINK("a") LINK("b") LINK("c") JOINT("j", "continuous", "a", "b", "%s")
                       JOINT("k", "continuous", "b", "c", "<origin xyz='0 0 1'/>%s")),
             armature, armature);
    robot = parsed(&x, text, NULL);
    ck_assert_int_eq(robot.nwarnings, 0);
    /* the mass that is fixed to a link is its own, and what is written is meant */
    robot = parsed(&x,
                   ROBOT(LINK("a") LINK("b") UNIT_LINK("m") UNIT_LINK("c")
                             JOINT("j", "continuous", "a", "b", "") JOINT("f", "fixed", "b", "m", "")
                                 JOINT("k", "continuous", "b", "c", "<origin xyz='0 0 1'/>")),
                   NULL);
    ck_assert_int_eq(robot.nwarnings, 0);
    robot =
        parsed(&x,
               ROBOT(LINK("a") "<link name='b'><inertial><mass value='0'/><inertia ixx='0' ixy='0' ixz='0' "
                               "iyy='0' iyz='0' izz='0'/></inertial></link>" UNIT_LINK("c")
                                   JOINT("j", "continuous", "a", "b", "")
                                       JOINT("k", "continuous", "b", "c", "<origin xyz='0 0 1'/>")),
               NULL);
    ck_assert_int_eq(robot.nwarnings, 0);
}
END_TEST

/* ---- warnings ---- */

#define TENSOR_LINK(name, mass, ixx, ixy, iyy, izz) \
    "<link name='" name "'>\n<inertial><mass value='" mass "'/><inertia ixx='" ixx "' ixy='" ixy \
    "' ixz='0' iyy='" iyy "' iyz='0' izz='" izz "'/></inertial></link>"
static const char unreal[] = ROBOT(
    LINK("a") TENSOR_LINK("point", "1", "0", "0", "0", "0") TENSOR_LINK("broken", "1", "1", "0", "1", "3")
        TENSOR_LINK("negative", "1", "1", "1.001", "1", "2")
            TENSOR_LINK("weightless", "0", "1", "0", "1", "1") JOINT("j", "continuous", "a", "point", "")
                JOINT("k", "fixed", "point", "broken", "") JOINT("l", "continuous", "broken", "negative", "")
                    JOINT("m", "continuous", "a", "weightless", ""));

START_TEST(links_that_no_real_body_is_like_give_warnings_by_name) {
    static room x;
    static const char *const texts[] = {
        "link 'point', inertia: zero for a body with mass: no real body is like this",
        "link 'broken', inertia: one principal moment exceeds the sum of the others: no real body is like "
        "this",
        "link 'negative', inertia: has a negative principal moment: no real body is like this",
        "link 'weightless', mass: zero for a body with inertia: no real body is like this"};
    const rbd_urdf_options strict = {.strict = 1};
    rbd_urdf robot = parsed(&x, unreal, NULL);
    ck_assert_int_eq(robot.nwarnings, 4);
    for (int i = 0; i < 4; i++) {
        int found = 0;
        for (int k = 0; k < 4; k++)
            found += strcmp(robot.warnings[k].text, texts[i]) == 0 && robot.warnings[k].line == 1 + i;
        ck_assert_msg(found == 1, "%s", texts[i]);
    }
    ck_assert_int_eq(parse(&robot, unreal, &strict), RBD_URDF_WARN_INERTIA);
    ck_assert_str_eq(robot.error.text, texts[0]);
    ck_assert_int_eq(robot.nb, 0);
}
END_TEST

START_TEST(limits_that_make_no_sense_are_none_with_a_warning) {
    static room x;
    static const char *const texts[] = {"joint 'j': it has no <limit>; read as none",
                                        "joint 'k': the velocity limit is negative; read as none",
                                        "joint 'k': <limit> has no effort; read as none",
                                        "joint 'k': the lower limit exceeds the upper; read as none"};
    rbd_urdf robot = parsed(
        &x,
        ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") UNIT_LINK("d") JOINT("j", "revolute", "a", "b", "")
                  JOINT("k", "prismatic", "b", "c", "<limit lower='1' upper='-1' velocity='-2'/>")
                      JOINT("l", "continuous", "c", "d", "<limit effort='2'/>")),
        NULL);
    ck_assert_int_eq(robot.nwarnings, 4);
    for (int i = 0; i < 4; i++) ck_assert_str_eq(robot.warnings[i].text, texts[i]);
    for (int i = 0; i < 3; i++)
        ck_assert(robot.bodies[i].lower == 0 && robot.bodies[i].upper == 0 && robot.bodies[i].velocity == 0);
    ck_assert_double_eq(robot.bodies[2].effort, 2);
}
END_TEST

START_TEST(limits_that_are_not_used_give_no_warning_about_their_order) {
    static room x;
    rbd_urdf robot = parsed(
        &x,
        ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") UNIT_LINK("d")
                  JOINT("j", "revolute", "a", "b", "<limit lower='-inf' upper='-1' velocity='1' effort='1'/>")
                      JOINT("k", "continuous", "b", "c", "<limit lower='3' upper='-3'/>")
                          JOINT("l", "continuous", "c", "d", "<limit lower='-inf' upper='inf'/>")),
        NULL);
    ck_assert_int_eq(robot.nwarnings, 1);
    ck_assert_str_eq(robot.warnings[0].text, "joint 'j': the lower limit is infinite; read as none");
    for (int i = 0; i < 3; i++) ck_assert(robot.bodies[i].lower == 0 && robot.bodies[i].upper == 0);
    robot = with_room(&x);
    ck_assert_int_eq(
        parse(&robot,
              ROBOT(LINK("a") UNIT_LINK("b") JOINT("j", "continuous", "a", "b", "<limit lower='low'/>")),
              NULL),
        RBD_URDF_ERR_NUMBER);
}
END_TEST

START_TEST(infinite_limits_are_none_with_a_warning) {
    static room x;
    rbd_urdf robot = parsed(
        &x,
        ROBOT(LINK("a") UNIT_LINK("b") JOINT(
            "j", "revolute", "a", "b", "<limit lower='-inf' upper='2' velocity='INF' effort='Infinity'/>")),
        NULL);
    ck_assert_int_eq(robot.nwarnings, 3);
    ck_assert_str_eq(robot.warnings[0].text, "joint 'j': the lower limit is infinite; read as none");
    ck_assert(robot.bodies[0].lower == 0 && robot.bodies[0].upper == 0 && robot.bodies[0].velocity == 0);
}
END_TEST

/* b has mass, the chain c, d has not, e has armature. */
static const char massless[] =
    ROBOT(LINK("a") UNIT_LINK("b") LINK("c") LINK("d") LINK("e") JOINT("ab", "continuous", "a", "b", "")
              JOINT("bc", "continuous", "b", "c", "") JOINT("cd", "continuous", "c", "d", "")
                  JOINT("de", "continuous", "b", "e", "<dynamics armature='1'/>"));

START_TEST(joints_that_move_no_mass_are_an_error_or_locked) {
    static room x;
    const rbd_urdf_options lock = {.lock_massless = 1};
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, massless, NULL), RBD_URDF_ERR_MODEL);
    ck_assert(strncmp(robot.error.text, "link 'd', joint 'cd', mass: ", 28) == 0);
    ck_assert_int_eq(parse(&robot, massless, &lock), RBD_URDF_OK);
    ck_assert_int_eq(robot.nb, 2);
    ck_assert_str_eq(robot.bodies[1].name, "e");
    ck_assert_int_eq(robot.nwarnings, 2);
    ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_LOCKED);
    ck_assert_str_eq(robot.warnings[0].text, "joint 'cd': it moves no mass; held still");
    ck_assert_str_eq(robot.warnings[1].text, "joint 'bc': it moves no mass; held still");
}
END_TEST

/* drive moves no mass itself; what mimics it, through idle, may. */
#define DRIVEN(follower) \
    ROBOT(LINK("a") LINK("b") LINK("c") follower UNIT_LINK("e") JOINT("drive", "continuous", "a", "b", "") \
              JOINT("follow", "continuous", "a", "d", "<mimic joint='idle'/>") \
                  JOINT("idle", "continuous", "a", "c", "<mimic joint='drive'/>") \
                      JOINT("spin", "continuous", "a", "e", ""))

START_TEST(a_joint_moves_the_mass_of_those_that_mimic_it) {
    static room x;
    const rbd_urdf_options lock = {.lock_massless = 1};
    rbd_urdf robot = parsed(&x, DRIVEN(UNIT_LINK("d")), &lock);
    ck_assert_int_eq(robot.nwarnings, 0);
    ck_assert_int_eq(robot.nb, 4);
    robot = parsed(&x, DRIVEN(LINK("d")), &lock);
    ck_assert_int_eq(robot.nwarnings, 3);
    ck_assert_int_eq(robot.nb, 1);
}
END_TEST

START_TEST(a_joint_that_moves_no_mass_with_those_that_mimic_it_gives_a_warning) {
    static room x;
    rbd_urdf robot = parsed(&x, DRIVEN(UNIT_LINK("d")), NULL);
    ck_assert_int_eq(robot.nwarnings, 0);
    robot = parsed(&x, DRIVEN(LINK("d")), NULL);
    ck_assert_int_eq(robot.nwarnings, 1);
    ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_SINGULAR);
    ck_assert_str_eq(
        robot.warnings[0].text,
        "joint 'drive': neither it nor joints that mimic it move mass: forward dynamics is singular; to "
        "hold it still: options.lock, rbd-model --lock 'drive', or --lock-massless for all such; for "
        "kinematics "
        "alone, as poses and Jacobians: options.kinematic, rbd-model --kinematic");
}
END_TEST

/* rbd_model_build takes the elbow, because it carries a joint that others mimic. */
START_TEST(a_joint_that_carries_only_joints_without_mass_gives_a_warning) {
    static const char text[] = ROBOT(
        LINK("a") UNIT_LINK("b") LINK("c") LINK("d") LINK("e") JOINT("trunk", "continuous", "a", "b", "")
            JOINT("elbow", "continuous", "b", "c", "") JOINT("left", "continuous", "c", "d", "")
                JOINT("right", "continuous", "c", "e", "<mimic joint='left'/>"));
    const rbd_urdf_options lock = {.lock_massless = 1};
    static room x;
    rbd_urdf robot = parsed(&x, text, NULL);
    ck_assert_int_eq(robot.nwarnings, 2);
    ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_SINGULAR);
    ck_assert_ptr_nonnull(
        strstr(robot.warnings[0].text, "joint 'elbow': it moves no mass: forward dynamics"));
    ck_assert_ptr_nonnull(
        strstr(robot.warnings[1].text, "joint 'left': neither it nor joints that mimic it"));

    robot = parsed(&x, text, &lock);
    ck_assert_int_eq(robot.nb, 1);
}
END_TEST

/* An arm without masses, as many makers publish it. The message's advice helps, and no other stands there. */
#define NO_MASSES(of_joints) \
    ROBOT(LINK("a") LINK("b") LINK("c") LINK("d") JOINT("shoulder", "continuous", "a", "b", of_joints) \
              JOINT("left", "continuous", "b", "c", of_joints) \
                  JOINT("right", "continuous", "b", "d", of_joints "<mimic joint='left'/>"))

START_TEST(a_robot_without_masses_is_told_how_to_be_read) {
    const rbd_urdf_lock left[] = {{"left", 0}, {NULL, 0}};
    const rbd_urdf_options options[4] = {
        {.lock_massless = 1}, {.root = RBD_FLOATING}, {.lock = left}, {.strict = 1}};
    static room x;
    rbd_urdf robot = with_room(&x);
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(parse(&robot, NO_MASSES(""), &options[i]), RBD_URDF_ERR_MODEL);
        ck_assert(strncmp(robot.error.text, "no link that moves has mass: ", 29) == 0);
        ck_assert_ptr_nonnull(strstr(robot.error.text, "options.kinematic, rbd-model --kinematic"));
    }

    ck_assert_int_eq(parse(&robot, NO_MASSES("<dynamics armature='1'/>"), &options[3]), RBD_URDF_OK);
    ck_assert_int_eq(robot.nwarnings, 0);
    ck_assert_int_eq(robot.nb, 3);
}
END_TEST

/* With options.kinematic it is read without a word, and rbd_model_build_kinematic takes it. */
START_TEST(a_robot_without_masses_is_read_for_kinematics) {
    static const rbd_urdf_options options[3] = {{.kinematic = 1, .strict = 1},
                                                {.kinematic = 1, .strict = 1, .root = RBD_FLOATING},
                                                {.kinematic = 1, .strict = 1, .keep_all = 1}};
    static const char *const texts[2] = {NO_MASSES(""), massless};
    static unsigned char memory[RBD_MODEL_SIZE(9)], work_memory[RBD_WORK_SIZE_MIMIC(9, 14)];
    for (int i = 0; i < 6; i++) {
        static room x;
        const rbd_urdf robot = parsed(&x, texts[i % 2], &options[i / 2]);
        const double q[15] = {0};
        double g[14];
        const rbd_model *m;
        rbd_work *w;
        ck_assert_int_eq(robot.nwarnings, 0);
        ck_assert_int_eq(rbd_model_build_kinematic(robot.bodies, robot.nb, memory, sizeof memory, &m, NULL),
                         RBD_OK);
        ck_assert_int_eq(rbd_work_init(m, work_memory, sizeof work_memory, &w), RBD_OK);
        ck_assert_int_eq(rbd_kinematics(m, w, q, NULL, NULL), RBD_OK);
        ck_assert_int_eq(rbd_gravity_torque(m, w, q, g), RBD_ERR_MASSLESS);
    }
}
END_TEST

/* Where each joint moves mass the option changes nothing; with lock_massless it is a contradiction. */
START_TEST(kinematic_changes_no_robot_with_masses) {
    static const char text[] = ROBOT(UNIT_LINK("a") UNIT_LINK("b") UNIT_LINK("c") JOINT(
        "j", "continuous", "a", "b", "<origin xyz='1 2 3'/>") JOINT("k", "prismatic", "b", "c", LIMIT));
    const rbd_urdf_options kinematic = {.kinematic = 1}, both = {.kinematic = 1, .lock_massless = 1};
    static room x, y;
    rbd_urdf usual = parsed(&x, text, NULL), robot = parsed(&y, text, &kinematic);
    ck_assert_int_eq(robot.nb, usual.nb);
    expect_same_results(robot.bodies, robot.nb, usual.bodies, usual.nb);
    ck_assert_int_eq(parse(&robot, text, &both), RBD_URDF_ERR_OPTION);
    ck_assert_ptr_nonnull(strstr(robot.error.text, "kinematic"));
}
END_TEST

/* ---- wrong mimics ---- */

/* Joints that mimic what is missing, itself, each other, or what cannot lead; and one that is right. */
#define WRONG_MIMICS \
    ROBOT(UNIT_LINK("a") UNIT_LINK("b") UNIT_LINK("c") UNIT_LINK("d") UNIT_LINK("e") UNIT_LINK("f") \
              UNIT_LINK("g") UNIT_LINK("h") JOINT("knuckle", "continuous", "a", "b", "") \
                  JOINT("tip", "continuous", "b", "c", "<mimic joint='Knuckl' multiplier='2' offset='1'/>") \
                      JOINT("self", "continuous", "a", "d", "<mimic joint='self'/>") \
                          JOINT("one", "continuous", "a", "e", "<mimic joint='two'/>") \
                              JOINT("two", "continuous", "a", "f", "<mimic joint='one'/>") \
                                  JOINT("plane", "planar", "a", "g", "<mimic joint='knuckle'/>") \
                                      JOINT("of_plane", "continuous", "a", "h", "<mimic joint='plane'/>"))

START_TEST(wrong_mimics_may_move_freely) {
    static room x;
    static const char *const told[5] = {
        "joint 'plane': only revolute, continuous and prismatic joints can mimic; it moves freely",
        "joint 'tip': it mimics 'Knuckl', which is missing; did you mean 'knuckle'?; it moves freely",
        "joint 'self': it mimics itself; it moves freely",
        "joint 'one': it mimics itself through others; it moves freely",
        "joint 'of_plane': it mimics 'plane', which is not revolute, continuous or prismatic; it moves "
        "freely"};
    const rbd_urdf_options options = {.free_mimics = 1};
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, WRONG_MIMICS, NULL), RBD_URDF_ERR_MIMIC);
    ck_assert_ptr_nonnull(strstr(robot.error.text, "options.free_mimics, rbd-model --free-mimics"));

    robot = parsed(&x, WRONG_MIMICS, &options);
    ck_assert_int_eq(robot.nwarnings, 5);
    for (int i = 0; i < 5; i++) {
        ck_assert_str_eq(robot.warnings[i].text, told[i]);
        ck_assert_int_eq(robot.warnings[i].status, RBD_URDF_WARN_MIMIC);
    }
    for (int i = 0; i < robot.nb; i++) {
        const rbd_body *b = &robot.bodies[i];
        if (b->joint && strcmp(b->joint, "two") == 0)
            ck_assert_str_eq(b->mimic, "one"); /* which leads now */
        else
            ck_assert_ptr_null(b->mimic);
    }
}
END_TEST

/* Four fingers whose mimics lack the prefix of the hand: all are named, and the advice stands before them. */
START_TEST(mimics_without_their_prefix_are_named_at_once) {
    static const char *const fingers[4] = {"index", "middle", "ring", "little"};
    static room x;
    char text[6000], *end = text + sprintf(text, "<robot name='hand'>" UNIT_LINK("palm"));
    for (int i = 0; i < 4; i++)
        end += sprintf(
            end,
            "<link name='r_%s_1'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
            "izz='1'/></inertial></link><link name='r_%s_2'><inertial><mass value='1'/><inertia ixx='1' "
            "ixy='0' "
            "ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
            "<joint name='r_%s' type='continuous'><parent link='palm'/><child link='r_%s_1'/>"
            "<axis xyz='0 1 0'/></joint><joint name='r_%s_tip' type='continuous'><parent link='r_%s_1'/>"
            "<child link='r_%s_2'/><axis xyz='0 1 0'/><mimic joint='%s'/></joint>",
            fingers[i], fingers[i], fingers[i], fingers[i], fingers[i], fingers[i], fingers[i], fingers[i]);
    strcpy(end, "</robot>");
    const rbd_urdf_options options = {.free_mimics = 1};
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, text, NULL), RBD_URDF_ERR_MIMIC);
    ck_assert_ptr_nonnull(strstr(robot.error.text, "--free-mimics; missing too: 'middle' of 'r_middle_tip', "
                                                   "'ring' of 'r_ring_tip', 'little' of 'r_little_tip'"));
    ck_assert_int_eq(parse(&robot, text, &options), RBD_URDF_OK);
    ck_assert_int_eq(robot.nwarnings, 4);
}
END_TEST

/* ---- URDF 1.1 and 1.2 ---- */

/* Turns v by the unit quaternion q: v + 2 w (u x v) + 2 u x (u x v), of u its vector part. */
static void turned_by(const double q[4], const double v[3], double out[3]) {
    double t[3];
    for (int i = 0; i < 3; i++)
        t[i] = 2 * (q[(i + 1) % 3] * v[(i + 2) % 3] - q[(i + 2) % 3] * v[(i + 1) % 3]);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] + q[3] * t[i] + q[(i + 1) % 3] * t[(i + 2) % 3] - q[(i + 2) % 3] * t[(i + 1) % 3];
}

START_TEST(quaternions_turn_joints_and_inertias) {
    static room x;
    const double half = sqrt(0.5), q[4] = {0.5, -0.1, 0.7, 0.5}, nearly[4] = {0, half, 0, half};
    const double *all[2] = {q, nearly}; /* the second is a pitch of 90 degrees */
    for (int k = 0; k < 2; k++) {
        char text[900];
        snprintf(text, sizeof text,
                 ROBOT(LINK("a") "<link name='b'><inertial><origin quat_xyzw='%.17g %.17g %.17g %.17g'/>"
                                 "<mass value='1'/><inertia ixx='3' ixy='0' ixz='0' iyy='4' iyz='0' izz='5'/>"
                                 "</inertial></link>" JOINT("j", "continuous", "a", "b",
                                                            "<origin quat_xyzw='%.17g %.17g %.17g %.17g'/>")),
                 all[k][0], all[k][1], all[k][2], all[k][3], all[k][0], all[k][1], all[k][2], all[k][3]);
        const rbd_urdf robot = parsed(&x, text, NULL);
        double length = 0, columns[3][3], inertia[9] = {0};
        ck_assert_int_eq(robot.nwarnings, 0);
        for (int i = 0; i < 4; i++) length += all[k][i] * all[k][i];
        for (int j = 0; j < 3; j++) {
            const double e[3] = {j == 0, j == 1, j == 2};
            double unit[4];
            for (int i = 0; i < 4; i++) unit[i] = all[k][i] / sqrt(length);
            turned_by(unit, e, columns[j]);
            for (int i = 0; i < 3; i++)
                ck_assert_double_eq_tol(robot.bodies[0].rotation[3 * i + j], columns[j][i], 1e-15);
        }
        for (int i = 0; i < 3; i++) /* sum of 3, 4, 5 times the axis' dyad */
            for (int j = 0; j < 3; j++)
                for (int n = 0; n < 3; n++) inertia[3 * i + j] += (3 + n) * columns[n][i] * columns[n][j];
        const int upper[6] = {0, 1, 2, 4, 5, 8};
        for (int i = 0; i < 6; i++)
            ck_assert_double_eq_tol(robot.bodies[0].inertia[i], inertia[upper[i]], 1e-14);
    }
}
END_TEST

/* Capsules, limits of acceleration and jerk, and the number of the version are known. */
START_TEST(later_versions_of_urdf_are_read) {
    static room x;
    const rbd_urdf_options strict = {.strict = 1};
    const rbd_urdf robot = parsed(
        &x,
        "<robot name='r' version='1.2'><link name='a'/><link name='b'><inertial><mass value='1'/><inertia "
        "ixx='1' "
        "ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial><collision><geometry><capsule radius='1' "
        "length='2'/></geometry></collision></link><joint name='j' type='revolute'><parent link='a'/><child "
        "link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='2' velocity='3' acceleration='4' "
        "deceleration='5' jerk='6'/></joint></robot>",
        &strict);
    ck_assert_double_eq(robot.bodies[0].velocity, 3);
    ck_assert_int_eq(robot.nwarnings, 0);
}
END_TEST

/* ---- encodings and other formats ---- */

/* A text of ASCII in UTF-16, with a byte order mark or without; returns its bytes. */
static size_t in_utf16(const char *text, int little, int mark, char *to) {
    size_t n = 0;
    if (mark) {
        memcpy(to, little ? "\xff\xfe" : "\xfe\xff", 2);
        n = 2;
    }
    for (; *text; text++, n += 2) {
        to[n + (size_t)!little] = *text;
        to[n + (size_t)little] = 0;
    }
    return n;
}

START_TEST(text_in_utf16_is_read) {
    static room x, y;
    const rbd_urdf usual = parsed(&x, fixed_links, NULL);
    static char wide[20000];
    for (int i = 0; i < 4; i++) {
        rbd_urdf robot = with_room(&y);
        const size_t n = in_utf16(fixed_links, i & 1, i >> 1, wide);
        ck_assert_msg(rbd_urdf_parse(wide, n, NULL, &robot) == RBD_URDF_OK, "%d: %s", i, robot.error.text);
        ck_assert_int_eq(robot.nb, usual.nb);
        expect_same_results(robot.bodies, robot.nb, usual.bodies, usual.nb);
        ck_assert_int_eq(rbd_urdf_parse(wide, n - 1, NULL, &robot), RBD_URDF_ERR_XML);
        ck_assert_str_eq(robot.error.text, "it is text in UTF-16, but ends within a character");
    }
}
END_TEST

/* A URDF in UTF-32, of both orders of bytes, with a byte order mark or without. */
START_TEST(text_in_utf32_is_named) {
    static room x;
    static char wide[40000];
    for (int i = 0; i < 4; i++) {
        const size_t mark = i >> 1;
        rbd_urdf robot = with_room(&x);
        size_t n = 0;
        memset(wide, 0, sizeof wide);
        if (mark) {
            memcpy(wide, i & 1 ? "\xff\xfe\0\0" : "\0\0\xfe\xff", 4);
            n = 4;
        }
        for (const char *c = fixed_links; *c; c++, n += 4) wide[n + (i & 1 ? 0 : 3)] = *c;
        ck_assert_int_eq(rbd_urdf_parse(wide, n, NULL, &robot), RBD_URDF_ERR_XML);
        ck_assert_str_eq(robot.error.text, "it is text in UTF-32: save it as UTF-8");
    }
}
END_TEST

/* U+1F916, which takes two units, and the first of them alone. */
START_TEST(pairs_of_utf16_are_characters) {
    static room x;
    static char wide[4000];
    rbd_urdf robot = with_room(&x);
    const char text[] =
        "<robot name='--'>" UNIT_LINK("a") UNIT_LINK("b") JOINT("j", "continuous", "a", "b", "");
    size_t n = in_utf16(text, 1, 1, wide);
    n += in_utf16("</robot>", 1, 0, wide + n);
    memcpy(wide + 2 + 2 * 13, "\x3e\xd8\x16\xdd", 4);
    ck_assert_msg(rbd_urdf_parse(wide, n, NULL, &robot) == RBD_URDF_OK, "%s", robot.error.text);
    ck_assert_str_eq(robot.name, "\xf0\x9f\xa4\x96");
    memcpy(wide + 2 + 2 * 13, "\x3e\xd8\x3e\xd8", 4);
    ck_assert_int_eq(rbd_urdf_parse(wide, n, NULL, &robot), RBD_URDF_ERR_XML);
    ck_assert_str_eq(robot.error.text, "it is text in UTF-16 that has half a character: save it as UTF-8");
}
END_TEST

/* How files of other formats begin, and a word of the sentence. */
static const struct {
    const char *text, *word;
} formats[] = {{"PK\003\004xx", "zip archive"},
               {"\037\213xx", "gzip"},
               {"PXR-USDC", "USD"},
               {"#usda 1.0\n", "USD"},
               {" \n<!DOCTYPE html>\n<html lang=en>", "raw file"},
               {"\xef\xbb\xbf<HTML>", "raw file"},
               {"version https://git-lfs.github.com/spec/v1\n", "git lfs pull"},
               {"404: Not Found", "404"},
               {"glTF\2", "glTF"},
               {"solid part\nfacet", "STL"},
               {"ply\nformat", "PLY"},
               {"mtllib a.mtl", "OBJ"},
               {"%PDF-1.4", "PDF"},
               {"{\\rtf1\\ansi <robot/>}", "RTF"},
               {"GIF89a\1", "GIF"},
               {"\x89PNG\r\n", "PNG"},
               {"\xff\xd8\xff\xe0", "JPEG"},
               {"BZh91AY", "bzip2"},
               {"\3757zXZ", "xz"},
               {"7z\xbc\xaf\x27", "7z archive"},
               {"Rar!\x1a", "RAR archive"},
               {"{\"links\": []}", "JSON"},
               {"[1, 2]", "JSON"},
               {"---\nrobot: r", "YAML"},
               {"robot:\n  links:", "YAML"},
               {"robot_name: r", "YAML"},
               {"<mujoco model='m'/>", "MJCF, the format of MuJoCo"},
               {"<mujocoinclude/>", "MJCF"},
               {"<sdf version='1.7'/>", "SDF, the format of Gazebo"},
               {"<COLLADA/>", "COLLADA"},
               {"<KinBody/>", "OpenRAVE"},
               {"<OpenSimDocument/>", "OpenSim"},
               {"<launch/>", "launch file"},
               {"<package/>", "package.xml"}};

START_TEST(other_formats_are_named) {
    static room x;
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, formats[_i].text, NULL), RBD_URDF_ERR_ROBOT);
    ck_assert_msg(strstr(robot.error.text, formats[_i].word) != NULL, "%s", robot.error.text);
    ck_assert_int_ge(robot.error.line, 1);
}
END_TEST

START_TEST(a_binary_mesh_is_named) {
    static room x;
    char mesh[84 + 2 * 50] = "exported by a program";
    rbd_urdf robot = with_room(&x);
    mesh[80] = 2;
    ck_assert_int_eq(rbd_urdf_parse(mesh, sizeof mesh, NULL, &robot), RBD_URDF_ERR_ROBOT);
    ck_assert_ptr_nonnull(strstr(robot.error.text, "STL"));
    mesh[80] = 3; /* of another length: text that is none of URDF */
    ck_assert_int_eq(rbd_urdf_parse(mesh, sizeof mesh, NULL, &robot), RBD_URDF_ERR_XML);
}
END_TEST

/* The file has a free joint of its own. */
START_TEST(a_second_free_joint_is_told) {
    static room x;
    const rbd_urdf_options floating = {.root = RBD_FLOATING};
    static const char *const texts[2] = {
        ROBOT(LINK("world") UNIT_LINK("trunk") BARE_JOINT("free", "floating", "world", "trunk", "")),
        ROBOT(UNIT_LINK("base") UNIT_LINK("trunk") BARE_JOINT("free", "floating", "base", "trunk", ""))};
    static const char *const told[2] = {
        "link 'world': the floating root link has no mass; joint 'free' floats already: leave out "
        "options.root, "
        "rbd-model --floating",
        "link 'base': the root link floats; joint 'free' floats already: leave out options.root, rbd-model "
        "--floating"};
    for (int i = 0; i < 2; i++) {
        rbd_urdf robot = parsed(&x, texts[i], &floating);
        ck_assert_int_eq(robot.nwarnings, 1);
        ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_ROOT);
        ck_assert_str_eq(robot.warnings[0].text, told[i]);
        robot = parsed(&x, texts[i], NULL);
        ck_assert_int_eq(robot.nwarnings, 0);
    }
}
END_TEST

/* ---- xacro ---- */

/* What a text has, whether it is read, and a word of what is told. */
#define LEFTOVER(inside) ROBOT(LINK("a") UNIT_LINK("b") JOINT("j", "continuous", "a", "b", "") inside)
static const struct {
    const char *text;
    int read;
    const char *word;
} xacros[] = {
    {LEFTOVER("<xacro:imu parent='b'/>"), 1, "<xacro:imu> is not read; xacro left it there"},
    {LEFTOVER("<xacro:property name='l' value='2'/>"), 1, "<xacro:property> is not read"},
    {LEFTOVER("<xacro:macro name='leg'><link name='${x}'/></xacro:macro>"), 1, "<xacro:macro> is not read"},
    {LEFTOVER("<xacro:macro name='leg'/><xacro:leg/>"), 0, "<xacro:leg> is of xacro: expand"},
    {LEFTOVER("<xacro:include filename='x'/>"), 0, "<xacro:include> is of xacro: expand"},
    {LEFTOVER("<xacro:if value='1'/>"), 0, "xacro FILE -o robot.urdf"},
    {LEFTOVER("<include filename='x'/>"), 0, "<include> is of xacro"},
    {LEFTOVER("<property name='l' value='2'/>"), 0, "<property> is of xacro"},
    {LEFTOVER("<gazebo><property name='l'/><include/><xacro:leg x='${l}'/></gazebo>"), 1, NULL},
    {LEFTOVER("<link name='c'><visual><origin xyz='${l} 0 0'/></visual></link>"
              "<joint name='k' type='fixed'><parent link='b'/><child link='c'/></joint>"),
     1, NULL},
    {LEFTOVER("<link name='${p}c'/>"), 0, "link '${p}c': <link name>: '${p}c' is of xacro"},
    {LEFTOVER("<link name='c'/><joint name='k' type='$(arg t)'><parent link='b'/><child link='c'/></joint>"),
     0, "joint 'k': <joint type>: '$(arg t)' is of xacro"},
    {ROBOT("<xacro:arg name='x' default='1'/>"), 0,
     "the robot has no link; the file has <xacro:arg> of line 1"}};

START_TEST(sources_of_xacro_are_told_from_leftovers) {
    static room x;
    rbd_urdf robot = with_room(&x);
    const int status = parse(&robot, xacros[_i].text, NULL);
    const char *told = status ? robot.error.text : robot.nwarnings ? robot.warnings[0].text : NULL;
    ck_assert_msg((status == RBD_URDF_OK) == xacros[_i].read, "%s", robot.error.text);
    ck_assert_int_eq(xacros[_i].word == NULL, told == NULL);
    if (told) ck_assert_msg(strstr(told, xacros[_i].word) != NULL, "%s", told);
}
END_TEST

/* ---- what is odd but usable ---- */

/* odd/expected.txt has a row for each file: name|line|text of its only warning. */
START_TEST(odd_files_give_the_warning_expected) {
    const rbd_urdf_options strict = {.strict = 1};
    char row[600], path[1000];
    int rows = 0;
    FILE *expected;
    snprintf(path, sizeof path, "%s", path_of("tests/urdf/odd", "expected.txt", ""));
    expected = fopen(path, "r");
    ck_assert(expected != NULL);
    for (; fgets(row, sizeof row, expected); rows++) {
        static room x;
        rbd_urdf robot = with_room(&x);
        const char *file = strtok(row, "|"), *line = strtok(NULL, "|"), *text = strtok(NULL, "\n");
        ck_assert_msg(rbd_urdf_load(path_of("tests/urdf/odd", file, ""), NULL, &robot) == RBD_URDF_OK,
                      "%s: %s", file, robot.error.text);
        ck_assert_int_eq(robot.nwarnings, 1);
        ck_assert_str_eq(robot.warnings[0].text, text);
        ck_assert_int_eq(robot.warnings[0].line, atoi(line));
        ck_assert_str_ne(rbd_urdf_status_string(robot.warnings[0].status), "unknown status");
        ck_assert_int_eq(rbd_urdf_load(path_of("tests/urdf/odd", file, ""), &strict, &robot),
                         robot.warnings[0].status);
        ck_assert_str_eq(robot.error.text, text);
    }
    fclose(expected);
    ck_assert_int_eq(rows, count_files("tests/urdf/odd"));
}
END_TEST

/* A joint's type and what it has; the text of its only warning, NULL if it has none. */
#define DEGREES(type, inside, warning) \
    {ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") JOINT("j", type, "a", "b", inside) \
               JOINT("k", "continuous", "a", "c", "")), \
     warning}
#define BOUNDS(lower, upper) "<limit lower='" lower "' upper='" upper "' velocity='3' effort='4'/>"
#define LOOK " looks like degrees; it is read as rad"
static const struct {
    const char *text, *warning;
} degrees[] = {
    DEGREES("revolute", BOUNDS("-90", "90"), "joint 'j': <limit>, -90 .. 90," LOOK),
    DEGREES("revolute", BOUNDS("0", "170"), "joint 'j': <limit>, 0 .. 170," LOOK),
    DEGREES("revolute", BOUNDS("-114.591559", "1"), "joint 'j': <limit>, -114.592 .. 1," LOOK),
    DEGREES("revolute", BOUNDS("-360", "360"), "joint 'j': <limit>, -360 .. 360," LOOK),
    DEGREES("revolute", BOUNDS("-12.566", "12.566"), NULL),   /* two turns */
    DEGREES("revolute", BOUNDS("-62.8319", "17.4533"), NULL), /* ten turns, 1000 degrees */
    DEGREES("revolute", BOUNDS("-1e6", "1e6"), NULL),         /* no limit, as some write it */
    DEGREES("revolute", BOUNDS("90", "-90"), "joint 'j': the lower limit exceeds the upper; read as none"),
    DEGREES("prismatic", BOUNDS("-90", "90"), NULL),  /* m */
    DEGREES("continuous", BOUNDS("-90", "90"), NULL), /* not used */
    DEGREES("continuous", "<origin rpy='0 90 0'/>", "joint 'j': <origin rpy>, 0 90 0," LOOK),
    DEGREES("fixed", "<origin rpy='0 0 -45'/>", "joint 'j': <origin rpy>, 0 0 -45," LOOK),
    DEGREES("continuous", "<origin xyz='90 90 90' rpy='3.1416 -6.2832 0'/>", NULL),
    DEGREES("continuous", "<mimic joint='k' offset='90'/>", "joint 'j': <mimic offset>, 90," LOOK),
    DEGREES("prismatic", BOUNDS("0", "1") "<mimic joint='k' offset='90'/>", NULL),
};

START_TEST(what_looks_like_degrees_gives_a_warning) {
    static room x;
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, degrees[_i].text, NULL), RBD_URDF_OK);
    ck_assert_int_eq(robot.nwarnings, degrees[_i].warning != NULL);
    if (degrees[_i].warning) ck_assert_str_eq(robot.warnings[0].text, degrees[_i].warning);
}
END_TEST

START_TEST(a_joint_held_still_at_degrees_gives_a_warning) {
    static const char text[] = ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") JOINT(
        "j", "continuous", "a", "b", "") JOINT("k", "continuous", "b", "c", ""));
    static room x;
    rbd_urdf_lock lock[] = {{"j", -90}, {NULL, 0}};
    const rbd_urdf_options options = {.lock = lock};
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, text, &options), RBD_URDF_OK);
    ck_assert_int_eq(robot.nwarnings, 1);
    ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_DEGREES);
    ck_assert_str_eq(robot.warnings[0].text,
                     "joint 'j': held still at -90, which looks like degrees; it is read as rad");
    lock[0].value = -1.5707963267948966;
    ck_assert_int_eq(parse(&robot, text, &options), RBD_URDF_OK);
    ck_assert_int_eq(robot.nwarnings, 0);
}
END_TEST

START_TEST(a_robot_without_a_name_is_called_robot) {
    static room x;
    static const char *const heads[] = {"<robot>", "<robot name=''>"};
    for (int i = 0; i < 2; i++) {
        char text[600];
        snprintf(text, sizeof text,
                 "%s" LINK("a") UNIT_LINK("b") JOINT("j", "continuous", "a", "b", "") "</robot>", heads[i]);
        rbd_urdf robot = parsed(&x, text, NULL);
        ck_assert_str_eq(robot.name, "robot");
        ck_assert_int_eq(robot.nwarnings, 1);
        ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_NAME);
    }
}
END_TEST

/* Whatever its length, an axis gives the robot that the unit vector gives, to the bit. */
START_TEST(axes_of_any_length_are_made_unit_vectors) {
    static room x, y;
    static const char *const types[] = {"revolute", "continuous", "prismatic", "planar"};
    static const char *const unit = "0 -1 0", *const axes[] = {"0 -2 0", "0 -1e-320 0", "0 -1e300 0"};
    char text[900];
    for (size_t type = 0; type < 4; type++)
        for (size_t i = 0; i < 3; i++) {
            rbd_urdf robot[2];
            for (int k = 0; k < 2; k++) {
                snprintf(text, sizeof text,
                         ROBOT(LINK("a") UNIT_LINK("b") BARE_JOINT(
                             "j", "%s", "a", "b", "<axis xyz='%s'/><limit velocity='3' effort='4'/>")),
                         types[type], k ? axes[i] : unit);
                robot[k] = parsed(k ? &x : &y, text, NULL);
            }
            ck_assert_int_eq(robot[0].nwarnings, 0);
            ck_assert_int_eq(robot[1].nwarnings, 1);
            ck_assert_int_eq(robot[1].warnings[0].status, RBD_URDF_WARN_AXIS);
            ck_assert_mem_eq(robot[1].bodies[0].axis, robot[0].bodies[0].axis, 3 * sizeof(double));
            ck_assert_mem_eq(robot[1].bodies[0].rotation, robot[0].bodies[0].rotation, 9 * sizeof(double));
        }
    /* one that is rounded stays as it is written */
    rbd_urdf rounded = parsed(&x,
                              ROBOT(LINK("a") UNIT_LINK("b") BARE_JOINT("j", "continuous", "a", "b",
                                                                        "<axis xyz='0.707 0.707 0'/>")),
                              NULL);
    ck_assert_int_eq(rounded.nwarnings, 0);
    ck_assert_double_eq(rounded.bodies[0].axis[0], 0.707);
}
END_TEST

/* rbd_model_build takes a fixed joint with an axis for one whose type was forgotten. */
START_TEST(fixed_joints_have_no_axis) {
    static room x;
    const rbd_urdf_lock lock[] = {{"k", 0.5}, {NULL, 0}};
    const rbd_urdf_options options = {.keep_all = 1, .lock = lock};
    rbd_urdf robot = parsed(&x,
                            ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") UNIT_LINK("d")
                                      BARE_JOINT("j", "fixed", "a", "b", "<axis xyz='0 1 0'/>")
                                          BARE_JOINT("k", "continuous", "b", "c", "<axis xyz='0 1 0'/>")
                                              BARE_JOINT("l", "continuous", "c", "d", "<axis xyz='0 1 0'/>")),
                            &options);
    ck_assert_int_eq(robot.nb, 4);
    for (int i = 0; i < 4; i++)
        ck_assert_int_eq(robot.bodies[i].axis[1] == 0, robot.bodies[i].type == RBD_FIXED);
}
END_TEST

START_TEST(a_joint_that_mimics_by_zero_stands_at_its_offset) {
    static room x;
    /* k stands at 0.5, so l at 0.25 - 2 * 0.5; the product of the last two ratios is too small for a double
     */
    rbd_urdf robot = parsed(
        &x,
        ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") UNIT_LINK("d") UNIT_LINK("e") UNIT_LINK("f") JOINT(
            "l", "prismatic", "b", "d", LIMIT "<mimic joint='k' multiplier='-2' offset='0.25'/>")
                  JOINT("k", "prismatic", "b", "c", LIMIT "<mimic joint='j' multiplier='0' offset='0.5'/>")
                      JOINT("m", "continuous", "b", "e", "<mimic joint='j' multiplier='1e-200'/>")
                          JOINT("n", "continuous", "b", "f", "<mimic joint='m' multiplier='1e-200'/>")
                              JOINT("j", "continuous", "a", "b", "")),
        NULL);
    ck_assert_int_eq(robot.nb, 2);
    ck_assert_double_eq(robot.frames[rbd_urdf_link_index(&robot, "c")].position[0], 0.5);
    ck_assert_double_eq(robot.frames[rbd_urdf_link_index(&robot, "d")].position[0], -0.75);
    ck_assert_int_eq(robot.nwarnings, 3);
    ck_assert_str_eq(robot.warnings[0].text, "joint 'k': held still at 0.5, as its <mimic> has multiplier 0");
    ck_assert_str_eq(robot.warnings[1].text, "joint 'l': held still at -0.75, as it mimics 'k'");
    ck_assert_str_eq(robot.warnings[2].text, "joint 'n': held still at 0, as its <mimic> has multiplier 0");
    for (int i = 0; i < 3; i++) ck_assert_int_eq(robot.warnings[i].status, RBD_URDF_WARN_LOCKED);
}
END_TEST

/* ---- joints held still by name ---- */

#define MASSIVE(name) HEAVY(name, "2", "0.1 0.2 0.3", "0.4 0.5 0.6")
#define PLACED(axis) "<origin xyz='0.3 -0.2 0.5' rpy='0.4 -0.3 0.2'/><axis xyz='" axis "'/>"
static const char lockable[] =
    ROBOT(LINK("base") MASSIVE("a") MASSIVE("b") MASSIVE("c") MASSIVE("d") MASSIVE("e")
              BARE_JOINT("ja", "revolute", "base", "a", PLACED("0 1 0") LIMIT)
                  BARE_JOINT("turn", "revolute", "a", "b", PLACED("3 -2 6") LIMIT)
                      BARE_JOINT("slide", "prismatic", "b", "c", PLACED("0.6 0 0.805") LIMIT)
                          BARE_JOINT("jd", "continuous", "c", "d", PLACED("1 0 0"))
                              BARE_JOINT("je", "revolute", "b", "e", PLACED("0 0 1") LIMIT));

/* Inverse dynamics, and where link d is. */
typedef struct held_results {
    double tau[5], R[9], p[3];
} held_results;
static held_results compute_held(const rbd_urdf *robot, const double *q, const double *v, const double *a) {
    static unsigned char memory[RBD_MODEL_SIZE(10)], work[RBD_WORK_SIZE(10, 10)];
    held_results out;
    const rbd_model *m;
    rbd_work *w;
    ck_assert_int_eq(rbd_model_build(robot->bodies, robot->nb, memory, sizeof memory, &m, NULL), RBD_OK);
    ck_assert_int_eq(rbd_work_init(m, work, sizeof work, &w), RBD_OK);
    ck_assert_int_eq(rbd_rnea(m, w, q, v, a, NULL, out.tau), RBD_OK);
    ck_assert_int_eq(rbd_kinematics(m, w, q, v, a), RBD_OK);
    ck_assert_int_eq(rbd_body_pose(m, w, rbd_body_index(m, "d"), out.R, out.p), RBD_OK);
    return out;
}

/* The joints that are left feel what they feel on the whole robot with the others at rest there. */
START_TEST(joints_held_still_are_as_at_rest_there) {
    static room x, y;
    const double turn = 1.2, slide = -0.4;
    const rbd_urdf_lock lock[] = {{"turn", turn}, {"slide", slide}, {NULL, 0}};
    const rbd_urdf_options options = {.lock = lock, .keep_all = _i};
    const double q[5] = {0.3, turn, slide, -0.7, 0.9}, v[5] = {1, 0, 0, -2, 3}, a[5] = {2, 0, 0, 5, -4};
    const double q_held[3] = {0.3, -0.7, 0.9}, v_held[3] = {1, -2, 3}, a_held[3] = {2, 5, -4};
    rbd_urdf whole = parsed(&x, lockable, NULL), held = parsed(&y, lockable, &options);
    held_results all = compute_held(&whole, q, v, a), rest = compute_held(&held, q_held, v_held, a_held);
    const double tau[3] = {all.tau[0], all.tau[3], all.tau[4]};
    ck_assert_int_eq(held.nb, _i ? 6 : 3);
    ck_assert_int_eq(held.nwarnings, 1); /* the axis of turn; the holding is asked for */
    ck_assert_int_eq(rbd_urdf_joint_index(&held, "turn"), -1);
    expect_close("tau", rest.tau, tau, 3, 1e-13);
    expect_close("R", rest.R, all.R, 9, 1e-14);
    expect_close("p", rest.p, all.p, 3, 1e-14);
}
END_TEST

START_TEST(a_quarter_turn_is_exact) {
    static room x;
    const rbd_urdf_lock lock[] = {{"k", 1.5707963267948966}, {NULL, 0}};
    const rbd_urdf_options options = {.lock = lock};
    const double turned[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
    rbd_urdf robot =
        parsed(&x,
               ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") JOINT("j", "continuous", "a", "b", "")
                         BARE_JOINT("k", "continuous", "b", "c", "<axis xyz='0 0 3'/>")),
               &options);
    ck_assert_int_eq(robot.nb, 1);
    for (int i = 0; i < 9; i++) ck_assert_double_eq(robot.frames[2].rotation[i], turned[i]);
}
END_TEST

START_TEST(joints_of_several_degrees_of_freedom_are_held_at_neutral) {
    static room x, y;
    static const char *const types[] = {"planar", "floating"};
    const rbd_urdf_lock lock[] = {{"k", 0}, {NULL, 0}}, elsewhere[] = {{"k", 0.1}, {NULL, 0}};
    const rbd_urdf_options options = {.lock = lock}, bad = {.lock = elsewhere};
    char text[1200];
    for (int i = 0; i < 2; i++) {
        const char *const format = ROBOT(
            LINK("a") MASSIVE("b") MASSIVE("c") JOINT("j", "continuous", "a", "b", "")
                BARE_JOINT("k", "%s", "b", "c", "<origin xyz='1 2 3' rpy='1 2 3'/><axis xyz='0 0.6 0.8'/>"));
        snprintf(text, sizeof text, format, "fixed");
        rbd_urdf fixed = parsed(&x, text, NULL);
        snprintf(text, sizeof text, format, types[i]);
        rbd_urdf robot = parsed(&y, text, &options);
        ck_assert_int_eq(robot.nwarnings, 0);
        ck_assert_int_eq(robot.nb, 1);
        ck_assert_mem_eq(robot.bodies[0].inertia, fixed.bodies[0].inertia, 6 * sizeof(double));
        ck_assert_mem_eq(robot.frames[2].rotation, fixed.frames[2].rotation, 9 * sizeof(double));
        ck_assert_int_eq(parse(&robot, text, &bad), RBD_URDF_ERR_OPTION);
        ck_assert_str_eq(robot.error.text, "joint 'k': only revolute, continuous and prismatic joints can be "
                                           "held still at 0.1");
    }
}
END_TEST

static const char followers[] = ROBOT(
    LINK("a") UNIT_LINK("b") UNIT_LINK("c") UNIT_LINK("d") UNIT_LINK("e")
        JOINT("drive", "prismatic", "a", "b", LIMIT)
            JOINT("left", "prismatic", "a", "c", LIMIT "<mimic joint='drive' multiplier='-1' offset='0.5'/>")
                JOINT("right", "prismatic", "a", "d", LIMIT "<mimic joint='left' multiplier='2'/>")
                    JOINT("spin", "continuous", "a", "e", ""));

static double held_at(const rbd_urdf *robot, const char *link) {
    return robot->frames[rbd_urdf_link_index(robot, link)].position[0];
}

START_TEST(what_mimics_a_joint_held_still_is_held_too) {
    static room x;
    const rbd_urdf_lock drive[] = {{"drive", 0.25}, {NULL, 0}}, left[] = {{"left", 1.5}, {NULL, 0}};
    rbd_urdf_options options = {.lock = drive};
    rbd_urdf robot = parsed(&x, followers, &options);
    ck_assert_int_eq(robot.nb, 1); /* spin */
    ck_assert_double_eq(held_at(&robot, "b"), 0.25);
    ck_assert_double_eq(held_at(&robot, "c"), 0.25);
    ck_assert_double_eq(held_at(&robot, "d"), 0.5);
    ck_assert_int_eq(robot.nwarnings, 2);
    ck_assert_str_eq(robot.warnings[0].text, "joint 'left': held still at 0.25, as it mimics 'drive'");
    ck_assert_str_eq(robot.warnings[1].text, "joint 'right': held still at 0.5, as it mimics 'left'");

    options.lock = left; /* which mimics no more */
    robot = parsed(&x, followers, &options);
    ck_assert_int_eq(robot.nb, 2); /* drive, spin */
    ck_assert_double_eq(held_at(&robot, "c"), 1.5);
    ck_assert_double_eq(held_at(&robot, "d"), 3);
    ck_assert_int_eq(robot.nwarnings, 2);
    ck_assert_int_eq(robot.warnings[0].status, RBD_URDF_WARN_LIMIT);
    ck_assert_str_eq(robot.warnings[0].text, "joint 'right': held still at 3, beyond its limits -1 .. 2");
}
END_TEST

/* To hold it still is what the errors advise for a joint that cannot mimic. */
START_TEST(the_mimic_of_a_joint_held_still_is_not_read) {
    static room x;
    static const char *const texts[] = {"<mimic joint='gone'/>", "<mimic/>", "<mimic joint='j'/>",
                                        "<mimic joint='j' multiplier='x'/>"};
    const rbd_urdf_lock lock[] = {{"k", 0}, {NULL, 0}};
    const rbd_urdf_options options = {.lock = lock};
    for (size_t i = 0; i < 4; i++) {
        char text[900];
        snprintf(text, sizeof text,
                 ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") JOINT("j", "continuous", "a", "b", "")
                           JOINT("k", "floating", "b", "c", "%s")),
                 texts[i]);
        rbd_urdf robot = with_room(&x);
        ck_assert_int_lt(parse(&robot, text, NULL), 0);
        ck_assert_int_eq(parse(&robot, text, &options), RBD_URDF_OK);
        ck_assert_int_eq(robot.nb, 1);
        ck_assert_int_eq(robot.nwarnings, 0);
    }
}
END_TEST

START_TEST(locks_that_cannot_be_are_errors_by_name) {
    static room x;
    static const struct {
        rbd_urdf_lock lock[3];
        rbd_urdf_status status;
        const char *text;
    } cases[] = {
        {{{"Tern", 0}}, RBD_URDF_ERR_OPTION, "there is no joint 'Tern' to hold still; did you mean 'turn'?"},
        {{{"elbow", 0}}, RBD_URDF_ERR_OPTION, "there is no joint 'elbow' to hold still"},
        {{{"a", 0}},
         RBD_URDF_ERR_OPTION,
         "there is no joint 'a' to hold still; link 'a' hangs on joint 'ja'"},
        {{{"base", 0}}, RBD_URDF_ERR_OPTION, "there is no joint 'base' to hold still"},
        {{{"turn", 0}, {"turn", 1}}, RBD_URDF_ERR_OPTION, "joint 'turn' is to be held still twice"},
        {{{"turn", NAN}}, RBD_URDF_ERR_NUMBER, "joint 'turn': held still at nan, which is not finite"},
        {{{"slide", INFINITY}}, RBD_URDF_ERR_NUMBER, "joint 'slide': held still at inf, which is not finite"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const rbd_urdf_options options = {.lock = cases[i].lock};
        rbd_urdf robot = with_room(&x);
        ck_assert_int_eq(parse(&robot, lockable, &options), cases[i].status);
        ck_assert_str_eq(robot.error.text, cases[i].text);
    }
}
END_TEST

START_TEST(a_fixed_joint_may_be_held_at_zero_only) {
    static room x;
    static const char text[] = ROBOT(LINK("a") UNIT_LINK("b") UNIT_LINK("c") JOINT(
        "j", "continuous", "a", "b", "") JOINT("k", "fixed", "b", "c", ""));
    const rbd_urdf_lock zero[] = {{"k", 0}, {NULL, 0}}, other[] = {{"k", 1}, {NULL, 0}};
    rbd_urdf_options options = {.lock = zero};
    rbd_urdf robot = parsed(&x, text, &options);
    ck_assert_int_eq(robot.nwarnings, 0);
    options.lock = other;
    ck_assert_int_eq(parse(&robot, text, &options), RBD_URDF_ERR_OPTION);
}
END_TEST

START_TEST(a_joint_held_beyond_its_limits_gives_a_warning) {
    static room x;
    const rbd_urdf_lock lock[] = {{"turn", 2.25}, {"ja", 2}, {"jd", 9}, {NULL, 0}};
    const rbd_urdf_options options = {.lock = lock};
    rbd_urdf robot = parsed(&x, lockable, &options);
    ck_assert_int_eq(robot.nwarnings, 2); /* one is of an axis */
    ck_assert_str_eq(robot.warnings[1].text, "joint 'turn': held still at 2.25, beyond its limits -1 .. 2");
}
END_TEST

/* ---- a part of the robot ---- */

#define ARM(base) \
    base UNIT_LINK("hand") UNIT_LINK("left") UNIT_LINK("right") \
        JOINT("wrist", "revolute", "arm", "hand", LIMIT) JOINT("l", "prismatic", "hand", "left", LIMIT) \
            JOINT("r", "prismatic", "hand", "right", LIMIT "<mimic joint='l'/>")
static const char arm_alone[] = ROBOT(ARM(UNIT_LINK("arm")));
/* outside of the arm nothing is right, beside the names */
static const char arm_on_a_wreck[] =
    ROBOT(ARM(UNIT_LINK("base") UNIT_LINK("arm") "<link name='bolt'><inertial/></link>" LINK("other root"))
              JOINT("shoulder", "universal", "base", "arm", "") JOINT("l", "fixed", "base", "bolt", "")
                  JOINT("ring", "fixed", "bolt", "base", ""));

START_TEST(a_part_is_as_if_it_were_alone) {
    static room x, y;
    for (int floating = 0; floating < 2; floating++) {
        const rbd_joint_type root = floating ? RBD_FLOATING : RBD_FIXED;
        const rbd_urdf_options whole = {.root = root}, part = {.root = root, .root_link = "arm"};
        rbd_urdf alone = parsed(&x, arm_alone, &whole), taken = parsed(&y, arm_on_a_wreck, &part);
        ck_assert_int_eq(taken.nb, 3 + floating);
        ck_assert_int_eq(taken.nwarnings, 0);
        ck_assert_int_eq(taken.nframes, 4);
        ck_assert_uint_eq(taken.names_size, alone.names_size);
        ck_assert_mem_eq(y.names, x.names, alone.names_size);
        for (int i = 0; i < taken.nb; i++) { /* the strings lie elsewhere */
            rbd_body b = taken.bodies[i];
            b.name = alone.bodies[i].name, b.joint = alone.bodies[i].joint, b.mimic = alone.bodies[i].mimic;
            ck_assert_mem_eq(&b, &alone.bodies[i], sizeof b);
        }
    }
}
END_TEST

START_TEST(parts_that_cannot_be_are_errors_by_name) {
    static room x;
    static const struct {
        const char *text, *root, *keep[2];
        rbd_urdf_lock lock[2];
        rbd_urdf_status status;
        const char *error;
    } cases[] = {
        {arm_alone,
         "Hand_",
         {0},
         {{0}},
         RBD_URDF_ERR_OPTION,
         "there is no link 'Hand_' to be the root; did you mean 'hand'?"},
        {arm_alone, "elbow", {0}, {{0}}, RBD_URDF_ERR_OPTION, "there is no link 'elbow' to be the root"},
        {arm_alone,
         "hand",
         {"arm"},
         {{0}},
         RBD_URDF_ERR_OPTION,
         "there is no link 'arm' to keep on link 'hand'"},
        {arm_alone,
         "hand",
         {0},
         {{"wrist", 0}},
         RBD_URDF_ERR_OPTION,
         "there is no joint 'wrist' to hold still on link 'hand'"},
        {arm_alone, "left", {0}, {{0}}, RBD_URDF_ERR_ROBOT, NULL}, /* nothing moves */
        {"<sdf/>",
         "left",
         {0},
         {{0}},
         RBD_URDF_ERR_ROBOT,
         "<sdf> is not a robot of URDF, but of SDF, the format of Gazebo: export the robot as URDF from the "
         "program "
         "that wrote it"},
        /* it leads itself; on a part, what stands outside is not there */
        {ROBOT(UNIT_LINK("a") UNIT_LINK("b") JOINT("j", "continuous", "a", "b", "")
                   JOINT("k", "continuous", "b", "a", "")),
         "a",
         {0},
         {{0}},
         RBD_URDF_ERR_TREE,
         "link 'a' is its own ancestor: the joints form a cycle"},
        {ROBOT(UNIT_LINK("a") UNIT_LINK("b") UNIT_LINK("c") JOINT("j", "continuous", "a", "b", "")
                   JOINT("k", "continuous", "b", "c", "<mimic joint='j'/>")),
         "b",
         {0},
         {{0}},
         RBD_URDF_ERR_MIMIC,
         "joint 'k': it mimics 'j', which is missing; to hold it still: options.lock, rbd-model --lock 'k'; "
         "to let "
         "all such joints move freely: options.free_mimics, rbd-model --free-mimics"},
        /* what is misspelt may belong to the part */
        {ROBOT(UNIT_LINK("arm") UNIT_LINK("b") JOINT("j", "continuous", "Arm", "b", "")),
         "arm",
         {0},
         {{0}},
         RBD_URDF_ERR_JOINT,
         "joint 'j': its parent link 'Arm' is missing; did you mean 'arm'?"},
        {ROBOT(UNIT_LINK("arm") UNIT_LINK("b") "<joint name='j' type='fixed'><child link='b'/></joint>"),
         "arm",
         {0},
         {{0}},
         RBD_URDF_ERR_JOINT,
         "joint 'j': it has no <parent link=\"...\">"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const rbd_urdf_options options = {
            .root_link = cases[i].root, .keep = cases[i].keep, .lock = cases[i].lock};
        rbd_urdf robot = with_room(&x);
        ck_assert_int_eq(parse(&robot, cases[i].text, &options), cases[i].status);
        if (cases[i].error) ck_assert_str_eq(robot.error.text, cases[i].error);
    }
}
END_TEST

/* The advice of the error, followed. */
START_TEST(one_of_two_roots_can_be_taken) {
    static room x;
    static const char text[] =
        ROBOT(LINK("b") UNIT_LINK("a") LINK("lost") JOINT("j", "continuous", "b", "a", ""));
    const rbd_urdf_options options = {.root_link = "b"};
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, text, NULL), RBD_URDF_ERR_TREE);
    ck_assert_ptr_nonnull(strstr(robot.error.text, "rbd-model --root 'b'"));
    ck_assert_int_eq(parse(&robot, text, &options), RBD_URDF_OK);
    ck_assert_int_eq(robot.nb, 1);
    ck_assert_int_eq(robot.nframes, 2);
}
END_TEST

/* A joint without mass beyond is named with what holds it still; so held, the file is good. */
START_TEST(the_advice_for_a_joint_that_moves_no_mass_helps) {
    static room x;
    const rbd_urdf_lock lock[] = {{"cd", 0}, {"bc", 0}, {NULL, 0}};
    const rbd_urdf_options options = {.lock = lock};
    rbd_urdf robot = with_room(&x);
    ck_assert_int_eq(parse(&robot, massless, NULL), RBD_URDF_ERR_MODEL);
    ck_assert_ptr_nonnull(strstr(robot.error.text, "rbd-model --lock 'cd', or --lock-massless"));
    ck_assert_int_eq(parse(&robot, massless, &options), RBD_URDF_OK);
    ck_assert_int_eq(robot.nb, 2);
    ck_assert_int_eq(robot.nwarnings, 0);
}
END_TEST

/* ---- surroundings ---- */

START_TEST(a_comma_locale_changes_nothing) {
    static room x, y;
    rbd_urdf classic = parsed(&x, fixed_links, NULL), robot;
    comma_locale(); /* of C++, and of C where the system has one */
    robot = parsed(&y, fixed_links, NULL);
    classic_locale();
    for (int i = 0; i < classic.nb; i++) {
        ck_assert_double_eq(robot.bodies[i].mass, classic.bodies[i].mass);
        ck_assert_mem_eq(robot.bodies[i].position, classic.bodies[i].position, 3 * sizeof(double));
        ck_assert_mem_eq(robot.bodies[i].inertia, classic.bodies[i].inertia, 6 * sizeof(double));
    }
}
END_TEST

START_TEST(nothing_is_printed) {
    char path[] = "/tmp/rbd_urdf_XXXXXX", row[600], list[1000];
    const int saved = dup(2), file = mkstemp(path);
    FILE *expected;
    static room x;
    rbd_urdf robot = with_room(&x);
    snprintf(list, sizeof list, "%s", path_of("tests/urdf/broken", "expected.txt", ""));
    expected = fopen(list, "r");
    ck_assert(saved >= 0 && file >= 0 && expected);
    dup2(file, 2);
    while (fgets(row, sizeof row, expected))
        rbd_urdf_load(path_of("tests/urdf/broken", strtok(row, "|"), ""), NULL, &robot);
    parse(&robot, unreal, NULL);
    fflush(stderr);
    dup2(saved, 2);
    ck_assert_int_eq(lseek(file, 0, SEEK_END), 0);
    fclose(expected);
    close(file);
    close(saved);
    unlink(path);
}
END_TEST

int main(void) {
    Suite *suite = suite_create("urdf");
    TCase *c = tcase_create("urdf"), *large = tcase_create("large");
    SRunner *runner;
    int failed;
    tcase_set_timeout(c, 60);
    tcase_set_timeout(large, 60);
    tcase_add_loop_test(c, urdf_files_give_the_bits_of_the_tables, 0, TABLES);
    tcase_add_test(c, broken_files_give_the_sentence_expected);
    tcase_add_loop_test(c, errors_have_their_status, 0, (int)(sizeof kinds / sizeof *kinds));
    tcase_add_test(c, arguments_are_checked);
    tcase_add_loop_test(large, deep_nesting_is_an_error_and_no_crash, 0, 4);
    tcase_add_test(large, long_chains_are_no_crash);
    tcase_add_test(large, too_many_bodies_are_an_error);
    tcase_add_test(large, too_many_mimic_joints_are_an_error);
    tcase_add_test(large, chains_of_mimic_joints_end_at_the_one_that_leads);
    tcase_add_test(c, the_first_call_counts);
    tcase_add_test(c, nothing_is_found_in_what_was_not_filled);
    tcase_add_test(c, a_file_that_cannot_be_read_leaves_nothing_of_the_robot_before);
    tcase_add_test(c, the_order_is_that_of_the_file_but_parents_go_first);
    tcase_add_test(c, joints_keep_type_axis_limits_and_dynamics);
    tcase_add_test(c, mimic_joints_follow_through_others);
    tcase_add_test(c, fixed_links_are_merged_or_kept_with_the_same_dynamics);
    tcase_add_test(c, a_tool_frame_can_be_asked_for_by_name);
    tcase_add_test(c, a_planar_joint_moves_across_its_axis);
    tcase_add_test(c, inertias_are_turned_by_their_origin);
    tcase_add_test(c, a_floating_root_link_is_body_zero);
    tcase_add_test(c, geometry_and_extensions_are_left_unread);
    tcase_add_test(c, what_is_known_to_say_nothing_of_dynamics_gives_no_warning);
    tcase_add_test(c, slips_are_told_once_each_with_their_first_line);
    tcase_add_loop_test(c, no_slip_is_dropped, 0, sizeof names_read / sizeof *names_read);
    tcase_add_test(c, a_misspelt_link_is_told_before_it_is_missing);
    tcase_add_test(c, crosses_and_robots_without_mass_give_no_warning);
    tcase_add_test(c, links_that_no_real_body_is_like_give_warnings_by_name);
    tcase_add_test(c, limits_that_make_no_sense_are_none_with_a_warning);
    tcase_add_test(c, limits_that_are_not_used_give_no_warning_about_their_order);
    tcase_add_test(c, infinite_limits_are_none_with_a_warning);
    tcase_add_test(c, joints_that_move_no_mass_are_an_error_or_locked);
    tcase_add_test(c, a_joint_moves_the_mass_of_those_that_mimic_it);
    tcase_add_test(c, a_joint_that_moves_no_mass_with_those_that_mimic_it_gives_a_warning);
    tcase_add_test(c, a_joint_that_carries_only_joints_without_mass_gives_a_warning);
    tcase_add_test(c, a_robot_without_masses_is_told_how_to_be_read);
    tcase_add_test(c, a_robot_without_masses_is_read_for_kinematics);
    tcase_add_test(c, kinematic_changes_no_robot_with_masses);
    tcase_add_test(c, wrong_mimics_may_move_freely);
    tcase_add_test(c, mimics_without_their_prefix_are_named_at_once);
    tcase_add_test(c, quaternions_turn_joints_and_inertias);
    tcase_add_test(c, later_versions_of_urdf_are_read);
    tcase_add_test(c, text_in_utf16_is_read);
    tcase_add_test(c, text_in_utf32_is_named);
    tcase_add_test(c, pairs_of_utf16_are_characters);
    tcase_add_loop_test(c, other_formats_are_named, 0, sizeof formats / sizeof *formats);
    tcase_add_test(c, a_binary_mesh_is_named);
    tcase_add_test(c, a_second_free_joint_is_told);
    tcase_add_loop_test(c, sources_of_xacro_are_told_from_leftovers, 0, sizeof xacros / sizeof *xacros);
    tcase_add_test(c, odd_files_give_the_warning_expected);
    tcase_add_loop_test(c, what_looks_like_degrees_gives_a_warning, 0, sizeof degrees / sizeof *degrees);
    tcase_add_test(c, a_joint_held_still_at_degrees_gives_a_warning);
    tcase_add_test(c, a_robot_without_a_name_is_called_robot);
    tcase_add_test(c, axes_of_any_length_are_made_unit_vectors);
    tcase_add_test(c, fixed_joints_have_no_axis);
    tcase_add_test(c, a_joint_that_mimics_by_zero_stands_at_its_offset);
    tcase_add_loop_test(c, joints_held_still_are_as_at_rest_there, 0, 2);
    tcase_add_test(c, a_quarter_turn_is_exact);
    tcase_add_test(c, joints_of_several_degrees_of_freedom_are_held_at_neutral);
    tcase_add_test(c, what_mimics_a_joint_held_still_is_held_too);
    tcase_add_test(c, the_mimic_of_a_joint_held_still_is_not_read);
    tcase_add_test(c, locks_that_cannot_be_are_errors_by_name);
    tcase_add_test(c, a_fixed_joint_may_be_held_at_zero_only);
    tcase_add_test(c, a_joint_held_beyond_its_limits_gives_a_warning);
    tcase_add_test(c, a_part_is_as_if_it_were_alone);
    tcase_add_test(c, parts_that_cannot_be_are_errors_by_name);
    tcase_add_test(c, one_of_two_roots_can_be_taken);
    tcase_add_test(c, the_advice_for_a_joint_that_moves_no_mass_helps);
    tcase_add_test(c, a_comma_locale_changes_nothing);
    tcase_add_test(c, nothing_is_printed);
    suite_add_tcase(suite, c);
    suite_add_tcase(suite, large);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
