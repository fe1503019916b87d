// SPDX-License-Identifier: MIT
/// \file
/// Counts the heap calls of one thread: link count_allocations.cpp into the test. Not with sanitizers.
#pragma once

#include <cstdint>

#include <doctest/doctest.h>

/// A test case that counts; skipped, with a message, where that is impossible.
#define COUNTING_TEST_CASE(name) TEST_CASE(name* doctest::skip(!tactor::test::can_count(name)))

/// A test case that leaves the process without descriptors.
#define EXHAUSTING_TEST_CASE(name) TEST_CASE(name* doctest::skip(!tactor::test::can_exhaust(name)))

namespace tactor::test {

/// Returns false under sanitizers, where this program cannot count.
bool counts_allocations() noexcept;

/// Returns the same; prints "SKIPPED" for the test case if allocations are not counted.
bool can_count(const char* test_case) noexcept;
bool can_exhaust(const char* test_case) noexcept;

/// Grants this thread so many heap calls, and then refuses so many; 0 refusals: grants all. Without effect
/// under sanitizers.
void refuse_allocations(std::uint64_t granted, std::uint64_t refused) noexcept;

/// Counts malloc, calloc, realloc, free and the like of the calling thread while it lives.
class count_allocations {
public:
    count_allocations() noexcept;
    ~count_allocations();
    count_allocations(const count_allocations&) = delete;
    count_allocations& operator=(const count_allocations&) = delete;

    std::uint64_t calls() const noexcept;
    /// Bytes asked for and not given back.
    std::int64_t bytes() const noexcept;
};

} // namespace tactor::test
