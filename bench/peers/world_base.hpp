// world_base.hpp - libraries whose floating base has, linear first, the velocity of its origin in world axes
// and the angular one in its own; accelerations classical. SPDX-License-Identifier: MIT
#ifndef PEERS_WORLD_BASE_HPP
#define PEERS_WORLD_BASE_HPP

#include "tree.hpp"

inline vec3 turned(const double *v) { return cross(get(v), get(v + 3)); } // omega x u

inline void base_to(const mat3 &R, const double *w_u, double *x) {
    put(x, R * get(w_u + 3));
    put(x + 3, get(w_u));
}

inline void base_from(const mat3 &R, const double *x, double *w_u) {
    const vec3 angular = get(x + 3);
    put(w_u + 3, transpose(R) * get(x));
    put(w_u, angular);
}

// Velocity, acceleration and torque of the base, which is body 0.
inline void world_base(const struct state *rbd, double *v, double *a, double *tau) {
    const mat3 R = rotation_of(rbd->q + 3);
    double classical[6];
    put(classical, get(rbd->a));
    put(classical + 3, get(rbd->a + 3) + turned(rbd->v));
    base_to(R, rbd->v, v);
    base_to(R, classical, a);
    base_to(R, rbd->tau, tau);
}

// The order of rbd's degrees of freedom, and the axes of its base.
class world_order {
    const std::vector<int> &place; // the library's place of each of rbd's
    bool floating;
    mat3 R = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};

    void turn_base(double *x, size_t stride) const {
        double its[6], ours[6];
        for (size_t i = 0; i < 6; i++) its[i] = x[i * stride];
        base_from(R, its, ours);
        for (size_t i = 0; i < 6; i++) x[i * stride] = ours[i];
    }

  public:
    world_order(const std::vector<int> &places, bool has_base, const double *q)
        : place(places), floating(has_base) {
        if (floating) R = rotation_of(q + 3);
    }

    void vector(const double *its, double *x) const {
        for (size_t i = 0; i < place.size(); i++) x[i] = its[place[i]];
        if (floating) turn_base(x, 1);
    }

    // Rows of nv, whose columns multiply velocities: a Jacobian's.
    void columns(const double *its, int rows, double *x) const {
        for (int i = 0; i < rows; i++) vector(its + (size_t)i * place.size(), x + (size_t)i * place.size());
    }

    // nv x nv, by velocities from both sides.
    void matrix(const double *its, double *x) const {
        const size_t n = place.size();
        for (size_t i = 0; i < n; i++) vector(its + (size_t)place[i] * n, x + i * n);
        for (size_t j = 0; j < n && floating; j++) turn_base(x + j, n);
    }
};

#endif
