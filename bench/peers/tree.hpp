// tree.hpp - the part of a description that adapters share: where each body's joint lies in q and v of rbd,
// and what the adapters can have: joints of one degree of freedom and one floating base.
// SPDX-License-Identifier: MIT
#ifndef PEERS_TREE_HPP
#define PEERS_TREE_HPP

#include <cfloat>
#include <cstdint>
#include <cstdio>
#include <vector>
#include "../calls/library.h"
#include "algebra.hpp"

// Before what an adapter gives: all else of it stays within it.
#define PEER __attribute__((visibility("default")))

// A library whose calls take one state of doubles; the rest of it is still to be set.
inline library plain_library(const char *name, const char *version) {
    library l = {};
    l.name = name;
    l.version = version;
    l.scalar = "double";
    l.variant = RUN_TIME;
    l.lanes = l.width = 1;
    l.size = sizeof(double);
    l.epsilon = DBL_EPSILON;
    return l;
}

// The first place for an object of Eigen's in memory that has 64 bytes to spare.
inline void *aligned(void *memory) {
    const std::uintptr_t address = reinterpret_cast<std::uintptr_t>(memory);
    return reinterpret_cast<void *>((address + 63) / 64 * 64);
}

struct tree {
    std::vector<rbd_body> bodies;
    std::vector<int> iq, iv; // per body, -1 = fixed
    bool floating = false;   // body 0, at q[0], v[0]
    int nq = 0, nv = 0;
};

inline bool turns(const rbd_body &b) { return b.type == RBD_REVOLUTE || b.type == RBD_CONTINUOUS; }
inline bool has_one_axis(const rbd_body &b) { return turns(b) || b.type == RBD_PRISMATIC; }

// Whether the base floats freely, its joint frame being the world's.
inline bool is_floating_base(const rbd_body &b, int index) {
    const mat3 R = rotation_given(b.rotation);
    const bool at_world = R.m[0] == 1 && R.m[4] == 1 && R.m[8] == 1 && b.position[0] == 0 &&
                          b.position[1] == 0 && b.position[2] == 0;
    return b.type == RBD_FLOATING && index == 0 && b.parent == -1 && at_world;
}

// Sets t; false, with the reason in text (160 bytes), if a joint is of another kind.
inline bool read_tree(const rbd_body *bodies, int nb, tree *t, char *text) {
    t->bodies.assign(bodies, bodies + nb);
    for (int i = 0; i < nb; i++) {
        const rbd_body &b = bodies[i];
        const bool base = is_floating_base(b, i), axis = has_one_axis(b);
        if (b.mimic || (!base && !axis && b.type != RBD_FIXED)) {
            std::snprintf(text, 160,
                          "this adapter has one-axis joints and a floating base only: body %d '%s'", i,
                          b.name ? b.name : "");
            return false;
        }
        t->iq.push_back(base || axis ? t->nq : -1);
        t->iv.push_back(base || axis ? t->nv : -1);
        t->floating = t->floating || base;
        t->nq += base ? 7 : axis;
        t->nv += base ? 6 : axis;
    }
    return true;
}

#endif
