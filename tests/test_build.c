/* test_build.c - [build]: every refusal by name, with body and field; warnings; capacity. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "suites.h"
#include "support.h"

enum { NB = 4 };

/* A sound description: floating base, a revolute arm, a fixed tool, a helical joint at its end. */
static void sound(rbd_body b[NB]) {
    const rbd_body rows[NB] = {{.name = "base",
                                .joint = "free",
                                .parent = -1,
                                .type = RBD_FLOATING,
                                .mass = 3,
                                .inertia = {1, 0, 0, 1, 0, 1}},
                               {.name = "arm",
                                .joint = "elbow",
                                .type = RBD_REVOLUTE,
                                .axis = {0, 0, 2},
                                .position = {1, 0, 0},
                                .mass = 2,
                                .com = {0, 0.1, 0},
                                .inertia = {0.2, 0, 0, 0.2, 0, 0.2}},
                               {.name = "tool",
                                .joint = "flange",
                                .parent = 1,
                                .type = RBD_FIXED,
                                .mass = 0.5,
                                .inertia = {0.1, 0, 0, 0.1, 0, 0.1}},
                               {.name = "screw",
                                .joint = "lead",
                                .parent = 2,
                                .type = RBD_HELICAL,
                                .axis = {1, 1, 0},
                                .pitch = 0.1,
                                .mass = 1,
                                .inertia = {0.1, 0, 0, 0.1, 0, 0.1}}};
    memcpy(b, rows, sizeof rows);
}

static rbd_status build(const rbd_body *bodies, int nb, rbd_report *report) {
    static unsigned char memory[RBD_MODEL_SIZE(MAX_BODIES)];
    const rbd_model *m;
    return rbd_model_build(bodies, nb, memory, sizeof memory, &m, report);
}

static void check_refusal(const rbd_body b[NB], const char *change, rbd_status status, int body,
                          const char *field) {
    rbd_report report;
    char text[200], named[80];
    ck_assert_msg(build(b, NB, NULL) == status, "%s: without a report", change);
    memset(&report, 0x5a, sizeof report);
    const rbd_status found = build(b, NB, &report);
    ck_assert_msg(found == status && report.error.status == status, "%s: %d instead of %d (%s)", change,
                  found, status, rbd_status_string(found));
    ck_assert_msg(report.error.body == body, "%s: body %d", change, report.error.body);
    ck_assert_msg(report.error.name == b[body].name, "%s: name", change);
    ck_assert_msg(report.error.field && strcmp(report.error.field, field) == 0, "%s: field '%s'", change,
                  report.error.field ? report.error.field : "NULL");
    rbd_finding_text(&report.error, text, sizeof text);
    snprintf(named, sizeof named, "body %d '%s', field '%s': ", body, b[body].name, field);
    ck_assert_msg(strncmp(text, named, strlen(named)) == 0, "%s: '%s'", change, text);
}

/* One change of the sound description, and what the build must say to it. */
#define REFUSES(status, body, field, change) \
    do { \
        rbd_body b[NB]; \
        sound(b); \
        change; \
        check_refusal(b, #change, status, body, field); \
    } while (0)

/* A number that must be finite: NaN and both infinities. */
#define REFUSES_NONFINITE(status, body, field, number) \
    do { \
        REFUSES(status, body, field, number = NAN); \
        REFUSES(status, body, field, number = HUGE_VAL); \
        REFUSES(status, body, field, number = -HUGE_VAL); \
    } while (0)

START_TEST(sound_description_is_built_without_finding) {
    rbd_body b[NB];
    rbd_report report;
    sound(b);
    memset(&report, 0x5a, sizeof report);
    ck_assert_int_eq(build(b, NB, &report), RBD_OK);
    ck_assert_int_eq(report.error.status, RBD_OK);
    ck_assert_int_eq(report.warnings, 0);
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
}
END_TEST

START_TEST(names_standing_twice_are_refused) {
    REFUSES(RBD_ERR_NAME, 2, "name", b[2].name = "base");
    REFUSES(RBD_ERR_NAME, 3, "name", b[3].name = "tool");
    REFUSES(RBD_ERR_NAME, 2, "joint", b[2].joint = "free");
    REFUSES(RBD_ERR_NAME, 3, "joint", b[3].joint = "elbow");
    char copy[] = "base"; /* the text counts, not the pointer */
    REFUSES(RBD_ERR_NAME, 1, "name", b[1].name = copy);
}
END_TEST

START_TEST(nameless_bodies_are_welcome) {
    rbd_body b[NB];
    sound(b);
    for (int i = 0; i < NB; i++) b[i].name = b[i].joint = NULL;
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
}
END_TEST

START_TEST(wrong_parents_are_refused) {
    REFUSES(RBD_ERR_PARENT, 0, "parent", b[0].parent = 0);
    REFUSES(RBD_ERR_PARENT, 1, "parent", b[1].parent = 1);
    REFUSES(RBD_ERR_PARENT, 1, "parent", b[1].parent = 2);
    REFUSES(RBD_ERR_PARENT, 1, "parent", b[1].parent = 1000000);
    REFUSES(RBD_ERR_PARENT, 2, "parent", b[2].parent = -2);
}
END_TEST

START_TEST(unknown_joint_types_are_refused) {
    REFUSES(RBD_ERR_TYPE, 1, "type", b[1].type = RBD_JOINT_TYPES);
    REFUSES(RBD_ERR_TYPE, 1, "type", b[1].type = (rbd_joint_type)1000);
    REFUSES(RBD_ERR_TYPE, 1, "type", b[1].type = (rbd_joint_type)-1);
}
END_TEST

static void follow(rbd_body *b, const char *joint) {
    b->mimic = joint;
    b->mimic_ratio = 2;
}

/* Type 0 is fixed: whoever forgets the type but gives an axis must hear of it. */
START_TEST(fixed_joints_with_an_axis_are_refused) {
    for (int k = 0; k < 3; k++) {
        REFUSES(RBD_ERR_TYPE, 2, "type", b[2].axis[k] = 1);
        REFUSES(RBD_ERR_TYPE, 2, "type", b[2].axis[k] = -1e-3);
    }
    REFUSES(RBD_ERR_TYPE, 1, "type", b[1].type = RBD_FIXED); /* the arm has its axis already */
}
END_TEST

/* The sentence on a change of the sound description, without body and field. */
static const char *sentence(const rbd_body *b) {
    static char text[200];
    rbd_report report;
    ck_assert_int_ne(build(b, NB, &report), RBD_OK);
    rbd_finding_text(&report.error, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "': "));
    return strstr(text, "': ") + 3;
}

