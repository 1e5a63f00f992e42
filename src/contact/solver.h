#ifndef RBDI_CONTACT_SOLVER_H
#define RBDI_CONTACT_SOLVER_H
#include "base/pieces.h"
#include "contact/newton.h"

/* ---- solver code [solver code] ----
   The first sweep is enough if contacts hardly affect each other. Newton steps follow. If none reduces the
   residual, some sweeps follow, twice as many each time. The best p of all is kept. */

/* Sweeps and Newton steps that are left. */
RBDI_PART int rbdi_iterations_left(const rbdi_contact_solver *s) {
    return s->given.iterations - s->solution.sweeps - s->solution.newton_steps;
}

/* Up to n sweeps, forth and back. u may have the rounding of far larger impulses, so it is computed anew
   before a small residual counts. */
RBDI_PART void rbdi_sweep_back_and_forth(rbdi_contact_solver *s, int n) {
    while (n-- > 0 && rbdi_iterations_left(s) > 0) rbdi_sweep_laws(s, n & 1);

    rbdi_project_laws(s);
    if (s->solution.residual <= s->given.tolerance) rbdi_contact_residual(s);
}

/* Ends with this p, moved into cones and bounds, 0 for contacts that open. A contact that opens but pushes,
   by less than the tolerance, counts as sticking. Returns whether the problem is solved. */
RBDI_PART int rbdi_contact_end(rbdi_contact_solver *s) {
    if (rbdi_into_cones(s, 1)) rbdi_contact_residual(s);

    for (int i = 0; i < s->given.contacts; ++i)
        if (s->law[i].state == RBD_OPENS && s->p[3 * i + 2] > 0) s->law[i].state = RBD_STICKS;

    return s->solution.residual <= s->given.tolerance;
}

/* Sets p to other impulses, moved into cones and bounds. */
RBDI_PART void rbdi_set_impulses(rbdi_contact_solver *s, const rbd_real *p) {
    rbdi_copy_rows(s, p, s->p);
    (void)rbdi_into_cones(s, 0);
    rbdi_contact_residual(s);
}

/* Ends a problem that is not solved with the best p or, unless that halves the residual, with p = 0: contacts
   that jam would get impulses in whose rounding the velocities are lost. */
RBDI_PART void rbdi_contact_give_up(rbdi_contact_solver *s) {
    rbd_real least;
    rbdi_clear(s->start, s->rows);
    rbdi_set_impulses(s, s->start);
    least = s->solution.residual / 2;

    rbdi_set_impulses(s, s->best);
    if (!(s->solution.residual < least)) rbdi_set_impulses(s, s->start);
    (void)rbdi_contact_end(s);
}

/* Solves a problem from the p that is given. */
RBDI_PART void rbdi_contact_iterate(rbdi_contact_solver *s) {
    const rbd_const proximal[3] = RBDI_PROXIMAL;
    rbd_real least = rbdi_set(RBDI_UNBOUNDED);
    int sweeps = 2;
    s->solution.sweeps = s->solution.newton_steps = 0;
    s->solution.residual = rbdi_zero();
    if (s->rows == 0) return;
    rbdi_clear(s->best, s->rows);

    rbdi_contact_velocities(s);
    rbdi_sweep_back_and_forth(s, 1);

    for (;;) {
        int tried = 0;
        if (!(s->solution.residual > s->given.tolerance) && rbdi_contact_end(s)) return;

        if (s->solution.residual < least) {
            least = s->solution.residual;
            rbdi_copy_rows(s, s->p, s->best);
        }
        if (rbdi_iterations_left(s) <= 0) {
            rbdi_contact_give_up(s);
            return;
        }

        while (tried < 3 && !rbdi_newton_step(s, proximal[tried])) ++tried;
        ++s->solution.newton_steps;
        if (tried < 3) continue;

        rbdi_sweep_back_and_forth(s, sweeps);
        if (sweeps < RBDI_MOST_SWEEPS) sweeps *= 2;
    }
}

/* Lays out a solver's arrays in the memory. */
RBDI_PART void rbdi_lay_solver(rbdi_contact_solver *s, int contacts, int bounded, unsigned char *at) {
    const int rows = 3 * contacts + bounded;
    s->law = RBDI_CUT(rbdi_contact_law, contacts);
    s->bound = RBDI_CUT(rbd_contact_state, bounded);
    s->unknown = RBDI_CUT(rbdi_contact_unknown, rows);

    s->u = RBDI_CUT(rbd_real, rows * (rows + 5 + RBDI_CHUNK));
    s->start = s->u + rows;
    s->full = s->start + rows;
    s->best = s->full + rows;
    s->scratch = s->best + rows;
    s->G = s->scratch + rows;
}

