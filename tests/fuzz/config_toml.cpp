// SPDX-License-Identifier: MIT
// Configuration and array files: what each section says is in its bounds.
#include <cmath>

#include <tactor/setup.hpp>

#include "files/setup_text.hpp"
#include "holds.hpp"
#include "options/resolve.hpp"

using namespace tactor;

namespace {

void check_line(const gpio_line_name& l)
{
    HOLDS(l.name.empty() ? !l.chip.empty() && l.offset.has_value() : !l.offset);
}

void check_setup(const setup& s)
{
    if (s.array)
        fuzz::check_array(*s.array);
    HOLDS(!s.output.rate || (*s.output.rate >= 8000 && *s.output.rate <= 768000));
    HOLDS(!s.output.periods || *s.output.periods >= 2);
    HOLDS(!s.output.period_frames || *s.output.period_frames >= 1);
    HOLDS(!s.output.channels || (*s.output.channels >= 1 && *s.output.channels <= 1024));
    if (s.amplifier) {
        check_line(s.amplifier->line);
        HOLDS(s.amplifier->settle_s >= 0.0 && std::isfinite(s.amplifier->settle_s));
    }
    if (s.sync) {
        HOLDS(s.sync->pulse_s > 0.0 && std::isfinite(s.sync->pulse_s));
        HOLDS(from_string<edge_kind>(to_string(s.sync->edge)) == s.sync->edge);
        for (const auto* l : {&s.sync->out, &s.sync->in})
            if (*l)
                check_line(**l);
    }
    HOLDS(parse_setup(detail::format_settings({.defaults = s.defaults}), "again").defaults == s.defaults);
    HOLDS(parse_setup(detail::format_settings({.texture = s.texture}), "again").texture == s.texture);
    try {
        for (const options::default_value& d : options::read_defaults(s))
            HOLDS((d.row->where & options::in_defaults) != 0);
    } catch (const error& e) {
        HOLDS(e.place().line != 0);
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    check_setup(fuzz::accepted([&] { return parse_setup(fuzz::as_text(data, size), "fuzz.toml"); }));
    return 0;
}
