/* rbd_mjcf.h - a robot's MJCF file as the description that rbd_model_build takes, on MuJoCo's library.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   For programs on a PC; firmware takes the C tables that the command rbd-model writes. MuJoCo itself compiles
   the file, with its defaults, includes, meshes and inertias. ONE file of the program, C or C++, linked with
   MuJoCo (2.2.2 or newer: Debian's libmujoco-dev), says

       #define RBD_MJCF_IMPLEMENTATION
       #include "rbd_mjcf.h"

   and everything else includes it plainly. The program implements rbd.h, for double, there or elsewhere.
   Meson builds that file as the library rbd_mjcf. A model from a file:

       static rbd_body bodies[100]; static char names[10000];
       rbd_mjcf robot = {.bodies = bodies, .bodies_max = 100, .names = names, .names_max = sizeof names};
       if (rbd_mjcf_load("robot.xml", NULL, &robot) != RBD_MJCF_OK) puts(robot.error.text);
       rbd_model_build(robot.bodies, robot.nb, memory, sizeof memory, &model, NULL);
       rbd_set_gravity(work, robot.gravity);

   CONTENTS (search for the tag)
     [reading] [coordinates] [options] [status] [robot] [calls] [states]
     --- stop here if you only use it ---
     [load] [findings] [names] [poses] [masses] [rows] [frames] [mimics] [held] [constraints] [left out]
     [result] [compiler] [functions]

   [reading] How an MJCF file becomes a description:
     order        MuJoCo's order of bodies and joints; q and v follow it
     free joint   RBD_FLOATING on the world
     ball         RBD_SPHERICAL
     hinge        RBD_REVOLUTE, without limits RBD_CONTINUOUS
     slide        RBD_PRISMATIC
     no joint     the body is merged into the one that carries it, or kept as a body of type RBD_FIXED
     several joints of one body: all but the last move links without mass, called JOINT_link
     frames       a body has MuJoCo's frame. If its last joint turns about a point that is not the body's
                  origin, the joint moves a link JOINT_link there, and the body is fixed on it (RBD_FIXED)
     names        of joints and bodies; one without is called joint_N or body_N, by MuJoCo's number, and an
                  equality connect_N or weld_N
     sites        are listed as frames, and can be kept as bodies of type RBD_FIXED
     effort       of a joint: the least of actuatorfrcrange and of what its actuators can exert: their
                  forcerange, or for motors ctrlrange times gain, times gear
     equality     joint with polycoef "a b 0 0 0": the joint mimics the other one; without another joint, or
                  with b = 0, it is held still. connect and weld: constraints for rbd_constraint_set_init,
                  with gains of solref: kp = 1/(timeconst dampratio)^2, kd = 2/timeconst. They are rigid:
                  solimp is not read
     gravity      of the file, 0 if its flag is off
     Geometry is read by MuJoCo, for masses alone. What rbd has no place for gives a warning that names it:
     springs, gravcomp, limits of ball joints, tendons, actuators that are more than a torque at a joint,
     flexes, plugins, a medium, equalities of other types. With options.strict it is an error.

   [coordinates] MuJoCo's qpos, qvel and rbd's q, v differ in this, and [states] converts them:
     quaternions  MuJoCo w x y z, rbd x y z w
     free joint   qpos = (position, quaternion), q likewise; qvel = (velocity of the origin in world axes;
                  omega in body axes), v = (omega; velocity of the origin), both in body axes
     hinge, slide equal, with ref too; one that mimics or is held is in qpos and not in q
     acceleration of a free joint: with w = omega, u = velocity in body axes, and R from body to world,
                  MuJoCo's linear part is R (a_u + w x u), a_u being that of rbd

   Called with bodies and names NULL, loading only counts: robot.nb, robot.names_size, robot.nframes,
   robot.nconstraints and robot.nwarnings say how long the arrays must be for the second call.

   An error says what is wrong, as MuJoCo's compiler does. One call at a time: MuJoCo's handlers of errors and
   warnings, which a call replaces and puts back, are global.
*/
#ifndef RBD_MJCF_H
#define RBD_MJCF_H

#include "rbd_constraints.h"

struct mjModel_; /* MuJoCo's mjModel */

#ifdef __cplusplus
extern "C" {
#endif

/* ---- options [options] ---- */

/* A joint to be held still. */
typedef struct rbd_mjcf_lock {
    const char *joint;
    double value; /* rad or m, as in qpos; of a ball or free joint 0, which is q of rbd_neutral */
} rbd_mjcf_lock;

/* How to read. NULL, or all zero, is the file as it is. */
typedef struct rbd_mjcf_options {
    const double *gravity; /* 3, world frame, m/s^2, copied to the result; NULL = the file's */
    const char *const
        *keep;       /* names of bodies without joints, or of sites, to keep as bodies, ended by NULL */
    int keep_all;    /* keep all bodies without joints */
    int free_mimics; /* joints of an equality move freely, with a warning */
    int strict;      /* warnings are errors */
    const rbd_mjcf_lock *lock; /* joints to hold still, ended by joint = NULL; NULL = none */
} rbd_mjcf_options;

/* ---- status [status] ---- */

/* Result of loading: 0, or a negative error; with options.strict also a warning's, which are positive. */
typedef enum rbd_mjcf_status {
    RBD_MJCF_OK = 0,
    RBD_MJCF_ERR_NULL = -1,     /* a required pointer is NULL */
    RBD_MJCF_ERR_OPTION = -2,   /* an option has no such value, or names what is not there */
    RBD_MJCF_ERR_FILE = -3,     /* the file cannot be read */
    RBD_MJCF_ERR_ROOM = -4,     /* an array is too short: the counts say how long they must be */
    RBD_MJCF_ERR_MEMORY = -5,   /* out of memory */
    RBD_MJCF_ERR_COMPILER = -6, /* MuJoCo's compiler refuses it */
    RBD_MJCF_ERR_ROBOT = -7,    /* nothing moves */
    RBD_MJCF_ERR_MODEL = -8,    /* rbd_model_build would refuse it */
    RBD_MJCF_ERR_LIBRARY = -9,  /* MuJoCo's library is of another version than its header */
    RBD_MJCF_WARN_ACTUATOR = 1, /* an actuator is more than a torque at a joint */
    RBD_MJCF_WARN_TENDON = 2,   /* tendons are left out */
    RBD_MJCF_WARN_FORCE = 3,    /* springs, gravcomp or a medium are left out */
    RBD_MJCF_WARN_LIMIT = 4,    /* limits of a ball joint are left out */
    RBD_MJCF_WARN_EQUALITY = 5, /* an equality is left out */
    RBD_MJCF_WARN_ARMATURE = 6, /* of a free joint: it differs in the bias */
    RBD_MJCF_WARN_MOCAP = 7,    /* a mocap body is read as fixed to the world */
    RBD_MJCF_WARN_LEFT_OUT = 8, /* flexes and plugins are left out */
    RBD_MJCF_WARN_LOCKED = 9,   /* an equality holds a joint still */
    RBD_MJCF_WARN_MODEL = 10,   /* a warning of rbd_model_build */
    RBD_MJCF_WARN_COMPILER = 11 /* a warning of MuJoCo's compiler */
} rbd_mjcf_status;

/* A status in a few English words; a static string. */
const char *rbd_mjcf_status_string(rbd_mjcf_status status);

/* An error or a warning. */
typedef struct rbd_mjcf_finding {
    rbd_mjcf_status status;
    int line;       /* of the file, from 1; 0 = none in particular */
    char text[400]; /* a sentence, cut to fit */
} rbd_mjcf_finding;

/* ---- robot [robot] ---- */

/* A body of the file, a link between two of its joints, or a site, and where it is on the description. */
typedef struct rbd_mjcf_frame {
    const char *link;
    const char *joint;  /* that carries it, NULL: it is the world */
    int parent;         /* index of the frame that carries it, -1: it is the world */
    int body;           /* index of the body that it is, or is merged into; -1 = the world */
    double position[3]; /* of its origin in that body's frame */
    double rotation[9]; /* 3 x 3, turns its vectors into that body's */
} rbd_mjcf_frame;

/* Where MuJoCo has the joint of a body. */
typedef struct rbd_mjcf_place {
    int qpos; /* index of its first coordinate in qpos, -1: the body's joint is fixed */
    int dof;  /* of its first velocity in qvel */
} rbd_mjcf_place;

/* The caller's arrays, and what loading puts there. bodies and names both NULL: nothing is written, only the
   counts are set, and warnings. Another array NULL: not asked for. */
typedef struct rbd_mjcf {
    rbd_body *bodies; /* the description; its strings lie in names */
    int bodies_max;
    char *names;
    size_t names_max;
    rbd_mjcf_frame *frames; /* the world first, then bodies in MuJoCo's order, sites last */
    int frames_max;
    rbd_mjcf_place *places; /* one for each body of the description; the calls of [states] need them */
    int places_max;
    rbd_constraint *constraints; /* connect and weld */
    int constraints_max;
    rbd_mjcf_finding *warnings; /* those beyond warnings_max are counted only */
    int warnings_max;
    /* results: */
    const char *name; /* of the model; in names */
    int nb;           /* bodies, and places */
    int nframes;
    int nconstraints;
    int nwarnings;
    int nqpos, nqvel;       /* lengths of MuJoCo's qpos and qvel */
    size_t names_size;      /* bytes of names */
    double gravity[3];      /* for rbd_set_gravity */
    double fixed_mass;      /* kg, of the bodies that are fixed to the world: in no body */
    rbd_mjcf_finding error; /* its status is what the call returned */
} rbd_mjcf;

/* ---- calls [calls] ---- */

/* Loads a file.
   path      of the MJCF file; what it includes is found from there
   options   may be NULL
   robot     the caller's arrays; receives the description
   Errors: all of rbd_mjcf_status; robot->error has the sentence. */
rbd_mjcf_status rbd_mjcf_load(const char *path, const rbd_mjcf_options *options, rbd_mjcf *robot);

/* The same from text in memory: length bytes, need not end with 0. Files that it names are found from the
   working folder. */
rbd_mjcf_status rbd_mjcf_parse(const char *text, size_t length, const rbd_mjcf_options *options,
                               rbd_mjcf *robot);

/* The same from a model that MuJoCo has compiled, an mjModel, for programs that have one. */
rbd_mjcf_status rbd_mjcf_convert(const struct mjModel_ *model, const rbd_mjcf_options *options,
                                 rbd_mjcf *robot);

/* ---- states [states] ----
   States of MuJoCo as states of the built model, and back. robot: as loaded, with bodies, names and places.
   The arrays are of double and do not overlap. Nothing happens without places. */

/* Coordinates: q from qpos. Those of joints that mimic or are held are not read. */
void rbd_mjcf_q_of_qpos(const rbd_mjcf *robot, const double *qpos, double *q);

/* Velocities: v from qvel. qpos gives the rotation of a free joint. */
void rbd_mjcf_v_of_qvel(const rbd_mjcf *robot, const double *qpos, const double *qvel, double *v);

/* Coordinates: qpos from q. Those of joints that mimic follow; those of held joints stay as they are. */
void rbd_mjcf_qpos_of_q(const rbd_mjcf *robot, const double *q, double *qpos);

/* Velocities: qvel from v, qpos as from rbd_mjcf_qpos_of_q. Those of held joints stay as they are. */
void rbd_mjcf_qvel_of_v(const rbd_mjcf *robot, const double *qpos, const double *v, double *qvel);

#ifdef __cplusplus
}
#endif

