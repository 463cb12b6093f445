#include "host_sim/replay/seal.hpp"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__)
#define FAIRLEAD_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) || \
    __has_feature(thread_sanitizer)
#define FAIRLEAD_SANITIZED 1
#endif
#endif

namespace {

std::atomic<int> seals{0};

void check() noexcept {
    if (seals.load(std::memory_order_relaxed) == 0) return;
    seals = 0;  // what abort() does may allocate
    constexpr char message[] = "fairlead: the heap is sealed, and something allocates\n";
    static_cast<void>(!write(STDERR_FILENO, message, sizeof message - 1));
    std::abort();
}

}  // namespace

#ifdef FAIRLEAD_SANITIZED

extern "C" int __sanitizer_install_malloc_and_free_hooks(  // NOLINT(bugprone-reserved-identifier)
    void (*on_malloc)(const volatile void*, std::size_t), void (*on_free)(const volatile void*));

namespace {
void on_malloc(const volatile void*, std::size_t) { check(); }
void on_free(const volatile void*) {}
const int installed = __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
}  // namespace

#else

// glibc's own names for what is replaced here
extern "C" {
void* __libc_malloc(std::size_t);                 // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t, std::size_t);    // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void*, std::size_t);         // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t, std::size_t);  // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) {
    check();
    return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
    check();
    return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
    check();
    return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
    check();
    return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    check();
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
    check();
    *out = __libc_memalign(alignment, size);
    return *out != nullptr || size == 0 ? 0 : ENOMEM;
}
}

#endif

namespace fairlead::sim {

HeapSeal::HeapSeal() { ++seals; }
HeapSeal::~HeapSeal() {
    if (seals > 0) --seals;
}

}  // namespace fairlead::sim
