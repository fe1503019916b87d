// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

using numbers = std::vector<double>;

// Returns a number of each burst of a plan.
numbers burst_numbers(const planned_stimulus& p, const char* key)
{
    numbers all;
    for (const json_value& b : p.facts()["bursts"].list())
        if (const auto v = b[key].number())
            all.push_back(*v);
    return all;
}

// Lists the different values in the plans of a session.
template <class F>
std::string over_plans(const session_facts& s, const F& value)
{
    std::set<std::string> seen;
    for (const planned_stimulus& p : s.stimuli)
        if (std::string text = value(p.facts()); !text.empty())
            seen.insert(std::move(text));
    return fmt::format("{}", fmt::join(seen, ", "));
}

std::string carrier_text(const session_facts& s)
{
    if (s.stimuli.empty())
        return "";
    numbers ramps;
    for (const planned_stimulus& p : s.stimuli)
        for (const double r : burst_numbers(p, "ramp_s"))
            ramps.push_back(r);
    const std::string phase = over_plans(s, [](const json_value& p) { return p["render"]["phase"].words(); });
    std::string text =
        fmt::format("{}; {}; {} of {} s at both ends of a burst", over_plans(s, describe_carrier),
                    phase == "stroke"  ? "the phase ran on through each stimulus"
                    : phase == "burst" ? "the phase began anew with each burst"
                                       : "the phase differed between stimuli",
                    over_plans(s, describe_envelope), range_text(ramps));
    if (const std::string rise = over_plans(s, describe_rise); !rise.empty())
        text += "; " + rise;
    return text;
}

std::string law_text(const session_facts& s)
{
    if (!s.design)
        return "";
    std::set<std::string> laws;
    for (const method_definition& m : s.design->methods)
        laws.insert(timing_law(m.options.profile));
    return fmt::format("{}", fmt::join(laws, " and "));
}

// Lists the values of a key in the plans of a method (empty: of all), in the order of the sessions.
std::vector<std::string> list_kinds(const study_facts& f, const std::string& method, const char* key)
{
    std::vector<std::string> kinds;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            if (method.empty() || p.method == method)
                if (const std::string kind = p.facts()[key].words();
                    !kind.empty() && std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
                    kinds.push_back(kind);
    return kinds;
}

std::string options_text(const session_facts& s, const std::string& method)
{
    if (s.design)
        for (const method_definition& m : s.design->methods)
            if (m.name == method)
                return method_options(m.options);
    return "";
}

std::string method_text(const study_facts& f, const std::string& method)
{
    const std::vector<std::string> algorithms = list_kinds(f, method, "algorithm");
    std::string text = fmt::format("\n**{}.** ", plain(method));
    if (algorithms.empty())
        return text + "Its algorithm is not recorded.\n";
    for (const std::string& a : algorithms)
        text += fmt::format("Algorithm {}: {}\n", plain(a), algorithm_text(a));
    text += fmt::format("Phantom model: {}. Options: {}.\n", plain_list(list_kinds(f, method, "phantom")),
                        join_texts(f, [&](const session_facts& s) { return options_text(s, method); }));
    return text;
}

std::string bursts_cell(const planned_stimulus& p)
{
    const numbers durations = burst_numbers(p, "duration_s");
    return durations.empty() ? "continuous"
                             : fmt::format("{} of {} s", durations.size(), range_text(durations));
}

std::string plan_row(const planned_stimulus& p)
{
    const json_value f = p.facts();
    const auto number = [](const json_value& v) {
        return v.there() ? digits(v.need_number()) : std::string("-");
    };
    return table_row({plain(p.motion), plain(p.method), plain(f["stroke"]["name"].words()),
                      number(f["stroke"]["duration_s"]), number(f["stroke"]["length_mm"]), number(f["soa_s"]),
                      bursts_cell(p), number(f["total_s"]), fmt::format("{}", f["conflicts"].list().size()),
                      "`" + p.hash + "`"});
}

// Makes a row for each plan; names the sessions that have it, if not all do.
std::string plans_table(const study_facts& f)
{
    shared_texts rows;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            add_text(rows, plan_row(p), s.code);
    if (rows.empty())
        return "\nThe stimuli are not recorded.\n";
    std::string text = "\n" + table_head({"motion", "method", "path", "target (s)", "length (mm)", "SOA (s)",
                                          "bursts", "sound (s)", "overlaps", "SHA-256 of the plan"});
    std::string whose;
    for (const auto& [row, codes] : rows) {
        text += row;
        if (codes.size() != f.sessions.size())
            whose += fmt::format("\nNot everybody's: plan `{}` of {}.\n", row.substr(row.rfind('`') - 64, 64),
                                 subjects(codes));
    }
    return text + whose;
}

std::string notes_text(const study_facts& f)
{
    std::set<std::string> notes;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli) {
            if (const std::string note = p.facts()["stroke"]["note"].words(); !note.empty())
                notes.insert(fmt::format("- {}: {}\n", plain(p.motion), plain(note)));
            for (const json_value& w : p.facts()["warnings"].list())
                notes.insert(
                    fmt::format("- {} by {}: {}\n", plain(p.motion), plain(p.method), plain(w.need_text())));
        }
    return notes.empty() ? "" : fmt::format("\nOf these plans it was noted:\n\n{}", fmt::join(notes, ""));
}

} // namespace

std::string stimuli_section(const study_facts& f)
{
    std::string text = "\n## Stimuli\n\n### Carrier and timing\n\n";
    text += fmt::format("Carrier: {}.\n\n", join_texts(f, carrier_text));
    text += fmt::format("Timing law (Eq. 1 of Park et al. 2016, from Israr and Poupyrev 2011), the SOA being "
                        "the time from onset to onset:\n{}.\n",
                        join_texts(f, law_text));
    text += "\n### Methods of rendering\n";
    std::vector<std::string> methods;
    for (const session_facts& s : f.sessions)
        for (const planned_stimulus& p : s.stimuli)
            if (std::find(methods.begin(), methods.end(), p.method) == methods.end())
                methods.push_back(p.method);
    for (const std::string& m : methods)
        text += method_text(f, m);
    for (const std::string& kind : list_kinds(f, "", "phantom"))
        text += fmt::format("\n**Phantom model {}.** {}\n", plain(kind), phantom_text(kind));
    text += "\n### Motions and plans\n";
    return text + plans_table(f) + notes_text(f);
}

} // namespace tactor::study
