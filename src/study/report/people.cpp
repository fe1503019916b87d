// SPDX-License-Identifier: MIT
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/report/markdown.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

std::string ages_text(const study_facts& f)
{
    std::vector<double> ages;
    for (const person& p : f.people) {
        double age = 0.0;
        const std::string text = p.age.value_or("");
        const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), age);
        if (!text.empty() && failed == std::errc() && end == text.data() + text.size())
            ages.push_back(age);
    }
    if (ages.empty())
        return not_recorded;
    const t_test t = test_mean(ages, 0.0);
    std::string text = fmt::format("{} years, mean {:.1f}", range_text(ages), *t.mean);
    if (t.se)
        text += fmt::format(", sd {:.1f}", *t.se * std::sqrt(static_cast<double>(ages.size())));
    if (ages.size() != f.people.size())
        text += fmt::format(" (of {}; the others': {})", ages.size(), not_recorded);
    return text;
}

// How many said what, in a column.
std::string counts_text(const study_facts& f, std::optional<std::string> person::*column)
{
    std::map<std::string, unsigned> counts;
    for (const person& p : f.people)
        ++counts[(p.*column) ? plain(*(p.*column)) : not_recorded];
    if (counts.size() == 1 && counts.contains(not_recorded))
        return not_recorded;
    std::string all;
    for (const auto& [said, n] : counts)
        all += fmt::format("{}{} {}", all.empty() ? "" : ", ", n, said);
    return all;
}

std::string dates_text(const study_facts& f)
{
    std::vector<std::string> days;
    for (const session_facts& s : f.sessions)
        if (const std::string date = s.facts()["date"].words(); !date.empty())
            days.push_back(date.substr(0, date.find('T')));
    if (days.empty())
        return not_recorded;
    const auto [first, last] = std::minmax_element(days.begin(), days.end());
    return *first == *last ? plain(*first) : fmt::format("{} to {}", plain(*first), plain(*last));
}

} // namespace

std::string participants_section(const study_facts& f)
{
    std::vector<std::string> codes;
    for (const person& p : f.people)
        codes.push_back(p.code);
    std::string text = "\n## Participants\n\n";
    text += fmt::format("{}: {}. Age: {}. Sex: {}. Handedness: {}. Dates of the sessions: {}.\n",
                        counted(codes.size(), "participant"), subjects(codes), ages_text(f),
                        counts_text(f, &person::sex), counts_text(f, &person::handedness), dates_text(f));
    for (const std::string& code : codes)
        if (std::none_of(f.sessions.begin(), f.sessions.end(),
                         [&](const session_facts& s) { return s.code == code; }))
            text += fmt::format("\nsub-{} is among the participants and has no session.\n", code);
    return text;
}

} // namespace tactor::study