#endif /* RBD_MJCF_H */

/* ====================================================================================================
   Implementation
   ================================================================================================= */

#if defined RBD_MJCF_IMPLEMENTATION && !defined RBDI_MJCF_IMPLEMENTED
#define RBDI_MJCF_IMPLEMENTED

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <mujoco/mujoco.h>

/* What newer versions of MuJoCo call otherwise. 2.2.2 is 222, 3.4.0 is 340, 3.5.0 is 3005000. */
#if mjVERSION_HEADER >= 300
#define RBDI_MJCF_EQ_ACTIVE eq_active0
#else
#define RBDI_MJCF_EQ_ACTIVE eq_active
#endif
#if mjVERSION_HEADER >= 3011000
#define RBDI_MJCF_ACTUATORS(m) ((int)(m)->nactuator)
#define RBDI_MJCF_GEAR(m, i) ((m)->actuator_gear + 6 * (m)->actuator_outadr[i])
#define RBDI_MJCF_CTRL(m, i) ((m)->actuator_ctrladr[i])
#else
#define RBDI_MJCF_ACTUATORS(m) ((int)(m)->nu)
#define RBDI_MJCF_GEAR(m, i) ((m)->actuator_gear + 6 * (i))
#define RBDI_MJCF_CTRL(m, i) (i)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- load [load] ---- */

typedef struct rbdi_mjcf_pose {
    double R[9], p[3];
} rbdi_mjcf_pose;

/* A row of the description. Strings are places in rbdi_mjcf_load.names, 0 = none. */
typedef struct rbdi_mjcf_row {
    rbd_body body;
    size_t name, joint, mimic;
    rbd_mjcf_place place;
} rbdi_mjcf_row;

typedef struct rbdi_mjcf_item {
    size_t link, joint;
    int parent, body;
    rbdi_mjcf_pose at;
} rbdi_mjcf_item;

/* How a joint follows another: q = ratio q_leader + offset; a ratio of 0 holds it still. */
typedef struct rbdi_mjcf_follow {
    int is_set;
    int leader; /* MuJoCo's joint */
    double ratio, offset;
} rbdi_mjcf_follow;

/* One load. After the first error, which stays, every step does nothing. */
typedef struct rbdi_mjcf_load {
    const mjModel *m;
    const rbd_mjcf_options *options;
    rbdi_mjcf_row *rows;
    int nb;
    rbdi_mjcf_item *frames;
    int nframes;
    rbd_constraint *constraints;
    size_t *constraint_names;
    int nconstraints;
    char *names;
    size_t names_size, names_room;
    rbd_mjcf_finding *warnings;
    int nwarnings, warnings_room;
    rbd_mjcf_finding error;
    double fixed_mass;
    /* of MuJoCo's bodies: name, row (-1 = the world), pose in that row's frame, frame */
    size_t *link_name;
    int *row_of;
    rbdi_mjcf_pose *pose_of;
    int *frame_of;
    /* of MuJoCo's joints */
    size_t *joint_name;
    int *row_of_joint;
    rbdi_mjcf_follow *follow;
    unsigned char *held;
    double *held_at;
} rbdi_mjcf_load;

static int rbdi_mjcf_is_ok(const rbdi_mjcf_load *l) { return l->error.status == RBD_MJCF_OK; }

/* ---- findings [findings] ---- */

/* The line of the file that a message of MuJoCo's names, in one of its three ways; 0: none. */
static int rbdi_mjcf_line(const char *text) {
    static const char *const marks[] = {"line ", "line = ", "Line number="};
    int number = 0;
    for (size_t i = 0; i < sizeof marks / sizeof *marks && number <= 0; i++) {
        const char *mark = strstr(text, marks[i]);
        if (mark) number = atoi(mark + strlen(marks[i]));
    }
    return number > 0 ? number : 0;
}

/* Writes a sentence: MuJoCo's have several lines, with spaces. */
static void rbdi_mjcf_write(rbd_mjcf_finding *f, rbd_mjcf_status status, const char *format,
                            va_list arguments) {
    char *to = f->text;
    f->status = status;
    vsnprintf(f->text, sizeof f->text, format, arguments);
    for (const char *c = f->text; *c; c++) {
        const int is_space = *c == '\n' || *c == '\r' || *c == ' ';
        if (!is_space) *to++ = *c;
        if (is_space && to > f->text && to[-1] != ' ') *to++ = ' ';
    }
    if (to > f->text && to[-1] == ' ') to--;
    *to = 0;
    f->line = rbdi_mjcf_line(f->text);
}

static void rbdi_mjcf_fail(rbdi_mjcf_load *l, rbd_mjcf_status status, const char *format, ...) {
    va_list arguments;
    if (!rbdi_mjcf_is_ok(l)) return;
    va_start(arguments, format);
    rbdi_mjcf_write(&l->error, status, format, arguments);
    va_end(arguments);
    if (status != RBD_MJCF_ERR_COMPILER) l->error.line = 0;
}

/* Memory that the load owns, zeroed; NULL after an error. */
static void *rbdi_mjcf_memory(rbdi_mjcf_load *l, int n, size_t size) {
    void *memory = calloc((size_t)n + 1, size);
    if (!memory) rbdi_mjcf_fail(l, RBD_MJCF_ERR_MEMORY, "out of memory");
    return memory;
}

static void rbdi_mjcf_warn(rbdi_mjcf_load *l, rbd_mjcf_status status, const char *format, ...) {
    va_list arguments;
    if (l->nwarnings == l->warnings_room) {
        const int room = 2 * l->warnings_room + 16;
        void *larger = realloc(l->warnings, (size_t)room * sizeof *l->warnings);
        if (!larger) {
            rbdi_mjcf_fail(l, RBD_MJCF_ERR_MEMORY, "out of memory");
            return;
        }
        l->warnings = (rbd_mjcf_finding *)larger;
        l->warnings_room = room;
    }
    va_start(arguments, format);
    rbdi_mjcf_write(&l->warnings[l->nwarnings], status, format, arguments);
    va_end(arguments);
    if (status != RBD_MJCF_WARN_COMPILER) l->warnings[l->nwarnings].line = 0;
    l->nwarnings++;
}

/* ---- names [names] ---- */

static const char *rbdi_mjcf_text(const rbdi_mjcf_load *l, size_t name) { return l->names + name; }

/* Puts a and b behind each other, and underscores behind them; returns the place, 0 after an error. */
static size_t rbdi_mjcf_put(rbdi_mjcf_load *l, const char *a, const char *b, size_t underscores) {
    const size_t at = l->names_size, length = strlen(a) + strlen(b) + underscores + 1;
    if (at + length > l->names_room) {
        const size_t room = 2 * (at + length) + 1000;
        char *larger = (char *)realloc(l->names, room);
        if (!larger) {
            rbdi_mjcf_fail(l, RBD_MJCF_ERR_MEMORY, "out of memory");
            return 0;
        }
        l->names = larger;
        l->names_room = room;
    }
    strcpy(l->names + at, a);
    strcat(l->names + at, b);
    memset(l->names + at + length - 1 - underscores, '_', underscores);
    l->names[at + length - 1] = 0;
    l->names_size += length;
    return at;
}

static int rbdi_mjcf_is_one_of(const rbdi_mjcf_load *l, const char *text, const size_t *names, int n) {
    for (int i = 0; i < n; i++)
        if (names[i] && strcmp(rbdi_mjcf_text(l, names[i]), text) == 0) return 1;
    return 0;
}

static int rbdi_mjcf_is_link(const rbdi_mjcf_load *l, const char *text) {
    if (rbdi_mjcf_is_one_of(l, text, l->link_name, (int)l->m->nbody)) return 1;
    for (int i = 0; i < l->nframes; i++)
        if (strcmp(rbdi_mjcf_text(l, l->frames[i].link), text) == 0) return 1;
    return 0;
}

static int rbdi_mjcf_is_joint(const rbdi_mjcf_load *l, const char *text) {
    if (rbdi_mjcf_is_one_of(l, text, l->joint_name, (int)l->m->njnt)) return 1;
    for (int i = 0; i < l->nframes; i++)
        if (strcmp(rbdi_mjcf_text(l, l->frames[i].joint), text) == 0) return 1;
    return 0;
}

/* A new name made of two parts, and of underscores if it is taken. */
static size_t rbdi_mjcf_new_name(rbdi_mjcf_load *l, const char *a, const char *b,
                                 int (*is_taken)(const rbdi_mjcf_load *, const char *)) {
    char *first = (char *)malloc(strlen(a) + 1); /* a may lie in names, which move */
    size_t at = 0;
    if (!first) {
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_MEMORY, "out of memory");
        return 0;
    }
    strcpy(first, a);
    for (size_t underscores = 0; rbdi_mjcf_is_ok(l); underscores++) {
        const size_t before = l->names_size;
        at = rbdi_mjcf_put(l, first, b, underscores);
        if (!at || !is_taken(l, rbdi_mjcf_text(l, at))) break;
        l->names_size = before;
    }
    free(first);
    return at;
}

static void rbdi_mjcf_name_numbered(rbdi_mjcf_load *l, const char *kind, int number, size_t *name,
                                    int (*is_taken)(const rbdi_mjcf_load *, const char *)) {
    char text[20];
    snprintf(text, sizeof text, "%d", number);
    *name = rbdi_mjcf_new_name(l, kind, text, is_taken);
}

/* Names of the model, of all bodies and of all joints; place 0 is the empty name. */
static void rbdi_mjcf_name_all(rbdi_mjcf_load *l) {
    const mjModel *m = l->m;
    rbdi_mjcf_put(l, "", "", 0);
    rbdi_mjcf_put(l, m->names, "", 0);
    for (int i = 0; i < m->nbody; i++) {
        const char *name = m->names + m->name_bodyadr[i];
        if (*name) l->link_name[i] = rbdi_mjcf_put(l, name, "", 0);
    }
    for (int i = 0; i < m->njnt; i++) {
        const char *name = m->names + m->name_jntadr[i];
        if (*name) l->joint_name[i] = rbdi_mjcf_put(l, name, "", 0);
    }
    for (int i = 0; i < m->nbody; i++)
        if (!l->link_name[i]) rbdi_mjcf_name_numbered(l, "body_", i, &l->link_name[i], rbdi_mjcf_is_link);
    for (int i = 0; i < m->njnt; i++)
        if (!l->joint_name[i]) rbdi_mjcf_name_numbered(l, "joint_", i, &l->joint_name[i], rbdi_mjcf_is_joint);
}

/* ---- poses [poses] ---- */

