// SPDX-License-Identifier: MIT
#include "files/stroke/choices.hpp"

#include <fmt/format.h>

namespace tactor::detail {
namespace {

constexpr double longest_soa_s = 10.0;
constexpr double shortest_burst_s = 0.0001;
constexpr bounds levels_db{-120.0, 60.0};

} // namespace

stroke chosen(const toml_table& t, stroke s)
{
    s.choices.algorithm = t.kind<algorithm_kind>("algorithm");
    s.choices.phantom = t.kind<phantom_kind>("phantom");
    s.choices.faces = t.kind<faces_kind>("faces");
    s.choices.soa_s = t.number("soa_s", {0.0, longest_soa_s, true});
    s.choices.burst_s = t.number("burst_s", {shortest_burst_s, longest_soa_s});
    if (s.choices.soa_s && s.choices.burst_s && *s.choices.burst_s > *s.choices.soa_s)
        t.fail("burst_s",
               fmt::format("burst_s is {}, longer than soa_s of {}", *s.choices.burst_s, *s.choices.soa_s),
               "bursts must not overlap: at most soa_s");
    for (const char* key : {"burst_s", "soa_s"})
        if (t.has(key))
            s.choices_at = t.where(key);
    s.fit_margin_mm = read_fit(t);
    return s;
}

std::optional<double> read_fit(const toml_table& t)
{
    const bool fit = t.boolean("fit").value_or(false);
    const auto margin = t.number("fit_margin_mm", {0.0, max_mm});
    if (margin && !fit)
        t.fail("fit_margin_mm", "nothing is fitted", "add fit = true, or leave it out");
    if (!fit)
        return {};
    return margin.value_or(0.0);
}

stroke levelled(const toml_table& t, stroke s)
{
    s.choices.level_db += t.number("level_db", levels_db).value_or(0.0);
    return s;
}

} // namespace tactor::detail