/* Takes a problem, sets its defaults, and prepares its contacts. */
RBDI_PART void rbdi_contact_begin(rbdi_contact_solver *s, const rbd_contact_problem *given, rbd_real *p) {
    s->given = *given;
    s->rows = 3 * given->contacts + given->bounded;
    s->p = p;
    s->sides = 1;
    if (!(given->tolerance > 0)) s->given.tolerance = rbdi_set(RBDI_CONTACT_TOLERANCE);
    if (given->iterations == 0) s->given.iterations = RBDI_CONTACT_ITERATIONS;

    s->unmoved = rbdi_zero();
    for (int r = 0; r < s->rows; ++r) {
        const rbd_real least = given->delta[r * (s->rows + 1)] * RBDI_UNMOVED * RBDI_UNMOVED;
        if (least > s->unmoved) s->unmoved = least;
    }

    for (int i = 0; i < given->contacts; ++i)
        rbdi_contact_prepare(&s->law[i], &given->delta[3 * i * (s->rows + 1)], s->rows, given->friction[i]);
}

/* Of a number x - x is 0, else NaN, and so is a sum with it. */
RBDI_PART int rbdi_all_finite(const rbd_real *x, int n) {
    rbd_real sum = rbdi_zero();
    for (int i = 0; i < n; ++i) sum = sum + (x[i] - x[i]);
    return sum == 0;
}

/* Whether an index into G, the largest array, would not fit an int. */
RBDI_INLINE int rbdi_too_large(int contacts, int bounded) {
    const int most = (int)((unsigned)-1 >> 1);
    int rows;
    if (contacts > most / 3 || bounded > most - 3 * contacts) return 1;

    rows = 3 * contacts + bounded;
    return rows > 0 && rows > most / rows - 5 - RBDI_CHUNK;
}

RBDI_PART rbd_status rbdi_check_problem(const rbd_contact_problem *given, const void *memory, size_t size,
                                        const rbd_real *p) {
    if (!given) return RBD_ERR_NULL;
    if (given->contacts < 0 || given->bounded < 0) return RBD_ERR_COUNT;
    if (rbdi_too_large(given->contacts, given->bounded)) return RBD_ERR_COUNT;

    if (!memory || (given->contacts && !given->friction) ||
        (given->bounded && (!given->lower || !given->upper)))
        return RBD_ERR_NULL;
    if (given->contacts + given->bounded > 0 && (!given->delta || !given->b || !p)) return RBD_ERR_NULL;
    if (size < rbd_contact_solve_size(given->contacts, given->bounded)) return RBD_ERR_MEMORY;

    if (!(given->tolerance >= 0) || given->iterations < 0) return RBD_ERR_RANGE;
    for (int i = 0; i < given->contacts; ++i)
        if (!(given->friction[i] >= 0)) return RBD_ERR_RANGE;
    for (int i = 0; i < given->bounded; ++i)
        if (!(given->lower[i] <= given->upper[i])) return RBD_ERR_RANGE;

    return RBD_OK;
}

RBDI_API size_t rbd_contact_solve_size(int contacts, int bounded) {
    if (contacts < 0 || bounded < 0 || rbdi_too_large(contacts, bounded)) return 0;
    return RBDI_CONTACT_SOLVER_BYTES(contacts, bounded);
}

RBDI_API rbd_status rbd_contact_solve(const rbd_contact_problem *problem, void *memory, size_t size,
                                      rbd_real *p, rbd_contact_state *state, rbd_contact_solution *solution) {
    const rbd_status status = rbdi_check_problem(problem, memory, size, p);
    rbdi_contact_solver s;
    if (status) return status;

    s.rows = 3 * problem->contacts + problem->bounded;
    if (!rbdi_all_finite(problem->delta, s.rows * s.rows) || !rbdi_all_finite(problem->b, s.rows) ||
        !rbdi_all_finite(p, s.rows)) {
        rbdi_clear(p, s.rows);
        return RBD_ERR_NAN;
    }

    rbdi_lay_solver(&s, problem->contacts, problem->bounded, rbdi_aligned(memory));
    rbdi_contact_begin(&s, problem, p);
    rbdi_contact_iterate(&s);

    for (int i = 0; state && i < problem->contacts; ++i) state[i] = s.law[i].state;
    if (solution) *solution = s.solution;
    return RBD_OK;
}

#endif
