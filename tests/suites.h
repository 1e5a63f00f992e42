/* suites.h - the suites that tests.c runs, one per file test_NAME.c. */
#ifndef SUITES_H
#define SUITES_H

#include <check.h>

/* In the order of rbd.h's sections; then what concerns all of them. */
#define SUITES(x) \
    x(status) x(build) x(payload) x(lock) x(work) x(rnea) x(observer) x(crba) x(aba) x(hybrid) x(cholesky) \
        x(passive) x(kinematics) x(wrench) x(points) x(manifold) x(lookup) x(joints) x(mimic) x(massless) \
            x(singular) x(simulation) x(textbook) x(guarded) x(control) x(derivatives) x(jacobians) \
                x(constraints) x(contact) x(contact_step) x(contact_bounded) x(contact_energy) \
                    x(contact_derivatives) x(ik) x(estimate) x(actuator) x(tasks)

#define DECLARE_SUITE(name) Suite *name##_suite(void);
SUITES(DECLARE_SUITE)

#endif
