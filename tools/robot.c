/* Robots from URDF files, and the options that say how. SPDX-License-Identifier: MIT */
#include "robot.h"
#include "nearest.h"
#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *allocate(size_t n, size_t size) {
    void *memory = calloc(n ? n : 1, size ? size : 1);
    if (!memory) {
        fprintf(stderr, "%s: out of memory\n", program);
        exit(EXIT_BAD);
    }
    return memory;
}

void *grown(void *memory, size_t size) {
    void *larger = realloc(memory, size);
    if (!larger) {
        fprintf(stderr, "%s: out of memory\n", program);
        exit(EXIT_BAD);
    }
    return larger;
}

/* ---- options ---- */

int usage_error(const char *format, ...) {
    const size_t length = strlen(format);
    va_list arguments;
    fprintf(stderr, "%s: ", program);
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "%s %s --help\n", length && format[length - 1] == '?' ? " See" : "; see", program);
    return EXIT_USAGE;
}

int unknown_option(const char *argument, const char *const *helps) {
    const char *start = argument + strspn(argument, "-");
    char name[100];
    nearest n;
    snprintf(name, sizeof name, "%.*s", (int)strcspn(start, "="), start);
    n = nearest_to(name);
    for (; *helps; helps++) nearest_see_options(&n, *helps);
    if (*n.best) return usage_error("unknown option '%s'; did you mean '--%s'?", argument, n.best);
    return usage_error("unknown option '%s'", argument);
}

int option_is(const char *argument, const char *name) {
    const size_t length = strlen(name);
    return strncmp(argument, name, length) == 0 && (argument[length] == 0 || argument[length] == '=');
}

/* Whether an option stands before argument i too, where it would be lost. */
static int stands_before(char **argv, int i) {
    static const char *const several[] = {"--keep", "--lock", "--given", "--passive"};
    char name[100];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(argv[i], "="), argv[i]);
    for (size_t k = 0; k < sizeof several / sizeof *several; k++)
        if (strcmp(name, several[k]) == 0) return 0;
    for (int k = 1; k < i; k++)
        if (option_is(argv[k], name)) return usage_error("%s: it stands twice", name);
    return 0;
}

const char *option_value(char **argv, int *i) {
    const char *equals = strchr(argv[*i], '=');
    if (stands_before(argv, *i)) return NULL;
    if (equals) return equals + 1;
    if (!argv[*i + 1]) {
        usage_error("%s: its value is missing", argv[*i]);
        return NULL;
    }
    return argv[++*i];
}

const char settings_help[] =
    "  --floating          the root link is on a floating joint, not fixed to the world\n"
    "  --root-joint NAME   what that joint is called (root)\n"
    "  --root LINK         take only this link, as the root, and its subtree\n"
    "  --gravity X,Y,Z     in the world frame, m/s^2 (0,0,-9.81)\n"
    "  --keep LINK         keep this fixed link as a body, a frame; may stand several times\n"
    "  --keep-all          keep all fixed links\n"
    "  --lock JOINT=VALUE  hold this joint still there, in rad or m (JOINT alone: at 0), and those that\n"
    "                      mimic it; may stand several times\n"
    "  --lock-massless     hold joints still that move no mass (else they are an error)\n"
    "  --kinematic         let them move, for poses, Jacobians and inverse kinematics alone\n"
    "  --free-mimics       let joints move freely that mimic a missing joint (else they are an error)\n"
    "  --strict            warnings are errors\n"
    "  --messages          show the messages of urdfdom\n"
    "  --help, --version\n";

int read_vector(const char *option, const char *text, double v[3]) {
    int length = 0;
    if (sscanf(text, "%lf,%lf,%lf%n", &v[0], &v[1], &v[2], &length) != 3 || text[length] != 0)
        return usage_error("%s: '%s' is not three numbers X,Y,Z", option, text);
    return 0;
}

static int read_gravity(settings *s, const char *text) {
    s->urdf.gravity = s->gravity;
    return read_vector("--gravity", text, s->gravity);
}

/* Whether a shell takes it as it is, and nothing in it begins or ends a comment. */
static int is_plain(const char *argument) {
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=,:+@%-";
    return *argument && argument[strspn(argument, plain)] == 0;
}

/* The argument behind the end of a text, in quotes if need be: they part what would begin or end a comment
   or a trigraph. Returns the end. */
static char *append_argument(char *end, const char *argument) {
    if (is_plain(argument)) return end + sprintf(end, " %s", argument);
    end += sprintf(end, " '");
    for (; *argument; argument++)
        end += sprintf(end,
                       *argument == '\''           ? "'\\''"
                       : strchr("*?\\", *argument) ? "''%c''"
                                                   : "%c",
                       *argument);
    return end + sprintf(end, "'");
}

