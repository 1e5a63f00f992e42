/* rows_record.h - what rbd.h does to rows, as calls instead of scalars. Included behind rbd.h by record.cpp.
   SPDX-License-Identifier: MIT */

enum { MOST_COLUMNS = 120 /* a set of fours is a word */ };

/* Where a factor stands: the rows of L, and 1/D. */
struct row_factor {
    std::vector<int> row;
    int inverse;
};
static std::unordered_map<const number *, row_factor> factors;

/* The memory of rows while a function is recorded. */
static class row_recorder {
  public:
    bool is_on;

    void begin(function *to, bool on) {
        f = to, is_on = on;
        f->rows = 0;
        now.clear(), numbers.clear(), matrices.clear(), factors.clear();
    }

    /* Places for rows of so many columns, each in whole fours. */
    int take(int rows, int columns) {
        matrices.push_back({f->rows, rows, pitch_of(columns)});
        f->rows += rows * pitch_of(columns);
        now.resize(size_t(f->rows), NOWHERE), numbers.resize(size_t(f->rows));
        return matrices.back().at;
    }
    static int fours(int columns) { return (columns + FOUR - 1) / FOUR; }
    static int pitch_of(int columns) { return FOUR * fours(columns); }

    row_call start() { return {0, {}, {}}; }
    void put(row_call *c, int at, number y) {
        const value x = record(y.x);
        if (now[size_t(at)] == x) return;
        c->stores.push_back({at, x, now[size_t(at)] != NOWHERE});
        now[size_t(at)] = x, numbers[size_t(at)] = y;
    }
    /* The value at a place after all recorded calls; 0 if none has written it. */
    number load(int at) const { return now[size_t(at)] == NOWHERE ? number(0) : numbers[size_t(at)]; }

    void finish(row_call c) {
        c.node = int(tape->nodes.size());
        for (int at : places_written(c)) {
            const number y = number::of(write(LOADED, at, int(f->calls.size())));
            now[size_t(at)] = record(y.x), numbers[size_t(at)] = y;
        }
        f->calls.push_back(std::move(c));
    }

    /* Rows of a matrix in memory, from one to the next a pitch. */
    struct place {
        int at, rows, pitch;
    };
    /* Where x, with rows a stride apart, stands in whole fours since a call before, or a new place for it. */
    place find(const number *x, ptrdiff_t stride, int rows, int columns) {
        for (int i = 0; i < rows * columns; i++) {
            const value y = record(x[i / columns * stride + i % columns].x);
            const node &n = tape->nodes[size_t(node_of(y))];
            if (n.op != LOADED || now[size_t(n.arg[0])] != y) continue;
            for (const place &m : matrices) {
                const int at = n.arg[0] - i / columns * m.pitch - i % columns, first = at - m.at;
                if (m.rows == rows && first >= 0 && first % FOUR == 0 && first + pitch_of(columns) <= m.pitch)
                    return {at, rows, m.pitch};
            }
            break;
        }
        return {take(rows, columns), rows, pitch_of(columns)};
    }

  private:
    function *f;
    std::vector<value> now;      /* what stands at each place, as recorded; or NOWHERE */
    std::vector<number> numbers; /* the same, as written */
    std::vector<place> matrices;
} recorder;

/* ---- packed matrices, see rbd.h's [packed matrix] ---- */

/* As many sums as registers demand. */
static void add_sum(row_call *c, const row_sum &all) {
    if (all.fours() == 0) c->sums.push_back(all);
    for (int i = 0; all.fours() >> i; i += MOST_FOURS) {
        const auto part = [i](unsigned fours) { return fours >> i & ((1u << MOST_FOURS) - 1); };
        row_sum s = all;
        s.to += FOUR * i, s.from += FOUR * i, s.own = part(s.own);
        s.terms.clear();
        for (row_sum::multiple t : all.terms) {
            t.fours = part(t.fours), t.row += FOUR * i;
            if (t.fours) s.terms.push_back(t);
        }
        if (s.fours()) c->sums.push_back(s);
    }
}
/* The fours of so many columns. */
static unsigned first_fours(int columns) { return (1u << row_recorder::fours(columns)) - 1; }

