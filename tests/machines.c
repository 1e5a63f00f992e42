/* machines.c - runs the suites that machines.sh takes to other machines: those that need neither the
   textbook's long double, which is another format there or a slow one, nor much time under an emulator. */
#include <check.h>

#define SUITES(x) x(status) x(build) x(work) x(passive) x(manifold) x(lookup) x(singular)
#define DECLARE_SUITE(name) Suite *name##_suite(void);
SUITES(DECLARE_SUITE)
#define ADD_SUITE(name) srunner_add_suite(runner, name##_suite());

int main(void) {
    SRunner *runner = srunner_create(NULL);
    SUITES(ADD_SUITE)
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
