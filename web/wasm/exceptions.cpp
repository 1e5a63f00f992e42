/* C++ exceptions for WASI, since Debian's libc++abi is built without them. The compiler (-fwasm-exceptions)
   calls these functions; their names and tables are those of the Itanium C++ ABI. For one thread, without
   exception specifications. A throw inside the compiled libc++ still ends the program.
   SPDX-License-Identifier: MIT */
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <typeinfo>

namespace {

/* What stands before each thrown object. */
struct alignas(16) header {
    const std::type_info *type;
    void *(*destructor)(void *); /* on wasm destructors return the object */
    void *caught;                /* the part of the object that the handler asked for */
    header *outer;               /* caught before this one, in a handler that still runs */
    int handlers;                /* that run with it */
    bool thrown_again;           /* the handler has ended by a `throw;` */
};

header *innermost; /* of the caught ones */

header *header_of(void *object) { return static_cast<header *>(object) - 1; }
void *object_of(header *h) { return h + 1; }

/* The virtual functions of libc++abi's type_info, in their order. The last one decides about a catch, and
   moves the pointer to the base that is caught. */
struct handler_type : std::type_info {
    virtual ~handler_type();
    virtual void unused_1() const;
    virtual void unused_2() const;
    virtual bool catches(const std::type_info *thrown, void *&object) const = 0;
};

/* Reads a function's table of handlers. */
struct reader {
    const uint8_t *at;

    uint8_t byte() { return *at++; }
    uint32_t number(int *bits) { /* LEB128 */
        uint32_t x = 0;
        uint8_t b;
        *bits = 0;
        do {
            b = byte();
            x |= uint32_t(b & 0x7f) << *bits;
            *bits += 7;
        } while (b & 0x80);
        return x;
    }
    uint32_t natural() {
        int bits;
        return number(&bits);
    }
    int32_t integer() {
        int bits;
        const uint32_t x = number(&bits);
        if (bits >= 32) return int32_t(x);
        const uint32_t sign = uint32_t(1) << (bits - 1);
        return int32_t((x ^ sign) - sign);
    }
};

const uint8_t omitted = 0xff, absolute = 0;

/* Whether a handler of this type (0: of all) catches the exception. */
bool catches(const handler_type *type, header *h) {
    void *object = object_of(h);
    if (type && !type->catches(h->type, object)) return false;
    h->caught = object;
    return true;
}

/* Number of the first handler behind landing pad `pad` that catches; 0 if only destructors run there. */
int handler(header *h, const uint8_t *table, uint32_t pad) {
    reader r = {table};
    if (r.byte() != omitted) abort(); /* landing pads are numbers here, not addresses */
    const uint8_t encoding = r.byte();
    const uint8_t *types = nullptr; /* ends here: they are counted backwards */
    if (encoding != omitted) {
        const uint32_t distance = r.natural();
        types = r.at + distance;
    }
    r.byte(); /* how addresses are written */
    const uint32_t length = r.natural();
    const uint8_t *actions = r.at + length;
    uint32_t action;
    do {
        r.natural(); /* the pad's own number */
        action = r.natural();
    } while (pad-- > 0);
    if (action == 0) return 0;
    for (r.at = actions + action - 1;;) {
        const int32_t number = r.integer();
        const uint8_t *here = r.at;
        const int32_t next = r.integer();
        if (number < 0 || (number > 0 && encoding != absolute)) abort(); /* an exception specification */
        if (number > 0) {
            const handler_type *type;
            memcpy(&type, types - size_t(number) * sizeof type, sizeof type);
            if (catches(type, h)) return number;
        }
        if (next == 0) return 0;
        r.at = here + next;
    }
}

} // namespace

extern "C" {

/* The compiler fills in the first two before _Unwind_CallPersonality, and reads the third after it. */
struct {
    uint32_t pad;
    const uint8_t *table;
    uint32_t handler;
} __wasm_lpad_context;

int _Unwind_CallPersonality(void *object) {
    __wasm_lpad_context.handler = 0;
    if (__wasm_lpad_context.table)
        __wasm_lpad_context.handler =
            uint32_t(handler(header_of(object), __wasm_lpad_context.table, __wasm_lpad_context.pad));
    return 0;
}

void *__cxa_allocate_exception(size_t size) noexcept {
    header *h = static_cast<header *>(calloc(1, sizeof *h + size));
    if (!h) abort();
    return object_of(h);
}

void __cxa_free_exception(void *object) noexcept { free(header_of(object)); }

[[noreturn]] void __cxa_throw(void *object, std::type_info *type, void *(*destructor)(void *)) {
    header_of(object)->type = type;
    header_of(object)->destructor = destructor;
    __builtin_wasm_throw(0, object);
}

void *__cxa_get_exception_ptr(void *object) noexcept { return header_of(object)->caught; }

void *__cxa_begin_catch(void *object) noexcept {
    header *h = header_of(object);
    if (h->handlers++ == 0) h->outer = innermost, innermost = h;
    h->thrown_again = false;
    return h->caught;
}

void __cxa_end_catch() {
    header *h = innermost;
    if (--h->handlers > 0) return;
    innermost = h->outer;
    if (h->thrown_again) return;
    if (h->destructor) h->destructor(object_of(h));
    free(h);
}

[[noreturn]] void __cxa_rethrow() {
    if (!innermost) abort();
    innermost->thrown_again = true;
    __builtin_wasm_throw(0, object_of(innermost));
}

} // extern "C"

/* libc++abi's, built without exceptions, ends the program if there is no memory. */
void *operator new(size_t size) {
    if (void *memory = malloc(size ? size : 1)) return memory;
    throw std::bad_alloc();
}