static char *command_line(char **argv) {
    size_t room = strlen(program) + 1;
    char *text, *end;
    for (char **a = argv + 1; *a; a++) room += 3 + 5 * strlen(*a);
    text = allocate(room, 1);
    end = text + sprintf(text, "%s", program);
    for (char **a = argv + 1; *a; a++) end = append_argument(end, *a);
    return text;
}

settings settings_new(int argc, char **argv) {
    settings s = {.command = command_line(argv)};
    s.keep = allocate((size_t)argc, sizeof *s.keep);
    s.lock = allocate((size_t)argc, sizeof *s.lock);
    s.urdf.keep = s.keep;
    s.urdf.lock = s.lock;
    return s;
}

void settings_free(settings *s) {
    free(s->command);
    free(s->keep);
    free(s->lock);
}

/* Takes "JOINT" or "JOINT=VALUE" apart: the text, an argument of the program, then ends after the name. */
static int read_lock(settings *s, char *text) {
    char *equals = strrchr(text, '='), *end;
    rbd_urdf_lock *lock = &s->lock[s->nlock++];
    lock->joint = text;
    if (!equals) return 0;
    lock->value = strtod(equals + 1, &end);
    if (end == equals + 1 || *end != 0)
        return usage_error("--lock: '%s' in '%s' is not a number", equals + 1, text);
    *equals = 0;
    return 0;
}

/* In rbd 0.1.0 --lock stood alone, for --lock-massless: it still may where no joint can be meant. */
static int is_lock_alone(const char *argument, const char *next) {
    const size_t length = next ? strlen(next) : 0;
    return strcmp(argument, "--lock") == 0 &&
           (!next || strcmp(next, "-") == 0 || strncmp(next, "--", 2) == 0 ||
            (length >= 5 && strcmp(next + length - 5, ".urdf") == 0));
}

int settings_read(settings *s, char **argv, int *i) {
    const char *argument = argv[*i], *value;
    if (strcmp(argument, "--floating") == 0)
        s->urdf.root = RBD_FLOATING;
    else if (strcmp(argument, "--keep-all") == 0)
        s->urdf.keep_all = 1;
    else if (strcmp(argument, "--strict") == 0)
        s->urdf.strict = 1;
    else if (strcmp(argument, "--lock-massless") == 0 || is_lock_alone(argument, argv[*i + 1]))
        s->urdf.lock_massless = 1;
    else if (strcmp(argument, "--kinematic") == 0)
        s->urdf.kinematic = 1;
    else if (strcmp(argument, "--free-mimics") == 0)
        s->urdf.free_mimics = 1;
    else if (strcmp(argument, "--messages") == 0)
        s->urdf.show_messages = 1;
    else if (option_is(argument, "--gravity"))
        return (value = option_value(argv, i)) ? read_gravity(s, value) : EXIT_USAGE;
    else if (option_is(argument, "--root-joint"))
        return (s->urdf.root_joint = option_value(argv, i)) ? 0 : EXIT_USAGE;
    else if (option_is(argument, "--root"))
        return (s->urdf.root_link = option_value(argv, i)) ? 0 : EXIT_USAGE;
    else if (option_is(argument, "--lock"))
        return (value = option_value(argv, i)) ? read_lock(s, (char *)value) : EXIT_USAGE;
    else if (option_is(argument, "--keep"))
        return (s->keep[s->nkeep++] = option_value(argv, i)) ? 0 : EXIT_USAGE;
    else
        return -1;
    return 0;
}

/* ---- robots ---- */

static void print_finding(const char *path, const char *what, const rbd_urdf_finding *f) {
    fprintf(stderr, "%s:", path);
    if (f->line) fprintf(stderr, "%d:", f->line);
    fprintf(stderr, " %s: %s\n", what, f->text);
}

void robot_print_warnings(const robot *r) {
    for (int i = 0; i < r->urdf.nwarnings; i++) print_finding(r->path, "warning", &r->urdf.warnings[i]);
}

/* The whole of a file, or of standard input for "-"; NULL if it cannot be read, as errno says. */
static char *read_file(const char *path, size_t *length) {
    FILE *file = strcmp(path, "-") == 0 ? stdin : fopen(path, "rb");
    char *text = NULL;
    size_t room = 0, n;
    *length = 0;
    if (!file) return NULL;
    do {
        if (*length == room) text = grown(text, room = 2 * room + 65536);
        *length += n = fread(text + *length, 1, room - *length, file);
    } while (n > 0);
    if (ferror(file)) {
        const int reason = errno;
        free(text);
        text = NULL;
        if (file != stdin) fclose(file);
        errno = reason;
    } else if (file != stdin) {
        fclose(file);
    }
    return text;
}

/* Warnings before an error may say where it comes from. */
static void print_first_warnings(const char *path, const rbd_urdf *u) {
    for (int i = 0; i < u->nwarnings && i < u->warnings_max; i++)
        print_finding(path, "warning", &u->warnings[i]);
}