static void rbdi_mjcf_turn(const double R[9], const double v[3], double out[3]) {
    const double a = v[0], b = v[1], c = v[2];
    for (int i = 0; i < 3; i++) out[i] = R[3 * i] * a + R[3 * i + 1] * b + R[3 * i + 2] * c;
}

static void rbdi_mjcf_multiply(const double A[9], const double B[9], double out[9]) {
    double C[9];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
    memcpy(out, C, sizeof C);
}

/* An entry that differs from 0, 1 or -1 by rounding alone becomes that number. */
static void rbdi_mjcf_snap(double R[9]) {
    for (int i = 0; i < 9; i++)
        if (fabs(R[i] - floor(R[i] + 0.5)) <= 1e-15) R[i] = floor(R[i] + 0.5) + 0.0;
}

/* The matrix of a unit quaternion w x y z. */
static void rbdi_mjcf_matrix(const mjtNum quat[4], double R[9]) {
    const double w = quat[0], x = quat[1], y = quat[2], z = quat[3];
    R[0] = 1 - 2 * (y * y + z * z);
    R[1] = 2 * (x * y - w * z);
    R[2] = 2 * (x * z + w * y);
    R[3] = 2 * (x * y + w * z);
    R[4] = 1 - 2 * (x * x + z * z);
    R[5] = 2 * (y * z - w * x);
    R[6] = 2 * (x * z - w * y);
    R[7] = 2 * (y * z + w * x);
    R[8] = 1 - 2 * (x * x + y * y);
    rbdi_mjcf_snap(R);
}

static rbdi_mjcf_pose rbdi_mjcf_shift(double x, double y, double z) {
    rbdi_mjcf_pose X = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    X.p[0] = x + 0.0; /* no -0 */
    X.p[1] = y + 0.0;
    X.p[2] = z + 0.0;
    return X;
}

static rbdi_mjcf_pose rbdi_mjcf_pose_of(const mjtNum pos[3], const mjtNum quat[4]) {
    rbdi_mjcf_pose X = rbdi_mjcf_shift(pos[0], pos[1], pos[2]);
    rbdi_mjcf_matrix(quat, X.R);
    return X;
}

static int rbdi_mjcf_is_turned(const double R[9]) {
    for (int i = 0; i < 9; i++)
        if (R[i] != (i % 4 == 0)) return 1;
    return 0;
}

/* Pose b within pose a. */
static rbdi_mjcf_pose rbdi_mjcf_compose(const rbdi_mjcf_pose *a, const rbdi_mjcf_pose *b) {
    rbdi_mjcf_pose c = *b;
    if (rbdi_mjcf_is_turned(a->R)) {
        rbdi_mjcf_multiply(a->R, b->R, c.R);
        rbdi_mjcf_snap(c.R);
        rbdi_mjcf_turn(a->R, b->p, c.p);
    }
    for (int i = 0; i < 3; i++) c.p[i] += a->p[i];
    return c;
}

/* A turn about a unit axis n: R = cos 1 + sin [n]x + (1 - cos) n n' (Rodrigues). */
static rbdi_mjcf_pose rbdi_mjcf_turned(const mjtNum n[3], double angle) {
    rbdi_mjcf_pose X = rbdi_mjcf_shift(0, 0, 0);
    const double c = cos(angle), s = sin(angle);
    const double cross[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
    for (int i = 0; i < 9; i++) X.R[i] = c * (i % 4 == 0) + s * cross[i] + (1 - c) * n[i / 3] * n[i % 3];
    rbdi_mjcf_snap(X.R);
    return X;
}

/* ---- masses [masses] ---- */

/* Inertia xx xy xz yy yz zz of a body of this mass about a point that is d from its centre of mass. */
static void rbdi_mjcf_add_steiner(double I[6], double mass, const double d[3]) {
    I[0] += mass * (d[1] * d[1] + d[2] * d[2]);
    I[1] -= mass * d[0] * d[1];
    I[2] -= mass * d[0] * d[2];
    I[3] += mass * (d[0] * d[0] + d[2] * d[2]);
    I[4] -= mass * d[1] * d[2];
    I[5] += mass * (d[0] * d[0] + d[1] * d[1]);
}

/* R diag(D) R' */
static void rbdi_mjcf_inertia(const double R[9], const mjtNum D[3], double I[6]) {
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < 6; k++) {
        const double *a = R + 3 * row[k], *b = R + 3 * column[k];
        I[k] = a[0] * D[0] * b[0] + a[1] * D[1] * b[1] + a[2] * D[2] * b[2];
    }
}

/* Adds the mass of MuJoCo's body to the row that it belongs to. */
static void rbdi_mjcf_add_mass(rbdi_mjcf_load *l, int body) {
    const mjModel *m = l->m;
    const double mass = m->body_mass[body];
    rbdi_mjcf_pose at = rbdi_mjcf_pose_of(m->body_ipos + 3 * body, m->body_iquat + 4 * body);
    rbd_body *to;
    double inertia[6], com[3], d[3];
    if (l->row_of[body] < 0) return;
    to = &l->rows[l->row_of[body]].body;

    at = rbdi_mjcf_compose(&l->pose_of[body], &at);
    rbdi_mjcf_inertia(at.R, m->body_inertia + 3 * body, inertia);
    if (to->mass == 0) {
        if (mass > 0) memcpy(to->com, at.p, sizeof at.p);
        to->mass = mass;
        for (int i = 0; i < 6; i++) to->inertia[i] += inertia[i];
        return;
    }

    for (int i = 0; i < 3; i++) com[i] = (to->mass * to->com[i] + mass * at.p[i]) / (to->mass + mass);
    for (int i = 0; i < 3; i++) d[i] = to->com[i] - com[i];
    rbdi_mjcf_add_steiner(to->inertia, to->mass, d);
    for (int i = 0; i < 3; i++) d[i] = at.p[i] - com[i];
    rbdi_mjcf_add_steiner(to->inertia, mass, d);
    for (int i = 0; i < 6; i++) to->inertia[i] += inertia[i];
    memcpy(to->com, com, sizeof com);
    to->mass += mass;
}

/* ---- rows [rows] ---- */

static int rbdi_mjcf_add_row(rbdi_mjcf_load *l, rbd_joint_type type, int parent, const rbdi_mjcf_pose *at) {
    rbdi_mjcf_row *r = &l->rows[l->nb];
    r->body.type = type;
    r->body.parent = parent;
    memcpy(r->body.position, at->p, sizeof at->p);
    memcpy(r->body.rotation, at->R, sizeof at->R);
    r->place.qpos = -1;
    r->place.dof = -1;
    return l->nb++;
}

static double rbdi_mjcf_largest(const mjtNum range[2]) { return fmax(fabs(range[0]), fabs(range[1])); }

/* The largest force of an actuator before its gear, 0 = unlimited or unknown. */
static double rbdi_mjcf_force(const mjModel *m, int a) {
    const int is_motor = m->actuator_gaintype[a] == mjGAIN_FIXED && m->actuator_biastype[a] == mjBIAS_NONE &&
                         m->actuator_dyntype[a] == mjDYN_NONE;
    const int ctrl = RBDI_MJCF_CTRL(m, a);
    double force = 0;
    if (is_motor && m->actuator_ctrllimited[ctrl])
        force = fabs(m->actuator_gainprm[a * mjNGAIN]) * rbdi_mjcf_largest(m->actuator_ctrlrange + 2 * ctrl);
    if (m->actuator_forcelimited[a]) {
        const double limit = rbdi_mjcf_largest(m->actuator_forcerange + 2 * a);
        if (force == 0 || limit < force) force = limit;
    }
    return force;
}

static int rbdi_mjcf_is_at_joint(const mjModel *m, int actuator) {
    const int type = m->actuator_trntype[actuator];
    return type == mjTRN_JOINT || type == mjTRN_JOINTINPARENT;
}

/* The effort limit of a joint: what all of its actuators can exert together; 0 = none. */
static double rbdi_mjcf_effort(const mjModel *m, int joint) {
    double effort = 0;
    int unlimited = 0;
    for (int a = 0; a < RBDI_MJCF_ACTUATORS(m); a++) {
        double force;
        if (!rbdi_mjcf_is_at_joint(m, a) || m->actuator_trnid[2 * a] != joint) continue;
        force = rbdi_mjcf_force(m, a) * fabs(RBDI_MJCF_GEAR(m, a)[0]);
        effort += force;
        unlimited = unlimited || force == 0;
    }
    if (unlimited) effort = 0;
#if mjVERSION_HEADER >= 237
    if (m->jnt_actfrclimited[joint]) {
        const double limit = rbdi_mjcf_largest(m->jnt_actfrcrange + 2 * joint);
        if (effort == 0 || limit < effort) effort = limit;
    }
#endif
    return effort;
}

static rbd_joint_type rbdi_mjcf_type(const mjModel *m, int joint) {
    switch (m->jnt_type[joint]) {
    case mjJNT_FREE: return RBD_FLOATING;
    case mjJNT_BALL: return RBD_SPHERICAL;
    case mjJNT_SLIDE: return RBD_PRISMATIC;
    default: return m->jnt_limited[joint] ? RBD_REVOLUTE : RBD_CONTINUOUS;
    }
}

static int rbdi_mjcf_is_single(const mjModel *m, int joint) {
    return m->jnt_type[joint] == mjJNT_SLIDE || m->jnt_type[joint] == mjJNT_HINGE;
}

/* Limits, damping, friction and armature. Of a free joint rbd has angles first. */
static void rbdi_mjcf_fill_joint(const mjModel *m, int joint, rbd_body *b) {
    const int first = m->jnt_dofadr[joint];
    const int n = rbdi_mjcf_is_single(m, joint) ? 1 : b->type == RBD_FLOATING ? 6 : 3;
    for (int i = 0; i < n; i++) {
        const int dof = first + (n == 6 ? (i + 3) % 6 : i);
        b->armature[i] = m->dof_armature[dof];
        b->damping[i] = m->dof_damping[dof];
        b->friction[i] = m->dof_frictionloss[dof];
    }
    if (n > 1) return;
    for (int i = 0; i < 3; i++) b->axis[i] = m->jnt_axis[3 * joint + i];
    if (m->jnt_limited[joint]) {
        b->lower = m->jnt_range[2 * joint];
        b->upper = m->jnt_range[2 * joint + 1];
    }
    b->effort = rbdi_mjcf_effort(m, joint);
}

/* Adds the row that a joint moves. X: pose of the body's frame in the row `parent` with this joint at its
   reference; after it, in the new row. The joint's own frame is turned or shifted back by ref, so that q is
   qpos. */
