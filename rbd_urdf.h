/* rbd_urdf.h - a robot's URDF file as the description that rbd_model_build takes, on urdfdom.
   SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors. Licence in full at the end of rbd.h.

   A C interface for programs on a PC; firmware takes the C tables that the command rbd-model writes.
   ONE C++ file of the program, linked with urdfdom (pkg-config urdfdom), says

       #define RBD_URDF_IMPLEMENTATION
       #include "rbd_urdf.h"

   and everything else, C or C++, includes it plainly. Meson builds that file as the library rbd_urdf.
   A model from a file:

       static rbd_body bodies[100]; static char names[10000];
       rbd_urdf robot = {.bodies = bodies, .bodies_max = 100, .names = names, .names_max = sizeof names};
       if (rbd_urdf_load("robot.urdf", NULL, &robot) != RBD_URDF_OK) puts(robot.error.text);
       rbd_model_build(robot.bodies, robot.nb, memory, sizeof memory, &model, NULL);

   CONTENTS (search for the tag)
     [reading] [options] [status] [robot] [calls] [lookup]
     --- stop here if you only use it ---
     [formats] [xml] [unread] [xacro] [check] [urdfdom] [description] [result]

   [reading] How a URDF becomes a description:
     order        the moving joints in the order of the file, parents before children; q and v follow
     root link    fixed: it is the world. Floating: body 0, on a floating joint called "root"
     fixed joint  its link is merged into the body it is fixed to, or kept as a body of type RBD_FIXED,
                  a frame whose pose rbd_body_pose gives; all links are listed as frames in any case
     continuous   RBD_CONTINUOUS, without limits
     planar       the axis is the normal. With k the axis's largest component (x, y, z = 0, 1, 2), the
                  first coordinate runs along unit vector k + 1 (after z comes x) made square to the axis,
                  the second along axis cross first: for z they are x, y; for x: y, z; for y: z, x.
                  Unless the axis is z the link is a fixed body on a nameless one that the joint moves
     mimic        follows another joint, also through others. With multiplier 0, or if it follows a joint of
                  options.lock, it is held still at the value that it then has. One that names a missing joint
                  is an error; with options.free_mimics a warning, and the joint moves freely
     axis         made a unit vector; one that is missing is x, with a warning
     limits       zero velocity or effort, or lower >= upper: none. A continuous joint has none; those of less
                  than a turn give a warning
     angles       rad. Values that look like degrees, as limits of -90 and 90, give a warning
     units        m, kg, kg m^2. A place 100 m away or more gives a warning that it looks like mm, unless the
                  joint is fixed; an inertia that the mass would have 20 m from its centre, or farther, one
                  that it looks like kg mm^2 or g mm^2
     dynamics     damping and friction, and armature = "..." there (kg m^2, or kg), for each degree of
                  freedom
     inertial     without it a link has no mass. A warning says so of one between moving joints that has a
                  shape, or length up to the next joint, if other links have mass
     massless     a joint that moves no mass is an error, of a robot without any mass too. lock_massless holds
                  such joints still; kinematic lets them move, for poses, Jacobians and inverse kinematics
                  alone: rbd_model_build_kinematic then takes the description, and dynamics is refused
     rotations    roll, pitch, yaw by the quaternion that urdfdom makes of them, or quat_xyzw (URDF 1.1),
                  made a unit quaternion; entries of the matrix that only rounding keeps from 0, 1 or -1 are
                  that
     version      1.0, 1.1, 1.2: capsules are geometry, and limits of acceleration and jerk are left unread
     encoding     UTF-8, or UTF-16 with or without a byte order mark
     Geometry, materials, sensors, transmissions, and names with a prefix as in <drake:joint> are left unread.
     Each other element or attribute that is not read gives a warning, because its name may be misspelt: with
     options.strict an error. Elements that stand twice must be equal. A source of xacro must be expanded
     first; a tag that xacro left beside a whole robot gives a warning. Other formats are refused by name.

   Called with bodies and names NULL, loading only counts: robot.nb, robot.names_size, robot.nframes and
   robot.nwarnings say how long the arrays must be for the second call.

   An error says what is wrong, names link or joint, and the option that helps. Odd data that can be computed
   with, such as an inertia that no real body has, gives a warning. The text may come from anywhere. Locale
   does not matter. urdfdom's messages are dropped unless options.show_messages; calls from several threads
   wait for each other, because urdfdom has one console. No exception leaves a call; no memory stays taken.
*/
#ifndef RBD_URDF_H
#define RBD_URDF_H

#include "rbd.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- options [options] ---- */

/* A joint to be held still. */
typedef struct rbd_urdf_lock {
    const char *joint;
    double value; /* rad or m; of a planar or floating joint 0, which is its neutral position */
} rbd_urdf_lock;

/* How to read. NULL, or all zero, is a robot with its root link fixed to the world. */
typedef struct rbd_urdf_options {
    rbd_joint_type root;     /* joint of the root link: RBD_FIXED (0) or RBD_FLOATING */
    const char *root_joint;  /* its name, NULL = "root" */
    const double *gravity;   /* 3, world frame, m/s^2, copied to the result; NULL = (0, 0, -9.81) */
    const char *const *keep; /* names of fixed links to keep as bodies, ended by NULL; NULL = none */
    int keep_all;            /* keep all fixed links as bodies */
    int lock_massless;       /* hold joints still that move no mass, with a warning; else an error */
    int kinematic;           /* let joints move no mass: build by rbd_model_build_kinematic */
    int free_mimics;       /* let joints move freely whose <mimic> is wrong, with a warning; else an error */
    int strict;            /* warnings are errors */
    int show_messages;     /* urdfdom's messages go to its console, which is standard error */
    const char *root_link; /* take only this link, as the root, and its subtree; NULL = all */
    const rbd_urdf_lock *lock; /* joints to hold still, ended by joint = NULL; NULL = none */
} rbd_urdf_options;

/* ---- status [status] ---- */

/* Result of loading: 0, or a negative error; with options.strict also a warning's, which are positive. */
typedef enum rbd_urdf_status {
    RBD_URDF_OK = 0,
    RBD_URDF_ERR_NULL = -1,      /* a required pointer is NULL */
    RBD_URDF_ERR_OPTION = -2,    /* an option has no such value, or names a link or joint that is not there */
    RBD_URDF_ERR_FILE = -3,      /* the file cannot be read */
    RBD_URDF_ERR_ROOM = -4,      /* an array is too short: the counts say how long they must be */
    RBD_URDF_ERR_MEMORY = -5,    /* out of memory */
    RBD_URDF_ERR_XML = -6,       /* not well-formed, or nested too deep */
    RBD_URDF_ERR_ROBOT = -7,     /* of another format, without links, still with xacro, or nothing moves */
    RBD_URDF_ERR_NAME = -8,      /* a name is missing or stands twice */
    RBD_URDF_ERR_NUMBER = -9,    /* not a finite number, or not as many as there must be */
    RBD_URDF_ERR_INERTIAL = -10, /* <inertial> is incomplete, or the mass negative */
    RBD_URDF_ERR_JOINT = -11,    /* unknown type, or parent or child is missing */
    RBD_URDF_ERR_AXIS = -12,     /* zero, or without xyz */
    RBD_URDF_ERR_MIMIC = -13,    /* it follows a joint that is missing, itself, or cannot be followed */
    RBD_URDF_ERR_TREE = -14,     /* the links are no tree: a cycle, two parents, two roots */
    RBD_URDF_ERR_MODEL = -15,    /* rbd_model_build would refuse it */
    RBD_URDF_ERR_PARSER = -16,   /* urdfdom refuses it */
    RBD_URDF_WARN_INERTIA = 1,   /* no real body has this mass and inertia */
    RBD_URDF_WARN_LIMIT = 2,  /* limits make no sense: read as none; or a joint is held still beyond them */
    RBD_URDF_WARN_ROOT = 3,   /* a floating root link without mass, or with a second free joint */
    RBD_URDF_WARN_LOCKED = 4, /* a joint that moves no mass, or mimics one at rest, is held still */
    RBD_URDF_WARN_AXIS = 5,   /* an axis or quaternion is not of unit length: made so; or no axis: x */
    RBD_URDF_WARN_NAME = 6,   /* the robot has no name: it is called "robot" */
    RBD_URDF_WARN_MIMIC = 7,  /* a <mimic> is ignored: of a fixed joint, or wrong with options.free_mimics */
    RBD_URDF_WARN_SINGULAR = 8,  /* neither a joint nor those that mimic it move mass */
    RBD_URDF_WARN_DEGREES = 9,   /* an angle is taken as rad, and looks like degrees */
    RBD_URDF_WARN_UNREAD = 10,   /* an element or attribute is not read: its name may be misspelt */
    RBD_URDF_WARN_MASSLESS = 11, /* a link between moving joints has a shape or length, but no <inertial> */
    RBD_URDF_WARN_UNITS = 12     /* taken as m or kg m^2, and looks like mm, kg mm^2 or g mm^2 */
} rbd_urdf_status;

/* A status in a few English words; a static string. */
const char *rbd_urdf_status_string(rbd_urdf_status status);

/* An error or a warning. */
typedef struct rbd_urdf_finding {
    rbd_urdf_status status;
    int line;       /* of the text, from 1; 0 = none in particular */
    char text[400]; /* a sentence that names link or joint, cut to fit */
} rbd_urdf_finding;

/* ---- robot [robot] ---- */

/* A link of the URDF: where it is on the bodies of the description. */
typedef struct rbd_urdf_frame {
    const char *link;
    const char *joint;  /* that carries it, NULL: it is the root */
    int parent;         /* index of the frame that carries it, -1: it is the root */
    int body;           /* index of the body that it is, or is merged into; -1 = the world */
    double position[3]; /* of its origin in that body's frame */
    double rotation[9]; /* 3 x 3, turns its vectors into that body's */
} rbd_urdf_frame;

/* The caller's arrays, and what loading puts there. bodies and names both NULL: nothing is written, only
   the counts are set, and warnings. frames or warnings NULL: not asked for. */
typedef struct rbd_urdf {
    rbd_body *bodies; /* the description; its strings lie in names */
    int bodies_max;
    char *names;
    size_t names_max;
    rbd_urdf_frame *frames; /* all links, in the file's order of joints, the root first */
    int frames_max;
    rbd_urdf_finding *warnings; /* those beyond warnings_max are counted only */
    int warnings_max;
    /* results: */
    const char *name; /* of the robot; in names */
    int nb;           /* bodies */
    int nframes;      /* links */
    int nwarnings;
    size_t names_size;      /* bytes of names */
    double gravity[3];      /* for rbd_set_gravity */
    double fixed_mass;      /* kg, of the links that are fixed to the world: in no body */
    rbd_urdf_finding error; /* its status is what the call returned */
} rbd_urdf;

/* ---- calls [calls] ---- */

/* Loads a file.
   path      of the URDF file
   options   may be NULL
   robot     the caller's arrays; receives the description
   Errors: all of rbd_urdf_status; robot->error has the sentence. */
rbd_urdf_status rbd_urdf_load(const char *path, const rbd_urdf_options *options, rbd_urdf *robot);

/* The same from text in memory: length bytes, need not end with 0. */
rbd_urdf_status rbd_urdf_parse(const char *text, size_t length, const rbd_urdf_options *options,
                               rbd_urdf *robot);

/* ---- lookup [lookup] ----
   In what the last call filled: all is unknown after an error and after a call that only counted. */

/* Index of the body that this joint moves, -1 if there is none: the joint is fixed or unknown. */
int rbd_urdf_joint_index(const rbd_urdf *robot, const char *joint);

/* Index in frames of a link, -1 if there is none (or frames were not asked for). */
int rbd_urdf_link_index(const rbd_urdf *robot, const char *link);

#ifdef __cplusplus
}
#endif

#endif /* RBD_URDF_H */

/* ====================================================================================================
   Implementation
   ================================================================================================= */

#if defined RBD_URDF_IMPLEMENTATION && !defined RBDI_URDF_IMPLEMENTED
#define RBDI_URDF_IMPLEMENTED

#ifndef __cplusplus
#error "rbd_urdf.h: the file that defines RBD_URDF_IMPLEMENTATION must be C++: urdfdom is"
#endif

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