/* Rows of U = D L, then those of L. */
template <class model, class work> bool rows_factor(const model *m, work *w, number *H) {
    if (!recorder.is_on || m->nv > MOST_COLUMNS) return false;
    row_call c = recorder.start();
    std::vector<int> U;
    row_factor L;
    for (int k = 0; k < m->nv; k++) {
        const int n = m->dof[k].depth + 1;
        U.push_back(recorder.take(1, n));
        for (int t = 0; t < row_recorder::pitch_of(n); t++)
            recorder.put(&c, U.back() + t, t < n ? H[m->dof[k].row + t] : number(0));
    }
    for (int k = 0; k < m->nv; k++) L.row.push_back(recorder.take(1, m->dof[k].depth));
    L.inverse = recorder.take(1, m->nv);
    for (int s = m->nv - 1; s >= 0; s--) {
        const int k = m->node[s].dof, d = m->dof[k].depth;
        const int u = U[size_t(k)];
        row_sum sum = {u, u, NOWHERE, false, first_fours(d + 1), {}};
        for (int t = s + m->node[s].descendants; t > s; t--) {
            const size_t i = size_t(m->node[t].dof);
            sum.terms.push_back({L.row[i] + d, U[i], first_fours(d + 1)});
        }
        if (!sum.terms.empty()) add_sum(&c, sum);
        add_sum(&c, {L.inverse + k, u + d, NOWHERE, false, 0, {}});
        if (d > 0) add_sum(&c, {L.row[size_t(k)], u, L.inverse + k, false, first_fours(d), {}});
    }
    recorder.finish(c);
    for (int k = 0; k < m->nv; k++) {
        const int d = m->dof[k].depth;
        w->pivot[k] = recorder.load(U[size_t(k)] + d);
        for (int t = 0; t < d; t++) H[m->dof[k].row + t] = recorder.load(L.row[size_t(k)] + t);
        H[m->dof[k].row + d] = recorder.load(L.inverse + k);
    }
    factors[H] = L;
    return true;
}

/* Of the matrix at X: sums up the tree, then down. filled: fours of each row that are not all zeros. */
static void add_solution(row_call *c, const rbd_model *m, const row_factor &L, int sign,
                         row_recorder::place X, std::vector<unsigned> filled) {
    const auto row = [&](int k) { return X.at + k * X.pitch; };
    const auto add = [&](int k, const row_sum &sum) {
        if (sum.fours() && (!sum.terms.empty() || sum.scale != NOWHERE)) add_sum(c, sum);
        filled[size_t(k)] = sum.fours();
    };
    for (int s = m->nv - 1; s >= 0; s--) {
        const int k = m->node[s].dof;
        row_sum sum = {row(k), row(k), NOWHERE, false, filled[size_t(k)], {}};
        for (int t = s + m->node[s].descendants; t > s; t--) {
            const int i = m->node[t].dof;
            if (filled[size_t(i)])
                sum.terms.push_back({L.row[size_t(i)] + m->dof[k].depth, row(i), filled[size_t(i)]});
        }
        add(k, sum);
    }
    for (int s = 0; s < m->nv; s++) {
        const int k = m->node[s].dof;
        row_sum sum = {row(k), row(k), L.inverse + k, sign < 0, filled[size_t(k)], {}};
        for (int i = m->dof[k].lambda; i >= 0; i = m->dof[i].lambda)
            if (filled[size_t(i)])
                sum.terms.insert(sum.terms.begin(),
                                 {L.row[size_t(k)] + m->dof[i].depth, row(i), filled[size_t(i)]});
        add(k, sum);
    }
}

/* X = sign M^-1 X, n columns. */
static void solve_rows(const rbd_model *m, const row_factor &L, int sign, ptrdiff_t stride, int n,
                       number *X) {
    row_call c = recorder.start();
    const row_recorder::place Y = recorder.find(X, stride, m->nv, n);
    std::vector<unsigned> filled(size_t(m->nv), 0);
    for (int k = 0; k < m->nv; k++) {
        const auto x = [&](int j) { return j < n ? X[k * stride + j] : number(0); };
        for (int j = 0; j < n; j++)
            if (record(x(j).x) != tape->constant(0)) filled[size_t(k)] |= 1u << j / FOUR;
        for (int j = 0; j < row_recorder::pitch_of(n); j++)
            if (filled[size_t(k)] >> j / FOUR & 1) recorder.put(&c, Y.at + k * Y.pitch + j, x(j));
    }
    add_solution(&c, m, L, sign, Y, filled);
    recorder.finish(c);
    for (int k = 0; k < m->nv; k++)
        for (int j = 0; j < n; j++) X[k * stride + j] = recorder.load(Y.at + k * Y.pitch + j);
}

template <class model>
bool rows_solve(const model *m, const number *L, int sign, ptrdiff_t stride, int n, number *X, number *Y) {
    if (!recorder.is_on || !factors.count(L) || n > MOST_COLUMNS) return false;
    solve_rows(m, factors[L], sign, stride, n, X);
    if (Y) solve_rows(m, factors[L], sign, stride, n, Y);
    return true;
}

template <class model> bool rows_invert(const model *m, const number *L, number *Z) {
    if (!recorder.is_on || !factors.count(L)) return false;
    for (int i = 0; i < m->nv * m->nv; i++) Z[i] = number(i % (m->nv + 1) ? 0 : 1);
    solve_rows(m, factors[L], 1, m->nv, m->nv, Z);
    return true;
}
