/* kernel.h - one kernel of a generated NAME_code.cuh: compared with generated C in double, and timed in
   each layout. SPDX-License-Identifier: MIT */
#ifndef RBD_BENCH_KERNEL_H
#define RBD_BENCH_KERNEL_H

#include CODE_HEADER

#include "../../tests/larger.h"
#include "device.h"
#include "report.h"
#include "states.h"

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

/* The measurements of all files that were linked, as a list. */
struct measurement {
    const char *algorithm;
    bool (*run)(const options &); /* true if right */
    measurement *next;

    static measurement *&first() {
        static measurement *head = nullptr;
        return head;
    }

    measurement(const char *name, bool (*f)(const options &)) : algorithm(name), run(f), next(first()) {
        first() = this;
    }
};

/* The kernels in blocks of all files that were linked, for those that launch several. */
struct blocks_kernel {
    const char *algorithm;
    void (*run)(int n, const void *const *arguments);
    blocks_kernel *next;

    static blocks_kernel *&first() {
        static blocks_kernel *head = nullptr;
        return head;
    }

    blocks_kernel(const char *name, void (*f)(int, const void *const *))
        : algorithm(name), run(f), next(first()) {
        first() = this;
    }
};

template <class... A, size_t... I>
void launch_with(void (*kernel)(int, A...), int n, const void *const *arguments, std::index_sequence<I...>) {
    launch(kernel, n, static_cast<A>(const_cast<void *>(arguments[I]))...);
}

template <class... A> void launch_with(void (*kernel)(int, A...), int n, const void *const *arguments) {
    launch_with(kernel, n, arguments, std::index_sequence_for<A...>());
}

inline void launch_blocks(const char *algorithm, int n, std::vector<const void *> arguments) {
    const blocks_kernel *k = blocks_kernel::first();
    while (k && std::strcmp(k->algorithm, algorithm)) k = k->next;
    if (!k) {
        std::fprintf(stderr, "no kernel of %s was linked\n", algorithm);
        std::exit(3);
    }
    k->run(n, arguments.data());
}

/* Memory of the device, allocated once and handed out from the start for each measurement. */
class memory_pool {
    char *memory;
    size_t size, used = 0;

    memory_pool() : memory(nullptr), size(std::min(device_memory(), most())) {
        memory = (char *)device_allocate(size);
    }

  public:
    /* The most that it takes. A profiler saves and restores all of it for each of its passes. */
    static size_t &most() {
        static size_t bytes = SIZE_MAX;
        return bytes;
    }

    static memory_pool &get() {
        static memory_pool pool;
        return pool;
    }

    void reset() { used = 0; }
    size_t capacity() const { return size; }

    void *take(size_t bytes) {
        void *at = memory + used;
        used += (bytes + 255) / 256 * 256;
        if (used > size) {
            std::fprintf(stderr, "the device's memory is too small\n");
            std::exit(3);
        }
        return at;
    }
};

/* States are stored in whole blocks of 32. */
inline size_t stored(int n) { return ((size_t)n + 31) / 32 * 32; }

/* Argument `array` of `slices` calls with n states each, each slice in layout L. */
template <class L, class S> RBD_KERNEL fill(int all, S *x, int size, int n, int array, bool floating) {
    const size_t slice = ((size_t)n + 31) / 32 * 32 * (size_t)size;
    RBD_EACH_STATE(i, all) {
        auto state = L::at(x + (size_t)(i / n) * slice, size, n, i % n);
        for (int k = 0; k < size; ++k) state[k] = random_component<S>(array, floating, (uint64_t)i, k);
    }
}

/* `count` states of n, evenly from the first to the last, as rows. */
template <class L, class S> RBD_KERNEL gather(int count, S *x, int size, int n, S *rows) {
    RBD_EACH_STATE(i, count) {
        const int state = count == 1 ? 0 : (int)((uint64_t)i * (uint64_t)(n - 1) / (uint64_t)(count - 1));
        auto from = L::at(x, size, n, state);
        for (int k = 0; k < size; ++k) rows[(size_t)i * (size_t)size + (size_t)k] = from[k];
    }
}

/* Largest difference of two arrays over the largest entry of the second. */
template <class S> double relative_error(const S *x, const double *expected, int size) {
    double largest = 1e-30;
    double error = 0;
    for (int k = 0; k < size; ++k) {
        const double difference = std::fabs((double)x[k] - expected[k]);
        largest = larger(largest, std::fabs(expected[k]));
        error = larger(error, difference);
    }
    return error / largest;
}

/* Calls of kernel(n, arguments...), whose arguments are arrays: const ones to read, others to write, and
   the statuses. In its place may stand a function of the host that launches kernels. */