/* One status, but what is to be mended differs. */
START_TEST(sentences_tell_causes_apart) {
    rbd_body unknown[NB], missing[NB], frozen[NB], infinite[NB], nobody[NB];
    const rbd_body *const wrong[5] = {unknown, missing, frozen, infinite, nobody};
    char texts[5][200];
    sound(unknown), sound(missing), sound(frozen), sound(infinite), sound(nobody);
    unknown[1].type = RBD_JOINT_TYPES;
    missing[1].type = RBD_FIXED;
    follow(&frozen[3], "elbow");
    follow(&infinite[3], "elbow");
    follow(&nobody[3], "nobody");
    frozen[3].mimic_ratio = 0;
    infinite[3].mimic_ratio = HUGE_VAL;
    for (int i = 0; i < 5; i++) {
        strcpy(texts[i], sentence(wrong[i]));
        for (int j = 0; j < i; j++) ck_assert_str_ne(texts[i], texts[j]);
    }
    ck_assert_ptr_nonnull(strstr(texts[1], "missing"));
    ck_assert_ptr_nonnull(strstr(texts[2], "fixed joint"));
}
END_TEST

static const rbd_joint_type with_axis[] = {RBD_REVOLUTE, RBD_CONTINUOUS,  RBD_CONTINUOUS_CS, RBD_PRISMATIC,
                                           RBD_HELICAL,  RBD_CYLINDRICAL, RBD_UNIVERSAL};

START_TEST(zero_and_nonfinite_axes_are_refused) {
    for (int i = 0; i < LENGTH(with_axis); i++) {
        REFUSES(RBD_ERR_AXIS, 1, "axis", b[1].type = with_axis[i]; b[1].axis2[0] = 1; b[1].axis[2] = 0);
        for (int k = 0; k < 3; k++)
            REFUSES_NONFINITE(RBD_ERR_AXIS, 1, "axis", b[1].type = with_axis[i]; b[1].axis2[0] = 1;
                              b[1].axis[k]);
    }
}
END_TEST

START_TEST(second_axes_zero_parallel_or_nonfinite_are_refused) {
    REFUSES(RBD_ERR_AXIS, 1, "axis2", b[1].type = RBD_UNIVERSAL);
    REFUSES(RBD_ERR_AXIS, 1, "axis2", b[1].type = RBD_UNIVERSAL; b[1].axis2[2] = 3);
    REFUSES(RBD_ERR_AXIS, 1, "axis2", b[1].type = RBD_UNIVERSAL; b[1].axis2[2] = -1);
    for (int k = 0; k < 3; k++)
        REFUSES_NONFINITE(RBD_ERR_AXIS, 1, "axis2", b[1].type = RBD_UNIVERSAL; b[1].axis2[0] = 1;
                          b[1].axis2[k]);
}
END_TEST

/* Long and short axes are axes; only zero is not. */
START_TEST(axes_of_any_length_are_welcome) {
    const double lengths[4] = {1e-300, 1e-6, 1e9, 1e300};
    for (int i = 0; i < 4; i++) {
        rbd_body b[NB];
        sound(b);
        b[1].axis[2] = lengths[i];
        ck_assert_msg(build(b, NB, NULL) == RBD_OK, "axis of length %g", lengths[i]);
    }
}
END_TEST

/* Of products of rows 4e-6 passes: six decimals in a file will do. */
START_TEST(matrices_that_rotate_to_six_decimals_are_welcome) {
    const double shear[9] = {1, 3e-6, 0, 0, 1, 0, 0, 0, 1}, more[9] = {1, 6e-6, 0, 0, 1, 0, 0, 0, 1};
    rbd_body b[NB];
    sound(b);
    memcpy(b[1].rotation, shear, sizeof shear);
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
    REFUSES(RBD_ERR_ROTATION, 1, "rotation", memcpy(b[1].rotation, more, sizeof more));
}
END_TEST

/* Two axes are parallel below an angle of 1e-6 rad. */
START_TEST(axes_of_a_universal_joint_are_parallel_below_a_millionth) {
    rbd_body b[NB];
    REFUSES(RBD_ERR_AXIS, 1, "axis2", b[1].type = RBD_UNIVERSAL; b[1].axis2[0] = 6e-7; b[1].axis2[2] = 1);
    sound(b);
    b[1].type = RBD_UNIVERSAL;
    b[1].axis2[0] = 2e-6;
    b[1].axis2[2] = 1;
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
}
END_TEST

START_TEST(nonfinite_pitch_and_position_are_refused) {
    REFUSES_NONFINITE(RBD_ERR_PITCH, 3, "pitch", b[3].pitch);
    for (int k = 0; k < 3; k++) {
        REFUSES_NONFINITE(RBD_ERR_POSITION, 2, "position", b[2].position[k]);
        REFUSES_NONFINITE(RBD_ERR_POSITION, 1, "position", b[1].position[k]);
    }
}
END_TEST

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