static int rbdi_mjcf_add_joint(rbdi_mjcf_load *l, int joint, int parent, rbdi_mjcf_pose *X) {
    const mjModel *m = l->m;
    const int type = m->jnt_type[joint];
    const mjtNum *axis = m->jnt_axis + 3 * joint, *anchor = m->jnt_pos + 3 * joint;
    const double ref = m->qpos0[m->jnt_qposadr[joint]];
    rbdi_mjcf_pose there = rbdi_mjcf_shift(0, 0, 0), back = there;
    int row;
    if (type == mjJNT_HINGE) there = rbdi_mjcf_turned(axis, -ref);
    if (type == mjJNT_SLIDE) there = rbdi_mjcf_shift(-ref * axis[0], -ref * axis[1], -ref * axis[2]);
    if (type == mjJNT_HINGE || type == mjJNT_BALL) {
        for (int i = 0; i < 3; i++) there.p[i] = anchor[i];
        back = rbdi_mjcf_shift(-anchor[0], -anchor[1], -anchor[2]);
    }

    there = type == mjJNT_FREE ? rbdi_mjcf_shift(0, 0, 0) : rbdi_mjcf_compose(X, &there);
    row = rbdi_mjcf_add_row(l, rbdi_mjcf_type(m, joint), parent, &there);
    rbdi_mjcf_fill_joint(m, joint, &l->rows[row].body);
    l->rows[row].joint = l->joint_name[joint];
    l->rows[row].place.qpos = m->jnt_qposadr[joint];
    l->rows[row].place.dof = m->jnt_dofadr[joint];
    l->row_of_joint[joint] = row;
    *X = back;
    return row;
}

/* ---- frames [frames] ---- */

static int rbdi_mjcf_add_frame(rbdi_mjcf_load *l, size_t link, size_t joint, int parent, int body,
                               const rbdi_mjcf_pose *at) {
    rbdi_mjcf_item *f = &l->frames[l->nframes];
    f->link = link;
    f->joint = joint;
    f->parent = parent;
    f->body = body;
    f->at = *at;
    return l->nframes++;
}

static int rbdi_mjcf_is_kept(const rbdi_mjcf_load *l, const char *name) {
    for (const char *const *k = l->options->keep; k && *k; k++)
        if (strcmp(*k, name) == 0) return 1;
    return 0;
}

/* Fixes a link to a row, as a row of its own if it is kept, and lists it as a frame. */
static void rbdi_mjcf_fix(rbdi_mjcf_load *l, size_t link, int parent, int is_kept, int *row,
                          rbdi_mjcf_pose *at, int *frame) {
    const size_t joint = rbdi_mjcf_new_name(l, rbdi_mjcf_text(l, link), "_fixed", rbdi_mjcf_is_joint);
    if (!rbdi_mjcf_is_ok(l)) return;
    if (is_kept) {
        *row = rbdi_mjcf_add_row(l, RBD_FIXED, *row, at);
        *at = rbdi_mjcf_shift(0, 0, 0);
        l->rows[*row].name = link;
        l->rows[*row].joint = joint;
    }
    *frame = rbdi_mjcf_add_frame(l, link, joint, parent, *row, at);
}

static int rbdi_mjcf_is_pose(const rbdi_mjcf_pose *X) { return X->p[0] != 0 || X->p[1] != 0 || X->p[2] != 0; }

/* Adds a body that joints move: a row for each; and one for the body, if the last joint's is elsewhere. */
static void rbdi_mjcf_add_moved(rbdi_mjcf_load *l, int body, int row, rbdi_mjcf_pose X) {
    const mjModel *m = l->m;
    const int first = m->body_jntadr[body], last = first + m->body_jntnum[body] - 1;
    const rbdi_mjcf_pose here = rbdi_mjcf_shift(0, 0, 0);
    int frame = l->frame_of[m->body_parentid[body]];
    for (int j = first; j <= last && rbdi_mjcf_is_ok(l); j++) {
        const size_t joint = l->joint_name[j];
        size_t link = l->link_name[body];
        row = rbdi_mjcf_add_joint(l, j, row, &X);
        if (j < last || rbdi_mjcf_is_pose(&X))
            link = rbdi_mjcf_new_name(l, rbdi_mjcf_text(l, joint), "_link", rbdi_mjcf_is_link);
        l->rows[row].name = link;
        frame = rbdi_mjcf_add_frame(l, link, joint, frame, row, &here);
    }
    if (rbdi_mjcf_is_ok(l) && rbdi_mjcf_is_pose(&X))
        rbdi_mjcf_fix(l, l->link_name[body], frame, 1, &row, &X, &frame);
    l->row_of[body] = row;
    l->pose_of[body] = here;
    l->frame_of[body] = frame;
}

static void rbdi_mjcf_add_body(rbdi_mjcf_load *l, int body) {
    const mjModel *m = l->m;
    const int parent = m->body_parentid[body];
    rbdi_mjcf_pose X = rbdi_mjcf_pose_of(m->body_pos + 3 * body, m->body_quat + 4 * body);
    X = rbdi_mjcf_compose(&l->pose_of[parent], &X);
    if (m->body_jntnum[body] > 0) {
        rbdi_mjcf_add_moved(l, body, l->row_of[parent], X);
    } else {
        const char *name = rbdi_mjcf_text(l, l->link_name[body]);
        const int is_kept = l->options->keep_all || rbdi_mjcf_is_kept(l, name);
        l->row_of[body] = l->row_of[parent];
        l->pose_of[body] = X;
        rbdi_mjcf_fix(l, l->link_name[body], l->frame_of[parent], is_kept, &l->row_of[body],
                      &l->pose_of[body], &l->frame_of[body]);
    }
    if (rbdi_mjcf_is_ok(l)) rbdi_mjcf_add_mass(l, body);
}

/* A site that is called as a body is called NAME_site. */
static void rbdi_mjcf_add_site(rbdi_mjcf_load *l, int site) {
    const mjModel *m = l->m;
    const char *name = m->names + m->name_siteadr[site];
    const int body = m->site_bodyid[site];
    rbdi_mjcf_pose X = rbdi_mjcf_pose_of(m->site_pos + 3 * site, m->site_quat + 4 * site);
    int row = l->row_of[body], frame;
    size_t link;
    if (!*name || !rbdi_mjcf_is_ok(l)) return;
    X = rbdi_mjcf_compose(&l->pose_of[body], &X);
    link = rbdi_mjcf_new_name(l, name, rbdi_mjcf_is_link(l, name) ? "_site" : "", rbdi_mjcf_is_link);
    if (!rbdi_mjcf_is_ok(l)) return;
    rbdi_mjcf_fix(l, link, l->frame_of[body], rbdi_mjcf_is_kept(l, rbdi_mjcf_text(l, link)), &row, &X,
                  &frame);
}

static void rbdi_mjcf_add_all(rbdi_mjcf_load *l) {
    const mjModel *m = l->m;
    const rbdi_mjcf_pose here = rbdi_mjcf_shift(0, 0, 0);
    l->row_of[0] = -1;
    l->pose_of[0] = here;
    l->frame_of[0] = rbdi_mjcf_add_frame(l, l->link_name[0], 0, -1, -1, &here);
    for (int i = 1; i < m->nbody && rbdi_mjcf_is_ok(l); i++) rbdi_mjcf_add_body(l, i);
    for (int i = 0; i < m->nsite && rbdi_mjcf_is_ok(l); i++) rbdi_mjcf_add_site(l, i);
}

/* Every name of options.keep is a frame without a joint of its own. */
static void rbdi_mjcf_check_keep(rbdi_mjcf_load *l) {
    for (const char *const *k = l->options->keep; k && *k && rbdi_mjcf_is_ok(l); k++)
        if (!rbdi_mjcf_is_link(l, *k))
            rbdi_mjcf_fail(l, RBD_MJCF_ERR_OPTION, "keep: there is no body or site '%s'", *k);
}

/* ---- mimics [mimics] ---- */

/* Name of an equality; that of one without is its kind and MuJoCo's number, as weld_2. */
static const char *rbdi_mjcf_equality(const mjModel *m, int equality, char text[32]) {
    const char *name = m->names + m->name_eqadr[equality];
    const int type = m->eq_type[equality];
    const char *kind = type == mjEQ_CONNECT ? "connect" : type == mjEQ_WELD ? "weld" : "equality";
    snprintf(text, 32, "%s_%d", kind, equality);
    return *name ? name : text;
}

static const char *rbdi_mjcf_joint(const rbdi_mjcf_load *l, int joint) {
    return rbdi_mjcf_text(l, l->joint_name[joint]);
}

/* q1 - ref1 = a + b (q2 - ref2) + c (q2 - ref2)^2 + ... */
static void rbdi_mjcf_read_mimic(rbdi_mjcf_load *l, int equality) {
    const mjModel *m = l->m;
    const mjtNum *a = m->eq_data + (size_t)equality * mjNEQDATA;
    const int joint = m->eq_obj1id[equality], leader = m->eq_obj2id[equality];
    const double ref = m->qpos0[m->jnt_qposadr[joint]];
    const double leader_ref = leader < 0 ? 0 : m->qpos0[m->jnt_qposadr[leader]];
    rbdi_mjcf_follow *f = &l->follow[joint];
    char text[32];
    const char *name = rbdi_mjcf_equality(m, equality, text), *who = rbdi_mjcf_joint(l, joint);
    if (leader >= 0 && (a[2] != 0 || a[3] != 0 || a[4] != 0))
        rbdi_mjcf_warn(l, RBD_MJCF_WARN_EQUALITY,
                       "equality '%s': joint '%s' follows by a polynomial of degree above 1; it is left free",
                       name, who);
    else if (l->options->free_mimics)
        rbdi_mjcf_warn(l, RBD_MJCF_WARN_EQUALITY, "equality '%s': joint '%s' is left free, as asked for",
                       name, who);
    else if (f->is_set)
        rbdi_mjcf_warn(l, RBD_MJCF_WARN_EQUALITY,
                       "equality '%s': joint '%s' follows by another equality too; this one is left out",
                       name, who);
    else {
        f->is_set = 1;
        f->leader = leader;
        f->ratio = leader < 0 ? 0 : a[1];
        f->offset = ref + a[0] - f->ratio * leader_ref;
    }
}

/* Puts in place of a leader that follows too what that one follows. A circle of them is cut. */
static void rbdi_mjcf_resolve(rbdi_mjcf_load *l, int joint) {
    rbdi_mjcf_follow *f = &l->follow[joint];
    for (int steps = 0; f->ratio != 0 && l->follow[f->leader].is_set; steps++) {
        const rbdi_mjcf_follow *next = &l->follow[f->leader];
        if (steps > l->m->njnt) {
            f->is_set = 0;
            rbdi_mjcf_warn(l, RBD_MJCF_WARN_EQUALITY,
                           "joint '%s' follows itself by a circle of equalities; it is left free",
                           rbdi_mjcf_joint(l, joint));
            return;
        }
        f->offset += f->ratio * next->offset;
        f->ratio *= next->ratio;
        f->leader = next->leader;
    }
}

/* Makes the joint's row a mimic, or marks the joint as held still. */
static void rbdi_mjcf_apply(rbdi_mjcf_load *l, int joint) {
    const rbdi_mjcf_follow *f = &l->follow[joint];
    rbdi_mjcf_row *r = &l->rows[l->row_of_joint[joint]];
    if (f->ratio == 0) {
        l->held[joint] = 1;
        l->held_at[joint] = f->offset;
        rbdi_mjcf_warn(l, RBD_MJCF_WARN_LOCKED, "joint '%s': an equality holds it still at %.6g",
                       rbdi_mjcf_joint(l, joint), f->offset);
        return;
    }
    r->mimic = l->joint_name[f->leader];
    r->body.mimic_ratio = f->ratio;
    r->body.mimic_offset = f->offset;
}

