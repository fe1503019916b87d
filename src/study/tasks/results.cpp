// SPDX-License-Identifier: MIT
// The results that most tasks have in common.
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

std::vector<named_value> task::measure(const run_outline& o, const std::vector<trial>& trials, sigmoid) const
{
    return list_cell_values(o, plan_cells(o).value(), trials);
}

compared_person task::compare(const run_outline& o, const std::vector<trial>& trials) const
{
    if (const auto plan = plan_cells(o)) {
        const auto cells = compute_cells(o, *plan, trials);
        return {cells ? std::optional(mean(cells->back())) : std::nullopt};
    }
    return {measure(o, trials, sigmoid::normal).front().value};
}

compared task::test(const run_outline& o, std::span<const compared_person> people, std::string_view) const
{
    std::vector<double> there;
    for (const compared_person& p : people)
        if (p.value)
            there.push_back(*p.value);
    const main_comparison c = name_comparison(o);
    const t_test t = test_mean_quickly(there, c.against.value_or(0.0), c.rounding);
    return {t.p, t.t.value_or(0.0) > 0.0};
}

std::string task::describe(const run_outline& o) const
{
    std::string text = fmt::format("{} ({})", facts_.trial, fmt::join(o.methods, ", "));
    if (o.is_adaptive())
        text += fmt::format("; {} chosen by the answers from {} to {}", o.vary,
                            plain_number(o.values.front()), plain_number(o.values.back()));
    else if (!o.vary.empty())
        text += fmt::format("; {} of {}", o.vary, fmt::join(o.values, ", "));
    if (o.standard)
        text += fmt::format("; standard {}", plain_number(*o.standard));
    return text;
}

std::vector<std::string_view> task::list_columns(const run_outline& o) const
{
    if (plan_cells(o))
        return {};
    std::vector<std::string_view> all{"signal", "positive"};
    if (!o.vary.empty())
        all.emplace_back("value");
    if (o.is_adaptive())
        all.emplace_back("track");
    return all;
}

named_texts task::describe_trial(const trial& t, const run_outline& own, const run_outline&) const
{
    named_texts all{{"method", is_silent(t) ? std::string(catch_name) : own.methods[t.method_1]},
                    {"response", fmt::format("{}", t.response)},
                    {"signal", t.signal ? "1" : "0"},
                    {"positive", t.positive ? "1" : "0"}};
    if (!own.vary.empty() && t.signal)
        all.emplace_back("value", fmt::format("{}", t.value));
    return all;
}

main_comparison make_comparison(std::string_view figure, std::string_view test, std::optional<double> against)
{
    if (!against)
        return {"no standard: nothing to compare with"};
    return {fmt::format("{}, {} against {}", figure, test, *against), against};
}

} // namespace tactor::study
