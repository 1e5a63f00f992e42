/* tests.c - runs all suites. `tests --errors` also prints the largest error of every quantity; `tests
   --contacts` runs those of rbd_contact.h and prints their figures. */
#include <string.h>

#include "suites.h"
#include "support.h"

#define ADD_SUITE(name) srunner_add_suite(runner, name##_suite());

int main(int argc, char **argv) {
    const int errors = argc > 1 && strcmp(argv[1], "--errors") == 0;
    const int contacts = argc > 1 && strcmp(argv[1], "--contacts") == 0;
    SRunner *runner = srunner_create(NULL);
    if (contacts) {
        ADD_SUITE(contact) ADD_SUITE(contact_step) ADD_SUITE(contact_derivatives) record_figures();
    } else {
        SUITES(ADD_SUITE)
    }
    if (errors) record_errors();
    if (errors || contacts) srunner_set_fork_status(runner, CK_NOFORK); /* all is kept in this process */
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (errors) print_errors();
    if (contacts) print_figures();
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