START_TEST(matrices_that_do_not_rotate_are_refused) {
    const double mirror[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1}, twice[9] = {2, 0, 0, 0, 2, 0, 0, 0, 2};
    const double shear[9] = {1, 0.01, 0, 0, 1, 0, 0, 0, 1}, flat[9] = {1, 0, 0, 0, 1, 0, 0, 0, 0};
    const double tall[9] = {1, 0, 0, 0, 1, 0, 0, 0, 2};
    REFUSES(RBD_ERR_ROTATION, 1, "rotation", memcpy(b[1].rotation, mirror, sizeof mirror));
    REFUSES(RBD_ERR_ROTATION, 1, "rotation", memcpy(b[1].rotation, twice, sizeof twice));
    REFUSES(RBD_ERR_ROTATION, 1, "rotation", memcpy(b[1].rotation, shear, sizeof shear));
    REFUSES(RBD_ERR_ROTATION, 2, "rotation", memcpy(b[2].rotation, flat, sizeof flat));
    REFUSES(RBD_ERR_ROTATION, 2, "rotation", memcpy(b[2].rotation, tall, sizeof tall));
    REFUSES(RBD_ERR_ROTATION, 0, "rotation", b[0].rotation[4] = 1);
    for (int k = 0; k < 9; k++)
        REFUSES_NONFINITE(RBD_ERR_ROTATION, 1, "rotation", memcpy(b[1].rotation, identity, sizeof identity);
                          b[1].rotation[k]);
}
END_TEST

START_TEST(negative_and_nonfinite_masses_are_refused) {
    REFUSES(RBD_ERR_MASS, 1, "mass", b[1].mass = -1e-9);
    REFUSES(RBD_ERR_MASS, 2, "mass", b[2].mass = -1);
    REFUSES_NONFINITE(RBD_ERR_MASS, 3, "mass", b[3].mass);
}
END_TEST

START_TEST(nonfinite_com_and_inertia_are_refused) {
    for (int k = 0; k < 3; k++) REFUSES_NONFINITE(RBD_ERR_COM, 1, "com", b[1].com[k]);
    for (int k = 0; k < 6; k++) {
        REFUSES_NONFINITE(RBD_ERR_INERTIA, 1, "inertia", b[1].inertia[k]);
        REFUSES_NONFINITE(RBD_ERR_INERTIA, 2, "inertia", b[2].inertia[k]);
    }
}
END_TEST

START_TEST(movable_leaf_without_mass_is_refused) {
    REFUSES(RBD_ERR_LEAF, 3, "mass", b[3].mass = 0; memset(b[3].inertia, 0, sizeof b[3].inertia));
    REFUSES(RBD_ERR_LEAF, 3, "mass", b[3].parent = 0; b[2].mass = b[1].mass = 0; b[1].type = RBD_FIXED;
            b[1].axis[2] = 0; b[3].mass = 0; memset(b[3].inertia, 0, sizeof b[3].inertia));
}
END_TEST

/* A revolute joint has one degree of freedom, a ball joint three: the rotors beyond turn nothing. */
START_TEST(armature_beyond_the_joint_s_freedom_is_no_inertia) {
    for (int k = 1; k < 6; k++)
        REFUSES(RBD_ERR_LEAF, 3, "mass", b[3].mass = 0; memset(b[3].inertia, 0, sizeof b[3].inertia);
                b[3].armature[k] = 1);
    for (int k = 3; k < 6; k++)
        REFUSES(RBD_ERR_LEAF, 3, "mass", b[3].mass = 0; memset(b[3].inertia, 0, sizeof b[3].inertia);
                b[3].type = RBD_SPHERICAL; b[3].armature[k] = 1);
}
END_TEST

/* Bodies fixed to a movable body belong to it, and the inertia of a rotor suffices. */
START_TEST(leaf_with_fixed_mass_or_armature_is_welcome) {
    rbd_body b[NB];
    sound(b);
    b[1].mass = 0;
    memset(b[1].inertia, 0, sizeof b[1].inertia);
    b[3].parent = 0; /* the arm is a leaf now, but for its fixed tool */
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
    sound(b);
    b[3].mass = 0;
    memset(b[3].inertia, 0, sizeof b[3].inertia);
    b[3].armature[0] = 0.1;
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
}
END_TEST

static void weigh_nothing(rbd_body *b) {
    b->mass = 0;
    memset(b->inertia, 0, sizeof b->inertia);
}

/* Inertia counts without mass, and what follows the leaf's joint moves with it. */
START_TEST(leaf_that_moves_inertia_elsewhere_is_welcome) {
    rbd_body b[NB];
    sound(b);
    weigh_nothing(&b[1]);
    b[2].mass = 0; /* the tool keeps its inertia */
    b[3].parent = 0;
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
    weigh_nothing(&b[2]);
    ck_assert_int_eq(build(b, NB, NULL), RBD_ERR_LEAF);
    b[3].mimic = "elbow";
    b[3].mimic_ratio = 1;
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
}
END_TEST

/* A body fixed to one that is fixed to the leaf: neither has mass, and nothing hangs on them. */
START_TEST(leaf_with_two_massless_bodies_fixed_to_it_is_refused) {
    REFUSES(RBD_ERR_LEAF, 1, "mass", b[3].type = RBD_FIXED; b[3].axis[0] = b[3].axis[1] = 0;
            for (int i = 1; i < NB; i++) weigh_nothing(&b[i]));
}
END_TEST

