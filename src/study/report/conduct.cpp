// SPDX-License-Identifier: MIT
#include "study/report/sections.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/report/markdown.hpp"

namespace tactor::study {
namespace {

constexpr const char* nobody = "none: the session was simulated";

bool is_own(const session_facts& s)
{
    return s.facts()["schema"].text() == own_schema;
}

bool is_simulated(const session_facts& s)
{
    return s.facts()["simulated"].truth().value_or(false);
}

// Says `say` of each opening of the device in which a trial of these runs counts; of all openings where
// none does. Which openings, where they differ.
template <class F>
std::string over_streams(const session_facts& s, const std::set<unsigned>& used, const F& say)
{
    sayings said;
    for (const json_value& one : s.facts()["streams"].list()) {
        const std::string number = one["stream"].words();
        if (!used.empty() && std::none_of(used.begin(), used.end(),
                                          [&](unsigned n) { return fmt::format("{}", n) == number; }))
            continue;
        std::string text = say(one);
        add_saying(said, text.empty() ? not_recorded : std::move(text), number);
    }
    if (said.size() == 1)
        return said.front().first == not_recorded ? "" : said.front().first;
    std::string all;
    for (const auto& [text, numbers] : said)
        all += fmt::format("{}{} ({} {} of the device)", all.empty() ? "" : ", ", text,
                           numbers.size() == 1 ? "opening" : "openings", fmt::join(numbers, ", "));
    return all;
}

std::set<unsigned> all_streams(const session_facts& s)
{
    std::set<unsigned> all;
    for (const std::set<unsigned>& of_run : s.streams)
        all.insert(of_run.begin(), of_run.end());
    return all;
}

std::string noise_words(const json_value& m)
{
    return fmt::format("{} noise of {} dBFS (root mean square), faded over {} s, {}",
                       plain(m["noise"].need_text()), digits(m["level_dbfs"].need_number()),
                       digits(m["fade_s"].need_number()),
                       m["while"].need_text() == "run" ? "through each run" : "while stimuli played");
}

// The noise in an opening of the device. Sessions of older versions name the noise's device alone.
std::string masker_words(const json_value& stream, const json_value& asked)
{
    if (!stream["masker"].there())
        return "none";
    const json_value noise = stream["masking"].there() ? stream["masking"] : asked;
    return noise.there() ? fmt::format("{}, from {}", noise_words(noise), plain(stream["masker"].words()))
                         : "";
}

} // namespace

std::string animation_text(const session_facts& s, std::size_t run)
{
    if (!s.design)
        return "";
    if (!s.design->runs.at(run).animation)
        return "no";
    constexpr const char* asked = " (the definition asks for it)";
    if (is_simulated(s))
        return std::string(nobody) + asked;
    const std::string shown = over_streams(s, s.streams.at(run), [](const json_value& one) -> std::string {
        const std::string display = one["display"].words();
        return display == "page"                         ? "yes, on the page"
               : display == "terminal with animation"    ? "yes, on the terminal"
               : display == "terminal without animation" ? "no, the terminal could not show it"
                                                         : "";
    });
    return (shown.empty() ? std::string(not_recorded) : shown) + (shown.starts_with("yes") ? "" : asked);
}

std::string masking_text(const session_facts& s)
{
    const json_value asked = s.facts()["masking"];
    if (!is_own(s))
        return asked.there() ? noise_words(asked) : "";
    const std::string wanted =
        asked.there() ? fmt::format(" (the definition asks for {})", noise_words(asked)) : "";
    if (is_simulated(s))
        return nobody + wanted;
    const std::string played =
        over_streams(s, all_streams(s), [&](const json_value& one) { return masker_words(one, asked); });
    if (played.empty())
        return asked.there() ? not_recorded + wanted : "none";
    return played + (played.starts_with("none") ? wanted : "");
}

std::string display_text(const session_facts& s)
{
    if (is_simulated(s))
        return nobody;
    return over_streams(s, all_streams(s),
                        [](const json_value& one) { return plain(one["display"].words()); });
}

std::string consent_text(const session_facts& s)
{
    if (is_simulated(s))
        return nobody;
    if (const auto at = s.facts()["consent"].text())
        return "given on " + plain(*at);
    return s.design && s.design->consent.empty() ? "not asked for by the definition" : "";
}

std::string walk_text(const session_facts& s)
{
    if (is_simulated(s))
        return nobody;
    std::set<std::string> felt;
    std::string last;
    for (const json_value& one : s.facts()["walk"].list()) {
        felt.insert(one["tactor"].words());
        last = one["asked"].words();
    }
    return felt.empty() ? "" : fmt::format("{}, the last on {}", counted(felt.size(), "tactor"), plain(last));
}

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

} // namespace tactor::study
