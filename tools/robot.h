/* robot.h - what rbd-model and rbd-eval share: a robot from a URDF file, with its messages, and options.
   SPDX-License-Identifier: MIT */
#ifndef TOOLS_ROBOT_H
#define TOOLS_ROBOT_H

#include "rbd_constraints.h"
#include "rbd_urdf.h"

enum { REASON = 500 };                 /* characters of a sentence */
enum { EXIT_BAD = 1, EXIT_USAGE = 2 }; /* a bad file or row; bad arguments */

/* Of the command, for messages; set by main. */
extern const char *program;

/* Prints "PROGRAM: ..." with a hint at --help to standard error; returns EXIT_USAGE. */
int usage_error(const char *format, ...);

/* The same of an option that is none of these texts, which a command's --help prints, ended by NULL. */
int unknown_option(const char *argument, const char *const *helps);

/* How to load, as options say, and the command itself. */
typedef struct settings {
    char *command; /* what a shell takes, and a comment of C may hold */
    rbd_urdf_options urdf;
    double gravity[3];
    const char **keep;   /* ended by NULL */
    rbd_urdf_lock *lock; /* ended by joint = NULL */
    int nkeep, nlock;
} settings;

/* Settings with room for the names that argc arguments may give. */
settings settings_new(int argc, char **argv);
void settings_free(settings *s);

/* Reads argument *i if it is one of those in settings_help, and its value. Returns 0 if it was, -1 if it is
   none of these, or an exit status. */
int settings_read(settings *s, char **argv, int *i);
extern const char settings_help[];

/* The value of argument *i, "--name VALUE" or "--name=VALUE"; NULL after a message if there is none, or if an
   option stands twice that may not. option_is tells whether the argument is this option. */
const char *option_value(char **argv, int *i);
int option_is(const char *argument, const char *name);

/* Reads "X,Y,Z". Returns 0, or EXIT_USAGE after a message. */
int read_vector(const char *option, const char *text, double v[3]);

typedef struct robot {
    const char *path;
    const char *command;         /* that reads it, for what is written of it; NULL: not known */
    rbd_urdf urdf;               /* of an MJCF file too */
    rbd_constraint *constraints; /* of an MJCF file */
    int nconstraints;
    const rbd_model *model; /* with the gravity asked for */
    int kinematic;          /* it may have joints that move no mass */
    void *model_memory;
} robot;

/* Loads and builds; the path "-" is standard input. Errors go to standard error, with file and line. Returns
 * 0 or EXIT_BAD. */
int robot_open(robot *r, const char *path, const settings *s);
void robot_close(robot *r);

/* Whether a text is MJCF, by its root element. */
int is_mjcf(const char *text, size_t length);

/* Loads it into r->urdf and r->constraints by rbd_mjcf.h; r->urdf.error has the error. Returns 0 or
   EXIT_BAD. */
int load_mjcf(robot *r, const char *text, size_t length, const settings *s);

/* The body that is this link, or -1, with the reason in text: it is merged into another, or is not there. */
int robot_link(const robot *r, const char *link, char text[REASON]);

/* Prints the warnings, "FILE:LINE: warning: ...", to standard error. */
void robot_print_warnings(const robot *r);

/* Memory or the end of the program: n things of some size, zeroed; at least one byte. */
void *allocate(size_t n, size_t size);

/* The memory, which may be NULL, made larger; or the end of the program. */
void *grown(void *memory, size_t size);

#endif
