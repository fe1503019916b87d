// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/split.hpp"
#include "core/words.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

// An age in years. BIDS writes ages from 89 on as "89+", so that nobody can be recognised: those count as the
// least that they are.
struct age_value {
    double years = 0.0;
    bool at_least = false;
};

std::optional<age_value> read_age(const std::string& text)
{
    const bool at_least = text.ends_with('+');
    const auto years =
        detail::number_in<double>(std::string_view(text).substr(0, text.size() - (at_least ? 1 : 0)));
    if (!years || !(*years >= 0.0 && *years < 200.0))
        return {};
    return age_value{*years, at_least};
}

std::string ages_text(const study_facts& f)
{
    std::vector<double> ages;
    std::size_t at_least = 0;
    std::string others;
    std::size_t missing = 0;
    for (const participant& p : f.people) {
        const std::string text = p.age.value_or("");
        if (const auto age = read_age(text)) {
            ages.push_back(age->years);
            at_least += age->at_least ? 1 : 0;
        } else if (text.empty())
            ++missing;
        else
            others += fmt::format("; sub-{}: \"{}\"", p.code, plain(text));
    }
    if (ages.empty())
        return others.empty() ? not_recorded : others.substr(2);
    const t_test t = test_mean(ages, 0.0);
    std::string text = fmt::format("{} years, mean {:.1f}", range_text(ages), *t.mean);
    if (t.se)
        text += fmt::format(", sd {:.1f}", *t.se * std::sqrt(static_cast<double>(ages.size())));
    if (at_least != 0)
        text += fmt::format(" ({} recorded as at least so old, as 89+, and counted as that)", at_least);
    if (ages.size() != f.people.size())
        text += fmt::format(" (of {}{})", ages.size(),
                            missing == 0     ? std::string()
                            : others.empty() ? fmt::format("; the others': {}", not_recorded)
                                             : fmt::format("; of {}: {}", missing, not_recorded));
    return text + others;
}

// Counts the values of a column.
std::string counts_text(const study_facts& f, std::optional<std::string> participant::*column)
{
    std::map<std::string, unsigned> counts;
    for (const participant& p : f.people)
        ++counts[(p.*column) ? plain(*(p.*column)) : not_recorded];
    if (counts.size() == 1 && counts.contains(not_recorded))
        return not_recorded;
    std::string all;
    for (const auto& [value, n] : counts)
        all += fmt::format("{}{} {}", all.empty() ? "" : ", ", n, value);
    return all;
}

// Returns the days on which a session was held, UTC, in order and each once.
std::vector<std::string> session_days(const session_facts& s)
{
    std::set<std::string> days;
    const auto add = [&](const std::string& time) {
        if (!time.empty())
            days.insert(time.substr(0, time.find('T')));
    };
    add(s.facts()["date"].words());
    for (const json_value& one : s.facts()["streams"].list())
        add(one["opened"].words());
    return {days.begin(), days.end()};
}

std::string dates_text(const study_facts& f)
{
    std::vector<std::string> days;
    for (const session_facts& s : f.sessions)
        for (std::string& day : session_days(s))
            days.push_back(std::move(day));
    if (days.empty())
        return not_recorded;
    const auto [first, last] = std::minmax_element(days.begin(), days.end());
    return *first == *last ? plain(*first) : fmt::format("{} to {}", plain(*first), plain(*last));
}

// Names sessions that were broken off and went on on another day.
std::string long_sessions_text(const study_facts& f)
{
    std::string text;
    for (const session_facts& s : f.sessions)
        if (const std::vector<std::string> days = session_days(s); days.size() > 1)
            text += fmt::format("\nThe session of sub-{} was held on {}.\n", s.code, plain_list(days));
    return text;
}

std::string left_out_text(const analysis& a)
{
    std::string text;
    for (const left_out& one : a.excluded)
        text +=
            fmt::format("\nExcluded from all that follows: sub-{} ({}).\n", one.participant, plain(one.why));
    for (const run_analysis& r : a.runs)
        for (const left_out& one : r.missing)
            text += fmt::format("\nLeft out of the run {}: sub-{} ({}).\n", plain(r.run.name),
                                one.participant, plain(one.why));
    return text;
}

} // namespace

std::string participants_section(const study_facts& f, const analysis& a)
{
    std::vector<std::string> codes;
    for (const participant& p : f.people)
        codes.push_back(p.code);
    std::string text = "\n## Participants\n\n";
    text += fmt::format("{}: {}. Age: {}. Sex: {}. Handedness: {}. Dates of the sessions (UTC): {}.\n",
                        counted(codes.size(), "participant"), subjects(codes), ages_text(f),
                        counts_text(f, &participant::sex), counts_text(f, &participant::handedness),
                        dates_text(f));
    for (const std::string& code : codes)
        if (std::none_of(f.sessions.begin(), f.sessions.end(),
                         [&](const session_facts& s) { return s.code == code; }))
            text += fmt::format("\nsub-{} is among the participants and has no session.\n", code);
    text += long_sessions_text(f);
    text += left_out_text(a);
    return text;
}

} // namespace tactor::study
