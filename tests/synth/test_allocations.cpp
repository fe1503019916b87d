// SPDX-License-Identifier: MIT
#include <span>

#include "count_allocations.hpp"
#include "pieces.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/event_source.hpp"

namespace allocations_test {

using namespace tactor;
using namespace tactor::test;
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

COUNTING_TEST_CASE("rendering allocates nothing")
{
    const score s = busy_score();
    for (const format_kind f : all_formats) {
        renderer r(s, f);
        std::vector<std::byte> out(500 * s.channels() * 4);
        const count_allocations count;
        for (std::size_t n = 1; r.position() < s.frames() + 1000; n = n % 500 + 1)
            r.process(std::span(out).first(n * s.channels() * sample_bytes(f)));
        CHECK(count.calls() == 0);
    }
}

COUNTING_TEST_CASE("walking through a score allocates nothing")
{
    const score s = busy_score();
    synth::event_source source(s);
    std::size_t events = 0;
    const count_allocations count;
    for (; source.peek() != nullptr; source.pop())
        ++events;
    CHECK(count.calls() == 0);
    CHECK(events > 1000);
}

COUNTING_TEST_CASE("a mixer allocates nothing after its construction")
{
    const score s = busy_score();
    synth::event_source source(s);
    synth::mixer m(std::vector<double>(9, 1.0), format_kind::s32, 512);
    std::vector<std::byte> out(96 * 9 * 4);
    const count_allocations count;
    for (std::uint32_t round = 0; round < 400; ++round) {
        while (source.peek() != nullptr && m.available() > 0) {
            synth::drive_event e = *source.peek();
            e.score = round % 7;
            m.add(e);
            source.pop();
        }
        m.process(96, out.data());
        if (round % 50 == 20)
            m.fade_out(round % 7, 100 * (round % 3));
    }
    m.reset();
    CHECK(count.calls() == 0);
}

} // namespace allocations_test