START_TEST(negative_and_nonfinite_joint_constants_are_refused) {
    REFUSES(RBD_ERR_ARMATURE, 1, "armature", b[1].armature[0] = -1);
    REFUSES(RBD_ERR_DAMPING, 1, "damping", b[1].damping[0] = -1);
    REFUSES(RBD_ERR_FRICTION, 1, "friction", b[1].friction[0] = -1);
    for (int k = 0; k < 6; k++) {
        REFUSES(RBD_ERR_ARMATURE, 0, "armature", b[0].armature[k] = -1e-9);
        REFUSES(RBD_ERR_DAMPING, 0, "damping", b[0].damping[k] = -1e-9);
        REFUSES(RBD_ERR_FRICTION, 0, "friction", b[0].friction[k] = -1e-9);
        REFUSES_NONFINITE(RBD_ERR_ARMATURE, 0, "armature", b[0].armature[k]);
        REFUSES_NONFINITE(RBD_ERR_DAMPING, 0, "damping", b[0].damping[k]);
        REFUSES_NONFINITE(RBD_ERR_FRICTION, 0, "friction", b[0].friction[k]);
    }
}
END_TEST

START_TEST(nonfinite_limits_and_negative_maxima_are_refused) {
    REFUSES(RBD_ERR_LIMITS, 1, "velocity", b[1].velocity = -1);
    REFUSES(RBD_ERR_LIMITS, 1, "effort", b[1].effort = -1);
    REFUSES_NONFINITE(RBD_ERR_LIMITS, 1, "lower", b[1].lower);
    REFUSES_NONFINITE(RBD_ERR_LIMITS, 1, "upper", b[1].upper);
    REFUSES_NONFINITE(RBD_ERR_LIMITS, 1, "velocity", b[1].velocity);
    REFUSES_NONFINITE(RBD_ERR_LIMITS, 1, "effort", b[1].effort);
}
END_TEST

START_TEST(wrong_mimic_joints_are_refused) {
    REFUSES(RBD_ERR_MIMIC, 3, "mimic", follow(&b[3], "nobody"));
    REFUSES(RBD_ERR_MIMIC, 3, "mimic", follow(&b[3], "lead"));   /* itself */
    REFUSES(RBD_ERR_MIMIC, 3, "mimic", follow(&b[3], "free"));   /* not one degree of freedom */
    REFUSES(RBD_ERR_MIMIC, 3, "mimic", follow(&b[3], "flange")); /* fixed */
    REFUSES(RBD_ERR_MIMIC, 0, "mimic", follow(&b[0], "elbow"));
    REFUSES(RBD_ERR_MIMIC, 1, "mimic", follow(&b[1], "lead"); follow(&b[3], "elbow"));
    REFUSES_NONFINITE(RBD_ERR_MIMIC, 3, "mimic_ratio", follow(&b[3], "elbow"); b[3].mimic_ratio);
    REFUSES(RBD_ERR_MIMIC, 3, "mimic_ratio", follow(&b[3], "elbow"); b[3].mimic_ratio = 0); /* stands still */
    REFUSES_NONFINITE(RBD_ERR_MIMIC, 3, "mimic_offset", follow(&b[3], "elbow"); b[3].mimic_offset);
}
END_TEST

START_TEST(joint_may_follow_a_later_one) {
    rbd_body b[NB];
    sound(b);
    follow(&b[1], "lead");
    ck_assert_int_eq(build(b, NB, NULL), RBD_OK);
}
END_TEST

/* ---- warnings ---- */

static void check_warning(const rbd_body b[NB], const char *change, rbd_status status, int body,
                          const char *field) {
    rbd_report report;
    memset(&report, 0x5a, sizeof report);
    ck_assert_msg(build(b, NB, &report) == RBD_OK, "%s: refused", change);
    ck_assert_msg(report.error.status == RBD_OK, "%s: error", change);
    ck_assert_msg(report.warnings == 1, "%s: %d warnings", change, report.warnings);
    ck_assert_msg(report.warning[0].status == status, "%s: %s", change,
                  rbd_status_string(report.warning[0].status));
    ck_assert_msg(report.warning[0].body == body && report.warning[0].name == b[body].name, "%s: body",
                  change);
    ck_assert_msg(strcmp(report.warning[0].field, field) == 0, "%s: field '%s'", change,
                  report.warning[0].field);
}

