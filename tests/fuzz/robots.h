/* robots.h - the robots and states of the library's fuzzer. A robot is told by its class and its number: the
   same on every machine. */
#ifndef ROBOTS_H
#define ROBOTS_H

#include "world.h"

enum { WORLD_COORDINATES = 7 * WORLD_BODIES };

/* The classes; the last has the traits of all others at random. */
enum {
    ORDINARY,  /* links of 0.1 to 1 m and 0.1 to 10 kg, any joints */
    AXES,      /* axes parallel, antiparallel, intersecting, coincident, at right angles */
    NEARLY,    /* the same but for 1e-1 to 1e-9 rad */
    FAR,       /* several roots, up to 1e6 m away */
    SCALED,    /* length and mass of the robot each times 1e-6 to 1e6 */
    MIXED,     /* length and mass of every link so */
    LIGHT,     /* massless links, point masses, thin rods */
    TURNED,    /* angles up to 1e6 rad, quaternions and (cos, sin) of any length */
    FOLLOWERS, /* mimic joints */
    ALL,
    CLASSES
};
extern const char *const class_names[CLASSES];

typedef struct sample {
    rbd_body bodies[WORLD_BODIES];
    int nb, nq, nv;
    double mass[WORLD_BODIES], length[WORLD_BODIES]; /* scales, 1 = ordinary */
    unsigned traits;
    uint64_t seed;
} sample;

/* A state; numbers that float has. tau is in units of what inverse dynamics adds up. */
typedef struct sample_state {
    double gravity[3];
    double q[WORLD_COORDINATES], q1[WORLD_COORDINATES], v[WORLD_DOFS], a[WORLD_DOFS], tau[WORLD_DOFS];
    double f_ext[6 * WORLD_BODIES];
} sample_state;

void draw_robot(sample *s, int class_number, int number);
void draw_state(sample *s, sample_state *x);

/* Its description as C source. */
void print_robot(const sample *s);
void print_state(const sample *s, const sample_state *x);

double uniform(uint64_t *seed, double low, double high);

#endif
