/* check.h - stands in for Check (libcheck) where there is none: on a microcontroller and on machines that are
   emulated, for scalars.c and for the suites of tests.c. The same tests run there, without processes, files
   or signals. The first failure ends the program.
   SPDX-License-Identifier: MIT */
#ifndef FIRMWARE_CHECK_H
#define FIRMWARE_CHECK_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CK_NORMAL, CHECK_MAX_TESTS = 64, CHECK_MAX_SUITES = 64 };
enum { CK_NOFORK }; /* as all is */

typedef struct TCase {
    void (*test[CHECK_MAX_TESTS])(void);
    const char *name[CHECK_MAX_TESTS];
    int tests;
} TCase;
typedef TCase *Suite; /* of one case, which has the tests of all */
typedef struct SRunner {
    Suite suite[CHECK_MAX_SUITES];
    int suites, tests;
} SRunner;

/* One of each in every file: a file makes one suite, and the file of main the runner. */
static TCase check_case;
static Suite check_suite;
static SRunner check_runner;
static const char *check_running; /* in the file of main; the message names file and line */

#define START_TEST(name) static void name(void)
#define END_TEST

#define ck_assert_msg(condition, ...) \
    do { \
        if (!(condition)) { \
            printf("FAILED %s: %s:%d: ", check_running ? check_running : "", __FILE__, __LINE__); \
            printf(__VA_ARGS__); \
            printf("\n"); \
            exit(EXIT_FAILURE); \
        } \
    } while (0)
#define ck_abort_msg(...) ck_assert_msg(0, __VA_ARGS__)
#define ck_assert(condition) ck_assert_msg(condition, "%s", #condition)
#define CHECK_COMPARE(a, operator, b) ck_assert_msg((a) operator(b), "%s %s %s", #a, #operator, #b)
#define ck_assert_int_eq(a, b) CHECK_COMPARE(a, ==, b)
#define ck_assert_int_ne(a, b) CHECK_COMPARE(a, !=, b)
#define ck_assert_int_lt(a, b) CHECK_COMPARE(a, <, b)
#define ck_assert_int_le(a, b) CHECK_COMPARE(a, <=, b)
#define ck_assert_int_gt(a, b) CHECK_COMPARE(a, >, b)
#define ck_assert_int_ge(a, b) CHECK_COMPARE(a, >=, b)
#define ck_assert_uint_eq(a, b) CHECK_COMPARE(a, ==, b)
#define ck_assert_uint_ne(a, b) CHECK_COMPARE(a, !=, b)
#define ck_assert_uint_lt(a, b) CHECK_COMPARE(a, <, b)
#define ck_assert_uint_le(a, b) CHECK_COMPARE(a, <=, b)
#define ck_assert_uint_gt(a, b) CHECK_COMPARE(a, >, b)
#define ck_assert_uint_ge(a, b) CHECK_COMPARE(a, >=, b)
#define ck_assert_double_eq(a, b) CHECK_COMPARE(a, ==, b)
#define ck_assert_double_lt(a, b) CHECK_COMPARE(a, <, b)
#define ck_assert_double_le(a, b) CHECK_COMPARE(a, <=, b)
#define ck_assert_double_gt(a, b) CHECK_COMPARE(a, >, b)
#define ck_assert_double_ge(a, b) CHECK_COMPARE(a, >=, b)
#define ck_assert_ptr_eq(a, b) CHECK_COMPARE(a, ==, b)
#define ck_assert_ptr_ne(a, b) CHECK_COMPARE(a, !=, b)
#define ck_assert_ptr_null(a) CHECK_COMPARE(a, ==, NULL)
#define ck_assert_ptr_nonnull(a) CHECK_COMPARE(a, !=, NULL)
#define ck_assert_str_eq(a, b) ck_assert_msg(strcmp(a, b) == 0, "\"%s\" == \"%s\"", a, b)
#define ck_assert_str_ne(a, b) ck_assert_msg(strcmp(a, b) != 0, "\"%s\" != \"%s\"", a, b)
#define ck_assert_mem_eq(a, b, size) ck_assert_msg(memcmp(a, b, size) == 0, "%s == %s", #a, #b)
#define ck_assert_mem_ne(a, b, size) ck_assert_msg(memcmp(a, b, size) != 0, "%s != %s", #a, #b)

static inline TCase *tcase_create(const char *name) {
    (void)name;
    return &check_case;
}
static inline void tcase_set_tags(TCase *c, const char *tags) {
    (void)c;
    (void)tags;
}
static inline void tcase_set_timeout(TCase *c, double seconds) {
    (void)c, (void)seconds; /* the emulator has one */
}
#define tcase_add_test(c, function) check_add(c, function, #function)
static inline void check_add(TCase *c, void (*test)(void), const char *name) {
    if (c->tests == CHECK_MAX_TESTS) {
        printf("FAILED: more than %d tests\n", CHECK_MAX_TESTS);
        exit(EXIT_FAILURE);
    }
    c->name[c->tests] = name;
    c->test[c->tests++] = test;
}
static inline Suite *suite_create(const char *name) {
    (void)name;
    return &check_suite;
}
static inline void suite_add_tcase(Suite *suite, TCase *c) { *suite = c; }
static inline void srunner_add_suite(SRunner *runner, Suite *suite) {
    if (runner->suites == CHECK_MAX_SUITES) {
        printf("FAILED: more than %d suites\n", CHECK_MAX_SUITES);
        exit(EXIT_FAILURE);
    }
    runner->suite[runner->suites++] = *suite;
}
static inline SRunner *srunner_create(Suite *suite) {
    if (suite) srunner_add_suite(&check_runner, suite);
    return &check_runner;
}
static inline void srunner_set_fork_status(SRunner *runner, int status) { (void)runner, (void)status; }
static inline void srunner_run_all(SRunner *runner, int verbosity) {
    (void)verbosity;
    for (int s = 0; s < runner->suites; s++)
        for (int i = 0; i < runner->suite[s]->tests; i++) {
            check_running = runner->suite[s]->name[i];
            runner->suite[s]->test[i]();
            runner->tests++;
        }
    printf("%d tests passed\n", runner->tests);
}
static inline int srunner_ntests_failed(SRunner *runner) {
    return runner->tests == 0; /* one that failed has ended the program */
}
static inline void srunner_free(SRunner *runner) { (void)runner; }

#endif