#define WARNS(status, body, field, change) \
    do { \
        rbd_body b[NB]; \
        sound(b); \
        change; \
        check_warning(b, #change, status, body, field); \
    } while (0)

#define INERTIA(i, xx, xy, xz, yy, yz, zz) \
    b[i].inertia[0] = xx, b[i].inertia[1] = xy, b[i].inertia[2] = xz, b[i].inertia[3] = yy, \
    b[i].inertia[4] = yz, b[i].inertia[5] = zz

START_TEST(impossible_inertias_are_warned_of) {
    WARNS(RBD_WARN_INERTIA_NEGATIVE, 1, "inertia", INERTIA(1, 1, 0, 0, 1, 0, -0.1));
    WARNS(RBD_WARN_INERTIA_NEGATIVE, 1, "inertia", INERTIA(1, 1, 2, 0, 1, 0, 1)); /* eigenvalue 1 - 2 */
    WARNS(RBD_WARN_INERTIA_NEGATIVE, 2, "inertia", INERTIA(2, 1, 0, 0, 1, 1.5, 1));
    WARNS(RBD_WARN_INERTIA_NEGATIVE, 1, "inertia", INERTIA(1, -1, 0, 0, 1, 0, 1));
    WARNS(RBD_WARN_INERTIA_NEGATIVE, 1, "inertia", INERTIA(1, 1, -0.6, -0.6, 1, -0.6, 1)); /* only det < 0 */
    WARNS(RBD_WARN_INERTIA_TRIANGLE, 1, "inertia", INERTIA(1, 1, 0, 0, 1, 0, 2.1));
    WARNS(RBD_WARN_INERTIA_TRIANGLE, 3, "inertia", INERTIA(3, 1, 0.9, 0, 1, 0, 0.1)); /* 1.9, 0.1, 0.1 */
    WARNS(RBD_WARN_INERTIA_TRIANGLE, 1, "inertia", INERTIA(1, 1, 0, 0, 0, 0, 0));     /* one moment alone */
    WARNS(RBD_WARN_INERTIA_TRIANGLE, 1, "inertia", INERTIA(1, 0, 0, 0, 1, 0, 0));
    WARNS(RBD_WARN_INERTIA_TRIANGLE, 1, "inertia", INERTIA(1, 0, 0, 0, 0, 0, 1));
    WARNS(RBD_WARN_INERTIA_ZERO, 1, "inertia", INERTIA(1, 0, 0, 0, 0, 0, 0));
    WARNS(RBD_WARN_MASS_ZERO, 1, "mass", b[1].mass = 0);
}
END_TEST

/* A moment that is negative by 1e-9 of the inertia's entries is rounding. */
START_TEST(moments_that_rounding_made_negative_are_not_warned_of) {
    rbd_report report;
    rbd_body b[NB];
    sound(b);
    INERTIA(1, 1, 0, 0, 1, 0, -1e-9); /* of the sum of the entries half of it */
    ck_assert_int_eq(build(b, NB, &report), RBD_OK);
    ck_assert_int_eq(report.warnings, 0);
    WARNS(RBD_WARN_INERTIA_NEGATIVE, 1, "inertia", INERTIA(1, 1, 0, 0, 1, 0, -4e-9));
}
END_TEST

#define LIMITS(i, joint, low, high) b[i].type = joint, b[i].lower = low, b[i].upper = high

START_TEST(limits_that_mean_none_are_warned_of) {
    rbd_report report;
    rbd_body b[NB];
    char text[200];
    WARNS(RBD_WARN_LIMITS, 1, "lower", LIMITS(1, RBD_REVOLUTE, 1, -1)); /* swapped */
    WARNS(RBD_WARN_LIMITS, 1, "lower", LIMITS(1, RBD_REVOLUTE, 0.5, 0.5));
    WARNS(RBD_WARN_LIMITS, 3, "lower", LIMITS(3, RBD_HELICAL, 0, -1));
    WARNS(RBD_WARN_LIMITS, 1, "lower", LIMITS(1, RBD_CONTINUOUS, -1, 1));
    WARNS(RBD_WARN_LIMITS, 1, "lower", LIMITS(1, RBD_CONTINUOUS_CS, -1, 0));
    WARNS(RBD_WARN_LIMITS, 1, "lower", LIMITS(1, RBD_CYLINDRICAL, 0, 1));
    WARNS(RBD_WARN_LIMITS, 0, "lower", LIMITS(0, RBD_FLOATING, 1, 0));

    sound(b);
    b[1].lower = 2, b[1].upper = 1;
    ck_assert_int_eq(build(b, NB, &report), RBD_OK);
    rbd_finding_text(&report.warning[0], text, sizeof text);
    ck_assert_str_eq(text, "body 1 'arm', field 'lower': not below upper: read as no limits");
    b[1].type = RBD_CONTINUOUS, b[1].upper = 3;
    ck_assert_int_eq(build(b, NB, &report), RBD_OK);
    rbd_finding_text(&report.warning[0], text, sizeof text);
    ck_assert_str_eq(text,
                     "body 1 'arm', field 'lower': limits of a joint whose type has none: read as none");
}
END_TEST

#define FOLLOWS(i, leader, ratio, offset, low, high) \
    LIMITS(i, RBD_REVOLUTE, low, high), b[i].mimic = leader, b[i].mimic_ratio = ratio, \
                                        b[i].mimic_offset = offset

/* x = ratio q + offset cannot be within its limits while q is within its own, or another follower is. */
START_TEST(limits_of_followers_that_contradict_are_warned_of) {
    rbd_report report;
    rbd_body b[NB];
    char text[200];
    WARNS(RBD_WARN_LIMITS, 3, "lower", (LIMITS(1, RBD_REVOLUTE, -1, 1), FOLLOWS(3, "elbow", 1, 0, 2, 3)));
    WARNS(RBD_WARN_LIMITS, 3, "lower", (LIMITS(1, RBD_REVOLUTE, -1, 1), FOLLOWS(3, "elbow", -2, 1, 3.5, 4)));
    WARNS(RBD_WARN_LIMITS, 1, "lower", (LIMITS(3, RBD_REVOLUTE, -1, 1), FOLLOWS(1, "lead", 1, 2, -2, 0.5)));

    sound(b);
    LIMITS(1, RBD_REVOLUTE, -1, 1);
    FOLLOWS(3, "elbow", -2, 1, 2.5, 4); /* q <= -0.75 */
    ck_assert_int_eq(build(b, NB, &report), RBD_OK);
    ck_assert_int_eq(report.warnings, 0);
    b[1].type = RBD_CONTINUOUS, b[1].lower = b[1].upper = 0;
    FOLLOWS(3, "elbow", 1, 0, 2, 3);
    ck_assert_int_eq(build(b, NB, &report), RBD_OK);
    ck_assert_int_eq(report.warnings, 0);

    /* two that follow the same joint: q in 2 .. 3 and in 4 .. 5 */
    b[2].type = RBD_REVOLUTE, b[2].axis[0] = 1;
    FOLLOWS(2, "elbow", 1, 0, 4, 5);
    ck_assert_int_eq(build(b, NB, &report), RBD_OK);
    ck_assert_int_eq(report.warnings, 1);
    rbd_finding_text(&report.warning[0], text, sizeof text);
    ck_assert_str_eq(text,
                     "body 3 'screw', field 'lower': no place of the joint that it mimics is within the "
                     "limits of all");
}
END_TEST

START_TEST(limits_that_are_some_or_none_are_not_warned_of) {
    static const rbd_joint_type types[] = {RBD_REVOLUTE, RBD_PRISMATIC, RBD_HELICAL};
    rbd_report report;
    rbd_body b[NB];
    for (int i = 0; i < 3; i++) {
        sound(b);
        LIMITS(1, types[i], -2, -1);
        ck_assert_int_eq(build(b, NB, &report), RBD_OK);
        ck_assert_int_eq(report.warnings, 0);
    }
    sound(b);
    LIMITS(1, RBD_CONTINUOUS, 0, -0.0);
    ck_assert_int_eq(build(b, NB, &report), RBD_OK);
    ck_assert_int_eq(report.warnings, 0);
}
END_TEST

/* R diag(moment) R', as six entries. */
static void turn_moments(const double R[9], const double moment[3], double I[6]) {
    int entry = 0;
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++, entry++) {
            I[entry] = 0;
            for (int k = 0; k < 3; k++) I[entry] += R[3 * i + k] * moment[k] * R[3 * j + k];
        }
}