namespace rbdi_urdf {

typedef std::string str;

/* An error that ends a load: thrown inside, caught at the C functions. */
struct failure {
    rbd_urdf_status status;
    int line;
    str text;
    failure(rbd_urdf_status s, int l, const str &t) : status(s), line(l), text(t) {}
};

inline str quoted(const str &name) { return "'" + name + "'"; }

/* A number for a message. */
inline str text_of(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

inline str lock_hint(const str &joint) {
    return "; to hold it still: options.lock, rbd-model --lock " + quoted(joint);
}

inline str kinematic_hint() {
    return "for kinematics alone, as poses and Jacobians: options.kinematic, rbd-model --kinematic";
}

inline str massless_hint(const str &joint) {
    return lock_hint(joint) + ", or --lock-massless for all such; " + kinematic_hint();
}

inline str mimic_hint(const str &joint) {
    return lock_hint(joint) +
           "; to let all such joints move freely: options.free_mimics, rbd-model --free-mimics";
}

inline str xacro_hint() {
    return "expand the file first: xacro FILE -o robot.urdf (of ROS), or xacrodoc FILE -o robot.urdf "
           "(pip install xacrodoc)";
}

/* Whether an angle larger than `usual` is likely to be in degrees: no multiple of ten degrees, as rad. */
inline bool looks_like_degrees(double x, double usual) {
    const double ten = 0.17453292519943295;
    return std::fabs(x) > usual && std::fabs(x) <= 720 && std::fabs(std::remainder(x, ten)) > 0.002;
}
const double a_turn = 7, two_turns = 13; /* as rad, rounded up */
const double whole_turn = 6.28;          /* and down */

/* m: parts of a robot are nearer to each other and smaller. */
const double too_far = 100, too_wide = 20;

inline char lower_case(char c) { return c >= 'A' && c <= 'Z' ? (char)(c | 0x20) : c; }

/* How many characters must be put in, left out, changed, or swapped with the next one, to make one name of
   the other (Damerau, Levenshtein; no character twice); upper and lower case are the same. */
inline size_t difference(const str &a, const str &b) {
    const size_t width = b.size() + 1;
    std::vector<size_t> before(width), last(width), row(width); /* of a's characters up to i - 2, i - 1, i */
    for (size_t k = 0; k < width; ++k) row[k] = k;
    for (size_t i = 1; i <= a.size(); ++i) {
        before.swap(last);
        last.swap(row);
        row[0] = i;
        for (size_t k = 1; k < width; ++k) {
            const bool same = lower_case(a[i - 1]) == lower_case(b[k - 1]);
            const bool swapped = i > 1 && k > 1 && lower_case(a[i - 1]) == lower_case(b[k - 2]) &&
                                 lower_case(a[i - 2]) == lower_case(b[k - 1]);
            row[k] = std::min(last[k - 1] + !same, 1 + std::min(last[k], row[k - 1]));
            if (swapped) row[k] = std::min(row[k], before[k - 2] + 1);
        }
    }
    return row[b.size()];
}

typedef std::map<str, int> name_index;

/* The name that one which is missing may stand for, "" if none comes near: a third of it may differ. */
inline str nearest_name(const str &name, const name_index &known) {
    const size_t longest = 100; /* the time goes with the square */
    size_t least = name.size() / 3 + 1;
    str best;
    for (name_index::const_iterator i = known.begin(); i != known.end(); ++i) {
        const size_t length = i->first.size();
        if (name.size() > longest || length > longest) continue;
        if (std::max(name.size(), length) - std::min(name.size(), length) >= least) continue;
        const size_t d = difference(name, i->first);
        if (d >= least) continue;
        least = d;
        best = i->first;
    }
    return best;
}

/* A hint at that name. */
inline str nearest(const str &name, const name_index &known) {
    const str best = nearest_name(name, known);
    return best.empty() ? best : "; did you mean " + quoted(best) + "?";
}

/* Makes a vector of n components, not all zero, a unit vector and returns its length. The power of two keeps
   the squares in range and changes no digit. */
inline double make_unit(double *v, int n = 3) {
    int exponent;
    double most = 0, square = 0;
    for (int i = 0; i < n; ++i) most = std::fmax(most, std::fabs(v[i]));
    std::frexp(most, &exponent);
    for (int i = 0; i < n; ++i) v[i] = std::ldexp(v[i], -exponent);

    for (int i = 0; i < n; ++i) square += v[i] * v[i];
    const double length = std::sqrt(square);
    for (int i = 0; i < n; ++i) v[i] /= length;
    return std::ldexp(length, exponent);
}

/* ---- formats [formats] ----
   Files that are no URDF at all are known by how they begin. */

/* Whether a text begins so; upper and lower case are the same. */
inline bool begins_with(const char *text, size_t length, const char *start) {
    for (; *start; ++start, ++text, --length)
        if (length == 0 || lower_case(*text) != *start) return false;
    return true;
}

/* A binary file of triangles: 80 bytes, their number, and 50 bytes of each. */
inline bool is_binary_stl(const char *text, size_t length) {
    const unsigned char *p = (const unsigned char *)text + 80;
    if (length < 84) return false;
    const size_t n = p[0] + ((size_t)p[1] << 8) + ((size_t)p[2] << 16) + ((size_t)p[3] << 24);
    return (length - 84) % 50 == 0 && (length - 84) / 50 == n;
}

/* Whether the first line is "name:" or begins so. */
inline bool looks_like_yaml(const char *text, size_t length) {
    size_t n = 0;
    while (n < length && (std::isalnum((unsigned char)text[n]) || text[n] == '_')) ++n;
    return n > 0 && n < length && text[n] == ':' &&
           (n + 1 == length || std::strchr(" \r\n", text[n + 1]) != NULL);
}

/* The sentence for a file that begins as no URDF does, NULL if it may be one. */
inline const char *other_format(const char *text, size_t length) {
    static const struct {
        const char *start, *sentence;
    } all[] = {
        {"pk\x03\x04", "it is a zip archive: unpack it, and read the .urdf in it"},
        {"\x1f\x8b", "it is compressed by gzip: unpack it first, by gunzip"},
        {"pxr-usdc", "it is USD (OpenUSD), binary: export the robot as URDF, or convert it (pip install "
                     "nvidia-srl-usd-to-urdf)"},
        {"#usda", "it is USD (OpenUSD): export the robot as URDF, or convert it (pip install "
                  "nvidia-srl-usd-to-urdf)"},
        {"<!doctype html", "it is a page of HTML and not the file that it shows: download the raw file"},
        {"<html", "it is a page of HTML and not the file that it shows: download the raw file"},
        {"version https://git-lfs", "it is a pointer of git-lfs and not the file itself: git lfs pull"},
        {"404: not found", "it is an answer of a server, 404: the address of the download was wrong"},
        {"gltf", "it is glTF, a mesh: a robot's URDF names its meshes"},
        {"solid ", "it is STL, a mesh: a robot's URDF names its meshes"},
        {"ply", "it is PLY, a mesh: a robot's URDF names its meshes"},
        {"mtllib", "it is OBJ, a mesh: a robot's URDF names its meshes"},
        {"%pdf", "it is PDF, a document"},
        {"{\\rtf", "it is RTF, a document: save it as plain text"},
        {"gif8", "it is GIF, a picture"},
        {"\x89png", "it is PNG, a picture"},
        {"\xff\xd8\xff", "it is JPEG, a picture"},
        {"bzh", "it is compressed by bzip2: unpack it first, by bunzip2"},
        {"\3757zxz", "it is compressed by xz: unpack it first, by unxz"},
        {"7z\xbc\xaf", "it is a 7z archive: unpack it, and read the .urdf in it"},
        {"rar!", "it is a RAR archive: unpack it, and read the .urdf in it"},
        {"{", "it is JSON: URDF is XML, and begins with <robot>"},
        {"[", "it is JSON: URDF is XML, and begins with <robot>"},
        {"---", "it is YAML: URDF is XML, and begins with <robot>"},
    };
    size_t n = begins_with(text, length, "\xef\xbb\xbf") ? 3 : 0; /* a byte order mark */
    while (n < length && text[n] && std::strchr(" \t\r\n", text[n])) ++n;
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        if (begins_with(text + n, length - n, all[i].start)) return all[i].sentence;
    return is_binary_stl(text, length) ? "it is STL, a mesh: a robot's URDF names its meshes"
           : looks_like_yaml(text + n, length - n)
               ? "it looks like YAML: URDF is XML, and begins with <robot>"
               : NULL;
}

/* Elements that files of other formats begin with. */
inline const char *other_root(const str &name) {
    static const struct {
        const char *name, *sentence;
    } all[] = {
        {"mujoco", "MJCF, the format of MuJoCo: rbd_mjcf.h reads it, or convert it to URDF (pip install "
                   "mjcf-urdf-simple-converter)"},
        {"mujocoinclude", "MJCF, the format of MuJoCo, and a part of a robot alone: convert the file that "
                          "includes it"},
        {"sdf", "SDF, the format of Gazebo: export the robot as URDF from the program that wrote it"},
        {"gazebo", "SDF of an old version, the format of Gazebo: export the robot as URDF from the program "
                   "that wrote it"},
        {"COLLADA", "COLLADA, a mesh: a robot's URDF names its meshes"},
        {"Robot", "OpenRAVE: convert it to URDF"},
        {"KinBody", "OpenRAVE: convert it to URDF"},
        {"Environment", "OpenRAVE: convert it to URDF"},
        {"OpenSimDocument", "OpenSim: convert it to URDF"},
        {"launch", "ROS, a launch file: it names the file of the robot"},
        {"package", "ROS, a package.xml: the robot is another file of the package"},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i)
        if (name == all[i].name) return all[i].sentence;
    return NULL;
}

/* Appends a character of UTF-8. */
inline void append_utf8(str &to, unsigned long c) {
    const int extra = c < 0x80 ? 0 : c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
    static const unsigned long lead[] = {0, 0xc0, 0xe0, 0xf0};
    to += (char)(lead[extra] | (c >> (6 * extra)));
    for (int k = extra; k-- > 0;) to += (char)(0x80 | ((c >> (6 * k)) & 0x3f));
}

/* Whether a text is in UTF-16: by its byte order mark, or because one byte of its first two is 0. */
inline bool is_utf16(const char *text, size_t length) {
    if (length < 2) return false;
    const int first = (unsigned char)text[0], second = (unsigned char)text[1];
    return first + second == 0xff + 0xfe || (first == 0) != (second == 0);
}

/* Whether a text is in UTF-32: by its byte order mark, or because three bytes of its first four are 0. */
inline bool is_utf32(const char *text, size_t length) {
    if (length < 4) return false;
    if (std::memcmp(text, "\xff\xfe\0\0", 4) == 0 || std::memcmp(text, "\0\0\xfe\xff", 4) == 0) return true;
    return text[1] == 0 && text[2] == 0 && (text[0] == 0) != (text[3] == 0);
}

/* A text in UTF-16 as one in UTF-8. */
inline str from_utf16(const char *text, size_t length) {
    const unsigned char *p = (const unsigned char *)text;
    const bool little = p[0] == 0xff || p[1] == 0; /* the low byte of a unit is its first */
    const size_t n = length / 2;
    str out;
    if (length % 2) throw failure(RBD_URDF_ERR_XML, 0, "it is text in UTF-16, but ends within a character");
    for (size_t i = p[0] + p[1] == 0xff + 0xfe; i < n; ++i) {
        unsigned long c = p[2 * i + little] * 256ul + p[2 * i + !little];
        if (c >= 0xd800 && c < 0xe000) { /* two units are one character */
            const unsigned long next = i + 1 < n ? p[2 * i + 2 + little] * 256ul + p[2 * i + 2 + !little] : 0;
            if (c >= 0xdc00 || next < 0xdc00 || next >= 0xe000)
                throw failure(RBD_URDF_ERR_XML, 0,
                              "it is text in UTF-16 that has half a character: save it as UTF-8");
            c = 0x10000 + ((c - 0xd800) << 10) + (next - 0xdc00);
            ++i;
        }
        append_utf8(out, c);
    }
    return out;
}

/* ---- XML [xml] ----
   A reader of our own goes first: it bounds the depth, insists on well-formed text, and finds the line
   of what it complains about. It keeps elements and attributes, of the parts that matter here only. */

struct element {
    str name;
    int line;
    std::vector<std::pair<str, str>> attributes;
    std::vector<element> children;

    const str *attribute(const char *key) const {
        for (size_t i = 0; i < attributes.size(); ++i)
            if (attributes[i].first == key) return &attributes[i].second;
        return NULL;
    }
    const element *child(const char *key) const {
        for (size_t i = 0; i < children.size(); ++i)
            if (children[i].name == key) return &children[i];
        return NULL;
    }
    /* Attributes in any order, children in the same. Not deeper than the reader goes. */
    bool says_the_same_as(const element &other) const {
        if (attributes.size() != other.attributes.size() || children.size() != other.children.size())
            return false;
        for (size_t i = 0; i < attributes.size(); ++i) {
            const str *value = other.attribute(attributes[i].first.c_str());
            if (!value || *value != attributes[i].second) return false;
        }
        for (size_t i = 0; i < children.size(); ++i)
            if (children[i].name != other.children[i].name ||
                !children[i].says_the_same_as(other.children[i]))
                return false;
        return true;
    }
};

class reader {
  public:
    reader(const char *text, size_t length) : p(text), end(text + length), line(1) {}

    element document() {
        element top;
        if (p == end) fail("it is empty");
        if (starts("\xef\xbb\xbf")) p += 3;
        while (between_elements()) {
        }
        if (p == end) fail("the text ends before any element");
        if (*p != '<') fail("text before the first element");
        tree(top);
        while (between_elements()) {
        }
        if (p != end) fail("something follows the end of <" + top.name + ">");
        return top;
    }

  private:
    enum { MAX_DEPTH = 100 };
    const char *p, *end;
    int line;

    void fail(const str &what) const { throw failure(RBD_URDF_ERR_XML, line, what); }

    bool starts(const char *s) const {
        size_t n = std::strlen(s);
        return (size_t)(end - p) >= n && std::memcmp(p, s, n) == 0;
    }
    static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
    static bool is_name(char c) { return !is_space(c) && c != '\0' && !std::strchr("<>/=\"'&!?", c); }
    void next() {
        if (*p == '\0') fail("the text has a zero byte");
        if (*p == '\n') ++line;
        ++p;
    }
    void skip_spaces() {
        while (p < end && is_space(*p)) next();
    }
    void skip_past(const char *s, const char *what) {
        int start = line;
        while (p < end && !starts(s)) next();
        if (p == end) {
            line = start;
            fail(str("this ") + what + " has no end");
        }
        p += std::strlen(s);
    }

    /* Skips a space, a comment or a declaration; false if there is none. */
    bool between_elements() {
        if (p == end) return false;
        if (is_space(*p))
            skip_spaces();
        else if (starts("<!--"))
            p += 4, skip_past("-->", "comment");
        else if (starts("<?"))
            skip_past("?>", "declaration");
        else if (starts("<!DOCTYPE"))
            doctype();
        else
            return false;
        return true;
    }
    void doctype() {
        while (p < end && *p != '>') {
            if (*p == '[') fail("declarations of entities are not supported");
            next();
        }
        skip_past(">", "DOCTYPE");
    }

    str name() {
        const char *start = p;
        while (p < end && is_name(*p)) ++p;
        if (p == start) fail("a name must stand here");
        return str(start, p);
    }

    /* The element that starts here, with all that is in it. Not recursive. */
    void tree(element &top) {
        std::vector<element *> open;
        if (start_tag(top)) return;
        open.push_back(&top);
        while (!open.empty()) {
            while (p < end && *p != '<') next();
            if (p == end)
                fail("the text ends inside <" + open.back()->name + "> of line " +
                     std::to_string(open.back()->line));
            if (starts("<!--"))
                p += 4, skip_past("-->", "comment");
            else if (starts("<![CDATA["))
                skip_past("]]>", "CDATA section");
            else if (starts("<?"))
                skip_past("?>", "declaration");
            else if (starts("</"))
                end_tag(open);
            else {
                std::vector<element> &siblings = open.back()->children;
                siblings.push_back(element());
                if (!start_tag(siblings.back())) open.push_back(&siblings.back());
                if (open.size() > MAX_DEPTH)
                    fail("elements are nested more than " + std::to_string((int)MAX_DEPTH) + " deep");
            }
        }
    }
    void end_tag(std::vector<element *> &open) {
        p += 2;
        str found = name();
        if (found != open.back()->name)
            fail("</" + found + "> ends <" + open.back()->name + "> of line " +
                 std::to_string(open.back()->line));
        skip_spaces();
        if (p == end || *p != '>') fail("</" + found + " is not ended by >");
        ++p;
        open.pop_back();
    }

    /* Returns whether the element is empty, <.../>. */
    bool start_tag(element &e) {
        e.line = line;
        ++p;
        e.name = name();
        for (;;) {
            bool spaced = p < end && is_space(*p);
            skip_spaces();
            if (starts("/>")) return p += 2, true;
            if (starts(">")) return ++p, false;
            if (p == end || !spaced || !is_name(*p)) fail("<" + e.name + " is not ended by >");
            attribute(e);
        }
    }
    void attribute(element &e) {
        str key = name(), value;
        if (e.attribute(key.c_str())) fail("<" + e.name + "> has attribute " + quoted(key) + " twice");
        skip_spaces();
        if (p == end || *p != '=') fail("attribute " + quoted(key) + " of <" + e.name + "> has no value");
        ++p;
        skip_spaces();
        if (p == end || (*p != '"' && *p != '\''))
            fail("the value of attribute " + quoted(key) + " of <" + e.name + "> is not in quotes");
        int start = line;
        for (char quote = *p++; p < end && *p != quote;) value += *p == '&' ? entity() : character();
        if (p == end) {
            line = start;
            fail("the value of attribute " + quoted(key) + " of <" + e.name + "> has no end");
        }
        ++p;
        e.attributes.push_back(std::make_pair(key, value));
    }
    str character() {
        char c = *p;
        next();
        return str(1, is_space(c) ? ' ' : c);
    }
    str entity() {
        static const char *const entities[] = {"&lt;", "<",      "&gt;", ">",      "&amp;",
                                               "&",    "&quot;", "\"",   "&apos;", "'"};
        for (int i = 0; i < 10; i += 2)
            if (starts(entities[i])) return p += std::strlen(entities[i]), entities[i + 1];
        if (starts("&#")) return numbered_character();
        fail("unknown entity: a plain & is written &amp;");
        return str();
    }
    str numbered_character() {
        int base = 10;
        unsigned long code = 0;
        p += 2;
        if (p < end && (*p == 'x' || *p == 'X')) base = 16, ++p;
        const char *start = p;
        for (int d; p < end && (d = digit(*p, base)) >= 0 && code < 0x110000; ++p)
            code = code * (unsigned long)base + (unsigned long)d;
        if (p == start || p == end || *p != ';' || code == 0 || code > 0x10ffff)
            fail("no such character: &#...; must be the number of one");
        ++p;
        str character;
        append_utf8(character, code);
        return character;
    }
    static int digit(char c, int base) {
        if (c >= '0' && c <= '9') return c - '0';
        if (base == 16 && c >= 'a' && c <= 'f') return c - 'a' + 10;
        if (base == 16 && c >= 'A' && c <= 'F') return c - 'A' + 10;
        return -1;
    }
};

/* ---- unread [unread] ----
   A misspelt name would vanish. So a warning tells all that is neither read nor known to say nothing about
   dynamics. */

struct warning_list {
    std::vector<rbd_urdf_finding> list;
    bool strict;
    void add(rbd_urdf_status status, int line, const str &text) {
        rbd_urdf_finding f;
        if (strict) throw failure(status, line, text);
        f.status = status;
        f.line = line;
        std::snprintf(f.text, sizeof f.text, "%s", text.c_str());
        list.push_back(f);
    }
};

/* An element that is read. Names in a list have spaces between. */
struct known_element {
    const char *name, *children, *attributes;            /* of those that are read */
    const char *harmless_children, *harmless_attributes; /* of those that may stand there unread */
};

/* The harmless names are of simulators, displays and controllers. Published robots have them, and they say
   nothing about masses, joints and forces that any reader of URDF would take from there. */
inline const known_element *known_elements(size_t &n) {
    static const known_element all[] = {
        {"robot", "link joint", "name",
         "material gazebo transmission sensor camera frame group collision_filter_group disable_collisions "
         "ros2_control mujoco bullet plugin",
         "version"},
        {"link", "inertial", "name",
         "visual collision contact surface material sensor gazebo bullet self_collision_checking "
         "collision_checking self_filter self_collide audio_source gravity kinematic",
         "type concave"},
        {"inertial", "origin mass inertia", "", "", ""},
        {"mass", "", "value", "", ""},
        {"inertia", "", "ixx ixy ixz iyy iyz izz", "", "iyx izx izy"},
        {"joint", "origin parent child axis limit dynamics mimic", "name type",
         "safety_controller calibration controller_gains hardwareInterface gazebo sensor", "dont_collapse"},
        {"origin", "", "xyz rpy quat_xyzw", "", ""},
        {"parent", "", "link", "", ""},
        {"child", "", "link", "", ""},
        {"axis", "", "xyz", "", ""},
        {"limit", "", "lower upper velocity effort", "",
         "acceleration deceleration jerk command_effort current gear_velocity stepSize twist k_velocity"},
        {"dynamics", "", "damping friction armature", "", "D K mu_coulomb mu_viscous"},
        {"mimic", "", "joint multiplier offset", "", ""},
    };
    n = sizeof all / sizeof *all;
    return all;
}

/* The next name of a list, which then begins behind it; "" at the end. */
inline str next_name(const char *&list) {
    const char *start = list, *end = start + std::strcspn(start, " ");
    list = end + std::strspn(end, " ");
    return str(start, end);
}

inline bool has_name(const char *list, const str &name) {
    while (*list)
        if (next_name(list) == name) return true;
    return false;
}

/* Puts the names of a list into an index. */
inline void add_names(const char *list, name_index &names) {
    while (*list) names[next_name(list)] = 0;
}

/* "link 'arm': " before a sentence about a part of it. */
inline str label_of(const element &e) {
    const str *name = e.attribute("name");
    return (e.name == "link" || e.name == "joint") && name ? e.name + " " + quoted(*name) + ": " : "";
}

/* The name behind the prefix of xacro, "" without it. */
inline str after_prefix(const str &name) { return name.compare(0, 6, "xacro:") == 0 ? name.substr(6) : ""; }

class unread_parts {
  public:
    unread_parts(const element &robot, warning_list &w) : warnings(w) {
        look(robot);
        for (size_t i = 0; i < notices.size(); ++i) tell(notices[i]);
    }

  private:
    struct notice {
        int line, times;
        str what, hint;
    };
    warning_list &warnings;
    std::vector<notice> notices;
    name_index first; /* of those that say the same of different links or joints: the index in notices */
    str who;          /* the link or joint that is looked at */

    /* Looks at what stands in an element that is read. The recursion is not deep, because the table of known
       elements has no circle. */
    void look(const element &e) {
        size_t n, k = 0;
        const known_element *all = known_elements(n);
        while (e.name != all[k].name) ++k;
        for (size_t i = 0; i < e.attributes.size(); ++i) attribute(e, all[k], e.attributes[i]);

        for (size_t i = 0; i < e.children.size(); ++i) {
            const element &c = e.children[i];
            if (e.name == "robot") who = label_of(c);
            if (has_name(all[k].children, c.name))
                look(c);
            else
                child(e, all[k], c);
        }
    }

    void attribute(const element &e, const known_element &known, const std::pair<str, str> &a) {
        const str &name = a.first;
        if (has_name(known.attributes, name) || has_name(known.harmless_attributes, name)) return;
        if (has_prefix(name) || name == "xmlns") return;

        const str best = nearest_of(name, known.attributes, known.harmless_attributes);
        const str owner = only_owner(name, &known_element::attributes);
        if (best.empty() && is_zero(a.second)) return;
        note(e.line, "<" + e.name + " " + name + ">",
             !owner.empty()  ? "; it belongs in <" + owner + ">"
             : !best.empty() ? "; did you mean " + quoted(best) + "?"
                             : "");
    }

    void child(const element &e, const known_element &known, const element &c) {
        static const char *const dynamic_with_prefix =
            "drake:joint drake:mimic drake:ball_constraint drake:linear_bushing_rpy drake:tendon_constraint";
        if (has_name(known.harmless_children, c.name)) return;
        const bool xacro = c.name.compare(0, 6, "xacro:") == 0;
        if (has_prefix(c.name) && !xacro && !has_name(dynamic_with_prefix, c.name)) return;

        const str best = nearest_of(c.name, known.children, known.harmless_children);
        const str owner = only_owner(c.name, &known_element::children);
        if (best.empty() && says_only_zero(c)) return;
        const bool part = e.name == "robot" || e.name == "link" || e.name == "joint";
        note(c.line, "<" + c.name + ">" + (part ? "" : " in <" + e.name + ">"),
             xacro                    ? xacro_text(c)
             : c.name == "loop_joint" ? "; the loop stays open: constraints can close it"
             : !owner.empty()         ? "; it belongs in <" + owner + ">"
             : !best.empty()          ? "; did you mean <" + best + ">?"
                                      : "");
    }

    static str xacro_text(const element &e) {
        return has_name("macro property arg", after_prefix(e.name))
                   ? "; the file may be a source of xacro, which is expanded by: xacro FILE -o robot.urdf"
                   : "; xacro left it there: no macro has this name";
    }

    static str nearest_of(const str &name, const char *read, const char *harmless) {
        name_index known;
        add_names(read, known);
        add_names(harmless, known);
        return nearest_name(name, known);
    }

    static bool has_prefix(const str &name) { return name.find(':') != str::npos; }

    /* The element that alone reads this name, "" if none or several do. */
    static str only_owner(const str &name, const char *known_element::*list) {
        size_t n, owners = 0;
        const known_element *all = known_elements(n);
        str owner;
        for (size_t k = 0; k < n; ++k) {
            if (!has_name(all[k].*list, name)) continue;
            owner = all[k].name;
            ++owners;
        }
        return owners == 1 ? owner : "";
    }

    /* An unknown element whose numbers are all 0 changes nothing. */
    static bool is_zero(const str &numbers) {
        return numbers.find_first_not_of("0.+- ") == str::npos && numbers.find('0') != str::npos;
    }
    static bool says_only_zero(const element &e) {
        bool zero = e.children.empty() && !e.attributes.empty();
        for (size_t i = 0; i < e.attributes.size(); ++i) zero = zero && is_zero(e.attributes[i].second);
        return zero;
    }

    /* The same of other links or joints is only counted. */
    void note(int line, const str &what, const str &hint) {
        const std::pair<name_index::iterator, bool> at =
            first.insert(std::make_pair(what + hint, (int)notices.size()));
        if (!at.second) {
            ++notices[(size_t)at.first->second].times;
            return;
        }
        notice x;
        x.line = line;
        x.times = 1;
        x.what = who + what;
        x.hint = hint;
        notices.push_back(x);
    }
    void tell(const notice &x) const {
        const str times = x.times > 1 ? " (" + std::to_string(x.times) + " times in the file)" : "";
        warnings.add(RBD_URDF_WARN_UNREAD, x.line, x.what + " is not read" + times + x.hint);
    }
};

/* ---- xacro [xacro] ----
   A source of xacro must be expanded first. Calls of macros that nothing defines, and definitions alone, may
   be left beside a whole robot: unread_parts tells them. */

/* Refuses elements of xacro that stand for others, and its values. Elements of its first versions have no
   prefix: they count where URDF has its own elements, but not within those of simulators. Not deeper than the
   reader goes. */
class xacro_check {
  public:
    str definition; /* "<xacro:macro> of line 3", "" if there is none */

    explicit xacro_check(const element &robot) {
        gather(robot);
        look(robot, true, "");
    }

  private:
    name_index macros; /* that the file defines */

    void gather(const element &e) {
        const bool macro = e.name == "xacro:macro" || e.name == "macro";
        if (macro && e.attribute("name")) macros[*e.attribute("name")] = 0;
        for (size_t i = 0; i < e.children.size(); ++i) gather(e.children[i]);
    }

    void look(const element &e, bool of_urdf, const str &who) {
        static const char *const own = "include if unless insert_block element attribute call";
        static const char *const old = "include macro property if unless insert_block";
        const str name = after_prefix(e.name);
        if ((of_urdf && has_name(old, e.name)) || has_name(own, name) || macros.count(name)) refuse(e);
        if (has_name("macro property arg", name)) { /* whose inside is not read */
            if (definition.empty()) definition = "<" + e.name + "> of line " + std::to_string(e.line);
            return;
        }

        size_t n, k = 0;
        const known_element *all = known_elements(n);
        while (k < n && e.name != all[k].name) ++k;
        const bool read = of_urdf && k < n;
        for (size_t i = 0; read && i < e.attributes.size(); ++i)
            if (has_name(all[k].attributes, e.attributes[i].first)) look_at_value(e, e.attributes[i], who);
        for (size_t i = 0; i < e.children.size(); ++i)
            look(e.children[i], read, e.name == "robot" ? label_of(e.children[i]) : who);
    }
    static void look_at_value(const element &e, const std::pair<str, str> &a, const str &who) {
        if (a.second.find("${") == str::npos && a.second.find("$(") == str::npos) return;
        throw failure(RBD_URDF_ERR_ROBOT, e.line,
                      who + "<" + e.name + " " + a.first + ">: " + quoted(a.second) +
                          " is of xacro: " + xacro_hint());
    }
    static void refuse(const element &e) {
        throw failure(RBD_URDF_ERR_ROBOT, e.line, "<" + e.name + "> is of xacro: " + xacro_hint());
    }
};

/* ---- check [check] ----
   Everything that urdfdom takes without a word is looked at here; what it gets to see is a text of the
   checked parts alone. */

/* A rotation that is given by quat_xyzw, of unit length: urdfdom does not get to see it. */
struct quaternion {
    bool given;
    double x[4]; /* x, y, z, w */
    quaternion() : given(false) {}
};

struct link_part {
    str name;
    int line;
    bool inertial, massive;    /* has <inertial>; mass or inertia in it is not zero */
    bool shaped;               /* has <visual> or <collision> */
    quaternion turned;         /* of <inertial>'s origin */
    int joint;                 /* that carries it, -1: none */
    std::vector<int> children; /* joints, in the file's order */
    link_part() : line(0), inertial(false), massive(false), shaped(false), joint(-1) {}
};

struct joint_part {
    str name, mimic;
    int line;
    rbd_joint_type motion, type; /* of the file; RBD_FIXED if it is held still */
    int parent, child;           /* links */
    double axis[3], lower, upper, armature, ratio, offset;
    double value;      /* where it is held still */
    quaternion turned; /* of its origin */
    joint_part()
        : line(0), motion(RBD_FIXED), type(RBD_FIXED), parent(-1), child(-1), lower(0), upper(0), armature(0),
          ratio(1), offset(0), value(0) {
        axis[0] = 1, axis[1] = axis[2] = 0; /* URDF's default */
    }
    bool held() const { return type != motion; }
};

inline bool has_joint_axis(rbd_joint_type type) { return type != RBD_FIXED && type != RBD_FLOATING; }
inline bool has_one_dof(rbd_joint_type type) {
    return type == RBD_REVOLUTE || type == RBD_CONTINUOUS || type == RBD_PRISMATIC;
}

/* The link that a joint names as its parent or child. */
inline const str *end_of(const element &joint, const char *which) {
    const element *x = joint.child(which);
    return x ? x->attribute("link") : NULL;
}

/* Removes the links outside this one's subtree, and the joints that they carry. An element without a name, or
   that names a missing link, stays: later checks refuse it. */
inline void take_subtree(element &robot, const str &root) {
    name_index taken; /* all links: whether they hang on the root */
    std::multimap<str, str> carries;
    for (size_t i = 0; i < robot.children.size(); ++i) {
        const element &e = robot.children[i];
        if (e.name == "link" && e.attribute("name")) taken[*e.attribute("name")] = 0;
        if (e.name == "joint" && end_of(e, "parent") && end_of(e, "child"))
            carries.insert(std::make_pair(*end_of(e, "parent"), *end_of(e, "child")));
    }
    if (!taken.count(root))
        throw failure(RBD_URDF_ERR_OPTION, 0,
                      "there is no link " + quoted(root) + " to be the root" + nearest(root, taken));
    for (std::vector<str> open(1, root); !open.empty();) {
        const str link = open.back();
        open.pop_back();
        if (!taken.count(link) || taken[link]++) continue;
        for (std::multimap<str, str>::const_iterator i = carries.lower_bound(link);
             i != carries.end() && i->first == link; ++i)
            open.push_back(i->second);
    }
    std::vector<element> rest;
    for (size_t i = 0; i < robot.children.size(); ++i) {
        element &e = robot.children[i];
        const str *link = e.name == "link"    ? e.attribute("name")
                          : e.name == "joint" ? end_of(e, "parent")
                                              : NULL;
        if (!link || !taken.count(*link) || taken[*link]) rest.push_back(std::move(e));
    }
    robot.children.swap(rest);
}

/* The part of a URDF that dynamics needs, checked, and as text for urdfdom. */
class checked {
  public:
    str robot, text;
    std::vector<link_part> links;
    std::vector<joint_part> joints;
    int root;

    checked(element top, const rbd_urdf_options &o, warning_list &w) : root(-1), options(o), warnings(w) {
        if (options.root_link) take_subtree(top, options.root_link);
        unread_parts(top, warnings);
        robot = name_of_robot(top);
        text = "<robot name=\"" + escaped(robot) + "\">\n";
        for (size_t i = 0; i < top.children.size(); ++i)
            if (top.children[i].name == "link") add_link(top.children[i]);
        if (links.empty()) fail(RBD_URDF_ERR_ROBOT, top, "the robot has no link");
        for (size_t i = 0; i < top.children.size(); ++i)
            if (top.children[i].name == "joint") add_joint(top.children[i]);
        text += "</robot>\n";
        check_tree();
        check_names();
        if (!options.kinematic) check_masses();
        if (options.lock_massless) lock_massless();
        if (options.free_mimics) free_wrong_mimics();
        follow_mimics();
        if (!options.kinematic) check_movers();
        check_count();
    }

    int link(const str &name) const { return find(link_index, name); }
    int joint(const str &name) const { return find(joint_index, name); }

  private:
    const rbd_urdf_options &options;
    warning_list &warnings;
    name_index link_index, joint_index;
    std::vector<int> outwards; /* links, parents first */
    str who;                   /* the link or joint that is being checked */

    static int find(const name_index &index, const str &name) {
        name_index::const_iterator i = index.find(name);
        return i == index.end() ? -1 : i->second;
    }

    void fail(rbd_urdf_status status, const element &e, const str &what) const {
        throw failure(status, e.line, who.empty() ? what : who + ": " + what);
    }

    static str escaped(const str &s) {
        str out;
        for (size_t i = 0; i < s.size(); ++i) {
            if (s[i] == '&')
                out += "&amp;";
            else if (s[i] == '<')
                out += "&lt;";
            else if (s[i] == '>')
                out += "&gt;";
            else if (s[i] == '"')
                out += "&quot;";
            else
                out += s[i];
        }
        return out;
    }

    str name_of(const element &e, const str &what) const {
        const str *name = e.attribute("name");
        if (!name || name->empty()) throw failure(RBD_URDF_ERR_NAME, e.line, what + " has no name");
        for (size_t i = 0; i < name->size(); ++i)
            if ((unsigned char)(*name)[i] < 0x20 || (*name)[i] == 0x7f)
                throw failure(RBD_URDF_ERR_NAME, e.line, "the name of " + what + " has a control character");
        return *name;
    }

    str name_of_robot(const element &e) {
        const str *name = e.attribute("name");
        if (name && !name->empty()) return name_of(e, "the robot");
        warnings.add(RBD_URDF_WARN_NAME, e.line, "the robot has no name; it is called 'robot'");
        return "robot";
    }

    /* The child of this name, NULL if there is none; two that differ are an error. */
    const element *only(const element &e, const char *name) const {
        const element *first = e.child(name);
        for (size_t i = 0; i < e.children.size(); ++i) {
            const element &c = e.children[i];
            if (c.name != name || &c == first) continue;
            if (!c.says_the_same_as(*first)) fail(RBD_URDF_ERR_XML, e, str("<") + name + "> stands twice");
            warnings.add(RBD_URDF_WARN_UNREAD, c.line,
                         who + ": <" + name + "> stands twice; they are the same, and the first is read");
        }
        return first;
    }

    double number(const element &e, const char *attribute, const str &token) const {
        try {
            double x = urdf::strToDouble(token.c_str());
            if (std::isfinite(x)) return x;
        } catch (const std::runtime_error &) {
        }
        fail(RBD_URDF_ERR_NUMBER, e,
             "<" + e.name + " " + attribute + ">: " + quoted(token) + " is not a finite number");
        return 0;
    }

    /* Writes an attribute of n numbers, if it is there, and reads them into x; returns whether it is. */
    bool copy(const element &e, const char *attribute, int n, double *x) {
        const str *value = e.attribute(attribute);
        str numbers;
        int found = 0;
        if (!value) return false;
        for (size_t i = 0; i < value->size();) {
            size_t start = value->find_first_not_of(" ", i);
            if (start == str::npos) break;
            i = value->find(' ', start);
            if (i == str::npos) i = value->size();
            str token = value->substr(start, i - start);
            double y = number(e, attribute, token);
            if (found < n) x[found] = y;
            numbers += (found++ ? " " : "") + token;
        }
        if (found != n)
            fail(RBD_URDF_ERR_NUMBER, e,
                 "<" + e.name + " " + attribute + "> has " + std::to_string(found) + " numbers, not " +
                     std::to_string(n));
        text += str(" ") + attribute + "=\"" + numbers + "\"";
        return true;
    }

    quaternion origin(const element &e) {
        const element *o = only(e, "origin");
        quaternion turned;
        double x[3];
        if (!o) return turned;
        turned = quaternion_of(*o);
        text += "<origin";
        if (copy(*o, "xyz", 3, x)) warn_of_millimetres(e, *o, x);
        if (copy(*o, "rpy", 3, x) && (looks_like_degrees(x[0], a_turn) || looks_like_degrees(x[1], a_turn) ||
                                      looks_like_degrees(x[2], a_turn)))
            warn_of_degrees(*o, "<origin rpy>, " + text_of(x[0]) + " " + text_of(x[1]) + " " + text_of(x[2]) +
                                    ",");
        text += "/>";
        return turned;
    }

    /* The attribute quat_xyzw of URDF 1.1, as a unit quaternion. */
    quaternion quaternion_of(const element &o) {
        quaternion q;
        str aside;
        std::swap(text, aside); /* urdfdom may not know it */
        q.given = copy(o, "quat_xyzw", 4, q.x);
        std::swap(text, aside);
        if (!q.given) return q;
        if (o.attribute("rpy")) fail(RBD_URDF_ERR_NUMBER, o, "<origin> has rpy and quat_xyzw: give one");
        if (q.x[0] == 0 && q.x[1] == 0 && q.x[2] == 0 && q.x[3] == 0)
            fail(RBD_URDF_ERR_NUMBER, o, "<origin quat_xyzw> is zero");

        const double length = make_unit(q.x, 4);
        if (length < 0.99 || length > 1.01)
            warnings.add(RBD_URDF_WARN_AXIS, o.line,
                         who + ": <origin quat_xyzw> is of length " + text_of(length) +
                             "; made a unit quaternion");
        return q;
    }
    /* A fixed joint, or one that lets a vehicle go anywhere, may be as far as a robot in a hall is from the
       origin. */
    void warn_of_millimetres(const element &e, const element &o, const double x[3]) const {
        const str *type = e.attribute("type");
        if (type && (*type == "fixed" || *type == "floating" || *type == "planar")) return;
        if (std::fabs(x[0]) < too_far && std::fabs(x[1]) < too_far && std::fabs(x[2]) < too_far) return;
        warnings.add(RBD_URDF_WARN_UNITS, o.line,
                     who + ": <origin xyz>, " + text_of(x[0]) + " " + text_of(x[1]) + " " + text_of(x[2]) +
                         ", looks like mm; it is read as m");
    }

    /* trace(I) = 2 sum m r^2, r from the centre of mass. */
    void warn_of_units(const element &inertia, double mass, double trace) const {
        const double radius = std::sqrt(trace / 2 / mass);
        if (!(mass > 0) || !(radius >= too_wide)) return;
        warnings.add(RBD_URDF_WARN_UNITS, inertia.line,
                     who + ": <inertia> is that of this mass " + text_of(radius) +
                         " m from its centre; it looks like kg mm^2 or g mm^2, and is read as kg m^2");
    }

    void warn_of_degrees(const element &e, const str &what) const {
        warnings.add(RBD_URDF_WARN_DEGREES, e.line,
                     who + ": " + what + " looks like degrees; it is read as rad");
    }

    void add_link(const element &e) {
        link_part l;
        who.clear();
        l.name = name_of(e, "a link");
        l.line = e.line;
        who = "link " + quoted(l.name);
        if (!link_index.insert(std::make_pair(l.name, (int)links.size())).second)
            fail(RBD_URDF_ERR_NAME, e, "the name stands twice");
        text += "<link name=\"" + escaped(l.name) + "\">";
        l.shaped = e.child("visual") || e.child("collision");
        if (const element *inertial = only(e, "inertial")) {
            l.inertial = true;
            l.massive = add_inertial(*inertial, l.turned);
        }
        text += "</link>\n";
        links.push_back(l);
    }

    /* Returns whether anything in it is not zero. */
    bool add_inertial(const element &e, quaternion &turned) {
        static const char *const entries[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
        static const char *const mirrored[] = {"", "iyx", "izx", "", "izy", ""};
        const element *mass = only(e, "mass"), *inertia = only(e, "inertia");
        double x, largest, trace = 0;
        text += "<inertial>";
        turned = origin(e);
        if (!mass) fail(RBD_URDF_ERR_INERTIAL, e, "<inertial> has no <mass>");
        if (!inertia) fail(RBD_URDF_ERR_INERTIAL, e, "<inertial> has no <inertia>");
        text += "<mass";
        if (!copy(*mass, "value", 1, &x)) fail(RBD_URDF_ERR_INERTIAL, *mass, "<mass> has no value");
        if (x < 0) fail(RBD_URDF_ERR_INERTIAL, *mass, "the mass is negative");
        const double kilograms = x;
        largest = x;
        text += "/><inertia";
        for (int i = 0; i < 6; ++i) {
            if (!copy(*inertia, entries[i], 1, &x))
                fail(RBD_URDF_ERR_INERTIAL, *inertia, str("<inertia> has no ") + entries[i]);
            largest = std::fmax(largest, std::fabs(x));
            if (i == 0 || i == 3 || i == 5) trace += x;
            const str *mirror = inertia->attribute(mirrored[i]);
            if (mirror && number(*inertia, mirrored[i], *mirror) != x)
                warnings.add(RBD_URDF_WARN_INERTIA, inertia->line,
                             who + ": <inertia " + mirrored[i] + "> differs from " + entries[i] +
                                 " and is not read");
        }
        text += "/></inertial>";
        warn_of_units(*inertia, kilograms, trace);
        return largest > 0;
    }

    rbd_joint_type joint_type(const element &e) const {
        static const struct {
            const char *name;
            rbd_joint_type type;
        } types[] = {{"revolute", RBD_REVOLUTE}, {"continuous", RBD_CONTINUOUS}, {"prismatic", RBD_PRISMATIC},
                     {"fixed", RBD_FIXED},       {"floating", RBD_FLOATING},     {"planar", RBD_PLANAR}};
        const str *type = e.attribute("type");
        if (!type) fail(RBD_URDF_ERR_JOINT, e, "it has no type");
        name_index known;
        for (size_t i = 0; i < sizeof types / sizeof *types; ++i) {
            if (*type == types[i].name) return types[i].type;
            known[types[i].name] = types[i].type;
        }
        fail(RBD_URDF_ERR_JOINT, e, "unknown type " + quoted(*type) + nearest(*type, known));
        return RBD_FIXED;
    }

    int end_of_joint(const element &e, const char *which) {
        const element *x = only(e, which);
        const str *name = end_of(e, which);
        if (!name) fail(RBD_URDF_ERR_JOINT, e, str("it has no <") + which + " link=\"...\">");
        int index = link(*name);
        if (index < 0)
            fail(RBD_URDF_ERR_JOINT, *x,
                 str("its ") + which + " link " + quoted(*name) + " is missing" + nearest(*name, link_index));
        text += str("<") + which + " link=\"" + escaped(*name) + "\"/>";
        return index;
    }

    void add_joint(const element &e) {
        joint_part j;
        who.clear();
        j.name = name_of(e, "a joint");
        j.line = e.line;
        who = "joint " + quoted(j.name);
        if (!joint_index.insert(std::make_pair(j.name, (int)joints.size())).second)
            fail(RBD_URDF_ERR_NAME, e, "the name stands twice");
        j.motion = j.type = joint_type(e);
        text += "<joint name=\"" + escaped(j.name) + "\" type=\"" + *e.attribute("type") + "\">";
        j.turned = origin(e);
        j.parent = end_of_joint(e, "parent");
        j.child = end_of_joint(e, "child");
        if (has_joint_axis(j.type)) axis(e, j.axis);
        if (has_one_dof(j.type)) limit(e, j);
        dynamics(e, j);
        if (const rbd_urdf_lock *lock = lock_of(j.name))
            hold_at(j, lock->value);
        else
            mimic(e, j);
        text += "</joint>\n";
        hang(e, j);
        joints.push_back(j);
    }

    void axis(const element &e, double x[3]) {
        const element *a = only(e, "axis");
        if (!a) {
            warnings.add(RBD_URDF_WARN_AXIS, e.line, who + ": it has no <axis>; read as 1 0 0");
            return;
        }
        text += "<axis";
        if (!copy(*a, "xyz", 3, x)) fail(RBD_URDF_ERR_AXIS, *a, "<axis> has no xyz");
        text += "/>";
        if (x[0] == 0 && x[1] == 0 && x[2] == 0) fail(RBD_URDF_ERR_AXIS, *a, "the axis is zero");
        double unit[3] = {x[0], x[1], x[2]};
        const double length = make_unit(unit);
        if (length > 0.99 && length < 1.01) return; /* as it is written: rounded */
        std::memcpy(x, unit, sizeof unit);
        warnings.add(RBD_URDF_WARN_AXIS, a->line,
                     who + ": the axis is of length " + text_of(length) + "; made a unit vector");
    }

    /* urdfdom insists on limits, dynamics does not: what is missing, infinite or makes no sense is none. */
    void limit(const element &e, joint_part &j) {
        static const char *const names[] = {"lower", "upper", "velocity", "effort"};
        const element *l = only(e, "limit");
        const bool needed = j.type != RBD_CONTINUOUS;
        double x[4] = {0, 0, 0, 0};
        bool finite[4] = {true, true, true, true};
        if (!l && needed) no_limit(e, "it has no <limit>");
        for (int i = 0; l && i < 4; ++i)
            finite[i] = read_limit(*l, names[i], needed && i >= 2, needed || i >= 2, x[i]);
        const bool both = finite[0] && finite[1], bounds = needed && both && x[0] < x[1];
        if (needed && both && x[0] > x[1]) no_limit(*l, "the lower limit exceeds the upper");
        if (needed && both && x[0] == x[1] && x[0] != 0) no_limit(*l, "the lower limit equals the upper");
        if (!needed && both && x[0] < x[1] && x[1] - x[0] < whole_turn)
            no_limit(*l, "it is continuous, but has limits, " + text_of(x[0]) + " .. " + text_of(x[1]));
        if (bounds) j.lower = x[0], j.upper = x[1];
        if (j.type == RBD_REVOLUTE &&
            (looks_like_degrees(j.lower, two_turns) || looks_like_degrees(j.upper, two_turns)))
            warn_of_degrees(*l, "<limit>, " + text_of(j.lower) + " .. " + text_of(j.upper) + ",");
        text += "<limit";
        for (int i = 0; i < 4; ++i) {
            if (i < 2 ? bounds : x[i] > 0)
                copy(*l, names[i], 1, &x[i]);
            else if (i >= 2)
                text += str(" ") + names[i] + "=\"0\"";
        }
        text += "/>";
    }

    /* Returns whether the limit is finite. Not needed: it may be missing; not used: it may be infinite. */
    bool read_limit(const element &l, const char *name, bool needed, bool used, double &x) {
        const str *value = l.attribute(name);
        str aside;
        if (value && is_infinite(*value)) {
            if (used) no_limit(l, str("the ") + name + " limit is infinite");
            return false;
        }
        std::swap(text, aside); /* it is not written yet */
        if (!copy(l, name, 1, &x) && needed) no_limit(l, str("<limit> has no ") + name);
        std::swap(text, aside);
        if (needed && x < 0) no_limit(l, str("the ") + name + " limit is negative");
        return true;
    }
    static bool is_infinite(const str &value) {
        str word;
        for (size_t i = 0; i < value.size(); ++i)
            if (!std::strchr("+- .", value[i])) word += lower_case(value[i]);
        return word == "inf" || word == "infinity";
    }
    void no_limit(const element &e, const str &what) const {
        warnings.add(RBD_URDF_WARN_LIMIT, e.line, who + ": " + what + "; read as none");
    }

    void dynamics(const element &e, joint_part &j) {
        static const char *const names[] = {"damping", "friction", "armature"};
        const element *d = only(e, "dynamics");
        double x[3] = {0, 0, 0};
        if (!d) return;
        const size_t start = text.size();
        text += "<dynamics";
        for (int i = 0; i < 3; ++i) {
            copy(*d, names[i], 1, &x[i]);
            if (x[i] < 0) fail(RBD_URDF_ERR_NUMBER, *d, str("the ") + names[i] + " is negative");
        }
        text += "/>";
        if (!d->attribute("damping") && !d->attribute("friction"))
            text.resize(start); /* urdfdom refuses it */
        j.armature = x[2];
    }

    void mimic(const element &e, joint_part &j) {
        const element *m = only(e, "mimic");
        if (m && j.type == RBD_FIXED)
            warnings.add(RBD_URDF_WARN_MIMIC, m->line, who + ": it is fixed; its <mimic> is ignored");
        if (!m || j.type == RBD_FIXED) return;
        const str *name = m->attribute("joint");
        if (!name || name->empty()) fail(RBD_URDF_ERR_MIMIC, *m, "<mimic> has no joint");
        if (!has_one_dof(j.type)) {
            const str why = "only revolute, continuous and prismatic joints can mimic";
            if (!options.free_mimics) fail(RBD_URDF_ERR_MIMIC, *m, why + mimic_hint(j.name));
            warnings.add(RBD_URDF_WARN_MIMIC, m->line, who + ": " + why + "; it moves freely");
            return;
        }
        j.mimic = *name;
        text += "<mimic joint=\"" + escaped(*name) + "\"";
        copy(*m, "multiplier", 1, &j.ratio);
        copy(*m, "offset", 1, &j.offset);
        if (j.type != RBD_PRISMATIC && looks_like_degrees(j.offset, two_turns))
            warn_of_degrees(*m, "<mimic offset>, " + text_of(j.offset) + ",");
        text += "/>";
    }

    /* The options' entry for a joint, NULL if there is none. */
    const rbd_urdf_lock *lock_of(const str &joint) const {
        for (const rbd_urdf_lock *l = options.lock; l && l->joint; ++l)
            if (joint == l->joint) return l;
        return NULL;
    }

    /* Makes a joint fixed. */
    static void hold(joint_part &j, double value) {
        j.type = RBD_FIXED;
        j.value = value;
        j.mimic.clear();
    }
    void hold_at(joint_part &j, double value) const {
        const str joint = "joint " + quoted(j.name), at = "held still at " + text_of(value);
        if (!std::isfinite(value))
            throw failure(RBD_URDF_ERR_NUMBER, j.line, joint + ": " + at + ", which is not finite");
        if (value != 0 && !has_one_dof(j.motion))
            throw failure(RBD_URDF_ERR_OPTION, j.line,
                          joint + ": only revolute, continuous and prismatic joints can be " + at);
        if (j.lower < j.upper && (value < j.lower || value > j.upper))
            warnings.add(RBD_URDF_WARN_LIMIT, j.line,
                         joint + ": " + at + ", beyond its limits " + text_of(j.lower) + " .. " +
                             text_of(j.upper));
        else if (j.motion != RBD_PRISMATIC && looks_like_degrees(value, two_turns))
            warnings.add(RBD_URDF_WARN_DEGREES, j.line,
                         joint + ": " + at + ", which looks like degrees; it is read as rad");
        hold(j, value);
    }

    void hang(const element &e, const joint_part &j) {
        link_part &child = links[(size_t)j.child];
        const int number = (int)joints.size();
        if (j.parent == j.child)
            fail(RBD_URDF_ERR_TREE, e, "parent and child are the same link " + quoted(child.name));
        if (child.joint >= 0)
            fail(RBD_URDF_ERR_TREE, e,
                 "its child link " + quoted(child.name) + " is already the child of joint " +
                     quoted(joints[(size_t)child.joint].name));
        child.joint = number;
        links[(size_t)j.parent].children.push_back(number);
    }

    void check_tree() {
        size_t reached = 0;
        for (size_t i = 0; i < links.size(); ++i) {
            if (links[i].joint >= 0) continue;
            if (root >= 0)
                throw failure(RBD_URDF_ERR_TREE, links[i].line,
                              "two links are no joint's child, so there are two roots: " +
                                  quoted(links[(size_t)root].name) + " and " + quoted(links[i].name) +
                                  "; to take one with its subtree: options.root_link, rbd-model --root " +
                                  quoted(links[(size_t)root].name));
            root = (int)i;
        }
        std::vector<bool> seen(links.size(), false);
        if (root >= 0) outwards.push_back(root);
        for (; reached < outwards.size(); ++reached) {
            const link_part &l = links[(size_t)outwards[reached]];
            seen[(size_t)outwards[reached]] = true;
            for (size_t k = 0; k < l.children.size(); ++k)
                outwards.push_back(joints[(size_t)l.children[k]].child);
        }
        for (size_t i = 0; reached < links.size() && i < links.size(); ++i)
            if (!seen[i])
                throw failure(RBD_URDF_ERR_TREE, links[cycle_from(i)].line,
                              "link " + quoted(links[cycle_from(i)].name) +
                                  " is its own ancestor: the joints form a cycle");
    }

    /* From a link that the root does not reach, towards its ancestors: one that is on the cycle. */
    size_t cycle_from(size_t i) const {
        for (size_t step = 0; step < links.size(); ++step) i = (size_t)joints[(size_t)links[i].joint].parent;
        return i;
    }

    /* Of each joint, whether it moves mass or has armature, or one does that mimics it. */
    std::vector<bool> movers() const {
        std::vector<bool> massive(links.size()), moves(joints.size());
        for (size_t k = outwards.size(); k-- > 1;) {
            const size_t child = (size_t)outwards[k], number = (size_t)links[child].joint;
            massive[child] = massive[child] || links[child].massive;
            moves[number] = massive[child] || joints[number].armature > 0;
            if (massive[child]) massive[(size_t)joints[number].parent] = true;
        }
        for (size_t i = 0; i < joints.size(); ++i)
            for (int k = moves[i] ? joint(joints[i].mimic) : -1; k >= 0 && !moves[(size_t)k];
                 k = joint(joints[(size_t)k].mimic))
                moves[(size_t)k] = true;
        return moves;
    }

    void lock_massless() {
        const std::vector<bool> moves = movers();
        for (size_t k = outwards.size(); k-- > 1;) {
            const int number = links[(size_t)outwards[k]].joint;
            joint_part &j = joints[(size_t)number];
            if (j.type == RBD_FIXED || moves[(size_t)number]) continue;
            warnings.add(RBD_URDF_WARN_LOCKED, j.line,
                         "joint " + quoted(j.name) + ": it moves no mass; held still");
            hold(j, 0);
        }
    }

    /* If joints move but no mass does, the file has no masses: the message says so, and names no joint. */
    void check_masses() const {
        const std::vector<bool> moves = movers();
        const bool floats = options.root == RBD_FLOATING;
        int line = -1;

        for (size_t i = 0; floats && i < links.size(); ++i)
            if (links[i].massive) return;
        for (size_t i = joints.size(); i-- > 0;) {
            if (joints[i].type == RBD_FIXED) continue;
            if (moves[i]) return;
            line = joints[i].line;
        }
        if (line < 0 && !floats) return;

        throw failure(RBD_URDF_ERR_MODEL, std::max(line, 0),
                      "no link that moves has mass: dynamics needs <inertial>; " + kinematic_hint());
    }

    /* Of each joint, whether another moves behind it. */
    std::vector<bool> carriers() const {
        std::vector<bool> below(links.size()), carries(joints.size());
        for (size_t k = outwards.size(); k-- > 1;) {
            const size_t child = (size_t)outwards[k], number = (size_t)links[child].joint;
            carries[number] = below[child];
            if (below[child] || joints[number].type != RBD_FIXED) below[(size_t)joints[number].parent] = true;
        }
        return carries;
    }

    /* rbd_model_build refuses a joint that moves no mass, but not one that others mimic, or that carries a
       joint which is not refused. */
    void check_movers() const {
        const std::vector<bool> carries = carriers();
        std::vector<bool> good = movers(), leads(joints.size());
        for (size_t i = 0; i < joints.size(); ++i)
            if (joint(joints[i].mimic) >= 0) leads[(size_t)joint(joints[i].mimic)] = true;

        for (size_t i = 0; i < joints.size(); ++i) {
            const int leader = joint(joints[i].mimic);
            const size_t k = leader < 0 ? i : (size_t)leader;
            const joint_part &j = joints[k];
            if (good[k] || j.type == RBD_FIXED || (leader < 0 && !carries[k])) continue;

            good[k] = true; /* told once */
            warnings.add(
                RBD_URDF_WARN_SINGULAR, j.line,
                "joint " + quoted(j.name) + ": " +
                    (leads[k] ? "neither it nor joints that mimic it move mass" : "it moves no mass") +
                    ": forward dynamics is singular" + massless_hint(j.name));
        }
    }

    /* A hint at the joint that is meant by a name that none has. */
    str joint_meant(const str &name) const {
        const int child = link(name), number = child < 0 ? -1 : links[(size_t)child].joint;
        if (number < 0) return nearest(name, joint_index);
        return "; link " + quoted(name) + " hangs on joint " + quoted(joints[(size_t)number].name);
    }

    /* That the options name what is there. */
    void check_names() const {
        const str part = options.root_link ? " on link " + quoted(options.root_link) : "";
        for (const char *const *k = options.keep; k && *k; ++k)
            if (link(*k) < 0)
                throw failure(RBD_URDF_ERR_OPTION, 0,
                              "there is no link " + quoted(*k) + " to keep" + part + nearest(*k, link_index));
        for (const rbd_urdf_lock *l = options.lock; l && l->joint; ++l) {
            if (joint(l->joint) < 0)
                throw failure(RBD_URDF_ERR_OPTION, 0,
                              "there is no joint " + quoted(l->joint) + " to hold still" + part +
                                  joint_meant(l->joint));
            if (lock_of(l->joint) != l)
                throw failure(RBD_URDF_ERR_OPTION, 0,
                              "joint " + quoted(l->joint) + " is to be held still twice");
        }
    }

    void check_count() const {
        int moving = 0;
        for (size_t i = 0; i < joints.size(); ++i) moving += joints[i].type != RBD_FIXED;
        if (moving > RBD_MAX_BODIES)
            throw failure(RBD_URDF_ERR_MODEL, 0,
                          "the model: " + std::to_string(moving) +
                              " moving joints are more than RBD_MAX_BODIES, " +
                              std::to_string(RBD_MAX_BODIES));
    }

    /* Makes every joint that mimics follow one that does not, as rbd's do, or holds it still. */
    void follow_mimics() {
        std::vector<bool> good(joints.size(), false);
        std::vector<size_t> path;
        for (size_t i = 0; i < joints.size(); ++i) {
            path.clear();
            for (size_t k = i; !good[k] && !joints[k].mimic.empty(); k = source_of(k)) {
                if (path.size() == joints.size() || (k == i && !path.empty()))
                    refuse_mimic(i, k == i ? path.size() > 1 ? "itself through others" : "itself"
                                           : "joints that mimic each other in a circle");
                path.push_back(k);
            }
            for (size_t step = path.size(); step-- > 0; good[path[step]] = true) follow(joints[path[step]]);
        }
    }

    /* The one that this joint mimics leads, follows one that leads, or is held still. */
    void follow(joint_part &j) {
        const joint_part &source = joints[(size_t)joint(j.mimic)];
        if (source.held()) {
            hold_follower(j, j.ratio * source.value + j.offset, "it mimics " + quoted(j.mimic));
            return;
        }
        if (!source.mimic.empty()) {
            j.offset += j.ratio * source.offset;
            j.ratio *= source.ratio;
            j.mimic = source.mimic;
        }
        if (j.ratio == 0) hold_follower(j, j.offset, "its <mimic> has multiplier 0");
    }
    void hold_follower(joint_part &j, double value, const str &why) const {
        hold_at(j, value);
        warnings.add(RBD_URDF_WARN_LOCKED, j.line,
                     "joint " + quoted(j.name) + ": held still at " + text_of(value) + ", as " + why);
    }

    /* Lets each joint move freely whose <mimic> follow_mimics would refuse. Each joint is looked at once:
       walk i goes from joint i to those that it follows, and ends where an earlier one went. */
    void free_wrong_mimics() {
        const size_t none = joints.size();
        std::vector<size_t> walk(joints.size(), none);
        for (size_t i = 0; i < joints.size(); ++i)
            for (size_t k = i; !joints[k].mimic.empty(); k = (size_t)joint(joints[k].mimic)) {
                const bool circle = walk[k] == i;
                if (walk[k] != none && !circle) break;
                walk[k] = i;

                const bool own = joint(joints[k].mimic) == (int)k;
                const str why = circle ? own ? "itself" : "itself through others" : wrong_source(k);
                if (why.empty()) continue;
                free_mimic(joints[k], why);
                break;
            }
    }
    void free_mimic(joint_part &j, const str &why) const {
        warnings.add(RBD_URDF_WARN_MIMIC, j.line,
                     "joint " + quoted(j.name) + ": it mimics " + why + "; it moves freely");
        j.mimic.clear();
        j.ratio = 1;
        j.offset = 0;
    }

    /* Why a joint cannot mimic the one that it names, "" if it can. */
    str wrong_source(size_t follower) const {
        const str &name = joints[follower].mimic;
        const int source = joint(name);
        if (source < 0) return quoted(name) + ", which is missing" + nearest(name, joint_index);
        if (!has_one_dof(joints[(size_t)source].motion))
            return quoted(name) + ", which is not revolute, continuous or prismatic";
        return "";
    }

    /* The joint that this one mimics: it must be there, and be able to lead. */
    size_t source_of(size_t follower) const {
        const str why = wrong_source(follower);
        const int source = joint(joints[follower].mimic);
        if (!why.empty()) refuse_mimic(follower, why, source < 0 ? missing_sources_but(follower) : "");
        return (size_t)source;
    }
    /* The missing joints that others mimic, for the same message. */
    str missing_sources_but(size_t follower) const {
        str others;
        for (size_t i = 0; i < joints.size(); ++i)
            if (i != follower && !joints[i].mimic.empty() && joint(joints[i].mimic) < 0)
                others += (others.empty() ? "; missing too: " : ", ") + quoted(joints[i].mimic) + " of " +
                          quoted(joints[i].name);
        return others;
    }
    void refuse_mimic(size_t follower, const str &what, const str &others = "") const {
        const joint_part &j = joints[follower];
        throw failure(RBD_URDF_ERR_MIMIC, j.line,
                      "joint " + quoted(j.name) + ": it mimics " + what + mimic_hint(j.name) + others);
    }
};

/* ---- urdfdom [urdfdom] ---- */

/* Takes urdfdom's messages while it lives, unless they shall be shown, and keeps the last one. */
class console {
  public:
    explicit console(bool show) : shown(show), previous(console_bridge::getOutputHandler()) {
        if (!shown) console_bridge::useOutputHandler(&handler);
    }
    ~console() {
        if (!shown) console_bridge::useOutputHandler(previous);
    }
    const str &last() const { return handler.last; }

  private:
    struct keeper : console_bridge::OutputHandler {
        str last;
        void log(const str &message, console_bridge::LogLevel, const char *, int) override { last = message; }
    } handler;
    bool shown;
    console_bridge::OutputHandler *previous;
    console(const console &);
    console &operator=(const console &);
};

/* The model of urdfdom. Its destructor would recurse from parent to child: ours unties them before. */
class parsed {
  public:
    parsed(const str &text, bool show) {
        static std::mutex one_at_a_time;
        std::lock_guard<std::mutex> lock(one_at_a_time);
        console messages(show);
        model = urdf::parseURDF(text);
        if (!model) throw failure(RBD_URDF_ERR_PARSER, 0, "urdfdom refuses it: " + messages.last());
    }
    ~parsed() {
        std::map<str, urdf::LinkSharedPtr>::iterator i;
        for (i = model->links_.begin(); i != model->links_.end(); ++i) {
            i->second->child_links.clear();
            i->second->child_joints.clear();
        }
    }
    const urdf::Link &link(const str &name) const {
        urdf::LinkConstSharedPtr l = model->getLink(name);
        if (!l) throw failure(RBD_URDF_ERR_PARSER, 0, "link " + quoted(name) + ": urdfdom lost it");
        return *l;
    }
    const urdf::Joint &joint(const str &name) const {
        urdf::JointConstSharedPtr j = model->getJoint(name);
        if (!j) throw failure(RBD_URDF_ERR_PARSER, 0, "joint " + quoted(name) + ": urdfdom lost it");
        return *j;
    }

  private:
    urdf::ModelInterfaceSharedPtr model;
    parsed(const parsed &);
    parsed &operator=(const parsed &);
};

/* ---- description [description] ---- */

/* A frame in another: rotation, row-major, turns its vectors into the other's; position of its origin. */
struct pose {
    double R[9], p[3];
    pose() {
        for (int i = 0; i < 9; ++i) R[i] = i % 4 == 0;
        for (int i = 0; i < 3; ++i) p[i] = 0;
    }
};

inline bool is_identity(const double R[9]) {
    for (int i = 0; i < 9; ++i)
        if (R[i] != (i % 4 == 0)) return false;
    return true;
}

/* An entry that differs from 0, 1 or -1 by rounding alone becomes that number. */
inline void snap(double R[9]) {
    for (int i = 0; i < 9; ++i)
        if (std::fabs(R[i] - std::round(R[i])) <= 1e-15) R[i] = std::round(R[i]) + 0.0;
}

inline pose pose_of(const urdf::Pose &from, const quaternion &turned) {
    pose to;
    double x, y, z, w;
    from.rotation.getQuaternion(x, y, z, w);
    if (turned.given) x = turned.x[0], y = turned.x[1], z = turned.x[2], w = turned.x[3];
    const double R[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
                         2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                         2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
    std::memcpy(to.R, R, sizeof R);
    snap(to.R);
    to.p[0] = from.position.x, to.p[1] = from.position.y, to.p[2] = from.position.z;
    return to;
}

inline void turn(const double R[9], const double v[3], double out[3]) {
    const double a = v[0], b = v[1], c = v[2];
    for (int i = 0; i < 3; ++i) out[i] = R[3 * i] * a + R[3 * i + 1] * b + R[3 * i + 2] * c;
}

inline void multiply(const double A[9], const double B[9], double out[9]) {
    double C[9];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
    std::memcpy(out, C, sizeof C);
}

inline pose compose(const pose &a, const pose &b) {
    pose c;
    if (is_identity(a.R))
        std::memcpy(c.R, b.R, sizeof c.R);
    else
        multiply(a.R, b.R, c.R), snap(c.R);
    turn(a.R, b.p, c.p);
    for (int i = 0; i < 3; ++i) c.p[i] += a.p[i];
    return c;
}

/* A rigid part: mass, centre of mass, inertia xx xy xz yy yz zz about it. */
struct part {
    double mass, com[3], inertia[6];
    part() : mass(0) {
        for (int i = 0; i < 3; ++i) com[i] = 0;
        for (int i = 0; i < 6; ++i) inertia[i] = 0;
    }
    bool nothing() const {
        for (int i = 0; i < 6; ++i)
            if (inertia[i] != 0) return false;
        return mass == 0;
    }
};

/* The part in the frame in which its own has this pose. */
inline part moved(const part &from, const pose &x) {
    part to = from;
    turn(x.R, from.com, to.com);
    for (int i = 0; i < 3; ++i) to.com[i] += x.p[i];
    if (is_identity(x.R)) return to;
    const double *I = from.inertia;
    const double full[9] = {I[0], I[1], I[2], I[1], I[3], I[4], I[2], I[4], I[5]};
    const double T[9] = {x.R[0], x.R[3], x.R[6], x.R[1], x.R[4], x.R[7], x.R[2], x.R[5], x.R[8]};
    double turned[9];
    multiply(x.R, full, turned);
    multiply(turned, T, turned);
    const int upper[6] = {0, 1, 2, 4, 5, 8};
    for (int i = 0; i < 6; ++i) to.inertia[i] = turned[upper[i]];
    return to;
}

/* Adds the share of a part whose centre of mass is d away. */
inline void add_inertia(double I[6], const part &p, const double d[3]) {
    const double steiner[6] = {d[1] * d[1] + d[2] * d[2], -d[0] * d[1], -d[0] * d[2],
                               d[0] * d[0] + d[2] * d[2], -d[1] * d[2], d[0] * d[0] + d[1] * d[1]};
    for (int i = 0; i < 6; ++i) I[i] += p.inertia[i] + p.mass * steiner[i];
}

/* Parts in one frame as one; a single one stays as it is, to the bit. */
inline part sum(const std::vector<part> &parts) {
    part all;
    if (parts.size() == 1) return parts[0];
    for (size_t k = 0; k < parts.size(); ++k) {
        all.mass += parts[k].mass;
        for (int i = 0; i < 3; ++i) all.com[i] += parts[k].mass * parts[k].com[i];
    }
    for (int i = 0; i < 3; ++i) all.com[i] = all.mass > 0 ? all.com[i] / all.mass : 0;
    for (size_t k = 0; k < parts.size(); ++k) {
        double d[3];
        for (int i = 0; i < 3; ++i) d[i] = parts[k].com[i] - all.com[i];
        add_inertia(all.inertia, parts[k], d);
    }
    return all;
}

/* A rotation whose third column is the axis; the first lies towards the unit vector that follows the
   axis's largest component. */
inline void turn_z_to(const double axis[3], double R[9]) {
    double z[3] = {axis[0], axis[1], axis[2]};
    make_unit(z);
    int k = 0;
    for (int i = 1; i < 3; ++i)
        if (std::fabs(z[i]) > std::fabs(z[k])) k = i;
    double x[3], square = 0;
    for (int i = 0; i < 3; ++i) x[i] = (i == (k + 1) % 3) - z[(k + 1) % 3] * z[i];
    for (int i = 0; i < 3; ++i) square += x[i] * x[i];
    for (int i = 0; i < 3; ++i) x[i] /= std::sqrt(square);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        R[3 * i] = x[i], R[3 * i + 1] = z[j] * x[l] - z[l] * x[j], R[3 * i + 2] = z[i];
    }
}

/* Where a joint that is held still puts its link: turned about the axis by R = cos 1 + sin [n]x +
   (1 - cos) n n' (Rodrigues), or shifted along it. */
inline pose pose_held(const joint_part &j) {
    pose x;
    double n[3] = {j.axis[0], j.axis[1], j.axis[2]};
    if (!j.held() || j.value == 0) return x;
    make_unit(n);
    if (j.motion == RBD_PRISMATIC) {
        for (int i = 0; i < 3; ++i) x.p[i] = j.value * n[i];
        return x;
    }
    const double c = std::cos(j.value), s = std::sin(j.value);
    const double cross[9] = {0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0};
    for (int i = 0; i < 9; ++i) x.R[i] = c * (i % 4 == 0) + s * cross[i] + (1 - c) * n[i / 3] * n[i % 3];
    snap(x.R);
    return x;
}

/* A body and the parts that belong to it; strings are written later. */
struct row {
    rbd_body body;
    str name, joint, mimic;
    int line;
    std::vector<part> parts;
    row(int parent, rbd_joint_type type, int at_line) : body(), line(at_line) {
        body.parent = parent;
        body.type = type;
    }
    void place(const pose &x) {
        std::memcpy(body.position, x.p, sizeof x.p);
        std::memcpy(body.rotation, x.R, sizeof x.R);
    }
};

struct frame {
    int link, joint, parent, body;
    pose at; /* in the body */
};

class description {
  public:
    std::vector<row> rows;
    std::vector<frame> frames;
    double fixed_mass;

    description(const checked &c, const parsed &u, const rbd_urdf_options &o, warning_list &w)
        : fixed_mass(0), file(c), dom(u), options(o), warnings(w), frame_of(c.links.size(), -1) {
        std::set<int> ready; /* joints whose parent is there: the first in the file goes first */
        add_root();
        join(ready, file.root);
        while (!ready.empty()) {
            const int number = *ready.begin();
            ready.erase(ready.begin());
            add_joint(number);
            join(ready, file.joints[(size_t)number].child);
        }
        for (size_t i = 0; i < rows.size(); ++i) give_mass(rows[i]);
        if (!options.kinematic) warn_massless();
        if (rows.empty())
            throw failure(
                RBD_URDF_ERR_ROBOT, 0,
                "nothing moves: all links are fixed to the world; for a free base let the root link float "
                "(options.root, rbd-model --floating)");
        check_build();
    }

  private:
    const checked &file;
    const parsed &dom;
    const rbd_urdf_options &options;
    warning_list &warnings;
    std::vector<int> frame_of; /* of each link */

    str root_name() const { return options.root_joint ? options.root_joint : "root"; }

    bool kept(const str &link) const {
        for (const char *const *k = options.keep; k && *k; ++k)
            if (link == *k) return true;
        return options.keep_all != 0;
    }

    void join(std::set<int> &ready, int link) const {
        const std::vector<int> &children = file.links[(size_t)link].children;
        ready.insert(children.begin(), children.end());
    }

    void add_root() {
        const link_part &l = file.links[(size_t)file.root];
        const bool world = l.name == "world" && !l.inertial;
        if (options.root != RBD_FLOATING) {
            if (kept(l.name) && !world) rows.push_back(row(-1, RBD_FIXED, l.line));
        } else {
            if (file.joint(root_name()) >= 0)
                throw failure(RBD_URDF_ERR_NAME, file.joints[(size_t)file.joint(root_name())].line,
                              "joint " + quoted(root_name()) +
                                  ": the joint of the floating root link is called so; to call that one "
                                  "otherwise: options.root_joint, rbd-model --root-joint");
            rows.push_back(row(-1, RBD_FLOATING, l.line));
            rows.back().joint = root_name();
        }
        if (!rows.empty()) {
            rows.back().name = l.name;
            rows.back().place(pose());
        }
        add_frame(file.root, -1, (int)rows.size() - 1, pose());
    }

    /* Puts a link on a body, -1 = the world, and its mass there. */
    void add_frame(int link, int joint, int body, const pose &at) {
        frame f;
        f.link = link, f.joint = joint, f.body = body, f.at = at;
        f.parent = joint < 0 ? -1 : frame_of[(size_t)file.joints[(size_t)joint].parent];
        frame_of[(size_t)link] = (int)frames.size();
        frames.push_back(f);
        const part p = mass_of(link);
        if (body < 0 || rows[(size_t)body].body.type == RBD_FIXED) fixed_mass += on_world(body) ? p.mass : 0;
        if (body >= 0 && !p.nothing()) rows[(size_t)body].parts.push_back(moved(p, at));
    }
    bool on_world(int body) const {
        while (body >= 0 && rows[(size_t)body].body.type == RBD_FIXED) body = rows[(size_t)body].body.parent;
        return body < 0;
    }

    part mass_of(int link) const {
        const link_part &l = file.links[(size_t)link];
        part p;
        if (!l.inertial) return p;
        const urdf::InertialSharedPtr &in = dom.link(l.name).inertial;
        if (!in)
            throw failure(RBD_URDF_ERR_PARSER, l.line,
                          "link " + quoted(l.name) + ": urdfdom lost its <inertial>");
        const double I[6] = {in->ixx, in->ixy, in->ixz, in->iyy, in->iyz, in->izz};
        std::memcpy(p.inertia, I, sizeof I);
        p.mass = in->mass;
        p = moved(p, pose_of(in->origin, l.turned));
        check_mass(l, p);
        return p;
    }

    /* rbd's own checks, link by link, before links are merged. */
    void check_mass(const link_part &l, const part &p) const {
        rbd_body alone = rbd_body();
        std::vector<unsigned char> memory(RBD_MODEL_SIZE(1));
        const rbd_model *model;
        rbd_report report;
        alone.parent = -1;
        give(alone, p);
        if (rbd_model_build(&alone, 1, memory.data(), memory.size(), &model, &report) != RBD_OK)
            throw failure(RBD_URDF_ERR_MODEL, l.line,
                          "link " + quoted(l.name) + ", " + finding(report.error));
        for (int i = 0; i < report.warnings && i < RBD_MAX_WARNINGS; ++i)
            warnings.add(RBD_URDF_WARN_INERTIA, l.line,
                         "link " + quoted(l.name) + ", " + finding(report.warning[i]));
    }
    static str finding(const rbd_finding &f) {
        return str(f.field ? f.field : "model") + ": " + rbd_status_string(f.status);
    }

    static void give(rbd_body &b, const part &p) {
        b.mass = p.mass;
        std::memcpy(b.com, p.com, sizeof p.com);
        std::memcpy(b.inertia, p.inertia, sizeof p.inertia);
    }
    static void give_mass(row &r) { give(r.body, sum(r.parts)); }

    void add_joint(int number) {
        const joint_part &j = file.joints[(size_t)number];
        const frame &parent = frames[(size_t)frame_of[(size_t)j.parent]];
        const urdf::Joint &u = dom.joint(j.name);
        const str &link = file.links[(size_t)j.child].name;
        const pose at =
            compose(compose(parent.at, pose_of(u.parent_to_joint_origin_transform, j.turned)), pose_held(j));
        if (j.type == RBD_FIXED && !kept(link)) {
            add_frame(j.child, number, parent.body, at);
            return;
        }
        row r(parent.body, j.type, j.line);
        r.name = link;
        r.joint = j.name;
        r.place(at);
        if (j.type != RBD_FIXED) add_motion(r, j, u);
        const bool tilted = j.type == RBD_PLANAR && !(j.axis[0] == 0 && j.axis[1] == 0 && j.axis[2] > 0);
        if (tilted)
            add_tilted(r, at, j.axis);
        else
            rows.push_back(r);
        add_frame(j.child, number, (int)rows.size() - 1, pose());
    }

    /* A planar joint that moves about another axis than z: on a frame turned so that it is z, and the link
       turned back upon it. */
    void add_tilted(row &r, const pose &at, const double axis[3]) {
        pose tilt, back;
        turn_z_to(axis, tilt.R);
        snap(tilt.R);
        for (int i = 0; i < 9; ++i) back.R[i] = tilt.R[3 * (i % 3) + i / 3];
        row link((int)rows.size(), RBD_FIXED, r.line);
        link.name = r.name;
        link.place(back);
        r.name.clear();
        r.place(compose(at, tilt));
        rows.push_back(r);
        rows.push_back(link);
    }

    void add_motion(row &r, const joint_part &j, const urdf::Joint &u) const {
        static const int dofs[RBD_JOINT_TYPES] = {0, 1, 1, 1, 1, 1, 2, 2, 3, 3, 3, 3, 3, 3, 3, 6};
        if (has_one_dof(j.type)) std::memcpy(r.body.axis, j.axis, sizeof j.axis);
        for (int i = 0; i < dofs[j.type]; ++i) {
            r.body.damping[i] = u.dynamics ? u.dynamics->damping : 0;
            r.body.friction[i] = u.dynamics ? u.dynamics->friction : 0;
            r.body.armature[i] = j.armature;
        }
        if (has_one_dof(j.type) && u.limits) {
            r.body.lower = u.limits->lower, r.body.upper = u.limits->upper;
            r.body.velocity = u.limits->velocity, r.body.effort = u.limits->effort;
        }
        if (!j.mimic.empty()) r.mimic = j.mimic, r.body.mimic_ratio = j.ratio, r.body.mimic_offset = j.offset;
    }

    /* A joint of the root link that makes the base float already, -1 if there is none. */
    int own_floating_joint() const {
        const std::vector<int> &children = file.links[(size_t)file.root].children;
        for (size_t i = 0; i < children.size(); ++i)
            if (file.joints[(size_t)children[i]].type == RBD_FLOATING) return children[i];
        return -1;
    }

    /* Warns of a floating root link without mass, or with a second free joint. */
    void check_root() const {
        const int own = own_floating_joint();
        const bool heavy = !rows[0].parts.empty();
        if (own < 0 && (heavy || options.kinematic)) return;
        warnings.add(RBD_URDF_WARN_ROOT, rows[0].line,
                     "link " + quoted(rows[0].name) +
                         (heavy ? ": the root link floats" : ": the floating root link has no mass") +
                         (own < 0 ? ""
                                  : "; joint " + quoted(file.joints[(size_t)own].name) +
                                        " floats already: leave out options.root, rbd-model --floating"));
    }

    /* Warns of a link between moving joints that has a shape, or length up to the next joint, but no mass:
       its <inertial> may be forgotten. A robot in which no link has mass is meant without. */
    void warn_massless() {
        std::vector<bool> heavy(rows.size()), carries(rows.size()); /* with the links that are fixed to it */
        for (size_t i = rows.size(); i-- > 0;) {
            const bool fixed = rows[i].body.type == RBD_FIXED;
            heavy[i] = heavy[i] || !rows[i].parts.empty();
            if (rows[i].body.parent < 0) continue;
            const size_t parent = (size_t)rows[i].body.parent;
            heavy[parent] = heavy[parent] || (fixed && heavy[i]);
            carries[parent] = carries[parent] || !fixed || carries[i];
        }
        if (std::find(heavy.begin(), heavy.end(), true) == heavy.end()) return;

        for (size_t i = 0; i < rows.size(); ++i) {
            const int joint = rows[i].body.type == RBD_FIXED ? -1 : file.joint(rows[i].joint);
            if (joint < 0 || heavy[i] || !carries[i]) continue;
            const link_part &l = file.links[(size_t)file.joints[(size_t)joint].child];
            if (!l.inertial && (l.shaped || has_length(l)))
                warnings.add(RBD_URDF_WARN_MASSLESS, l.line,
                             "link " + quoted(l.name) +
                                 ": it has no <inertial>, and stands between moving joints; read as no mass");
        }
    }
    bool has_length(const link_part &l) const {
        for (size_t i = 0; i < l.children.size(); ++i) {
            const urdf::Vector3 &to =
                dom.joint(file.joints[(size_t)l.children[i]].name).parent_to_joint_origin_transform.position;
            if (to.x != 0 || to.y != 0 || to.z != 0) return true;
        }
        return false;
    }

    /* That rbd_model_build takes the description is found out by asking it. */
    void check_build() {
        std::vector<rbd_body> bodies;
        for (size_t i = 0; i < rows.size(); ++i) {
            rbd_body b = rows[i].body;
            b.name = rows[i].name.empty() ? NULL : rows[i].name.c_str();
            b.joint = rows[i].joint.empty() ? NULL : rows[i].joint.c_str();
            b.mimic = rows[i].mimic.empty() ? NULL : rows[i].mimic.c_str();
            bodies.push_back(b);
        }
        if (options.root == RBD_FLOATING) check_root();

        const int nb = (int)bodies.size();
        std::vector<unsigned char> memory(rbd_model_size(bodies.data(), nb) + 1);
        const rbd_model *model;
        rbd_report report;
        const rbd_status status =
            options.kinematic
                ? rbd_model_build_kinematic(bodies.data(), nb, memory.data(), memory.size(), &model, &report)
                : rbd_model_build(bodies.data(), nb, memory.data(), memory.size(), &model, &report);
        if (status == RBD_OK) return;
        if (report.error.body < 0)
            throw failure(RBD_URDF_ERR_MODEL, 0, str("the model: ") + rbd_status_string(report.error.status));
        const row &r = rows[(size_t)report.error.body];
        const bool lockable = report.error.status == RBD_ERR_LEAF && file.joint(r.joint) >= 0;
        throw failure(RBD_URDF_ERR_MODEL, r.line,
                      "link " + quoted(r.name) + ", joint " + quoted(r.joint) + ", " + finding(report.error) +
                          (lockable ? massless_hint(r.joint) : ""));
    }
};

/* ---- result [result] ---- */

/* Puts strings into the caller's names, or only counts their bytes. */
class name_store {
  public:
    name_store(char *memory, size_t room) : base(memory), max(memory ? room : 0), used(0) {}
    size_t size() const { return used; }
    const char *put(const str &s) {
        const size_t at = used;
        used += s.size() + 1;
        if (!base || used > max) return NULL;
        return (const char *)std::memcpy(base + at, s.c_str(), s.size() + 1);
    }

  private:
    char *base;
    size_t max, used;
};

inline void write_frames(const description &d, const std::vector<const char *> &links,
                         const std::vector<const char *> &joints, rbd_urdf_frame *out) {
    for (size_t i = 0; i < d.frames.size(); ++i) {
        const frame &f = d.frames[i];
        out[i].link = links[(size_t)f.link];
        out[i].joint = f.joint < 0 ? NULL : joints[(size_t)f.joint];
        out[i].parent = f.parent;
        out[i].body = f.body;
        std::memcpy(out[i].position, f.at.p, sizeof f.at.p);
        std::memcpy(out[i].rotation, f.at.R, sizeof f.at.R);
    }
}

inline void write_bodies(const checked &file, const description &d, const std::vector<const char *> &links,
                         const std::vector<const char *> &joints, const char *root, rbd_body *out) {
    for (size_t i = 0; i < d.rows.size(); ++i) {
        const row &r = d.rows[i];
        const int joint = file.joint(r.joint);
        out[i] = r.body;
        out[i].name = r.name.empty() ? NULL : links[(size_t)file.link(r.name)];
        out[i].joint = r.joint.empty() ? NULL : joint < 0 ? root : joints[(size_t)joint];
        out[i].mimic = r.mimic.empty() ? NULL : joints[(size_t)file.joint(r.mimic)];
    }
}

inline void write_result(const checked &file, const description &d, rbd_urdf *robot) {
    name_store names(robot->names, robot->names_max);
    std::vector<const char *> links, joints;
    const char *root = NULL;
    robot->name = names.put(file.robot);
    for (size_t i = 0; i < file.links.size(); ++i) links.push_back(names.put(file.links[i].name));
    for (size_t i = 0; i < file.joints.size(); ++i) joints.push_back(names.put(file.joints[i].name));
    if (d.rows[0].body.type == RBD_FLOATING && file.joint(d.rows[0].joint) < 0)
        root = names.put(d.rows[0].joint);
    robot->nb = (int)d.rows.size();
    robot->nframes = (int)d.frames.size();
    robot->names_size = names.size();
    robot->fixed_mass = d.fixed_mass;
    if (!robot->bodies && !robot->names) return;
    if (!robot->bodies || robot->bodies_max < robot->nb)
        throw failure(RBD_URDF_ERR_ROOM, 0, "room for " + std::to_string(robot->nb) + " bodies is needed");
    if (!robot->names || robot->names_max < names.size())
        throw failure(RBD_URDF_ERR_ROOM, 0,
                      "room for names of " + std::to_string(names.size()) + " bytes is needed");
    if (robot->frames && robot->frames_max < robot->nframes)
        throw failure(RBD_URDF_ERR_ROOM, 0,
                      "room for " + std::to_string(robot->nframes) + " frames is needed");
    if (robot->frames) write_frames(d, links, joints, robot->frames);
    write_bodies(file, d, links, joints, root, robot->bodies);
}

inline void check_options(const rbd_urdf_options &o) {
    if (o.root != RBD_FIXED && o.root != RBD_FLOATING)
        throw failure(RBD_URDF_ERR_OPTION, 0, "root must be RBD_FIXED or RBD_FLOATING");
    if (o.kinematic && o.lock_massless)
        throw failure(RBD_URDF_ERR_OPTION, 0,
                      "lock_massless holds the joints still that kinematic lets move: give one of them");
    if (o.root_joint && !*o.root_joint) throw failure(RBD_URDF_ERR_OPTION, 0, "root_joint is empty");
    for (int i = 0; o.gravity && i < 3; ++i)
        if (!std::isfinite(o.gravity[i])) throw failure(RBD_URDF_ERR_OPTION, 0, "gravity is not finite");
}

inline void refuse_other_format(const element &e) {
    const char *format = other_root(e.name);
    throw failure(RBD_URDF_ERR_ROBOT, e.line,
                  "<" + e.name +
                      (format ? str("> is not a robot of URDF, but of ") + format
                              : "> is not a robot: <robot> must be the first element"));
}

inline void load(const char *text, size_t length, const rbd_urdf_options &options, warning_list &warnings,
                 rbd_urdf *robot) {
    static const double earth[3] = {0, 0, -9.81};
    check_options(options);
    std::memcpy(robot->gravity, options.gravity ? options.gravity : earth, sizeof earth);
    if (is_utf32(text, length)) throw failure(RBD_URDF_ERR_XML, 0, "it is text in UTF-32: save it as UTF-8");
    const str read = is_utf16(text, length) ? from_utf16(text, length) : str(text, length);
    if (const char *other = other_format(read.data(), read.size()))
        throw failure(RBD_URDF_ERR_ROBOT, 1, other);

    const element top = reader(read.data(), read.size()).document();
    if (top.name != "robot") refuse_other_format(top);
    const xacro_check xacro(top);
    try {
        const checked file(top, options, warnings);
        const parsed dom(file.text, options.show_messages != 0);
        write_result(file, description(file, dom, options, warnings), robot);
    } catch (const failure &f) { /* the reason may be that xacro has not expanded the file */
        if (xacro.definition.empty() || f.status > 0) throw;
        throw failure(f.status, f.line, f.text + "; the file has " + xacro.definition + ": " + xacro_hint());
    }
}

inline rbd_urdf_status report(rbd_urdf *robot, rbd_urdf_status status, int line, const char *text) {
    robot->error.status = status;
    robot->error.line = line;
    std::snprintf(robot->error.text, sizeof robot->error.text, "%s", text);
    return status;
}

/* Takes back the results of the call before. */
inline void clear(rbd_urdf *robot) {
    robot->name = NULL;
    robot->nb = robot->nframes = robot->nwarnings = 0;
    robot->names_size = 0;
    robot->fixed_mass = 0;
    report(robot, RBD_URDF_OK, 0, "");
}

/* Whether the last call wrote the description, and did not fail or only count. */
inline bool is_filled(const rbd_urdf *robot) {
    return robot && robot->error.status == RBD_URDF_OK && robot->bodies && robot->names;
}

/* Runs a load and turns whatever it throws into a status. */
inline rbd_urdf_status guarded(const char *text, size_t length, const rbd_urdf_options *options,
                               rbd_urdf *robot) {
    warning_list warnings;
    rbd_urdf_options o = rbd_urdf_options();
    rbd_urdf_status status = RBD_URDF_OK;
    if (options) o = *options;
    warnings.strict = o.strict != 0;
    try {
        load(text, length, o, warnings, robot);
    } catch (const failure &f) {
        status = report(robot, f.status, f.line, f.text.c_str());
    } catch (const std::bad_alloc &) {
        status = report(robot, RBD_URDF_ERR_MEMORY, 0, "out of memory");
    } catch (const std::exception &e) {
        status = report(robot, RBD_URDF_ERR_PARSER, 0, e.what());
    } catch (...) {
        status = report(robot, RBD_URDF_ERR_PARSER, 0, "urdfdom threw what is not an exception");
    }
    robot->nwarnings = (int)warnings.list.size();
    for (int i = 0; robot->warnings && i < robot->nwarnings && i < robot->warnings_max; ++i)
        robot->warnings[i] = warnings.list[(size_t)i];
    return status;
}

/* Reads a whole file; returns errno if it cannot be read, else 0. */
inline int read_file(const char *path, str &text) {
    char block[65536];
    errno = 0;
    std::FILE *file = std::fopen(path, "rb");
    if (!file) return errno ? errno : EIO;
    for (size_t n; (n = std::fread(block, 1, sizeof block, file)) > 0;) text.append(block, n);
    const int reason = !std::ferror(file) ? 0 : errno ? errno : EIO;
    std::fclose(file);
    return reason;
}

} // namespace rbdi_urdf

extern "C" {

rbd_urdf_status rbd_urdf_parse(const char *text, size_t length, const rbd_urdf_options *options,
                               rbd_urdf *robot) {
    if (!robot) return RBD_URDF_ERR_NULL;
    rbdi_urdf::clear(robot);
    if (!text) return rbdi_urdf::report(robot, RBD_URDF_ERR_NULL, 0, "text is NULL");
    return rbdi_urdf::guarded(text, length, options, robot);
}

rbd_urdf_status rbd_urdf_load(const char *path, const rbd_urdf_options *options, rbd_urdf *robot) {
    if (!robot) return RBD_URDF_ERR_NULL;
    rbdi_urdf::clear(robot);
    if (!path) return rbdi_urdf::report(robot, RBD_URDF_ERR_NULL, 0, "path is NULL");
    try {
        std::string text;
        const int reason = rbdi_urdf::read_file(path, text);
        if (!reason) return rbd_urdf_parse(text.data(), text.size(), options, robot);
        return rbdi_urdf::report(robot, RBD_URDF_ERR_FILE, 0,
                                 ("the file '" + std::string(path) +
                                  "' cannot be read: " + std::generic_category().message(reason))
                                     .c_str());
    } catch (...) {
        return rbdi_urdf::report(robot, RBD_URDF_ERR_MEMORY, 0, "out of memory");
    }
}

const char *rbd_urdf_status_string(rbd_urdf_status status) {
    switch (status) {
    case RBD_URDF_OK: return "no error";
    case RBD_URDF_ERR_NULL: return "a required pointer is NULL";
    case RBD_URDF_ERR_OPTION: return "an option has no such value, or names no link or joint";
    case RBD_URDF_ERR_FILE: return "the file cannot be read";
    case RBD_URDF_ERR_ROOM: return "an array is too short";
    case RBD_URDF_ERR_MEMORY: return "out of memory";
    case RBD_URDF_ERR_XML: return "not well-formed XML";
    case RBD_URDF_ERR_ROBOT: return "not a robot of URDF";
    case RBD_URDF_ERR_NAME: return "a name is missing or stands twice";
    case RBD_URDF_ERR_NUMBER: return "not a finite number";
    case RBD_URDF_ERR_INERTIAL: return "the inertial is incomplete or its mass negative";
    case RBD_URDF_ERR_JOINT: return "a joint lacks type, parent or child";
    case RBD_URDF_ERR_AXIS: return "an axis is zero or has no xyz";
    case RBD_URDF_ERR_MIMIC: return "a joint cannot mimic the one that it names";
    case RBD_URDF_ERR_TREE: return "the links are no tree";
    case RBD_URDF_ERR_MODEL: return "not a model that rbd_model_build takes";
    case RBD_URDF_ERR_PARSER: return "urdfdom refuses it";
    case RBD_URDF_WARN_INERTIA: return "no real body has this mass and inertia";
    case RBD_URDF_WARN_LIMIT: return "limits are missing, make no sense or are not kept";
    case RBD_URDF_WARN_ROOT: return "the floating root link has no mass, or a second free joint";
    case RBD_URDF_WARN_LOCKED: return "a joint that moves no mass, or mimics one at rest, is held still";
    case RBD_URDF_WARN_AXIS: return "an axis is missing, or it or a quaternion is not of unit length";
    case RBD_URDF_WARN_NAME: return "the robot has no name";
    case RBD_URDF_WARN_MIMIC: return "a <mimic> is ignored: of a fixed joint, or wrong";
    case RBD_URDF_WARN_SINGULAR: return "neither a joint nor those that mimic it move mass";
    case RBD_URDF_WARN_DEGREES: return "an angle looks like degrees";
    case RBD_URDF_WARN_UNITS: return "a length looks like mm, or an inertia like kg mm^2 or g mm^2";
    case RBD_URDF_WARN_UNREAD: return "an element or attribute is not read";
    case RBD_URDF_WARN_MASSLESS: return "a link between moving joints has no inertial";
    }
    return "unknown status";
}

int rbd_urdf_joint_index(const rbd_urdf *robot, const char *joint) {
    if (!rbdi_urdf::is_filled(robot) || !joint) return -1;
    for (int i = 0; i < robot->nb; ++i)
        if (robot->bodies[i].type != RBD_FIXED && robot->bodies[i].joint &&
            std::strcmp(robot->bodies[i].joint, joint) == 0)
            return i;
    return -1;
}

int rbd_urdf_link_index(const rbd_urdf *robot, const char *link) {
    if (!rbdi_urdf::is_filled(robot) || !robot->frames || !link) return -1;
    for (int i = 0; i < robot->nframes; ++i)
        if (std::strcmp(robot->frames[i].link, link) == 0) return i;
    return -1;
}

} // extern "C"

#endif /* RBD_URDF_IMPLEMENTATION */
