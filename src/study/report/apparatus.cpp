// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include <tactor/phantom.hpp>

#include "core/words.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

std::string spacing_text(const std::vector<double>& lines)
{
    std::vector<double> gaps;
    for (std::size_t i = 1; i < lines.size(); ++i)
        gaps.push_back(lines[i] - lines[i - 1]);
    return range_text(gaps);
}

// Describes rows and columns, or the distance of neighbours if there is no grid.
std::string layout_text(const array& a)
{
    const auto grid = find_grid(a);
    if (!grid)
        return fmt::format("in no grid, {} mm from neighbour to neighbour (median)",
                           digits(layout(a).pitch_mm()));
    const std::size_t columns = grid->x_mm.size();
    const std::size_t rows = grid->y_mm.size();
    std::string text = fmt::format("in {} and {}", counted(rows, "row"), counted(columns, "column"));
    if (columns > 1)
        text += fmt::format(", {} mm from column to column", spacing_text(grid->x_mm));
    if (rows > 1)
        text += fmt::format("{} {} mm from row to row", columns > 1 ? " and" : ",", spacing_text(grid->y_mm));
    return text + ", centre to centre";
}

std::string actuators_text(const array& a)
{
    std::set<std::string> kinds;
    for (const tactor_spec& t : a.tactors)
        kinds.insert(std::string(to_string(t.actuator)));
    std::string all;
    for (const std::string& k : kinds)
        all += (all.empty() ? "" : ", ") + (k == "unknown" ? std::string(not_recorded) : k);
    return all;
}

std::string array_table(const array& a)
{
    std::string text = table_head(
        {"tactor", "x (mm)", "y (mm)", "channel", "polarity", "gain (dB)", "limit (dBFS)", "actuator"});
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        const tactor_spec& t = a.tactors[i];
        text += table_row({fmt::format("{}", i), digits(t.position.x_mm), digits(t.position.y_mm),
                           fmt::format("{}", t.channel), fmt::format("{}", t.polarity), digits(t.gain_db),
                           digits(t.max_dbfs), std::string(to_string(t.actuator))});
    }
    return text;
}

// Makes a table of each array; names the participants if there are several.
std::string arrays_text(const study_facts& f)
{
    std::map<std::string, std::vector<std::string>> tables;
    for (const session_facts& s : f.sessions)
        tables[s.tactors ? array_table(*s.tactors) : ""].push_back(s.code);
    std::string text;
    for (const auto& [table, codes] : tables) {
        if (tables.size() > 1)
            text += fmt::format("\n{}:\n", subjects(codes));
        text += table.empty() ? "\nThe places of the tactors are not recorded.\n" : "\n" + table;
    }
    return text;
}

// Describes the measured displacement at full scale, and the acceleration that it is at each carrier; empty
// if the array does not state it.
std::string strength_text(const session_facts& s)
{
    std::vector<double> um;
    if (s.tactors)
        for (const tactor_spec& t : s.tactors->tactors)
            if (t.displacement_um_at_0dbfs)
                um.push_back(*t.displacement_um_at_0dbfs);
    if (um.empty())
        return "";
    std::string text = fmt::format("{} um", range_text(um));
    if (um.size() < s.tactors->tactors.size())
        text += fmt::format(" at {} of {}", um.size(), counted(s.tactors->tactors.size(), "tactor"));
    std::set<double> carriers;
    for (const planned_stimulus& p : s.stimuli)
        if (const auto hz = p.facts()["stroke"]["carrier_hz"].number())
            carriers.insert(*hz);
    for (const double hz : carriers) {
        constexpr double m_per_um = 1e-6;
        const double angular = 2.0 * std::numbers::pi * hz;
        std::vector<double> m_s2;
        for (const double d : um)
            m_s2.push_back(d * m_per_um * angular * angular);
        text += fmt::format(", which is {} m/s2 at {} Hz", range_text(m_s2), digits(hz));
    }
    return text;
}

std::string level_text(const session_facts& s)
{
    const json_value level = s.facts()["level"];
    if (const auto sl = level["sl_db"].number())
        return fmt::format("{} dB above each tactor's detection threshold ({} dB SL)", digits(*sl),
                           digits(*sl));
    const auto dbfs = level["dbfs"].number();
    return dbfs ? fmt::format("{} dBFS, the same for all tactors but for their gains", digits(*dbfs)) : "";
}

bool needs_thresholds(const session_facts& s)
{
    return !s.facts()["level"]["dbfs"].there();
}

// Returns true if a session has a threshold or needs one.
bool has_thresholds(const session_facts& s)
{
    const std::vector<json_value> all = s.facts()["thresholds_dbfs"].list();
    return needs_thresholds(s) ||
           std::any_of(all.begin(), all.end(), [](const json_value& one) { return one.there(); });
}

std::string assumed_text(const session_facts& s)
{
    const auto assumed = s.facts()["thresholds_assumed"].truth();
    if (!assumed)
        return "";
    if (!needs_thresholds(s))
        return "not used: the level is in dBFS";
    return *assumed ? "assumed, **not measured**, for tactors without one"
                    : "from the array file, none assumed";
}