/* The principal moments decide, whatever axes they are seen in. */
START_TEST(warnings_of_inertia_are_those_of_its_principal_moments) {
    uint64_t seed = 23;
    int seen[3] = {0};
    for (int i = 0; i < 1000; i++) {
        rbd_body b[NB];
        rbd_report report;
        double R[9], moment[3];
        sound(b);
        random_rotation(&seed, R);
        for (int k = 0; k < 3; k++) moment[k] = uniform(&seed, k == 0 ? -0.5 : 0.1, 1);
        const double least = fmin(moment[0], fmin(moment[1], moment[2]));
        const double most = fmax(moment[0], fmax(moment[1], moment[2]));
        const double beyond = 2 * most - moment[0] - moment[1] - moment[2];
        const int expected = least < 0    ? RBD_WARN_INERTIA_NEGATIVE
                             : beyond > 0 ? RBD_WARN_INERTIA_TRIANGLE
                                          : RBD_OK;
        if (fabs(least) < 1e-6 || fabs(beyond) < 1e-6) continue;
        turn_moments(R, moment, b[1].inertia);
        ck_assert_int_eq(build(b, NB, &report), RBD_OK);
        ck_assert_msg(report.warnings == (expected != RBD_OK), "%g %g %g: %d warnings", moment[0], moment[1],
                      moment[2], report.warnings);
        if (expected != RBD_OK) ck_assert_int_eq(report.warning[0].status, expected);
        seen[expected]++;
    }
    for (int k = 0; k < 3; k++) ck_assert_int_gt(seen[k], 100);
}
END_TEST

/* A rod, a disc, a thin plate lie on the border; rounding of their figures is no fault. */
START_TEST(borderline_inertias_are_not_warned_of) {
    const double shapes[3][6] = {{1, 0, 0, 1, 0, 0},                       /* rod */
                                 {1, 0, 0, 1, 0, 2},                       /* disc */
                                 {0.7, 0, 0, 0.1, 0, 0.7999999999999999}}; /* plate, rounded */
    for (int i = 0; i < 3; i++) {
        rbd_body b[NB];
        rbd_report report;
        sound(b);
        memcpy(b[1].inertia, shapes[i], sizeof shapes[i]);
        ck_assert_int_eq(build(b, NB, &report), RBD_OK);
        ck_assert_msg(report.warnings == 0, "shape %d: %s", i, rbd_status_string(report.warning[0].status));
    }
}
END_TEST

START_TEST(reference_models_have_no_error) {
    for (int i = 0; i < reference_count; i++) {
        rbd_report report;
        const ref_model *m = reference_model(i);
        ck_assert_msg(build(m->bodies, m->nb, &report) == RBD_OK, "%s", m->name);
    }
}
END_TEST

START_TEST(warnings_are_counted_beyond_what_is_kept) {
    rbd_body b[20];
    rbd_report report;
    memset(b, 0, sizeof b);
    for (int i = 0; i < 20; i++) {
        b[i].parent = i - 1;
        b[i].type = RBD_REVOLUTE;
        b[i].axis[i % 3] = 1;
        b[i].position[0] = 1;
        b[i].mass = 1;
    }
    ck_assert_int_eq(build(b, 20, &report), RBD_OK);
    ck_assert_int_eq(report.warnings, 20);
    for (int i = 0; i < RBD_MAX_WARNINGS; i++) {
        ck_assert_int_eq(report.warning[i].status, RBD_WARN_INERTIA_ZERO);
        ck_assert_int_eq(report.warning[i].body, i);
        ck_assert_ptr_null(report.warning[i].name);
    }
}
END_TEST

/* ---- arguments and memory ---- */

