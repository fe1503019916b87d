// SPDX-License-Identifier: MIT
#include "files/stroke/parts.hpp"

#include <iterator>

#include <fmt/format.h>

#include "core/limits.hpp"

namespace tactor::detail {
namespace {

constexpr unsigned most_repeats = 10'000;

void start(stroke& s, double start_s, start_from_kind from, std::size_t back)
{
    s.start_s = start_s;
    s.anchor = {from, static_cast<unsigned>(back)}; // at most most_strokes
}

/// Places a stroke after the last `back` strokes. Right after the last one it gets no number: that is exact
/// to the frame.
void follow(stroke& s, double wait_s, std::size_t back)
{
    if (wait_s == 0.0 && back == 1) {
        s.start_s.reset();
        s.anchor = {};
    } else {
        start(s, wait_s, start_from_kind::end, back);
    }
}

void check_count(const toml_table& t, std::string_view key, std::size_t strokes)
{
    if (strokes > most_strokes)
        t.fail(key, fmt::format("{} strokes in all", strokes), fmt::format("at most {}", most_strokes));
}

start_from_kind read_from(const toml_table& t)
{
    return t.kind<start_from_kind>("start_from").value_or(start_from_kind::piece);
}

} // namespace

void sequence::place_first(const toml_table& t, stroke& first, double lead_s)
{
    static_cast<void>(read_from(t)); // whatever it is, there is nothing before
    const auto told = t.number("start_s", {0.0, longest_stroke_s});
    const double after_s = told.value_or(0.0) + lead_s;
    if (!whole_piece_)
        all_.lead_s = after_s;
    else if (told || lead_s > 0.0)
        start(first, after_s, start_from_kind::piece, 1);
}

void sequence::place(const toml_table& t, stroke& first, double lead_s) const
{
    const start_from_kind from = read_from(t);
    const auto told =
        t.number("start_s", {from == start_from_kind::piece ? 0.0 : -longest_stroke_s, longest_stroke_s});
    const double after_s = told.value_or(0.0) + lead_s;
    if (told && *told < 0.0)
        first.places.start = t.where("start_s");
    if (from == start_from_kind::end || (!told && !t.has("start_from")))
        follow(first, after_s, before_.size);
    else if (from == start_from_kind::start)
        start(first, after_s - before_.lead_s, from, before_.size);
    else if (whole_piece_)
        start(first, after_s, from, 1);
    else
        start(first, after_s - all_.lead_s, start_from_kind::start, all_.strokes.size());
}

void sequence::add(const toml_table& t, entry e)
{
    check_count(t, "stroke", all_.strokes.size() + e.strokes.size());
    if (all_.strokes.empty())
        place_first(t, e.strokes.front(), e.lead_s);
    else
        place(t, e.strokes.front(), e.lead_s);
    before_ = {e.strokes.size(), e.lead_s};
    all_.strokes.insert(all_.strokes.end(), std::make_move_iterator(e.strokes.begin()),
                        std::make_move_iterator(e.strokes.end()));
}

entry repeated(const toml_table& t, entry e)
{
    const auto times = t.whole("repeat", 1, most_repeats);
    const auto pause = t.number("pause_s", {0.0, longest_stroke_s});
    if (pause && times.value_or(1) == 1)
        t.fail("pause_s", "nothing is repeated",
               "add repeat = 2 or more; pauses = [[part, seconds], ...] is along a path");
    if (times.value_or(1) == 1)
        return e;
    const std::size_t once = e.strokes.size();
    check_count(t, "repeat", once * *times);
    const std::vector<stroke> first = e.strokes;
    for (unsigned pass = 1; pass < *times; ++pass) {
        for (const stroke& s : first)
            e.strokes.push_back(s);
        follow(e.strokes[pass * once], pause.value_or(0.0) + e.lead_s, once);
    }
    for (std::size_t i = 0; i < e.strokes.size(); ++i)
        e.strokes[i].name += fmt::format(" ({} of {})", i / once + 1, *times);
    return e;
}

} // namespace tactor::detail
