// SPDX-License-Identifier: MIT
// Tables of a study's trials and figures for other programs.
#include "cli/analyze/analyze_output.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "cli/say.hpp"
#include "core/words.hpp"
#include "study/analysis/analysis.hpp"
#include "study/analysis/levels.hpp"
#include "study/results/measures.hpp"
#include "study/statistics/tests.hpp"
#include "study/tasks/task.hpp"

namespace tactor::cli {
namespace {

// A column in the table of trials.
struct trial_column {
    const char* name;
    /// Returns a cell of the column. Null if the task makes the cell.
    std::string (*cell)(const study::trial& t, const study::run_outline& own) = nullptr;
    bool always = true; ///< if false, only studies whose tasks need it have the column
};

constexpr trial_column trial_columns[] = {
    {"run", [](const auto&, const auto& r) { return r.name; }},
    {"task", [](const auto&, const auto& r) { return std::string(find_run_task(r).name()); }},
    {"trial", [](const auto& t, const auto&) { return fmt::format("{}", t.place); }},
    {"attempt", [](const auto& t, const auto&) { return fmt::format("{}", t.attempt); }},
    {"motion", [](const auto& t, const auto& r) { return r.motions[t.motion]; }},
    {"method"},
    {"other", nullptr, false},
    {"order"},
    {"response"},
    {"chosen"},
    {"rating"},
    {"correct"},
    {"track", [](const auto& t, const auto&) { return t.track != 0 ? fmt::format("{}", t.track) : "n/a"; },
     false},
    {"value", nullptr, false},
    {"signal", nullptr, false},
    {"positive", nullptr, false},
    {"estimate", nullptr, false},
    {"x", nullptr, false},
    {"y", nullptr, false},
    {"target_x", nullptr, false},
    {"target_y", nullptr, false},
    {"error", nullptr, false},
    {"distance", nullptr, false},
    {"frechet", nullptr, false},
    {"length", nullptr, false},
    {"direction", nullptr, false},
    {"curvature", nullptr, false},
    {"response_time",
     [](const auto& t, const auto&) {
         return t.response_time_s ? fmt::format("{}", *t.response_time_s) : "n/a";
     }},
    {"early",
     [](const auto& t, const auto&) -> std::string {
         return !t.early ? "n/a" : *t.early ? "true" : "false";
     }},
};

// Returns a column name that is valid in SPSS, JASP and R: RUN.METHOD.MOTION or RUN.FIGURE. It has at most 64
// letters, digits, dots and underscores, begins with a letter and does not end with a dot. Adds the name to
// `taken`, in which no two names differ only in case.
std::string make_column_name(const std::vector<std::string>& parts, std::set<std::string>& taken)
{
    constexpr std::size_t longest = 60; // leaves space for a number
    std::size_t length = parts.size() - 1;
    for (const std::string& part : parts)
        length += part.size();
    const bool fits = length < longest;
    std::string name;
    for (const std::string& part : parts) {
        name += name.empty() ? "" : ".";
        for (const char c :
             first_characters(part, fits ? longest : longest / std::max<std::size_t>(3, parts.size()) - 1))
            if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.')
                name += c;
            else if ((static_cast<unsigned char>(c) & 0xc0U) != 0x80U) // one for each UTF-8 character
                name += '_';
    }
    if (const char first = to_lower_case(name)[0]; first < 'a' || first > 'z')
        name.insert(0, "x");
    if (name.back() == '.')
        name.back() = '_';
    std::string unique = name;
    for (unsigned n = 2; !taken.insert(to_lower_case(unique)).second; ++n)
        unique = fmt::format("{}_{}", name, n);
    return unique;
}

// Columns of --format wide for a subset of a run's trials.
struct wide_block {
    std::size_t run = 0;
    std::string method = {};            // method of the trials; empty for all methods
    study::session_number session = {}; // session of the trials; not set for all sessions
    std::vector<study::named_value> columns = {};
};

// Returns the methods whose trials have separate columns, if the run measures figures.
std::vector<study::level> list_methods(const study::run_outline& r, study::sigmoid kind)
{
    const auto factors = study::list_factors(r, {}, kind);
    return !find_run_task(r).plan_cells(r) && find_run_task(r).has_one_method(r)
               ? factors.front().levels
               : std::vector<study::level>();
}

// Returns the values of a participant for a block. `own` is the run in the participant's version.
std::vector<study::named_value> measure_block(const wide_block& block, const study::run_outline& own,
                                              std::vector<study::trial> trials, study::sigmoid kind)
{
    if (block.session)
        std::erase_if(trials, [&](const study::trial& t) { return t.session != block.session; });
    if (!block.method.empty()) {
        const std::vector<study::level> methods = list_methods(own, kind);
        const auto at = std::ranges::find(methods, block.method, &study::level::name);
        std::erase_if(trials, [&](const study::trial& t) { return at == methods.end() || !at->has(t); });
    }
    std::vector<study::named_value> all = find_run_task(own).measure(own, trials, kind);
    if (const auto p = find_run_task(own).plan_intervals(own, kind); p && block.method.empty())
        all.push_back({{"time_order"}, compare_intervals(*p, trials).front().value});
    return all;
}

using table_row = std::vector<std::optional<double>>; // values of a participant, by column

// Unwraps the angles of a figure together in all columns that a test may compare: those of a run's methods,
// of its sessions, or of both.
void unwrap_columns(std::vector<table_row>& rows, const std::vector<wide_block>& blocks)
{
    std::map<std::tuple<std::size_t, bool, bool, std::string>, std::vector<double*>> angles;
    for (table_row& row : rows) {
        auto value = row.begin();
        for (const wide_block& b : blocks)
            for (const study::named_value& column : b.columns) {
                if (column.is_angle && *value)
                    angles[{b.run, b.method.empty(), !b.session, column.name.front()}].push_back(&**value);
                ++value;
            }
    }
    for (const auto& [key, values] : angles) {
        std::vector<double> all;
        for (const double* const v : values)
            all.push_back(*v);
        all = study::unwrap_angles(std::move(all));
        for (std::size_t i = 0; i < all.size(); ++i)
            *values[i] = all[i];
    }
}

// Returns the values of all participants.
std::vector<table_row> measure_rows(const study::dataset& d, const std::vector<wide_block>& blocks,
                                    study::sigmoid kind)
{
    std::vector<table_row> rows(d.participants.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const wide_block& block : blocks) {
            const study::run_outline& own = find_run(d, i, block.run);
            std::vector<study::named_value> values;
            if (!own.motions.empty()) // otherwise the participant's group does not have the run
                values = measure_block(block, own, d.data[i][block.run].trials, kind);
            for (const study::named_value& column : block.columns) {
                const auto at = std::ranges::find(values, column.name, &study::named_value::name);
                rows[i].push_back(at != values.end() ? at->value : std::nullopt);
            }
        }
    unwrap_columns(rows, blocks);
    return rows;
}

} // namespace

void print_trials(const study::dataset& d)
{
    std::string text;
    if (d.simulated)
        text += "# simulated: no person gave these answers\n";
    // Names may contain "#", so the command skips a number of lines instead of lines that begin with #.
    const std::size_t notes = 3 + (d.simulated ? 1 : 0) + d.experiment.runs.size();
    // With sum contrasts, an effect is the effect over all motions rather than at the first motion.
    text += fmt::format("# library(lme4)\n"
                        "# options(contrasts = c(\"contr.sum\", \"contr.poly\"))\n"
                        "# d <- read.delim(\"trials.tsv\", skip = {}, na.strings = \"n/a\", quote = \"\", "
                        "colClasses = c(participant = \"character\"))\n",
                        notes);
    std::set<std::string_view> needed;
    for (std::size_t k = 0; k < d.experiment.runs.size(); ++k) {
        const study::run_outline& r = d.experiment.runs[k];
        text += fmt::format("# {}\n", find_run_task(r).format_r_model(r, find_model_factors(d, k)));
        for (const std::string_view column : find_run_task(r).list_columns(r))
            needed.insert(column);
    }
    std::vector<trial_column> columns;
    std::ranges::copy_if(trial_columns, std::back_inserter(columns),
                         [&](const trial_column& c) { return c.always || needed.contains(c.name); });
    const bool grouped = !d.experiment.groups.empty();
    const bool several = d.experiment.sessions > 1;
    text += fmt::format("participant{}{}", grouped ? "\tgroup" : "", several ? "\tsession" : "");
    for (const trial_column& c : columns)
        text += fmt::format("\t{}", c.name);
    text += '\n';
    for (std::size_t i = 0; i < d.participants.size(); ++i)
        for (std::size_t k = 0; k < d.experiment.runs.size(); ++k) {
            const study::run_outline& own = find_run(d, i, k);
            const study::run_outline& whole = d.experiment.runs[k];
            for (const study::trial& t : d.data[i][k].trials) {
                text += d.participants[i];
                text += grouped ? "\t" + d.groups[i] : "";
                text += several ? fmt::format("\t{}", t.session.value()) : "";
                const study::named_texts cells = find_run_task(own).describe_trial(t, own, whole);
                for (const trial_column& c : columns) {
                    const auto at = std::ranges::find(cells, c.name, &study::named_texts::value_type::first);
                    text += "\t" + (c.cell != nullptr   ? c.cell(t, own)
                                    : at != cells.end() ? at->second
                                                        : "n/a");
                }
                text += '\n';
            }
        }
    fmt::print("{}", text);
}

void print_wide_table(const study::dataset& d, study::sigmoid kind)
{
    const bool grouped = !d.experiment.groups.empty();
    std::string text = d.simulated ? "participant_id,simulated" : "participant_id";
    text += grouped ? ",group" : "";
    std::set<std::string> taken;
    std::vector<wide_block> blocks;
    for (std::size_t k = 0; k < d.experiment.runs.size(); ++k) {
        std::vector<std::string> methods{""};
        if (const auto all = list_methods(d.experiment.runs[k], kind); all.size() > 1)
            std::ranges::transform(all, std::back_inserter(methods), &study::level::name);
        std::set<study::session_number> sessions{std::nullopt};
        if (const auto all = list_played_sessions(d, k); all.size() > 1)
            sessions.insert(all.begin(), all.end());
        for (const std::string& method : methods)
            for (const study::session_number n : sessions)
                blocks.push_back({k, method, n});
    }
    for (wide_block& block : blocks) {
        const study::run_outline& r = d.experiment.runs[block.run];
        block.columns = measure_block(block, r, {}, kind);
        for (const study::named_value& v : block.columns) {
            std::vector<std::string> parts{r.name};
            if (!block.method.empty())
                parts.push_back(block.method);
            parts.insert(parts.end(), v.name.begin(), v.name.end());
            if (block.session)
                parts.push_back(fmt::format("ses-{}", *block.session));
            text += "," + make_column_name(parts, taken);
        }
    }
    text += '\n';
    const std::vector<table_row> rows = measure_rows(d, blocks, kind);
    for (std::size_t i = 0; i < d.participants.size(); ++i) {
        text += fmt::format("sub-{}{}", d.participants[i], d.simulated ? ",true" : "");
        text += grouped ? "," + nlohmann::json(d.groups[i]).dump() : ""; // adds quotes
        for (const std::optional<double>& value : rows[i])
            text += value ? fmt::format(",{}", *value) : ",";
        text += '\n';
    }
    fmt::print("{}", text);
}

} // namespace tactor::cli
