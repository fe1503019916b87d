// SPDX-License-Identifier: MIT
// Counts what this thread takes from the heap. Not under a sanitizer, which has an allocator of its own.
#include <atomic>
#include <cstdlib>

#include <doctest/doctest.h>

#include "pieces.hpp"
#include "synth/event_source.hpp"
#include "synth/mixer.hpp"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define COUNTS_ALLOCATIONS 1

namespace {
thread_local std::size_t taken = 0;
}

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t n)
{
    ++taken;
    return __libc_malloc(n);
}

void* calloc(std::size_t n, std::size_t size)
{
    ++taken;
    return __libc_calloc(n, size);
}

void* realloc(void* p, std::size_t n)
{
    ++taken;
    return __libc_realloc(p, n);
}

void* aligned_alloc(std::size_t alignment, std::size_t n)
{
    ++taken;
    return __libc_memalign(alignment, n);
}
}
#endif

#ifdef COUNTS_ALLOCATIONS

using namespace tactor;
using namespace pieces;

namespace {

score busy_score()
{
    std::mt19937_64 random(31);
    render_options o;
    o.level_dbfs = -40.0;
    return {row(9),
            {{make_random(random, 9, 100, 1.0), {}},
             {make_continuous(9, 0.8), 0.1},
             {make_continuous(9, 0.8), 0.5}},
            o};
}

} // namespace

TEST_CASE("the counter counts")
{
    const std::size_t before = taken;
    std::vector<int> v(100 + before % 2);
    CHECK(taken == before + 1);
}

TEST_CASE("rendering allocates nothing")
{
    const score s = busy_score();
    for (const sample_format f : all_formats) {
        renderer r(s, f);
        std::vector<std::byte> out(500 * s.channels() * 4);
        const std::size_t before = taken;
        for (std::size_t n = 1; r.position() < s.frames() + 1000; n = n % 500 + 1) {
            r.process(n, out.data());
        }
        CHECK(taken == before);
    }
}

TEST_CASE("walking through a score allocates nothing")
{
    const score s = busy_score();
    synth::event_source source(s);
    std::size_t events = 0;
    const std::size_t before = taken;
    for (; source.peek() != nullptr; source.pop()) {
        ++events;
    }
    CHECK(taken == before);
    CHECK(events > 1000);
}

TEST_CASE("a mixer allocates nothing after its construction")
{
    const score s = busy_score();
    synth::event_source source(s);
    synth::mixer m(std::vector<double>(9, 1.0), sample_format::s32, 512);
    std::vector<std::byte> out(96 * 9 * 4);
    const std::size_t before = taken;
    for (std::uint32_t round = 0; round < 400; ++round) {
        while (source.peek() != nullptr && m.room() > 0) {
            synth::drive_event e = *source.peek();
            e.score = round % 7;
            m.add(e);
            source.pop();
        }
        m.process(96, out.data());
        if (round % 50 == 20) {
            m.fade_out(round % 7, 100 * (round % 3));
        }
    }
    m.reset();
    CHECK(taken == before);
}

#endif
