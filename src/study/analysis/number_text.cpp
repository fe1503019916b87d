// SPDX-License-Identifier: MIT
#include "study/analysis/analysis.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace tactor::study {

std::string value_text(std::optional<double> v, int decimals)
{
    return v ? fmt::format("{:.{}f}", *v, decimals) : "-";
}

std::string p_text(std::optional<double> p)
{
    return !p ? "-" : *p < 0.001 ? "<.001" : fmt::format("{:.3f}", *p);
}

std::string p_clause(std::optional<double> p)
{
    return !p ? "p -" : *p < 0.001 ? "p < 0.001" : fmt::format("p = {:.3f}", *p);
}

std::string interval_text(const std::optional<interval>& i)
{
    return i ? fmt::format("{:.2f} ... {:.2f}", i->first, i->second) : "-";
}

interval possible_values(const run_outline& run)
{
    return run.task == task_kind::rate ? interval{1.0, run.scale} : per_cents;
}

std::string interval_text(const std::optional<interval>& i, const interval& possible)
{
    if (!i)
        return "-";
    return interval_text(interval{std::max(i->first, possible.first), std::min(i->second, possible.second)});
}

std::string t_text(const t_test& t)
{
    return fmt::format("t({:.0f}) = {:.2f}, {}", *t.df, *t.t, p_clause(t.p));
}

std::string effect_text(const effect& e)
{
    std::string text =
        fmt::format("F({:.0f}, {:.0f}) = {:.2f}, {}; eta squared partial {:.3f}, generalised {:.3f}", e.df1,
                    e.df2, *e.f, p_clause(e.p), *e.eta2_partial, *e.eta2_generalised);
    if (e.epsilon_gg)
        text += fmt::format("; Greenhouse-Geisser {:.3f}, {}", *e.epsilon_gg, p_clause(e.p_gg));
    if (e.mauchly_w)
        text += fmt::format("; Mauchly W = {:.3f}, {}", *e.mauchly_w, p_clause(e.mauchly_p));
    return text;
}

} // namespace tactor::study