START_TEST(null_arguments_are_refused) {
    static unsigned char memory[RBD_MODEL_SIZE(NB)];
    const rbd_model *m;
    rbd_body b[NB];
    sound(b);
    ck_assert_int_eq(rbd_model_build(NULL, NB, memory, sizeof memory, &m, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_model_build(b, NB, NULL, sizeof memory, &m, NULL), RBD_ERR_NULL);
    ck_assert_int_eq(rbd_model_build(b, NB, memory, sizeof memory, NULL, NULL), RBD_ERR_NULL);
}
END_TEST

/* Whatever stood in the pointer before: a model that was refused is not there. */
START_TEST(model_is_null_after_an_error) {
    static unsigned char memory[RBD_MODEL_SIZE(NB)];
    const rbd_model *const before = (const rbd_model *)(const void *)memory;
    const rbd_model *m = before;
    rbd_body b[NB];
    sound(b);
    ck_assert_int_eq(rbd_model_build(NULL, NB, memory, sizeof memory, &m, NULL), RBD_ERR_NULL);
    ck_assert_ptr_null(m);
    m = before;
    ck_assert_int_eq(rbd_model_build(b, NB, NULL, sizeof memory, &m, NULL), RBD_ERR_NULL);
    ck_assert_ptr_null(m);
    m = before;
    ck_assert_int_eq(rbd_model_build(b, 0, memory, sizeof memory, &m, NULL), RBD_ERR_COUNT);
    ck_assert_ptr_null(m);
    m = before;
    ck_assert_int_eq(rbd_model_build(b, NB, memory, 100, &m, NULL), RBD_ERR_MEMORY);
    ck_assert_ptr_null(m);
    m = before;
    b[3].mass = -1;
    ck_assert_int_eq(rbd_model_build(b, NB, memory, sizeof memory, &m, NULL), RBD_ERR_MASS);
    ck_assert_ptr_null(m);
    m = before;
    weigh_nothing(&b[3]);
    ck_assert_int_eq(rbd_model_build(b, NB, memory, sizeof memory, &m, NULL), RBD_ERR_LEAF);
    ck_assert_ptr_null(m);
}
END_TEST

/* Nothing is checked but the count: an unknown joint type counts as fixed. */
START_TEST(size_of_a_wrong_description_is_a_figure_too) {
    rbd_body b[NB];
    sound(b);
    ck_assert_uint_eq(rbd_model_size(NULL, NB), 0);
    b[3].type = RBD_FIXED;
    const size_t size = rbd_model_size(b, NB);
    b[3].type = RBD_JOINT_TYPES;
    ck_assert_uint_eq(rbd_model_size(b, NB), size);
    b[3].type = (rbd_joint_type)1000000;
    ck_assert_uint_eq(rbd_model_size(b, NB), size);
}
END_TEST

START_TEST(body_count_out_of_range_is_refused) {
    rbd_body b[NB];
    rbd_report report;
    const int counts[4] = {0, -1, RBD_MAX_BODIES + 1, 2147483647};
    sound(b);
    for (int i = 0; i < 4; i++) {
        ck_assert_int_eq(build(b, counts[i], &report), RBD_ERR_COUNT);
        ck_assert_int_eq(report.error.status, RBD_ERR_COUNT);
        ck_assert_int_eq(report.error.body, -1);
        ck_assert_uint_eq(rbd_model_size(b, counts[i]), 0);
    }
}
END_TEST

START_TEST(memory_one_byte_too_small_is_refused) {
    for (int i = 0; i < reference_count; i++) {
        const ref_model *model = reference_model(i);
        const rbd_model *m;
        const size_t size = rbd_model_size(model->bodies, model->nb);
        ck_assert_uint_gt(size, 0);
        ck_assert_msg(size <= RBD_MODEL_SIZE((size_t)model->nb), "%s", model->name);
        unsigned char *memory = malloc(size); /* exact, so that a sanitizer sees the byte beyond */
        ck_assert_int_eq(rbd_model_build(model->bodies, model->nb, memory, size - 1, &m, NULL),
                         RBD_ERR_MEMORY);
        ck_assert_int_eq(rbd_model_build(model->bodies, model->nb, memory, 0, &m, NULL), RBD_ERR_MEMORY);
        ck_assert_int_eq(rbd_model_build(model->bodies, model->nb, memory, size, &m, NULL), RBD_OK);
        free(memory);
    }
}
END_TEST

/* Memory of any alignment; the model lies inside; nothing is written outside. */
START_TEST(memory_of_any_alignment_suffices) {
    const ref_model *model = reference_model(1);
    const size_t size = rbd_model_size(model->bodies, model->nb);
    unsigned char *memory = malloc(size + 64);
    for (size_t shift = 0; shift < 32; shift++) {
        const rbd_model *m;
        memset(memory, 0xa5, size + 64);
        ck_assert_int_eq(rbd_model_build(model->bodies, model->nb, memory + shift, size, &m, NULL), RBD_OK);
        ck_assert((const unsigned char *)m >= memory + shift);
        ck_assert((const unsigned char *)m < memory + shift + size);
        ck_assert_int_eq(rbd_nv(m), model->nv);
        for (size_t i = 0; i < size + 64; i++)
            if (i < shift || i >= shift + size)
                ck_assert_msg(memory[i] == 0xa5, "byte %d is written", (int)i);
    }
    free(memory);
}
END_TEST

START_TEST(largest_model_is_built) {
    rbd_body *b = calloc(RBD_MAX_BODIES, sizeof *b);
    for (int i = 0; i < RBD_MAX_BODIES; i++) {
        b[i].parent = i - 1;
        b[i].type = i % 7 == 0 ? RBD_FLOATING : RBD_REVOLUTE;
        b[i].axis[i % 3] = 1;
        b[i].position[0] = 0.001;
        b[i].mass = 1;
        b[i].inertia[0] = b[i].inertia[3] = b[i].inertia[5] = 1;
    }
    const size_t size = rbd_model_size(b, RBD_MAX_BODIES);
    void *memory = malloc(size);
    const rbd_model *m;
    ck_assert_uint_le(size, RBD_MODEL_SIZE(RBD_MAX_BODIES));
    ck_assert_int_eq(rbd_model_build(b, RBD_MAX_BODIES, memory, size, &m, NULL), RBD_OK);
    ck_assert_int_eq(rbd_nb(m), RBD_MAX_BODIES);
    free(memory);
    free(b);
}
END_TEST

/* No index for what has no coordinate: neither the next joint's nor, at the end, one out of range. */
START_TEST(fixed_and_mimic_joints_have_no_place) {
    rbd_body b[NB];
    sound(b);
    follow(&b[3], "elbow");
    robot r = BUILD(b);
    const int place[NB][2] = {{0, 0}, {7, 6}, {-1, -1}, {-1, -1}};
    for (int i = 0; i < NB; i++) {
        rbd_joint_info info;
        ck_assert_int_eq(rbd_joint(r.m, i, &info), RBD_OK);
        ck_assert_int_eq(info.type, b[i].type);
        ck_assert_int_eq(info.iq, place[i][0]);
        ck_assert_int_eq(info.iv, place[i][1]);
        ck_assert_int_eq(info.nq > 0, place[i][0] >= 0);
        ck_assert_int_eq(info.nv > 0, place[i][1] >= 0);
    }
    robot_free(&r);
}
END_TEST

/* In the solver's order the largest subtree follows its parent, so that most links have theirs before
   them. */
START_TEST(largest_subtree_comes_first) {
    static const int parents[5] = {-1, 0, 0, 2, 0}, order[5] = {0, 2, 3, 1, 4};
    rbd_body b[5];
    memset(b, 0, sizeof b);
    for (int i = 0; i < 5; i++) {
        b[i].parent = parents[i];
        b[i].type = RBD_REVOLUTE;
        b[i].axis[i % 3] = 1;
        b[i].position[1] = 0.1 * (i + 1);
        b[i].mass = 1;
        b[i].inertia[0] = b[i].inertia[3] = b[i].inertia[5] = 1;
    }
    robot r = BUILD(b);
    for (int i = 0; i < 5; i++) ck_assert_int_eq(r.m->order[i].dof, order[i]);
    robot_free(&r);
}
END_TEST

/* Only the strings must outlive the build. */
START_TEST(description_may_go_after_the_build) {
    rbd_body b[NB];
    static unsigned char memory[RBD_MODEL_SIZE(NB)], before[sizeof memory];
    const rbd_model *m;
    sound(b);
    ck_assert_int_eq(rbd_model_build(b, NB, memory, sizeof memory, &m, NULL), RBD_OK);
    memcpy(before, memory, sizeof memory);
    memset(b, 0x77, sizeof b);
    ck_assert_int_eq(memcmp(before, memory, sizeof memory), 0);
    ck_assert_int_eq(rbd_body_index(m, "screw"), 3);
}
END_TEST

Suite *build_suite(void) {
    Suite *suite = suite_create("build");
    TCase *c = tcase_create("build");
    tcase_add_test(c, sound_description_is_built_without_finding);
    tcase_add_test(c, names_standing_twice_are_refused);
    tcase_add_test(c, nameless_bodies_are_welcome);
    tcase_add_test(c, wrong_parents_are_refused);
    tcase_add_test(c, unknown_joint_types_are_refused);
    tcase_add_test(c, fixed_joints_with_an_axis_are_refused);
    tcase_add_test(c, sentences_tell_causes_apart);
    tcase_add_test(c, zero_and_nonfinite_axes_are_refused);
    tcase_add_test(c, second_axes_zero_parallel_or_nonfinite_are_refused);
    tcase_add_test(c, axes_of_a_universal_joint_are_parallel_below_a_millionth);
    tcase_add_test(c, matrices_that_rotate_to_six_decimals_are_welcome);
    tcase_add_test(c, axes_of_any_length_are_welcome);
    tcase_add_test(c, nonfinite_pitch_and_position_are_refused);
    tcase_add_test(c, matrices_that_do_not_rotate_are_refused);
    tcase_add_test(c, negative_and_nonfinite_masses_are_refused);
    tcase_add_test(c, nonfinite_com_and_inertia_are_refused);
    tcase_add_test(c, movable_leaf_without_mass_is_refused);
    tcase_add_test(c, armature_beyond_the_joint_s_freedom_is_no_inertia);
    tcase_add_test(c, leaf_with_fixed_mass_or_armature_is_welcome);
    tcase_add_test(c, leaf_that_moves_inertia_elsewhere_is_welcome);
    tcase_add_test(c, leaf_with_two_massless_bodies_fixed_to_it_is_refused);
    tcase_add_test(c, negative_and_nonfinite_joint_constants_are_refused);
    tcase_add_test(c, nonfinite_limits_and_negative_maxima_are_refused);
    tcase_add_test(c, wrong_mimic_joints_are_refused);
    tcase_add_test(c, joint_may_follow_a_later_one);
    tcase_add_test(c, impossible_inertias_are_warned_of);
    tcase_add_test(c, moments_that_rounding_made_negative_are_not_warned_of);
    tcase_add_test(c, limits_that_mean_none_are_warned_of);
    tcase_add_test(c, limits_of_followers_that_contradict_are_warned_of);
    tcase_add_test(c, limits_that_are_some_or_none_are_not_warned_of);
    tcase_add_test(c, warnings_of_inertia_are_those_of_its_principal_moments);
    tcase_add_test(c, borderline_inertias_are_not_warned_of);
    tcase_add_test(c, reference_models_have_no_error);
    tcase_add_test(c, warnings_are_counted_beyond_what_is_kept);
    tcase_add_test(c, null_arguments_are_refused);
    tcase_add_test(c, model_is_null_after_an_error);
    tcase_add_test(c, size_of_a_wrong_description_is_a_figure_too);
    tcase_add_test(c, body_count_out_of_range_is_refused);
    tcase_add_test(c, memory_one_byte_too_small_is_refused);
    tcase_add_test(c, memory_of_any_alignment_suffices);
    tcase_add_test(c, largest_model_is_built);
    tcase_add_test(c, fixed_and_mimic_joints_have_no_place);
    tcase_add_test(c, largest_subtree_comes_first);
    tcase_add_test(c, description_may_go_after_the_build);
    suite_add_tcase(suite, c);
    return suite;
}
