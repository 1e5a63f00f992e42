/* tests.c - runs all suites. `tests --errors` also prints the largest error of every quantity. */
#include <string.h>

#include "suites.h"
#include "support.h"

#define ADD_SUITE(name) srunner_add_suite(runner, name##_suite());

int main(int argc, char **argv) {
    const int errors = argc > 1 && strcmp(argv[1], "--errors") == 0;
    SRunner *runner = srunner_create(NULL);
    SUITES(ADD_SUITE)
    if (errors) {
        srunner_set_fork_status(runner, CK_NOFORK); /* the errors are kept in this process */
        record_errors();
    }
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (errors) print_errors();
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