template <class L, class... A> class kernel_calls {
    enum { COUNT = sizeof...(A) };
    typedef typename std::common_type<
        typename std::remove_const<typename std::remove_pointer<A>::type>::type...>::type real;

    void (*kernel)(int, A...);
    const int *size; /* of each argument; 1 for statuses */
    bool floating, is_kernel;
    void *array[COUNT] = {};

    static constexpr bool is_read[] = {std::is_const<typename std::remove_pointer<A>::type>::value...};
    static constexpr bool is_status[] = {std::is_same<A, int *>::value...};

    template <size_t... I> void call(std::index_sequence<I...>, int n, size_t slice) const {
        if (is_kernel)
            launch(kernel, n, static_cast<A>(array[I]) + slice * stored(n) * (size_t)size[I]...);
        else
            kernel(n, static_cast<A>(array[I]) + slice * stored(n) * (size_t)size[I]...);
    }

    template <class T> std::vector<T> host_rows(int k, int n, int count) const {
        std::vector<T> rows((size_t)count * (size_t)size[k]);
        T *scratch = (T *)device_allocate(rows.size() * sizeof(T));
        launch(gather<L, T>, count, (T *)array[k], size[k], n, scratch);
        device_wait();
        to_host(rows.data(), scratch, rows.size() * sizeof(T));
        device_free(scratch);
        return rows;
    }

    bool statuses_are_zero(int n, int count) const {
        for (int k = 0; k < COUNT; ++k) {
            if (!is_status[k]) continue;
            for (int status : host_rows<int>(k, n, count))
                if (status != 0) return false;
        }
        return true;
    }

  public:
    kernel_calls(void (*f)(int, A...), const int *sizes, bool floating_base, bool of_device = true)
        : kernel(f), size(sizes), floating(floating_base), is_kernel(of_device) {}

    void *argument(int k) const { return array[k]; }

    int bytes_a_state() const {
        int bytes = 0;
        for (int k = 0; k < COUNT; ++k) bytes += size[k] * (is_status[k] ? 4 : (int)sizeof(real));
        return bytes;
    }

    /* Memory and random input for so many calls with n states each. */
    void prepare(int n, int slices) {
        memory_pool::get().reset();
        for (int k = 0; k < COUNT; ++k) {
            array[k] = memory_pool::get().take((size_t)slices * stored(n) * (size_t)size[k] * sizeof(real));
            if (is_read[k]) launch(fill<L, real>, n * slices, (real *)array[k], size[k], n, k, floating);
        }
    }

    /* For a profiler. */
    bool launch_once(int n) {
        prepare(n, 1);
        (*this)(n, 0);
        device_wait();
        return true;
    }

    void operator()(int n, size_t slice) const { call(std::index_sequence_for<A...>(), n, slice); }

    /* Error of up to 1000 of n states, after a call whose output was poisoned; infinity if a status is not
       0. */
    template <class... R> double error(int n, void (*reference)(R...)) const {
        return error_by(n, [&](double *const *x) { apply(reference, x, std::index_sequence_for<R...>()); });
    }

    template <class... R> double error(int n, int (*reference)(R...)) const {
        return error_by(n, [&](double *const *x) { apply(reference, x, std::index_sequence_for<R...>()); });
    }

  private:
    template <class F, size_t... I>
    static void apply(F reference, double *const *x, std::index_sequence<I...>) {
        reference(x[I]...);
    }

    template <class Reference> double error_by(int n, Reference reference) const {
        const int count = n < 1000 ? n : 1000;
        std::vector<real> rows[COUNT];
        std::vector<double> expected[COUNT];
        double *x[COUNT];
        double worst = 0;
        for (int k = 0; k < COUNT; ++k)
            if (!is_read[k]) device_poison(array[k], stored(n) * (size_t)size[k] * sizeof(real));
        (*this)(n, 0);
        device_wait();
        for (int k = 0; k < COUNT; ++k) {
            if (!is_status[k]) rows[k] = host_rows<real>(k, n, count);
            expected[k].resize((size_t)size[k]);
            x[k] = expected[k].data();
        }
        for (int i = 0; i < count; ++i) {
            for (int k = 0; k < COUNT; ++k)
                for (int j = 0; is_read[k] && j < size[k]; ++j)
                    x[k][j] = (double)rows[k][(size_t)i * (size_t)size[k] + (size_t)j];
            reference(x);
            for (int k = 0; k < COUNT; ++k) {
                if (is_read[k] || is_status[k]) continue;
                const double own = relative_error(&rows[k][(size_t)i * (size_t)size[k]], x[k], size[k]);
                worst = larger(worst, own);
            }
        }
        return statuses_are_zero(n, count) ? worst : INFINITY;
    }
};

template <class L, class... A> constexpr bool kernel_calls<L, A...>::is_read[];
template <class L, class... A> constexpr bool kernel_calls<L, A...>::is_status[];

/* So many different states that they do not fit in a level-2 cache, while the memory holds them. */
inline int slices_of(int n, int bytes_a_state) {
    const size_t wanted = (size_t)256 << 20;
    const size_t call = stored(n) * (size_t)bytes_a_state;
    return (int)std::max<size_t>(1, std::min(wanted, memory_pool::get().capacity() / 2) / call);
}

inline bool fits(int n, int bytes_a_state) {
    return stored(n) * (size_t)bytes_a_state + 4096 <= memory_pool::get().capacity();
}

/* Compares and times one kernel in one layout; true if it is right. */
template <class L, class F, class... A>
bool measure(const options &o, const char *algorithm, const char *layout, void (*kernel)(int, A...),
             const int *sizes, bool floating, F reference, double tolerance) {
    enum { ODD = 1003 }; /* the last block is not full */
    if (!o.wants_layout(layout)) return true;
    kernel_calls<L, A...> calls(kernel, sizes, floating);
    if (o.profile) return calls.launch_once(o.most_states);
    calls.prepare(ODD, 1);
    double error = calls.error(ODD, reference);
    bool right = error <= tolerance;
    for (int n = o.least_states; n <= o.most_states && fits(n, calls.bytes_a_state()); n *= 4) {
        const int slices = slices_of(n, calls.bytes_a_state());
        calls.prepare(n, slices);
        const double own = calls.error(n, reference);
        error = larger(error, own);
        right = error <= tolerance;
        const double seconds =
            median_seconds(o.groups, o.least_seconds, [&](int k) { calls(n, (size_t)(k % slices)); });
        print_row("generated", algorithm, layout, n, error, right, seconds, calls.bytes_a_state());
    }
    return right;
}
#endif