/* The loader's sentence in the words of a command: "options.lock, rbd-model --lock" is "--lock" there. */
static void use_own_words(char *text) {
    static const char library[] = "options.", command[] = ", rbd-model --";
    for (char *at = strstr(text, library); at; at = strstr(at, library)) {
        char *end = at + strlen(library);
        while (isalnum((unsigned char)*end) || *end == '_') end++;
        if (strncmp(end, command, strlen(command)) == 0) {
            end += strlen(command) - 2;
            memmove(at, end, strlen(end) + 1);
        } else {
            at = end;
        }
    }
}

static rbd_urdf_status parse(const char *text, size_t length, const settings *s, rbd_urdf *u) {
    const rbd_urdf_status status = rbd_urdf_parse(text, length, &s->urdf, u);
    use_own_words(u->error.text);
    for (int i = 0; i < u->nwarnings && i < u->warnings_max; i++) use_own_words(u->warnings[i].text);
    return status;
}

/* Loads twice: to count, and to fill. */
static int load_text(const char *path, rbd_urdf *u, const char *text, size_t length, const settings *s) {
    rbd_urdf_finding first[20];
    u->warnings = first;
    u->warnings_max = sizeof first / sizeof *first;
    const rbd_urdf_status counted = parse(text, length, s, u);
    if (counted != RBD_URDF_OK) print_first_warnings(path, u);
    u->warnings = NULL;
    if (counted != RBD_URDF_OK) return EXIT_BAD;

    u->bodies = allocate((size_t)(u->bodies_max = u->nb), sizeof *u->bodies);
    u->names = allocate(u->names_max = u->names_size, 1);
    u->frames = allocate((size_t)(u->frames_max = u->nframes), sizeof *u->frames);
    u->warnings = allocate((size_t)(u->warnings_max = u->nwarnings), sizeof *u->warnings);
    return parse(text, length, s, u) == RBD_URDF_OK ? 0 : EXIT_BAD;
}

static int load(robot *r, const settings *s) {
    size_t length;
    char *text = read_file(r->path, &length);
    int status;
    if (!text) {
        fprintf(stderr, "%s: error: it cannot be read: %s\n", r->path, strerror(errno));
        return EXIT_BAD;
    }
    status =
        is_mjcf(text, length) ? load_mjcf(r, text, length, s) : load_text(r->path, &r->urdf, text, length, s);
    if (status != 0) print_finding(r->path, "error", &r->urdf.error);
    free(text);
    return status;
}

static int build(robot *r) {
    rbd_report report;
    char text[200];
    const size_t size = rbd_model_size(r->urdf.bodies, r->urdf.nb);
    rbd_model *model;
    rbd_status status;
    r->model_memory = allocate(size, 1);
    if (r->kinematic)
        status =
            rbd_model_build_kinematic(r->urdf.bodies, r->urdf.nb, r->model_memory, size, &r->model, &report);
    else
        status = rbd_model_build(r->urdf.bodies, r->urdf.nb, r->model_memory, size, &r->model, &report);
    if (status != RBD_OK) {
        fprintf(stderr, "%s: error: %s\n", r->path, rbd_finding_text(&report.error, text, sizeof text));
        return EXIT_BAD;
    }
    model = (rbd_model *)r->model; /* it lies in our memory */
    model->gravity.x = r->urdf.gravity[0];
    model->gravity.y = r->urdf.gravity[1];
    model->gravity.z = r->urdf.gravity[2];
    return 0;
}

int robot_open(robot *r, const char *path, const settings *s) {
    memset(r, 0, sizeof *r);
    r->path = path;
    r->command = s->command;
    r->kinematic = s->urdf.kinematic;
    return load(r, s) == 0 ? build(r) : EXIT_BAD;
}

int robot_link(const robot *r, const char *link, char text[REASON]) {
    const int body = rbd_body_index(r->model, link);
    const rbd_urdf_frame *f = NULL;
    nearest n = nearest_to(link);
    char hint[140];
    if (body >= 0) return body;
    for (int i = 0; i < r->urdf.nframes; i++) {
        const char *known = r->urdf.frames[i].link;
        if (strcmp(known, link) == 0) f = &r->urdf.frames[i];
        nearest_see(&n, known, strlen(known));
    }
    if (f && f->body < 0 && strcmp(link, "world") == 0)
        snprintf(text, REASON, "link 'world' is the world and no body");
    else if (f)
        snprintf(text, REASON,
                 "link '%.100s' is fixed to %.100s and no body of its own; for that: --keep %.100s", link,
                 f->body < 0 ? "the world" : r->urdf.bodies[f->body].name, link);
    else
        snprintf(text, REASON, "the robot has no link '%.100s'%s", link, nearest_hint(&n, hint));
    return -1;
}

void robot_close(robot *r) {
    free(r->urdf.bodies);
    free(r->urdf.names);
    free(r->urdf.frames);
    free(r->urdf.warnings);
    free(r->constraints);
    free(r->model_memory);
}
