// algebra.hpp - the little that adapters need to convert states; 3 x 3 matrices are row-major.
// SPDX-License-Identifier: MIT
#ifndef PEERS_ALGEBRA_HPP
#define PEERS_ALGEBRA_HPP

#include <cmath>

struct vec3 {
    double x, y, z;
};

struct mat3 {
    double m[9];
};

inline vec3 get(const double *p) { return {p[0], p[1], p[2]}; }
inline void put(double *p, vec3 v) { p[0] = v.x, p[1] = v.y, p[2] = v.z; }
inline vec3 operator+(vec3 a, vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline vec3 operator-(vec3 a, vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline vec3 cross(vec3 a, vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline vec3 operator*(const mat3 &A, vec3 v) {
    const double *m = A.m;
    return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
            m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

inline mat3 transpose(const mat3 &A) {
    const double *m = A.m;
    return {{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}};
}

// The rotation of a quaternion (x, y, z, w) of any length but 0.
inline mat3 rotation_of(const double q[4]) {
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double x = q[0] / n, y = q[1] / n, z = q[2] / n, w = q[3] / n;
    return {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w),
             1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w),
             1 - 2 * (x * x + y * y)}};
}

// A rotation of rbd_body, where all 0 is the identity.
inline mat3 rotation_given(const double r[9]) {
    mat3 R = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (int i = 0; i < 9; i++)
        if (r[i] != 0) {
            for (int k = 0; k < 9; k++) R.m[k] = r[k];
            break;
        }
    return R;
}

// Principal moments of a symmetric matrix, and their axes as the columns of a rotation (Jacobi's method).
inline void principal(const double I[6], double moments[3], mat3 *axes) {
    double A[3][3] = {{I[0], I[1], I[2]}, {I[1], I[3], I[4]}, {I[2], I[4], I[5]}};
    mat3 V = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (int sweep = 0; sweep < 30; sweep++)
        for (int p = 0; p < 2; p++)
            for (int q = p + 1; q < 3; q++) {
                if (A[p][q] == 0) continue;
                const double theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
                const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; k++) { // columns
                    const double x = A[k][p], y = A[k][q], v = V.m[3 * k + p], w = V.m[3 * k + q];
                    A[k][p] = c * x - s * y, A[k][q] = s * x + c * y;
                    V.m[3 * k + p] = c * v - s * w, V.m[3 * k + q] = s * v + c * w;
                }
                for (int k = 0; k < 3; k++) { // rows
                    const double x = A[p][k], y = A[q][k];
                    A[p][k] = c * x - s * y, A[q][k] = s * x + c * y;
                }
                A[p][q] = A[q][p] = 0;
            }
    for (int k = 0; k < 3; k++) moments[k] = A[k][k];
    *axes = V;
}

#endif
