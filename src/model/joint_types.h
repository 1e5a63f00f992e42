#ifndef RBDI_MODEL_JOINT_TYPES_H
#define RBDI_MODEL_JOINT_TYPES_H
#include "api/types.h"
#include "base/compiler.h"

/* Interface: rbdi_first_axis, rbdi_has_quaternion, rbdi_is_length, rbdi_type_turns */

/* ---- joint types [joint types] ----
   The differences between joint types. A type is a chain of one-axis links, one for each letter of its axes,
   or, if it has none, a block: a joint with several axes through one point. To add a type:

     always      its name in api/types.h, its q and v in [conventions], its row in rbdi_joint_facts
     a chain     of links that turn or slide needs that row alone. For links of another kind, as screws:
                 model/links.h: rbdi_build_joint
     a block     rbdi_first_axis and rbdi_is_length, below; model/joints.h: rbdi_joint_attitude,
                 rbdi_joint_origin, rbdi_block_pose; model/regroup.h: moments of mass that its motion leaves,
                 and whether it slides; model/lock.h: rbdi_block_motion_at; derivatives/memory.h: whether it
                 only slides
     v is not    rbdi_type_turns, below, if its step is an exponential of a motion in body axes, and
     the rate    rbdi_has_quaternion; else motion/manifold.h: rbdi_step_joint, rbdi_difference_joint,
     of q        rbdi_joint_rates, rbdi_joint_velocity, rbdi_neutral_joint, rbdi_random_joint
     its fields  model/describe.h: rbdi_describe_joint, if a description has fields for it other than axis and
                 axis2

   Floating joints are known in more places, as bases of robots: model/features.h, constraints/weights.h,
   contact/momentum.h, estimate/estimate.h, tasks/contacts.h. model/check.h asks whether a joint is fixed. No
   other room names a type: the test `rooms` compares. */

/* Numbers of coordinates and dofs, and the axes of one-axis links, in order: 'a' axis, 'b' axis2, 'x' 'y' 'z'
   those of the joint frame. A link turns about a small letter, and slides along a capital one. A type without
   axes is a block. */
typedef struct rbdi_joint_fact {
    signed char nq, nv;
    char axes[4];
} rbdi_joint_fact;

RBDI_PART const rbdi_joint_fact *rbdi_joint_facts(int type) {
    static const rbdi_joint_fact facts[RBD_JOINT_TYPES] = {
        {0, 0, ""},    /* fixed */
        {1, 1, "a"},   /* revolute */
        {1, 1, "a"},   /* continuous */
        {2, 1, "a"},   /* continuous_cs */
        {1, 1, "A"},   /* prismatic */
        {1, 1, "a"},   /* helical */
        {2, 2, "aA"},  /* cylindrical */
        {2, 2, "ab"},  /* universal */
        {4, 3, ""},    /* spherical */
        {3, 3, "zyx"}, /* Euler zyx */
        {3, 3, "xyz"}, /* xyz */
        {3, 3, "yxz"}, /* yxz */
        {3, 3, "zxy"}, /* zxy */
        {3, 3, ""},    /* planar */
        {3, 3, ""},    /* translation */
        {7, 6, ""},    /* floating */
    };

    return &facts[type > RBD_FIXED && type < RBD_JOINT_TYPES ? type : RBD_FIXED];
}

/* Whether a letter of rbdi_joint_fact.axes is that of a link that slides; and as a small letter. */
RBDI_INLINE int rbdi_axis_slides(char letter) { return !(letter & ('a' ^ 'A')); }
RBDI_INLINE char rbdi_axis_name(char letter) { return (char)(letter | ('a' ^ 'A')); }

/* The first spatial unit axis, omega_x .. omega_z, v_x .. v_z, of a block's dofs. The others follow it. */
RBDI_INLINE int rbdi_first_axis(int type) {
    if (type == RBD_PLANAR) return 2;
    return type == RBD_TRANSLATION ? 3 : 0;
}

/* Whether v has components of a motion in body axes, and a step is its exponential. Coordinates of other
   joints add up. */
RBDI_INLINE int rbdi_type_turns(int type) {
    return type == RBD_SPHERICAL || type == RBD_PLANAR || type == RBD_FLOATING;
}

/* Whether the last four coordinates are a quaternion. */
RBDI_INLINE int rbdi_has_quaternion(int type) { return type == RBD_SPHERICAL || type == RBD_FLOATING; }

/* Whether coordinate k, which is no part of a quaternion, is a length. Those of a block come first. */
RBDI_PART int rbdi_is_length(int type, int k) {
    const rbdi_joint_fact *fact = rbdi_joint_facts(type);
    if (fact->axes[0]) return rbdi_axis_slides(fact->axes[k]);

    return type == RBD_PLANAR ? k < 2 : type != RBD_SPHERICAL;
}

/* Number of links of a joint: of a chain one for each dof, of a block one. */
RBDI_PART int rbdi_links_of(int type) {
    const rbdi_joint_fact *fact = rbdi_joint_facts(type);
    return fact->axes[0] ? fact->nv : fact->nv > 0;
}

RBDI_PART int rbdi_can_mimic(int type) {
    return type == RBD_REVOLUTE || type == RBD_CONTINUOUS || type == RBD_PRISMATIC || type == RBD_HELICAL;
}

RBDI_PART int rbdi_has_limits(int type) {
    return type == RBD_REVOLUTE || type == RBD_PRISMATIC || type == RBD_HELICAL;
}

#endif
