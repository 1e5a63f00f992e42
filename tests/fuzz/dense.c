/* dense.c - see dense.h */
#include "dense.h"

#include <math.h>
#include <string.h>

/* ---- small algebra ---- */

static quad dot(const quad *a, const quad *b, int n) {
    quad sum = 0;
    for (int i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

static void cross(const quad a[3], const quad b[3], quad out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void turn(const quad R[9], const quad x[3], quad out[3]) {
    for (int i = 0; i < 3; i++) out[i] = dot(R + 3 * i, x, 3);
}

static quad length(const quad a[3]) { return world_sqrt(dot(a, a, 3)); }

/* ---- rows ---- */

/* A frame of a constraint: columns of R in the world, origin, and the motion of the body's point that is
   there. */
typedef struct place {
    quad R[9], p[3], w[3], v[3], alpha[3], a[3];
    quad path, w_size, v_size, alpha_size, a_size;
} place;

static place place_of(const world *s, int body, const double *rotation, const double *position) {
    static const world_element ground = {.R = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const world_element *e = body < 0 ? &ground : &s->element[s->last[body]];
    const quad x[3] = {position[0], position[1], position[2]};
    quad R[9], arm[3], wr[3], wwr[3], ar[3];
    place out;
    world_rotation(rotation, R);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.R[3 * i + j] = e->R[3 * i] * R[j] + e->R[3 * i + 1] * R[3 + j] + e->R[3 * i + 2] * R[6 + j];
    turn(e->R, x, arm);
    cross(e->w, arm, wr);
    cross(e->w, wr, wwr);
    cross(e->alpha, arm, ar);
    for (int i = 0; i < 3; i++) {
        out.p[i] = e->p[i] + arm[i];
        out.w[i] = e->w[i];
        out.v[i] = e->v[i] + wr[i];
        out.alpha[i] = e->alpha[i];
        out.a[i] = e->a[i] + ar[i] + wwr[i];
    }
    const quad l = length(x);
    out.path = (body < 0 ? 0 : s->p_size[body]) + l;
    out.w_size = e->w_size;
    out.v_size = (body < 0 ? 0 : s->v_size[body]) + e->w_size * l;
    out.alpha_size = e->alpha_size;
    out.a_size = (body < 0 ? 0 : s->a_size[body]) + (e->alpha_size + e->w_size * e->w_size) * l;
    return out;
}

/* The turn of a rotation matrix, by way of the quaternion whose largest component is taken first. */
static void log_rotation(const quad R[9], quad out[3]) {
    const quad trace = R[0] + R[4] + R[8];
    quad u[4], square[4] = {1 + 2 * R[0] - trace, 1 + 2 * R[4] - trace, 1 + 2 * R[8] - trace, 1 + trace};
    int most = 0;
    for (int i = 1; i < 4; i++)
        if (square[i] > square[most]) most = i;
    const quad odd[3] = {R[7] - R[5], R[2] - R[6], R[3] - R[1]};
    for (int i = 0; i < 3; i++)
        u[i] = most == 3 ? odd[i] : i == most ? square[i] : R[3 * i + most] + R[3 * most + i];
    u[3] = most == 3 ? square[3] : odd[most];
    const quad sine = length(u),
               angle = 2 * (quad)atan2l((long double)sine, (long double)fabsl((long double)u[3]));
    for (int i = 0; i < 3; i++) out[i] = sine > 0 ? u[i] / sine * (u[3] < 0 ? -angle : angle) : 0;
}

static void angular_error(const rbd_constraint *k, const quad R[9], quad out[3]) {
    if (k->axes[0] + k->axes[1] + k->axes[2] != 2) {
        log_rotation(R, out);
        return;
    }
    const int free = k->axes[0] == 0 ? 0 : k->axes[1] == 0 ? 1 : 2;
    const quad turned[3] = {R[free], R[3 + free], R[6 + free]};
    quad axis[3] = {0, 0, 0};
    axis[free] = 1;
    cross(axis, turned, out);
}

/* x[0..2] in world axes into components of frame 2. */
static void into(const place *two, const quad x[3], quad out[3]) {
    for (int i = 0; i < 3; i++) out[i] = two->R[i] * x[0] + two->R[3 + i] * x[1] + two->R[6 + i] * x[2];
}

/* Adds sign times the motion (angular; linear) that each dof on the way to a body gives to the origin of
   frame 1; `path` is its distance along the tree. */
static void add_columns(const world *s, int body, const place *one, const place *two, quad path, int sign,
                        quad J[6][WORLD_DOFS], quad size[6][WORLD_DOFS]) {
    for (int i = body < 0 ? -1 : s->last[body]; i >= 0; i = s->element[i].before) {
        const world_element *e = &s->element[i];
        const quad scale = e->ratio < 0 ? -e->ratio : e->ratio;
        for (int k = 0; k < e->dofs; k++) {
            quad arm[3], u[3], z[6];
            for (int j = 0; j < 3; j++) arm[j] = one->p[j] - e->p[j];
            cross(e->turn[k], arm, u);
            for (int j = 0; j < 3; j++) u[j] += e->shift[k][j];
            into(two, e->turn[k], z);
            into(two, u, z + 3);
            const quad w = length(e->turn[k]), l = w * (path - e->path) + length(e->shift[k]);
            for (int j = 0; j < 6; j++) {
                J[j][e->iv + k] += sign * e->ratio * z[j];
                size[j][e->iv + k] += scale * (j < 3 ? w : l);
            }
        }
    }
}

/* All six components of a constraint, to the letter of [conventions]. */
typedef struct all_rows {
    quad J[6][WORLD_DOFS], J_size[6][WORLD_DOFS];
    quad gamma[6], e[6], gamma_size[2], Jv_size[2], e_size[2]; /* sizes: angular, linear */
} all_rows;

static void constraint_rows(const world *s, const rbd_constraint *k, all_rows *out) {
    const place one = place_of(s, k->body1, k->rotation1, k->position1),
                two = place_of(s, k->body2, k->rotation2, k->position2);
    quad x[3], w[3], u[3], spin[3], ws[3], angular[3], linear[3], a[3], b[3], R[9], d[3];
    memset(out, 0, sizeof *out);
    for (int i = 0; i < 3; i++) x[i] = one.p[i] - two.p[i], w[i] = one.w[i] - two.w[i];
    const quad l = length(x);
    add_columns(s, k->body1, &one, &two, one.path, 1, out->J, out->J_size);
    add_columns(s, k->body2, &one, &two, two.path + l, -1, out->J, out->J_size);
    cross(two.w, x, ws);
    for (int i = 0; i < 3; i++) u[i] = one.v[i] - two.v[i] - ws[i];
    cross(two.w, w, spin);
    for (int i = 0; i < 3; i++) angular[i] = one.alpha[i] - two.alpha[i] - spin[i];
    cross(two.w, ws, a);
    cross(two.alpha, x, b);
    cross(two.w, u, d);
    for (int i = 0; i < 3; i++) linear[i] = one.a[i] - two.a[i] - b[i] - a[i] - 2 * d[i];
    into(&two, angular, out->gamma);
    into(&two, linear, out->gamma + 3);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            R[3 * i + j] = 0;
            for (int m = 0; m < 3; m++) R[3 * i + j] += two.R[3 * m + i] * one.R[3 * m + j];
        }
    angular_error(k, R, out->e);
    into(&two, x, out->e + 3);
    /* Of half a turn, or nearly so, either sign is right. */
    out->e_size[0] = length(out->e) > (quad)3.1L ? HUGE_VALL : 4;
    out->e_size[1] = one.path + two.path;
    out->Jv_size[0] = one.w_size + two.w_size;
    out->Jv_size[1] = one.v_size + two.v_size + two.w_size * l;
    out->gamma_size[0] = one.alpha_size + two.alpha_size + two.w_size * out->Jv_size[0];
    out->gamma_size[1] = one.a_size + two.a_size + (two.alpha_size + two.w_size * two.w_size) * l +
                         2 * two.w_size * out->Jv_size[1];
}

void dense_rows_of(const world *s, const rbd_constraint *list, int n, const quad *v, dense_rows *out) {
    static all_rows all;
    int r = 0;
    out->nv = s->nv;
    for (int i = 0; i < n; i++) {
        constraint_rows(s, &list[i], &all);
        for (int j = 0; j < 6; j++) {
            if (!list[i].axes[j]) continue;
            memcpy(out->J[r], all.J[j], sizeof all.J[j]);
            memcpy(out->J_size[r], all.J_size[j], sizeof all.J_size[j]);
            out->gamma[r] = all.gamma[j], out->gamma_size[r] = all.gamma_size[j / 3];
            out->e[r] = all.e[j], out->e_size[r] = all.e_size[j / 3];
            out->Jv[r] = v ? dot(all.J[j], v, s->nv) : 0, out->Jv_size[r] = all.Jv_size[j / 3];
            out->kd[r] = list[i].kd, out->kp[r] = list[i].kp;
            r++;
        }
    }
    out->rows = r;
}

/* Row a of de/dq by those of J, for e = component a of w = log R: a . (z - w x z / 2 + c w x (w x z)). */
static void bend_row(const all_rows *all, const quad w[3], int a, int nv, quad *row) {
    const quad x = dot(w, w, 3), half = world_sqrt(x) / 2,
               c = x < (quad)1e-6L
                       ? 1 / (quad)12 + x / 720 + x * x / 30240
                       : (1 - half * (quad)cosl((long double)half) / (quad)sinl((long double)half)) / x;
    for (int k = 0; k < nv; k++) {
        const quad z[3] = {all->J[0][k], all->J[1][k], all->J[2][k]};
        quad once[3], twice[3];
        cross(w, z, once);
        cross(w, once, twice);
        row[k] = z[a] - once[a] / 2 + c * twice[a];
    }
}

void dense_slopes_of(const world *s, const rbd_constraint *list, int n, dense_rows *out) {
    static all_rows all;
    dense_rows_of(s, list, n, NULL, out);
    for (int i = 0, r = 0; i < n; i++) {
        const int *axes = list[i].axes;
        if (axes[0] + axes[1] + axes[2] == 1) {
            constraint_rows(s, &list[i], &all);
            bend_row(&all, all.e, axes[0] ? 0 : axes[1] ? 1 : 2, s->nv, out->J[r]);
        }
        for (int j = 0; j < 6; j++) r += axes[j];
    }
}

void dense_close(const world *s, rbd_constraint *k) {
    static const double zero[9] = {0};
    const place one = place_of(s, k->body1, k->rotation1, k->position1),
                two = place_of(s, k->body2, zero, zero);
    quad x[3], position[3];
    for (int i = 0; i < 3; i++) x[i] = one.p[i] - two.p[i];
    into(&two, x, position);
    for (int i = 0; i < 3; i++) {
        k->position2[i] = (double)position[i];
        for (int j = 0; j < 3; j++) {
            quad sum = 0;
            for (int m = 0; m < 3; m++) sum += two.R[3 * m + i] * one.R[3 * m + j];
            k->rotation2[3 * i + j] = (double)sum;
        }
    }
}

/* ---- dense matrices ---- */

/* x = L^-1 x, and x = L'^-1 x */
static void forward(const dense *d, quad *x) {
    for (int i = 0; i < d->nv; i++) {
        for (int k = 0; k < i; k++) x[i] -= d->L[i * d->nv + k] * x[k];
        x[i] /= d->L[i * d->nv + i];
    }
}

static void backward(const dense *d, quad *x) {
    for (int i = d->nv - 1; i >= 0; i--) {
        for (int k = i + 1; k < d->nv; k++) x[i] -= d->L[k * d->nv + i] * x[k];
        x[i] /= d->L[i * d->nv + i];
    }
}

static int cholesky(quad *M, int n) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            quad sum = M[i * n + j];
            for (int k = 0; k < j; k++) sum -= M[i * n + k] * M[j * n + k];
            if (i == j && !(sum > 0)) return 0;
            M[i * n + j] = i == j ? world_sqrt(sum) : sum / M[j * n + j];
        }
    return 1;
}

/* Turns two columns of A, and of V, until they are orthogonal; returns whether they were not. */
static int turn_pair(dense *d, int p, int q) {
    const quad a = dot(d->A[p], d->A[p], d->nv), b = dot(d->A[q], d->A[q], d->nv),
               c = dot(d->A[p], d->A[q], d->nv);
    if (!(c * c > (quad)1e-37L * a * b) || !(c * c > (quad)1e-76L)) return 0;
    const quad zeta = (b - a) / (2 * c), size = zeta < 0 ? -zeta : zeta,
               t = (zeta < 0 ? -1 : 1) / (size + world_sqrt(1 + zeta * zeta)),
               cosine = 1 / world_sqrt(1 + t * t), sine = t * cosine;
    for (int i = 0; i < d->nv; i++) {
        const quad x = d->A[p][i], y = d->A[q][i];
        d->A[p][i] = cosine * x - sine * y, d->A[q][i] = sine * x + cosine * y;
    }
    for (int i = 0; i < d->rows; i++) {
        const quad x = d->V[p][i], y = d->V[q][i];
        d->V[p][i] = cosine * x - sine * y, d->V[q][i] = sine * x + cosine * y;
    }
    return 1;
}

static void swap(quad *x, quad *y, int n) {
    for (int i = 0; i < n; i++) {
        const quad z = x[i];
        x[i] = y[i], y[i] = z;
    }
}

/* Singular values by Jacobi's method, one-sided (Hestenes 1958): small ones keep their digits. */
static void singular_values(dense *d) {
    for (int sweep = 0, turned = 1; turned && sweep < 40; sweep++) {
        turned = 0;
        for (int p = 0; p < d->rows; p++)
            for (int q = p + 1; q < d->rows; q++) turned += turn_pair(d, p, q);
    }
    for (int k = 0; k < d->rows; k++) d->sigma[k] = world_sqrt(dot(d->A[k], d->A[k], d->nv));
    for (int k = 0; k < d->rows; k++)
        for (int i = k + 1; i < d->rows; i++)
            if (d->sigma[i] > d->sigma[k]) {
                swap(d->A[i], d->A[k], d->nv);
                swap(d->V[i], d->V[k], d->rows);
                swap(&d->sigma[i], &d->sigma[k], 1);
            }
}

int dense_factor(dense *d, const dense_rows *rows, const quad *M, const quad *M_size, int nv, int scaled) {
    static quad copy[WORLD_DOFS * WORLD_DOFS];
    d->nv = nv, d->rows = rows->rows;
    memcpy(copy, M, sizeof *M * (size_t)(nv * nv));
    d->distance = world_distance(copy, M_size, nv);
    memcpy(d->L, M, sizeof *M * (size_t)(nv * nv));
    if (!cholesky(d->L, nv)) return 0;
    for (int k = 0; k < nv; k++) {
        quad x[WORLD_DOFS] = {0};
        x[k] = 1;
        forward(d, x);
        d->inverse[k] = dot(x, x, nv);
    }
    d->least_share = 1;
    for (int i = 0; i < d->rows; i++) {
        quad size = 0;
        memcpy(d->A[i], rows->J[i], sizeof d->A[i]);
        forward(d, d->A[i]);
        d->scale[i] = world_sqrt(dot(d->A[i], d->A[i], nv));
        for (int k = 0; k < nv; k++) size += rows->J_size[i][k] * rows->J_size[i][k] * d->inverse[k];
        size = world_sqrt(size);
        if (!(d->scale[i] > size * (quad)1e-13L)) {
            d->scale[i] = 1;
            memset(d->A[i], 0, sizeof d->A[i]);
        } else if (d->scale[i] < size * d->least_share) {
            d->least_share = d->scale[i] / size;
        }
        if (!scaled) d->scale[i] = 1;
        for (int k = 0; k < nv; k++) d->A[i][k] /= d->scale[i];
        for (int k = 0; k < d->rows; k++) d->V[i][k] = i == k;
    }
    singular_values(d);
    return 1;
}

int dense_rank(const dense *d, double bound) {
    int rank = 0;
    while (rank < d->rows && d->sigma[rank] > (quad)bound) rank++;
    return rank;
}

void dense_inverse(const dense *d, const quad *f, quad *x) {
    if (x != f) memcpy(x, f, sizeof *x * (size_t)d->nv);
    forward(d, x);
    backward(d, x);
}

quad dense_norm(const dense *d, const quad *x) {
    quad square = 0;
    for (int i = 0; i < d->nv; i++) {
        quad sum = 0;
        for (int k = i; k < d->nv; k++) sum += d->L[k * d->nv + i] * x[k];
        square += sum * sum;
    }
    return world_sqrt(square);
}

/* Takes from lambda what lies in the null vectors of J': those of the scaled rows over their scales, made
   orthonormal twice over. */
static void least_norm(const dense *d, int rank, quad *lambda) {
    static quad N[DENSE_ROWS][DENSE_ROWS];
    for (int k = rank; k < d->rows; k++) {
        for (int i = 0; i < d->rows; i++) N[k][i] = d->V[k][i] / d->scale[i];
        for (int again = 0; again < 2; again++) {
            for (int j = rank; j < k; j++) {
                const quad share = dot(N[j], N[k], d->rows);
                for (int i = 0; i < d->rows; i++) N[k][i] -= share * N[j][i];
            }
            const quad size = world_sqrt(dot(N[k], N[k], d->rows));
            for (int i = 0; i < d->rows; i++) N[k][i] /= size;
        }
    }
    for (int again = 0; again < 2; again++)
        for (int k = rank; k < d->rows; k++) {
            const quad share = dot(N[k], lambda, d->rows);
            for (int i = 0; i < d->rows; i++) lambda[i] -= share * N[k][i];
        }
}

void dense_solve(const dense *d, const dense_rows *rows, int rank, const quad *x0, const quad *b, quad *x,
                 quad *lambda, quad *rest) {
    quad wanted[DENSE_ROWS], y[WORLD_DOFS] = {0};
    for (int i = 0; i < d->rows; i++) {
        wanted[i] = (b[i] - dot(rows->J[i], x0, d->nv)) / d->scale[i];
        rest[i] = -wanted[i];
        lambda[i] = 0;
    }
    for (int k = 0; k < rank; k++) {
        const quad share = dot(d->V[k], wanted, d->rows), by = share / (d->sigma[k] * d->sigma[k]);
        for (int i = 0; i < d->nv; i++) y[i] += d->A[k][i] * by;
        for (int i = 0; i < d->rows; i++) lambda[i] += d->V[k][i] * by, rest[i] += d->V[k][i] * share;
    }
    for (int i = 0; i < d->rows; i++) lambda[i] /= d->scale[i];
    least_norm(d, rank, lambda);
    backward(d, y);
    for (int i = 0; i < d->nv; i++) x[i] = x0[i] + y[i];
}

int dense_depends(const dense *d, int rank, int i) {
    quad share = 0;
    for (int k = rank; k < d->rows; k++) share += d->V[k][i] * d->V[k][i];
    return share > (quad)1e-12L;
}