static int rbdi_mjcf_is_active(const mjModel *m, int equality) {
    return m->RBDI_MJCF_EQ_ACTIVE[equality] != 0;
}

static void rbdi_mjcf_find_mimics(rbdi_mjcf_load *l) {
    const mjModel *m = l->m;
    for (int i = 0; i < m->neq; i++)
        if (m->eq_type[i] == mjEQ_JOINT && rbdi_mjcf_is_active(m, i)) rbdi_mjcf_read_mimic(l, i);
    for (int i = 0; i < m->njnt; i++)
        if (l->follow[i].is_set) rbdi_mjcf_resolve(l, i);
    for (int i = 0; i < m->njnt; i++)
        if (l->follow[i].is_set) rbdi_mjcf_apply(l, i);
}

/* ---- held [held] ---- */

/* Lets the strings of the rows, and of the constraints, point into names, which do not move from here on. */
static void rbdi_mjcf_point(rbdi_mjcf_load *l, const char *names) {
    for (int i = 0; i < l->nb; i++) {
        rbdi_mjcf_row *r = &l->rows[i];
        r->body.name = r->name ? names + r->name : NULL;
        r->body.joint = r->joint ? names + r->joint : NULL;
        r->body.mimic = r->mimic ? names + r->mimic : NULL;
    }
    for (int i = 0; i < l->nconstraints; i++) l->constraints[i].name = names + l->constraint_names[i];
}

/* The rows' bodies behind each other, as rbd's calls take them; NULL after an error. */
static rbd_body *rbdi_mjcf_bodies(rbdi_mjcf_load *l) {
    rbd_body *bodies = (rbd_body *)rbdi_mjcf_memory(l, l->nb, sizeof *bodies);
    if (!bodies) return NULL;
    rbdi_mjcf_point(l, l->names);
    for (int i = 0; i < l->nb; i++) bodies[i] = l->rows[i].body;
    return bodies;
}

/* Number of coordinates that a row has in q. */
static int rbdi_mjcf_nq(const rbd_body *b) {
    if (b->type == RBD_FIXED || b->mimic) return 0;
    return b->type == RBD_FLOATING ? 7 : b->type == RBD_SPHERICAL ? 4 : 1;
}

static void rbdi_mjcf_read_lock(rbdi_mjcf_load *l, const rbd_mjcf_lock *lock) {
    int joint = 0;
    while (joint < l->m->njnt && strcmp(rbdi_mjcf_joint(l, joint), lock->joint) != 0) joint++;
    if (joint == l->m->njnt) {
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_OPTION, "lock: there is no joint '%s'", lock->joint);
    } else if (l->rows[l->row_of_joint[joint]].mimic) {
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_OPTION, "lock: joint '%s' mimics '%s': hold that one still",
                       lock->joint, rbdi_mjcf_text(l, l->rows[l->row_of_joint[joint]].mimic));
    } else if (!isfinite(lock->value) || (lock->value != 0 && !rbdi_mjcf_is_single(l->m, joint))) {
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_OPTION, "lock: joint '%s' cannot be held at %g", lock->joint,
                       lock->value);
    } else {
        l->held[joint] = 1;
        l->held_at[joint] = lock->value;
    }
}

/* Fixes the rows of held joints by rbd_lock_joints; those that mimic them follow. A quaternion of zeros is no
   rotation. */
static void rbdi_mjcf_hold(rbdi_mjcf_load *l, rbd_body *bodies, unsigned char *flags, double *q) {
    rbd_report report;
    int iq = 0;
    for (int i = 0; i < l->nb; i++) {
        const int nq = rbdi_mjcf_nq(&bodies[i]);
        for (int j = 0; j < l->m->njnt; j++) {
            if (!l->held[j] || l->row_of_joint[j] != i) continue;
            flags[i] = 1;
            if (nq == 1) q[iq] = l->held_at[j];
        }
        iq += nq;
    }
    if (rbd_lock_joints(bodies, l->nb, flags, q, bodies, &report) != RBD_OK) {
        char text[200];
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_MODEL, "%s", rbd_finding_text(&report.error, text, sizeof text));
        return;
    }
    for (int i = 0; i < l->nb; i++) {
        if (bodies[i].type == RBD_FIXED) {
            l->rows[i].mimic = 0;
            l->rows[i].place.qpos = -1;
            l->rows[i].place.dof = -1;
        }
        l->rows[i].body = bodies[i];
    }
}

static void rbdi_mjcf_hold_all(rbdi_mjcf_load *l) {
    int n = 0;
    for (const rbd_mjcf_lock *lock = l->options->lock; lock && lock->joint && rbdi_mjcf_is_ok(l); lock++)
        rbdi_mjcf_read_lock(l, lock);
    for (int j = 0; j < l->m->njnt; j++) n += l->held[j];
    if (n == 0 || !rbdi_mjcf_is_ok(l)) return;
    rbd_body *bodies = rbdi_mjcf_bodies(l);
    unsigned char *flags = (unsigned char *)rbdi_mjcf_memory(l, l->nb, 1);
    double *q = (double *)rbdi_mjcf_memory(l, 7 * l->nb, sizeof *q);
    if (rbdi_mjcf_is_ok(l)) rbdi_mjcf_hold(l, bodies, flags, q);
    free(bodies);
    free(flags);
    free(q);
}

/* ---- constraints [constraints] ---- */

/* The row whose joint moves this row, -1: it is fixed to the world. */
static int rbdi_mjcf_moving(const rbdi_mjcf_load *l, int row) {
    while (row >= 0 && l->rows[row].body.type == RBD_FIXED) row = l->rows[row].body.parent;
    return row;
}

/* A side of a constraint: the row that carries it, and a frame there. */
typedef struct rbdi_mjcf_side {
    int row;
    rbdi_mjcf_pose at;
} rbdi_mjcf_side;

static rbdi_mjcf_side rbdi_mjcf_on_body(const rbdi_mjcf_load *l, int body, const mjtNum pos[3],
                                        const mjtNum *quat) {
    static const mjtNum upright[4] = {1, 0, 0, 0};
    rbdi_mjcf_side side;
    side.row = l->row_of[body];
    side.at = rbdi_mjcf_pose_of(pos, quat ? quat : upright);
    side.at = rbdi_mjcf_compose(&l->pose_of[body], &side.at);
    return side;
}

static rbdi_mjcf_side rbdi_mjcf_on_site(const rbdi_mjcf_load *l, int site) {
    const mjModel *m = l->m;
    return rbdi_mjcf_on_body(l, m->site_bodyid[site], m->site_pos + 3 * site, m->site_quat + 4 * site);
}

/* Baumgarte's gains of solref: (time constant, damping ratio), or (-stiffness, -damping). */
static void rbdi_mjcf_set_gains(const mjtNum solref[2], rbd_constraint *c) {
    if (solref[0] > 0 && solref[1] > 0) {
        c->kp = 1 / (solref[0] * solref[0] * solref[1] * solref[1]);
        c->kd = 2 / solref[0];
    } else {
        c->kp = -solref[0];
        c->kd = -solref[1];
    }
}

/* connect holds two points together; weld a frame of body 2 (its anchor, upright) to the pose that body 1 has
   for it. Those between sites hold the sites together. */
static void rbdi_mjcf_add_constraint(rbdi_mjcf_load *l, int equality) {
    const mjModel *m = l->m;
    const int is_weld = m->eq_type[equality] == mjEQ_WELD;
    const int id1 = m->eq_obj1id[equality], id2 = m->eq_obj2id[equality];
    const mjtNum *data = m->eq_data + (size_t)equality * mjNEQDATA;
    rbd_constraint *c = &l->constraints[l->nconstraints];
    rbdi_mjcf_side side1, side2;
    char text[32];
    int are_sites = 0;
#if mjVERSION_HEADER >= 323
    are_sites = m->eq_objtype[equality] == mjOBJ_SITE;
#endif
    if (are_sites) {
        side1 = rbdi_mjcf_on_site(l, id1);
        side2 = rbdi_mjcf_on_site(l, id2);
    } else {
        const mjtNum *pos1 = is_weld ? data + 3 : data, *pos2 = is_weld ? data : data + 3;
        side1 = rbdi_mjcf_on_body(l, id1, pos1, is_weld ? data + 6 : NULL);
        side2 = rbdi_mjcf_on_body(l, id2, pos2, NULL);
    }
    if (rbdi_mjcf_moving(l, side1.row) == rbdi_mjcf_moving(l, side2.row)) {
        rbdi_mjcf_warn(l, RBD_MJCF_WARN_EQUALITY,
                       "equality '%s': no joint moves one side relative to the other; it is left out",
                       rbdi_mjcf_equality(m, equality, text));
        return;
    }

    c->body1 = side1.row;
    c->body2 = side2.row;
    memcpy(c->position1, side1.at.p, sizeof c->position1);
    memcpy(c->rotation1, side1.at.R, sizeof c->rotation1);
    memcpy(c->position2, side2.at.p, sizeof c->position2);
    memcpy(c->rotation2, side2.at.R, sizeof c->rotation2);
    for (int i = 0; i < 6; i++) c->axes[i] = is_weld || i >= 3;
    rbdi_mjcf_set_gains(m->eq_solref + (size_t)equality * mjNREF, c);
    if (!(c->kp >= 0 && c->kp < HUGE_VAL && c->kd >= 0 && c->kd < HUGE_VAL))
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_MODEL, "equality '%s': solref is not finite, or of two signs",
                       rbdi_mjcf_equality(m, equality, text));
    l->constraint_names[l->nconstraints++] = rbdi_mjcf_put(l, rbdi_mjcf_equality(m, equality, text), "", 0);
}

static void rbdi_mjcf_add_constraints(rbdi_mjcf_load *l) {
    const mjModel *m = l->m;
    for (int i = 0; i < m->neq && rbdi_mjcf_is_ok(l); i++) {
        const int type = m->eq_type[i];
        char text[32];
        const char *name = rbdi_mjcf_equality(m, i, text);
        if (!rbdi_mjcf_is_active(m, i))
            rbdi_mjcf_warn(l, RBD_MJCF_WARN_EQUALITY, "equality '%s' is not active; it is left out", name);
        else if (type == mjEQ_CONNECT || type == mjEQ_WELD)
            rbdi_mjcf_add_constraint(l, i);
        else if (type != mjEQ_JOINT)
            rbdi_mjcf_warn(l, RBD_MJCF_WARN_EQUALITY,
                           "equality '%s' holds what rbd has not, such as tendons; it is left out", name);
    }
}

/* ---- left out [left out] ----
   Things of one kind that rbd has no place for, in one warning that names them. */

