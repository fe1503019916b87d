// SPDX-License-Identifier: MIT
#include "study/results/model.hpp"

#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/words.hpp"

namespace tactor::study {

std::string quote(const std::string& text)
{
    return nlohmann::json(text).dump(); // a JSON string is also a string in R
}

std::string list_factors(const run_outline& run, const model_factors& f)
{
    std::vector<std::string> all;
    if (f.group)
        all.emplace_back("group");
    if (run.motions.size() > 1)
        all.emplace_back("motion");
    if (f.session)
        all.emplace_back(session_factor);
    const std::string term = all.empty() ? "1" : fmt::format("{}", fmt::join(all, " * "));
    return all.size() > 1 ? "(" + term + ")" : term;
}

std::string format_value_term(const run_outline& run)
{
    if (run.vary.empty())
        return {};
    const double at = run.standard.value_or(0.5 * (run.values.front() + run.values.back()));
    return fmt::format("I(value {} {})", at < 0.0 ? '+' : '-', plain_number(std::abs(at), 12));
}

std::string format_model_call(const run_outline& run, const model_factors& f, const r_model& m)
{
    const bool has_method = m.by_method && run.methods.size() > 1;
    std::vector<std::string> factors;
    if (!m.slope.empty())
        factors.push_back(m.slope);
    std::vector<std::string> people{"1"};
    people.insert(people.end(), factors.begin(), factors.end());
    if (has_method || run.motions.size() > 1)
        people.emplace_back(has_method ? "method" : "motion");
    if (f.session)
        people.emplace_back(session_factor);
    if (has_method)
        factors.emplace_back("method");
    if (const std::string others = list_factors(run, f); others != "1" || factors.empty())
        factors.push_back(others);
    return fmt::format("{} ~ {} + {}({} | participant), {}data = subset(d, run == {}))", m.response,
                       fmt::join(factors, " * "), m.first, fmt::join(people, " + "), m.family,
                       quote(run.name));
}

std::string format_signal_call(const run_outline& run, const model_factors& f)
{
    std::vector<std::string> factors;
    std::string data = fmt::format("subset(d, run == {})", quote(run.name));
    if (run.methods.size() > 1) {
        factors.emplace_back("method");
        // The level "none" would make one coefficient too many. Any method will do, because signal is 0.
        data = fmt::format("transform({}, method = replace(method, signal == 0, {}))", data,
                           quote(run.methods.front()));
    }
    if (run.motions.size() > 1)
        factors.emplace_back("motion");
    const std::string slope = factors.empty() ? "" : " + signal:" + factors.front();
    const std::string people = list_factors({}, f);
    if (people != "1")
        factors.push_back(people);
    const std::string felt = fmt::format("{}", fmt::join(factors, " * "));
    return fmt::format("glmer(positive ~ {}signal{} + (1 + signal{}{} | participant), {}data = {})",
                       people == "1" ? "" : people + " + ",
                       felt.empty()         ? ""
                       : factors.size() > 1 ? " + signal:(" + felt + ")"
                                            : " + signal:" + felt,
                       slope, f.session ? fmt::format(" + {}", session_factor) : "", probit, data);
}

} // namespace tactor::study
