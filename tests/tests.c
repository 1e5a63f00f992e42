/* tests.c - runs all suites, or those named: tests [SUITE...]. `tests --errors` also prints the largest error
   of every quantity; `tests --contacts` runs those of rbd_contact.h and prints their figures. */
#include <stdio.h>
#include <string.h>

#include "suites.h"
#include "support.h"

#define ADD_SUITE(name) srunner_add_suite(runner, name##_suite());
#define ADD_NAMED(name) \
    if (strcmp(wanted, #name) == 0) { \
        ADD_SUITE(name) \
        return 1; \
    }

/* Adds the suite of this name; returns 0 if there is none. */
static int add_named(SRunner *runner, const char *wanted) {
    SUITES(ADD_NAMED)
    return 0;
}

/* Adds the suites named, all if none is; returns the first name that is no suite's. */
static const char *add_suites(SRunner *runner, char **names, int n) {
    for (int i = 0; i < n; i++)
        if (!add_named(runner, names[i])) return names[i];

    if (n == 0) {
        SUITES(ADD_SUITE)
    }
    return NULL;
}

int main(int argc, char **argv) {
    const int errors = argc > 1 && strcmp(argv[1], "--errors") == 0;
    const int contacts = argc > 1 && strcmp(argv[1], "--contacts") == 0;
    const int options = errors || contacts;
    static char *of_contacts[] = {"contact", "contact_step", "contact_energy", "contact_bounded",
                                  "contact_derivatives"};
    SRunner *runner = srunner_create(NULL);

    const char *unknown = contacts ? add_suites(runner, of_contacts, LENGTH(of_contacts))
                                   : add_suites(runner, argv + 1 + options, argc - 1 - options);
    if (unknown) {
        fprintf(stderr, "tests: no suite is called '%s'\n", unknown);
        return EXIT_FAILURE;
    }
    if (contacts) record_figures();
    if (errors) record_errors();
    if (options) srunner_set_fork_status(runner, CK_NOFORK); /* all is kept in this process */
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (errors) print_errors();
    if (contacts) print_figures();
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