static int rbdi_mjcf_has_spring(const mjModel *m, int joint) {
#if mjVERSION_HEADER >= 3007000
    for (int i = 0; i < mjNPOLY; i++)
        if (m->jnt_stiffnesspoly[joint * mjNPOLY + i] != 0) return 1;
#endif
    return m->jnt_stiffness[joint] != 0;
}

static int rbdi_mjcf_has_drag(const mjModel *m, int joint) {
#if mjVERSION_HEADER >= 3007000
    for (int i = 0; i < mjNPOLY; i++)
        if (m->dof_dampingpoly[m->jnt_dofadr[joint] * mjNPOLY + i] != 0) return 1;
#endif
    (void)m;
    (void)joint;
    return 0;
}

static int rbdi_mjcf_is_limited_ball(const mjModel *m, int joint) {
    return m->jnt_type[joint] == mjJNT_BALL && m->jnt_limited[joint];
}

static int rbdi_mjcf_is_heavy_free(const mjModel *m, int joint) {
    return m->jnt_type[joint] == mjJNT_FREE && m->dof_armature[m->jnt_dofadr[joint]] != 0;
}

static int rbdi_mjcf_has_gravcomp(const mjModel *m, int body) {
#if mjVERSION_HEADER >= 231
    return m->body_gravcomp[body] != 0;
#else
    (void)m;
    (void)body;
    return 0;
#endif
}

static int rbdi_mjcf_is_mocap(const mjModel *m, int body) { return m->body_mocapid[body] >= 0; }

static int rbdi_mjcf_is_any(const mjModel *m, int i) {
    (void)m;
    (void)i;
    return 1;
}

static int rbdi_mjcf_is_elsewhere(const mjModel *m, int actuator) {
    return !rbdi_mjcf_is_at_joint(m, actuator);
}

static int rbdi_mjcf_is_slow(const mjModel *m, int actuator) {
    return rbdi_mjcf_is_at_joint(m, actuator) && m->actuator_dyntype[actuator] != mjDYN_NONE;
}

static int rbdi_mjcf_is_servo(const mjModel *m, int actuator) {
    return rbdi_mjcf_is_at_joint(m, actuator) && m->actuator_dyntype[actuator] == mjDYN_NONE &&
           (m->actuator_biastype[actuator] != mjBIAS_NONE || m->actuator_gaintype[actuator] != mjGAIN_FIXED);
}

static int rbdi_mjcf_has_gear(const mjModel *m, int actuator) {
    return rbdi_mjcf_is_at_joint(m, actuator) && RBDI_MJCF_GEAR(m, actuator)[0] != 1;
}

/* What a thing of a kind is called in a message. */
typedef void rbdi_mjcf_caller(const rbdi_mjcf_load *l, int i, char *text, size_t size);

static void rbdi_mjcf_call_joint(const rbdi_mjcf_load *l, int joint, char *text, size_t size) {
    snprintf(text, size, "'%s'", rbdi_mjcf_joint(l, joint));
}

static void rbdi_mjcf_call_body(const rbdi_mjcf_load *l, int body, char *text, size_t size) {
    snprintf(text, size, "'%s'", rbdi_mjcf_text(l, l->link_name[body]));
}

/* By its name, or by MuJoCo's number. */
static void rbdi_mjcf_call(const mjModel *m, const char *kind, int i, int name_address, char *text,
                           size_t size) {
    const char *name = m->names + name_address;
    if (*name) {
        snprintf(text, size, "'%s'", name);
    } else {
        snprintf(text, size, "%s %d", kind, i);
    }
}

static void rbdi_mjcf_call_tendon(const rbdi_mjcf_load *l, int tendon, char *text, size_t size) {
    rbdi_mjcf_call(l->m, "tendon", tendon, l->m->name_tendonadr[tendon], text, size);
}

#if mjVERSION_HEADER >= 300
static void rbdi_mjcf_call_flex(const rbdi_mjcf_load *l, int flex, char *text, size_t size) {
    rbdi_mjcf_call(l->m, "flex", flex, l->m->name_flexadr[flex], text, size);
}
#endif

/* By its name, or by MuJoCo's number and what it acts at. */
static void rbdi_mjcf_call_actuator(const rbdi_mjcf_load *l, int actuator, char *text, size_t size) {
    const mjModel *m = l->m;
    const int at = m->actuator_trnid[2 * actuator], type = m->actuator_trntype[actuator];
    size_t length;
    rbdi_mjcf_call(m, "actuator", actuator, m->name_actuatoradr[actuator], text, size);
    if (*text == '\'' || at < 0) return;

    length = strlen(text);
    length += (size_t)snprintf(text + length, size - length, " of %s",
                               rbdi_mjcf_is_at_joint(m, actuator) ? "joint " : "");
    if (rbdi_mjcf_is_at_joint(m, actuator))
        rbdi_mjcf_call_joint(l, at, text + length, size - length);
    else if (type == mjTRN_BODY)
        rbdi_mjcf_call_body(l, at, text + length, size - length);
    else if (type == mjTRN_TENDON)
        rbdi_mjcf_call_tendon(l, at, text + length, size - length);
    else
        rbdi_mjcf_call(m, "site", at, m->name_siteadr[at], text + length, size - length);
}

/* Warns of those of n things for which it is true, "WHAT: 'a', 'b' and 3 more". */
static void rbdi_mjcf_name_those(rbdi_mjcf_load *l, rbd_mjcf_status status, const char *what, int n,
                                 rbdi_mjcf_caller *call, int (*is_so)(const mjModel *, int)) {
    char list[300] = "", name[300];
    size_t length = 0;
    int named = 0, more = 0;
    for (int i = 0; i < n; i++) {
        if (!is_so(l->m, i)) continue;
        call(l, i, name, sizeof name);
        if (more > 0 || length + strlen(name) + 2 >= sizeof list) {
            more++;
            continue;
        }
        length += (size_t)snprintf(list + length, sizeof list - length, "%s%s", named ? ", " : "", name);
        named++;
    }
    if (named == 0 && more == 0) return;
    if (more > 0)
        rbdi_mjcf_warn(l, status, "%s: %s and %d more", what, list, more);
    else
        rbdi_mjcf_warn(l, status, "%s: %s", what, list);
}

static void rbdi_mjcf_name_actuators(rbdi_mjcf_load *l) {
    const int n = RBDI_MJCF_ACTUATORS(l->m);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_ACTUATOR, "actuators that act at no joint are left out", n,
                         rbdi_mjcf_call_actuator, rbdi_mjcf_is_elsewhere);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_ACTUATOR,
                         "activation of actuators (dyntype) is left out: tau is the torque at the joint", n,
                         rbdi_mjcf_call_actuator, rbdi_mjcf_is_slow);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_ACTUATOR,
                         "laws of servos (gaintype, biastype) are left out: tau is the torque at the joint",
                         n, rbdi_mjcf_call_actuator, rbdi_mjcf_is_servo);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_ACTUATOR,
                         "gears are left out: tau is the torque at the joint, gear times the actuator's", n,
                         rbdi_mjcf_call_actuator, rbdi_mjcf_has_gear);
}

static void rbdi_mjcf_name_left_out(rbdi_mjcf_load *l) {
    const mjModel *m = l->m;
    const mjtNum *wind = m->opt.wind;
    const int njnt = (int)m->njnt, nbody = (int)m->nbody;
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_FORCE, "springs of joints (stiffness) are left out", njnt,
                         rbdi_mjcf_call_joint, rbdi_mjcf_has_spring);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_FORCE, "damping of joints beyond its linear part is left out", njnt,
                         rbdi_mjcf_call_joint, rbdi_mjcf_has_drag);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_LIMIT, "limits of ball joints are left out", njnt,
                         rbdi_mjcf_call_joint, rbdi_mjcf_is_limited_ball);
    rbdi_mjcf_name_those(
        l, RBD_MJCF_WARN_ARMATURE,
        "armature of a free joint acts in body axes, MuJoCo's in world axes: bias forces differ", njnt,
        rbdi_mjcf_call_joint, rbdi_mjcf_is_heavy_free);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_FORCE, "compensation of gravity (gravcomp) is left out of bodies",
                         nbody, rbdi_mjcf_call_body, rbdi_mjcf_has_gravcomp);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_MOCAP, "mocap bodies are read as fixed to the world", nbody,
                         rbdi_mjcf_call_body, rbdi_mjcf_is_mocap);
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_TENDON, "tendons are left out", (int)m->ntendon,
                         rbdi_mjcf_call_tendon, rbdi_mjcf_is_any);
    rbdi_mjcf_name_actuators(l);
    if (m->opt.density != 0 || m->opt.viscosity != 0 || wind[0] != 0 || wind[1] != 0 || wind[2] != 0)
        rbdi_mjcf_warn(l, RBD_MJCF_WARN_FORCE,
                       "forces of the medium (density, viscosity, wind) are left out");
#if mjVERSION_HEADER >= 230
    if (m->nplugin > 0) rbdi_mjcf_warn(l, RBD_MJCF_WARN_LEFT_OUT, "plugins are left out");
#endif
#if mjVERSION_HEADER >= 300
    rbdi_mjcf_name_those(l, RBD_MJCF_WARN_LEFT_OUT, "flexes are left out", (int)m->nflex, rbdi_mjcf_call_flex,
                         rbdi_mjcf_is_any);
#endif
}

/* ---- result [result] ---- */

static void rbdi_mjcf_sum_fixed_mass(rbdi_mjcf_load *l) {
    for (int i = 1; i < l->m->nbody; i++)
        if (rbdi_mjcf_moving(l, l->row_of[i]) < 0) l->fixed_mass += l->m->body_mass[i];
}

static void rbdi_mjcf_report_build(rbdi_mjcf_load *l, rbd_status status, const rbd_report *report) {
    char text[300];
    if (status == RBD_ERR_COUNT)
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_MODEL, "it has %d bodies; rbd takes %d at most", l->nb,
                       RBD_MAX_BODIES);
    if (status != RBD_OK) {
        const char *what = report->error.body < 0 ? rbd_status_string(status)
                                                  : rbd_finding_text(&report->error, text, sizeof text);
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_MODEL, "the model: %s", what);
        return;
    }
    for (int i = 0; i < report->warnings && i < RBD_MAX_WARNINGS; i++)
        rbdi_mjcf_warn(l, RBD_MJCF_WARN_MODEL, "%s",
                       rbd_finding_text(&report->warning[i], text, sizeof text));
}

/* Whether rbd_model_build takes the description is found out by asking it. */
static void rbdi_mjcf_check_build(rbdi_mjcf_load *l) {
    rbd_body *bodies = rbdi_mjcf_bodies(l);
    const size_t size = bodies ? rbd_model_size(bodies, l->nb) : 0;
    void *memory = rbdi_mjcf_memory(l, (int)size, 1);
    const rbd_model *model;
    rbd_report report;
    int moving = 0;
    memset(&report, 0, sizeof report);
    for (int i = 0; i < l->nb; i++) moving += l->rows[i].body.type != RBD_FIXED;
    if (moving == 0)
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_ROBOT, "nothing moves: the file has no joint, or all are held");
    if (rbdi_mjcf_is_ok(l))
        rbdi_mjcf_report_build(l, rbd_model_build(bodies, l->nb, memory, size, &model, &report), &report);
    free(bodies);
    free(memory);
}

