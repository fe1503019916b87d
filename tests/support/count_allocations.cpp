// SPDX-License-Identifier: MIT
#include "count_allocations.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdio>

#include <malloc.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(realtime_sanitizer)
#define TACTOR_SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TACTOR_SANITIZED 1
#endif

namespace {

// constinit: reading them must not itself allocate.
thread_local constinit bool counting = false;
thread_local constinit std::uint64_t calls_made = 0;
thread_local constinit std::int64_t bytes_held = 0;
thread_local constinit std::uint64_t calls_granted = 0;
thread_local constinit std::uint64_t calls_refused = 0; // after the granted ones

} // namespace

#if !defined(TACTOR_SANITIZED)

// NOLINTBEGIN: glibc's own entry points, which have reserved names.
extern "C" {
void* __libc_malloc(std::size_t n);
void* __libc_calloc(std::size_t n, std::size_t size);
void* __libc_realloc(void* p, std::size_t n);
void* __libc_memalign(std::size_t alignment, std::size_t n);
void __libc_free(void* p);
}
// NOLINTEND

namespace {

bool refused() noexcept
{
    if (calls_refused == 0)
        return false;
    if (calls_granted != 0) {
        --calls_granted;
        return false;
    }
    --calls_refused;
    errno = ENOMEM;
    return true;
}

void* taken(void* p) noexcept
{
    if (counting) {
        ++calls_made;
        bytes_held += p != nullptr ? static_cast<std::int64_t>(malloc_usable_size(p)) : 0;
    }
    return p;
}

void given(void* p) noexcept
{
    if (counting && p != nullptr) {
        ++calls_made;
        bytes_held -= static_cast<std::int64_t>(malloc_usable_size(p));
    }
}

} // namespace

extern "C" {

void* malloc(std::size_t n)
{
    return refused() ? nullptr : taken(__libc_malloc(n));
}

void* calloc(std::size_t n, std::size_t size)
{
    return refused() ? nullptr : taken(__libc_calloc(n, size));
}

void* realloc(void* p, std::size_t n)
{
    if (refused())
        return nullptr;
    given(p);
    return taken(__libc_realloc(p, n));
}

void* memalign(std::size_t alignment, std::size_t n)
{
    return refused() ? nullptr : taken(__libc_memalign(alignment, n));
}

void* aligned_alloc(std::size_t alignment, std::size_t n)
{
    return refused() ? nullptr : taken(__libc_memalign(alignment, n));
}

int posix_memalign(void** p, std::size_t alignment, std::size_t n)
{
    *p = refused() ? nullptr : taken(__libc_memalign(alignment, n));
    return *p != nullptr ? 0 : ENOMEM;
}

void free(void* p)
{
    given(p);
    __libc_free(p);
}

} // extern "C"

#endif

namespace tactor::test {

bool counts_allocations() noexcept
{
#if defined(TACTOR_SANITIZED)
    return false;
#else
    return true;
#endif
}

bool can_count(const char* test_case) noexcept
{
    if (!counts_allocations())
        std::printf("SKIPPED: %s: a sanitizer replaces the allocator\n", test_case);
    return counts_allocations();
}

bool can_exhaust(const char* test_case) noexcept
{
    if (!counts_allocations())
        std::printf("SKIPPED: %s: a sanitizer needs descriptors itself\n", test_case);
    return counts_allocations();
}

void refuse_allocations(std::uint64_t granted, std::uint64_t refused) noexcept
{
    calls_granted = granted;
    calls_refused = refused;
}

count_allocations::count_allocations() noexcept
{
    calls_made = 0;
    bytes_held = 0;
    counting = true;
}

count_allocations::~count_allocations()
{
    counting = false;
}

std::uint64_t count_allocations::calls() const noexcept
{
    return calls_made;
}

std::int64_t count_allocations::bytes() const noexcept
{
    return bytes_held;
}

} // namespace tactor::test
