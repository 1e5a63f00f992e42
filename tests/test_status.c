/* test_status.c - [status]: sentences for statuses and findings. */
#include <string.h>

#include "suites.h"
#include "support.h"

START_TEST(every_status_has_a_sentence_of_its_own) {
    for (int i = RBD_ERR_MASSLESS; i <= RBD_WARN_LIMITS; i++) {
        const char *text = rbd_status_string((rbd_status)i);
        ck_assert_ptr_nonnull(text);
        ck_assert_msg(strlen(text) >= 2, "status %d: '%s'", i, text);
        for (int k = RBD_ERR_MASSLESS; k < i; k++) {
            const char *other = rbd_status_string((rbd_status)k);
            /* "not finite" and the like may serve two fields: the finding names the field */
            if (k >= RBD_ERR_ORDER || (k <= RBD_ERR_WORK && k != RBD_ERR_RANGE))
                ck_assert_msg(strcmp(text, other) != 0, "statuses %d and %d: '%s'", i, k, text);
        }
    }
}
END_TEST

START_TEST(unknown_statuses_have_a_sentence_too) {
    const int unknown[4] = {RBD_ERR_MASSLESS - 1, RBD_WARN_LIMITS + 1, 1000000, -1000000};
    for (int i = 0; i < 4; i++) {
        const char *text = rbd_status_string((rbd_status)unknown[i]);
        ck_assert_ptr_nonnull(text);
        ck_assert_str_ne(text, rbd_status_string(RBD_OK));
        ck_assert_uint_gt(strlen(text), 0);
    }
}
END_TEST

static const rbd_finding finding = {RBD_ERR_MASS, 3, "left_foot", "mass", NULL};

START_TEST(finding_names_body_field_and_cause) {
    char text[200], expected[200] = "body 3 'left_foot', field 'mass': ";
    strcat(expected, rbd_status_string(RBD_ERR_MASS));
    ck_assert_ptr_eq(rbd_finding_text(&finding, text, sizeof text), text);
    ck_assert_str_eq(text, expected);
}
END_TEST

START_TEST(finding_without_name_or_body_is_still_a_sentence) {
    const rbd_finding nameless = {RBD_ERR_COM, 12, NULL, "com", NULL},
                      whole = {RBD_ERR_COUNT, -1, NULL, NULL, NULL};
    char text[200];
    rbd_finding_text(&nameless, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "body 12"));
    ck_assert_ptr_nonnull(strstr(text, "'com'"));
    ck_assert_ptr_nonnull(strstr(text, rbd_status_string(RBD_ERR_COM)));
    ck_assert_ptr_null(strstr(text, "null"));
    rbd_finding_text(&whole, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, rbd_status_string(RBD_ERR_COUNT)));
    ck_assert_ptr_null(strstr(text, "-1"));
    ck_assert_ptr_null(strstr(text, "null"));
}
END_TEST

START_TEST(finding_is_cut_to_fit_and_terminated) {
    char whole[200], text[200];
    rbd_finding_text(&finding, whole, sizeof whole);
    const size_t length = strlen(whole);
    for (size_t size = 1; size <= length + 2; size++) {
        memset(text, '#', sizeof text);
        rbd_finding_text(&finding, text, size);
        const size_t kept = size - 1 < length ? size - 1 : length;
        ck_assert_uint_eq(strlen(text), kept);
        ck_assert_int_eq(strncmp(text, whole, kept), 0);
        ck_assert_int_eq(text[size], '#');
    }
    memset(text, '#', sizeof text);
    rbd_finding_text(&finding, text, 0);
    ck_assert_int_eq(text[0], '#');
}
END_TEST

START_TEST(finding_text_without_finding_or_text_is_left_alone) {
    char text[8] = "same";
    ck_assert_ptr_eq(rbd_finding_text(NULL, text, sizeof text), text);
    ck_assert_str_eq(text, "same");
    ck_assert_ptr_null(rbd_finding_text(&finding, NULL, 8));
}
END_TEST

Suite *status_suite(void) {
    Suite *suite = suite_create("status");
    TCase *c = tcase_create("status");
    tcase_add_test(c, every_status_has_a_sentence_of_its_own);
    tcase_add_test(c, unknown_statuses_have_a_sentence_too);
    tcase_add_test(c, finding_names_body_field_and_cause);
    tcase_add_test(c, finding_without_name_or_body_is_still_a_sentence);
    tcase_add_test(c, finding_is_cut_to_fit_and_terminated);
    tcase_add_test(c, finding_text_without_finding_or_text_is_left_alone);
    suite_add_tcase(suite, c);
    return suite;
}