static void rbdi_mjcf_lack(rbdi_mjcf_load *l, const char *what, size_t needed) {
    rbdi_mjcf_fail(l, RBD_MJCF_ERR_ROOM, "room for %s is needed: %lu", what, (unsigned long)needed);
}

static void rbdi_mjcf_check_rooms(rbdi_mjcf_load *l, const rbd_mjcf *r) {
    const size_t nb = (size_t)l->nb;
    if (!r->bodies || r->bodies_max < l->nb) rbdi_mjcf_lack(l, "bodies", nb);
    if (!r->names || r->names_max < l->names_size) rbdi_mjcf_lack(l, "bytes of names", l->names_size);
    if (r->frames && r->frames_max < l->nframes) rbdi_mjcf_lack(l, "frames", (size_t)l->nframes);
    if (r->places && r->places_max < l->nb) rbdi_mjcf_lack(l, "places", nb);
    if (r->constraints && r->constraints_max < l->nconstraints)
        rbdi_mjcf_lack(l, "constraints", (size_t)l->nconstraints);
}

static void rbdi_mjcf_write_frame(const rbdi_mjcf_item *f, const char *names, rbd_mjcf_frame *out) {
    out->link = names + f->link;
    out->joint = f->joint ? names + f->joint : NULL;
    out->parent = f->parent;
    out->body = f->body;
    memcpy(out->position, f->at.p, sizeof f->at.p);
    memcpy(out->rotation, f->at.R, sizeof f->at.R);
}

static void rbdi_mjcf_write_result(rbdi_mjcf_load *l, rbd_mjcf *r) {
    const int is_gravity = !(l->m->opt.disableflags & mjDSBL_GRAVITY);
    r->nb = l->nb;
    r->nframes = l->nframes;
    r->nconstraints = l->nconstraints;
    r->nqpos = (int)l->m->nq;
    r->nqvel = (int)l->m->nv;
    r->names_size = l->names_size;
    r->fixed_mass = l->fixed_mass;
    for (int i = 0; i < 3; i++)
        r->gravity[i] = l->options->gravity ? l->options->gravity[i] : is_gravity ? l->m->opt.gravity[i] : 0;
    if (!r->bodies && !r->names) return;
    rbdi_mjcf_check_rooms(l, r);
    if (!rbdi_mjcf_is_ok(l)) return;

    memcpy(r->names, l->names, l->names_size);
    r->name = r->names + 1;
    rbdi_mjcf_point(l, r->names);
    for (int i = 0; i < l->nb; i++) {
        r->bodies[i] = l->rows[i].body;
        if (r->places) r->places[i] = l->rows[i].place;
    }
    for (int i = 0; r->frames && i < l->nframes; i++)
        rbdi_mjcf_write_frame(&l->frames[i], r->names, &r->frames[i]);
    for (int i = 0; r->constraints && i < l->nconstraints; i++) r->constraints[i] = l->constraints[i];
}

static int rbdi_mjcf_is_finite(const double x[3]) {
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

static void rbdi_mjcf_check_gravity(rbdi_mjcf_load *l) {
    const double *g = l->options->gravity;
    if (g && !rbdi_mjcf_is_finite(g)) rbdi_mjcf_fail(l, RBD_MJCF_ERR_OPTION, "gravity is not finite");
    if (!g && !rbdi_mjcf_is_finite(l->m->opt.gravity))
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_MODEL, "<option>: gravity is not finite");
}

static void rbdi_mjcf_allocate(rbdi_mjcf_load *l) {
    const int nbody = (int)l->m->nbody, njnt = (int)l->m->njnt, nsite = (int)l->m->nsite,
              neq = (int)l->m->neq;
    const int rows = nbody + njnt + nsite;
    l->rows = (rbdi_mjcf_row *)rbdi_mjcf_memory(l, rows, sizeof *l->rows);
    l->frames = (rbdi_mjcf_item *)rbdi_mjcf_memory(l, rows, sizeof *l->frames);
    l->constraints = (rbd_constraint *)rbdi_mjcf_memory(l, neq, sizeof *l->constraints);
    l->constraint_names = (size_t *)rbdi_mjcf_memory(l, neq, sizeof(size_t));
    l->link_name = (size_t *)rbdi_mjcf_memory(l, nbody, sizeof(size_t));
    l->row_of = (int *)rbdi_mjcf_memory(l, nbody, sizeof(int));
    l->pose_of = (rbdi_mjcf_pose *)rbdi_mjcf_memory(l, nbody, sizeof *l->pose_of);
    l->frame_of = (int *)rbdi_mjcf_memory(l, nbody, sizeof(int));
    l->joint_name = (size_t *)rbdi_mjcf_memory(l, njnt, sizeof(size_t));
    l->row_of_joint = (int *)rbdi_mjcf_memory(l, njnt, sizeof(int));
    l->follow = (rbdi_mjcf_follow *)rbdi_mjcf_memory(l, njnt, sizeof *l->follow);
    l->held = (unsigned char *)rbdi_mjcf_memory(l, njnt, 1);
    l->held_at = (double *)rbdi_mjcf_memory(l, njnt, sizeof(double));
}

static void rbdi_mjcf_free(rbdi_mjcf_load *l) {
    free(l->rows);
    free(l->frames);
    free(l->constraints);
    free(l->constraint_names);
    free(l->names);
    free(l->warnings);
    free(l->link_name);
    free(l->row_of);
    free(l->pose_of);
    free(l->frame_of);
    free(l->joint_name);
    free(l->row_of_joint);
    free(l->follow);
    free(l->held);
    free(l->held_at);
}

static void rbdi_mjcf_describe(rbdi_mjcf_load *l, rbd_mjcf *robot) {
    static void (*const steps[])(rbdi_mjcf_load *) = {
        rbdi_mjcf_check_gravity, rbdi_mjcf_allocate,    rbdi_mjcf_name_all,      rbdi_mjcf_add_all,
        rbdi_mjcf_check_keep,    rbdi_mjcf_find_mimics, rbdi_mjcf_hold_all,      rbdi_mjcf_add_constraints,
        rbdi_mjcf_name_left_out, rbdi_mjcf_check_build, rbdi_mjcf_sum_fixed_mass};
    for (size_t i = 0; i < sizeof steps / sizeof *steps && rbdi_mjcf_is_ok(l); i++) steps[i](l);
    if (rbdi_mjcf_is_ok(l) && l->options->strict && l->nwarnings > 0) l->error = l->warnings[0];
    if (rbdi_mjcf_is_ok(l)) rbdi_mjcf_write_result(l, robot);
}

/* Takes back the results of the call before. */
static void rbdi_mjcf_clear(rbd_mjcf *robot) {
    robot->name = NULL;
    robot->nb = 0;
    robot->nframes = 0;
    robot->nconstraints = 0;
    robot->nwarnings = 0;
    robot->nqpos = 0;
    robot->nqvel = 0;
    robot->names_size = 0;
    robot->fixed_mass = 0;
    memset(&robot->error, 0, sizeof robot->error);
}

/* Hands out findings and gives all memory back. */
static rbd_mjcf_status rbdi_mjcf_finish(rbdi_mjcf_load *l, rbd_mjcf *robot) {
    const rbd_mjcf_status status = l->error.status;
    robot->error = l->error;
    robot->nwarnings = l->nwarnings;
    for (int i = 0; robot->warnings && i < l->nwarnings && i < robot->warnings_max; i++)
        robot->warnings[i] = l->warnings[i];
    rbdi_mjcf_free(l);
    return status;
}

/* ---- compiler [compiler] ----
   MuJoCo calls mju_user_error where it cannot go on, and ends the program if that is NULL or returns. */

static struct {
    jmp_buf jump;
    char error[1000];
} rbdi_mjcf_caught;

static void rbdi_mjcf_on_error(const char *text) {
    snprintf(rbdi_mjcf_caught.error, sizeof rbdi_mjcf_caught.error, "%s", text);
    longjmp(rbdi_mjcf_caught.jump, 1);
}

/* Those of the compiler are in what mj_loadXML says; others are of a step that it tries, as of contacts. */
static void rbdi_mjcf_on_warning(const char *text) { (void)text; }

/* Some broken files make MuJoCo throw what it does not catch; only C++ can. */
static mjModel *rbdi_mjcf_compile_guarded(const char *path, const mjVFS *files) {
#ifdef __cplusplus
    try {
#endif
        return mj_loadXML(path, files, rbdi_mjcf_caught.error, (int)sizeof rbdi_mjcf_caught.error);
#ifdef __cplusplus
    } catch (...) {
        snprintf(rbdi_mjcf_caught.error, sizeof rbdi_mjcf_caught.error, "an exception in its compiler");
        return NULL;
    }
#endif
}

static mjModel *rbdi_mjcf_compile_caught(const char *path, const mjVFS *files) {
    mjModel *volatile m = NULL;
    rbdi_mjcf_caught.error[0] = 0;
    if (setjmp(rbdi_mjcf_caught.jump) == 0) m = rbdi_mjcf_compile_guarded(path, files);
    return m;
}

/* Whether the compiler met an element, attribute or keyword that it does not know, or a range without the limits
   that newer versions take from it. */
static int rbdi_mjcf_may_be_newer(void) {
    static const char *const signs[] = {"Schema", "invalid keyword", "autolimits"};
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++)
        if (strstr(rbdi_mjcf_caught.error, signs[i])) return 1;
    return 0;
}

/* What MuJoCo's compiler makes of a file; NULL after an error. */
static mjModel *rbdi_mjcf_compile(rbdi_mjcf_load *l, const char *path, const mjVFS *files) {
    void (*const on_error)(const char *) = mju_user_error;
    void (*const on_warning)(const char *) = mju_user_warning;
    mjModel *m;
    if (mj_version() != mjVERSION_HEADER) {
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_LIBRARY, "MuJoCo's library is version %d, its header version %d",
                       mj_version(), mjVERSION_HEADER);
        return NULL;
    }
    mju_user_error = rbdi_mjcf_on_error;
    mju_user_warning = rbdi_mjcf_on_warning;
    m = rbdi_mjcf_compile_caught(path, files);
    mju_user_error = on_error;
    mju_user_warning = on_warning;
    for (size_t n = strlen(rbdi_mjcf_caught.error); n > 0 && rbdi_mjcf_caught.error[n - 1] == '\n'; n--)
        rbdi_mjcf_caught.error[n - 1] = 0;

    if (!m)
        rbdi_mjcf_fail(l, RBD_MJCF_ERR_COMPILER, "MuJoCo %s: %s%s", mj_versionString(),
                       *rbdi_mjcf_caught.error ? rbdi_mjcf_caught.error : "it gives no reason",
                       rbdi_mjcf_may_be_newer() ? "; is the file for a newer MuJoCo?" : "");
    else if (*rbdi_mjcf_caught.error)
        rbdi_mjcf_warn(l, RBD_MJCF_WARN_COMPILER, "MuJoCo: %s", rbdi_mjcf_caught.error);
    return m;
}