// Returns a threshold, or those at several frequencies.
std::string threshold_text(const json_value& t)
{
    if (!t.there())
        return "none";
    if (!t.is_list())
        return digits(t.need_number());
    std::string all;
    for (const json_value& pair : t.list()) {
        const std::vector<double> hz_and_dbfs = pair.need_numbers();
        if (hz_and_dbfs.size() != 2)
            pair.refuse("is no frequency with a threshold");
        all += fmt::format("{}{} at {} Hz", all.empty() ? "" : ", ", digits(hz_and_dbfs[1]),
                           digits(hz_and_dbfs[0]));
    }
    return all;
}

// Returns mean and standard deviation of one tactor's thresholds.
std::string mean_and_sd(const std::vector<double>& v)
{
    const t_test t = quick_test_mean(v, 0.0);
    if (!t.mean)
        return "none";
    return !t.se ? fmt::format("{:.2f}", *t.mean)
                 : fmt::format("{:.2f} ({:.2f})", *t.mean, *t.se * std::sqrt(static_cast<double>(v.size())));
}

// Makes a row for each participant, and one with mean and standard deviation for each tactor.
std::string thresholds_table(const study_facts& f)
{
    std::size_t most = 0;
    for (const session_facts& s : f.sessions)
        if (has_thresholds(s))
            most = std::max(most, s.facts()["thresholds_dbfs"].list().size());
    if (most == 0)
        return std::any_of(f.sessions.begin(), f.sessions.end(), needs_thresholds)
                   ? "Thresholds are not recorded.\n"
                   : "";
    std::vector<std::string> head{"threshold (dBFS)"};
    for (std::size_t i = 0; i < most; ++i)
        head.push_back(fmt::format("tactor {}", i));
    std::string text = table_head(head);
    std::vector<std::vector<double>> columns(most);
    for (const session_facts& s : f.sessions) {
        if (!has_thresholds(s))
            continue;
        std::vector<std::string> row{"sub-" + s.code};
        for (const json_value& one : s.facts()["thresholds_dbfs"].list()) {
            row.push_back(threshold_text(one));
            if (one.there() && !one.is_list())
                columns[row.size() - 2].push_back(one.need_number());
        }
        row.resize(most + 1, "none");
        text += table_row(row);
    }
    std::vector<std::string> summary{"mean (sd)"};
    for (const std::vector<double>& v : columns)
        summary.push_back(mean_and_sd(v));
    return text + table_row(summary);
}

// Describes the measurement of the thresholds; repeats what another program wrote.
std::string origin_text(const session_facts& s)
{
    if (!s.document.contains("calibration"))
        return "";
    const json_value c = s.facts()["calibration"];
    if (!c.there())
        return "none";
    if (s.facts()["schema"].text() != own_schema)
        return plain(c.words());
    std::string text = fmt::format("of participant {}, {}", plain(c["participant"].need_text()),
                                   plain(c["method"].need_text()));
    if (const auto rule = c["rule"].text())
        text += " " + plain(*rule);
    text += fmt::format(", carrier {} Hz, intervals of {} s", digits(c["carrier_hz"].need_number()),
                        digits(c["interval_s"].need_number()));
    if (const auto feedback = c["feedback"].truth())
        text += *feedback ? ", with feedback" : ", without feedback";
    text += fmt::format(", masker: {}, on {}", plain(c["masker"].text().value_or(not_recorded)),
                        plain(c["date"].text().value_or(not_recorded)));
    if (c["simulated"].truth().value_or(false))
        text += ", **SIMULATED: nobody was asked**";
    for (const json_value& w : c["warnings"].list())
        text += "; " + plain(w.need_text());
    return text;
}

std::string fact_text(const study_facts& f, const char* key)
{
    return join_texts(f, [&](const session_facts& s) {
        const json_value value = s.facts()[key];
        return !value.there() && s.document.contains(key) ? std::string("none") : plain(value.words());
    });
}

} // namespace

std::string apparatus_section(const study_facts& f)
{
    std::string text = "\n## Apparatus\n\n### Array\n\n";
    text += fmt::format("Array: {}.\n", join_texts(f, [](const session_facts& s) {
                            return s.tactors
                                       ? fmt::format("{}: {} {}; actuators: {}", plain(s.tactors->name),
                                                     counted(s.tactors->tactors.size(), "tactor"),
                                                     layout_text(*s.tactors), actuators_text(*s.tactors))
                                       : "";
                        }));
    text += arrays_text(f);
    text += "\n### Sound\n\n";
    text += fmt::format(
        "Sample rate (Hz): {}. Channels: {}. Device: {}. Sound server between tactor and the device: {}.\n",
        fact_text(f, "rate"), fact_text(f, "channels"), fact_text(f, "device"), fact_text(f, "sound_server"));
    text += "\n### Levels and thresholds\n\n";
    text +=
        fmt::format("Level: {}. Thresholds: {}.\n\n", join_texts(f, level_text), join_texts(f, assumed_text));
    if (const std::string strength = join_texts(f, strength_text); strength != not_recorded)
        text += fmt::format("Peak displacement of a sine at 0 dBFS, as measured: {}.\n\n", strength);
    text += thresholds_table(f);
    if (const std::string how = join_texts(f, origin_text); how != not_recorded)
        text += fmt::format("\nCalibration: {}.\n", how);
    return text;
}

} // namespace tactor::study