/* Puts a text into MuJoCo's file system in memory; returns 0, or MuJoCo's reason. */
static int rbdi_mjcf_put_file(mjVFS *files, const char *name, const char *text, size_t length) {
#if mjVERSION_HEADER >= 313
    return mj_addBufferVFS(files, name, text, (int)length);
#else
    const int status = mj_makeEmptyFileVFS(files, name, (int)length);
    if (status == 0) memcpy(files->filedata[mj_findFileVFS(files, name)], text, length);
    return status;
#endif
}

static rbdi_mjcf_load rbdi_mjcf_start(const rbd_mjcf_options *options) {
    static const rbd_mjcf_options none = {NULL, NULL, 0, 0, 0, NULL};
    rbdi_mjcf_load l;
    memset(&l, 0, sizeof l);
    l.options = options ? options : &none;
    return l;
}

/* ---- functions [functions] ---- */

rbd_mjcf_status rbd_mjcf_convert(const struct mjModel_ *model, const rbd_mjcf_options *options,
                                 rbd_mjcf *robot) {
    rbdi_mjcf_load l = rbdi_mjcf_start(options);
    if (!robot) return RBD_MJCF_ERR_NULL;
    rbdi_mjcf_clear(robot);
    l.m = model;
    if (!model)
        rbdi_mjcf_fail(&l, RBD_MJCF_ERR_NULL, "model is NULL");
    else
        rbdi_mjcf_describe(&l, robot);
    return rbdi_mjcf_finish(&l, robot);
}

rbd_mjcf_status rbd_mjcf_load(const char *path, const rbd_mjcf_options *options, rbd_mjcf *robot) {
    rbdi_mjcf_load l = rbdi_mjcf_start(options);
    FILE *file = NULL;
    mjModel *m = NULL;
    if (!robot) return RBD_MJCF_ERR_NULL;
    rbdi_mjcf_clear(robot);
    errno = 0;
    if (!path)
        rbdi_mjcf_fail(&l, RBD_MJCF_ERR_NULL, "path is NULL");
    else if (!(file = fopen(path, "rb")) || (fgetc(file) == EOF && ferror(file)))
        rbdi_mjcf_fail(&l, RBD_MJCF_ERR_FILE, "the file '%s' cannot be read: %s", path, strerror(errno));
    else
        m = rbdi_mjcf_compile(&l, path, NULL);
    if (file) fclose(file);
    l.m = m;
    if (m) rbdi_mjcf_describe(&l, robot);
    if (m) mj_deleteModel(m);
    return rbdi_mjcf_finish(&l, robot);
}

rbd_mjcf_status rbd_mjcf_parse(const char *text, size_t length, const rbd_mjcf_options *options,
                               rbd_mjcf *robot) {
    static const char name[] = "text_in_memory.xml";
    rbdi_mjcf_load l = rbdi_mjcf_start(options);
    mjVFS *files;
    mjModel *m = NULL;
    if (!robot) return RBD_MJCF_ERR_NULL;
    rbdi_mjcf_clear(robot);
    files = (mjVFS *)rbdi_mjcf_memory(&l, 1, sizeof *files);
    if (!text)
        rbdi_mjcf_fail(&l, RBD_MJCF_ERR_NULL, "text is NULL");
    else if (length < 1 || length > 0x7fffffff)
        rbdi_mjcf_fail(&l, RBD_MJCF_ERR_COMPILER, "the text is empty, or longer than 2 GB");
    if (rbdi_mjcf_is_ok(&l)) {
        mj_defaultVFS(files);
        if (rbdi_mjcf_put_file(files, name, text, length) != 0)
            rbdi_mjcf_fail(&l, RBD_MJCF_ERR_MEMORY, "out of memory");
        else
            m = rbdi_mjcf_compile(&l, name, files);
        mj_deleteVFS(files);
    }
    free(files);
    l.m = m;
    if (m) rbdi_mjcf_describe(&l, robot);
    if (m) mj_deleteModel(m);
    return rbdi_mjcf_finish(&l, robot);
}

const char *rbd_mjcf_status_string(rbd_mjcf_status status) {
    switch (status) {
    case RBD_MJCF_OK: return "no error";
    case RBD_MJCF_ERR_NULL: return "a required pointer is NULL";
    case RBD_MJCF_ERR_OPTION: return "an option has no such value, or names what is not there";
    case RBD_MJCF_ERR_FILE: return "the file cannot be read";
    case RBD_MJCF_ERR_ROOM: return "an array is too short";
    case RBD_MJCF_ERR_MEMORY: return "out of memory";
    case RBD_MJCF_ERR_COMPILER: return "MuJoCo's compiler refuses it";
    case RBD_MJCF_ERR_ROBOT: return "nothing moves";
    case RBD_MJCF_ERR_MODEL: return "not a model that rbd_model_build takes";
    case RBD_MJCF_ERR_LIBRARY: return "MuJoCo's library is of another version than its header";
    case RBD_MJCF_WARN_ACTUATOR: return "an actuator is more than a torque at a joint";
    case RBD_MJCF_WARN_TENDON: return "tendons are left out";
    case RBD_MJCF_WARN_FORCE: return "springs, gravcomp or a medium are left out";
    case RBD_MJCF_WARN_LIMIT: return "limits of a ball joint are left out";
    case RBD_MJCF_WARN_EQUALITY: return "an equality is left out";
    case RBD_MJCF_WARN_ARMATURE: return "armature of a free joint acts in body axes";
    case RBD_MJCF_WARN_MOCAP: return "a mocap body is read as fixed to the world";
    case RBD_MJCF_WARN_LEFT_OUT: return "flexes or plugins are left out";
    case RBD_MJCF_WARN_LOCKED: return "an equality holds a joint still";
    case RBD_MJCF_WARN_MODEL: return "a warning of rbd_model_build";
    case RBD_MJCF_WARN_COMPILER: return "a warning of MuJoCo's compiler";
    }
    return "unknown status";
}

/* out = R(quaternion w x y z) v, or R' v. */
static void rbdi_mjcf_rotate(const double *quat, int transposed, const double *v, double *out) {
    double R[9];
    const double s = 1 / sqrt(quat[0] * quat[0] + quat[1] * quat[1] + quat[2] * quat[2] + quat[3] * quat[3]);
    const mjtNum unit[4] = {s * quat[0], s * quat[1], s * quat[2], s * quat[3]};
    rbdi_mjcf_matrix(unit, R);
    for (int i = 0; i < 3; i++) {
        const double *a = R + (transposed ? i : 3 * i);
        const int step = transposed ? 3 : 1;
        out[i] = a[0] * v[0] + a[step] * v[1] + a[2 * step] * v[2];
    }
}

/* Whether a body has coordinates of its own in q. */
static int rbdi_mjcf_has_q(const rbd_mjcf *robot, int body) {
    return robot->places && robot->places[body].qpos >= 0 && !robot->bodies[body].mimic;
}

void rbd_mjcf_q_of_qpos(const rbd_mjcf *robot, const double *qpos, double *q) {
    for (int i = 0; i < robot->nb; i++) {
        const rbd_joint_type type = robot->bodies[i].type;
        const double *from = qpos;
        if (!rbdi_mjcf_has_q(robot, i)) continue;
        from += robot->places[i].qpos;
        if (type == RBD_FLOATING)
            for (int k = 0; k < 3; k++) *q++ = *from++;
        if (type == RBD_FLOATING || type == RBD_SPHERICAL) {
            for (int k = 0; k < 4; k++) *q++ = from[(k + 1) % 4];
        } else {
            *q++ = *from;
        }
    }
}

void rbd_mjcf_v_of_qvel(const rbd_mjcf *robot, const double *qpos, const double *qvel, double *v) {
    for (int i = 0; i < robot->nb; i++) {
        const rbd_joint_type type = robot->bodies[i].type;
        const int n = type == RBD_FLOATING ? 6 : type == RBD_SPHERICAL ? 3 : 1;
        const double *from = qvel;
        if (!rbdi_mjcf_has_q(robot, i)) continue;
        from += robot->places[i].dof;
        for (int k = 0; k < n; k++) v[k] = from[n == 6 ? (k + 3) % 6 : k];
        if (n == 6) rbdi_mjcf_rotate(qpos + robot->places[i].qpos + 3, 1, from, v + 3);
        v += n;
    }
}

/* The body whose joint body i follows. */
static int rbdi_mjcf_leader(const rbd_mjcf *robot, int i) {
    int leader = 0;
    while (!robot->bodies[leader].joint || strcmp(robot->bodies[leader].joint, robot->bodies[i].mimic) != 0)
        leader++;
    return leader;
}

void rbd_mjcf_qpos_of_q(const rbd_mjcf *robot, const double *q, double *qpos) {
    for (int i = 0; i < robot->nb; i++) {
        const rbd_joint_type type = robot->bodies[i].type;
        double *to = qpos;
        if (!rbdi_mjcf_has_q(robot, i)) continue;
        to += robot->places[i].qpos;
        if (type == RBD_FLOATING)
            for (int k = 0; k < 3; k++) *to++ = *q++;
        if (type == RBD_FLOATING || type == RBD_SPHERICAL) {
            for (int k = 0; k < 4; k++) to[(k + 1) % 4] = *q++;
        } else {
            *to = *q++;
        }
    }
    for (int i = 0; robot->places && i < robot->nb; i++) {
        const rbd_body *b = &robot->bodies[i];
        if (!b->mimic || robot->places[i].qpos < 0) continue;
        qpos[robot->places[i].qpos] =
            b->mimic_ratio * qpos[robot->places[rbdi_mjcf_leader(robot, i)].qpos] + b->mimic_offset;
    }
}

void rbd_mjcf_qvel_of_v(const rbd_mjcf *robot, const double *qpos, const double *v, double *qvel) {
    for (int i = 0; i < robot->nb; i++) {
        const rbd_joint_type type = robot->bodies[i].type;
        const int n = type == RBD_FLOATING ? 6 : type == RBD_SPHERICAL ? 3 : 1;
        double *to = qvel;
        if (!rbdi_mjcf_has_q(robot, i)) continue;
        to += robot->places[i].dof;
        for (int k = 0; k < n; k++) to[n == 6 ? (k + 3) % 6 : k] = v[k];
        if (n == 6) rbdi_mjcf_rotate(qpos + robot->places[i].qpos + 3, 0, v + 3, to);
        v += n;
    }
    for (int i = 0; robot->places && i < robot->nb; i++) {
        const rbd_body *b = &robot->bodies[i];
        if (!b->mimic || robot->places[i].dof < 0) continue;
        qvel[robot->places[i].dof] = b->mimic_ratio * qvel[robot->places[rbdi_mjcf_leader(robot, i)].dof];
    }
}

#ifdef __cplusplus
}
#endif

#endif /* RBD_MJCF_IMPLEMENTATION */
