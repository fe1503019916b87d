// SPDX-License-Identifier: MIT
// Columns of a run's tables, and conversion of their cells to values.
#include "study/bids/dataset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "study/data/text_table.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

constexpr unsigned most_count = 1000000000;

std::string format_value(const std::string& text)
{
    return text.empty() ? "n/a" : text;
}

// Writes seconds with six decimals: a microsecond is a twentieth of a frame at 48 kHz.
std::string format_value(double seconds)
{
    return fmt::format("{:.6f}", seconds);
}

template <class T>
std::string format_value(const T& v)
{
    return fmt::format("{}", v);
}

template <class T>
std::string format_value(const std::optional<T>& v)
{
    return v ? format_value(*v) : "n/a";
}

// Reader of one cell. It converts the cell to the type of a member, and keeps the member's default for n/a.
struct cell_reader {
    const text_table& table;
    std::size_t row;
    const trial_column& column;

    void read_into(std::string& v) const { v = table.cell(row, column.name).value_or(""); }
    void read_into(bool& v) const { v = table.truth(row, column.name); }
    void read_into(double& v) const { v = table.number(row, column.name).value_or(v); }
    void read_into(unsigned& v) const
    {
        v = table.whole(row, column.name, column.least, most_count).value_or(v);
    }
    void read_into(std::uint64_t& v) const
    {
        const double frame = table.number(row, column.name).value_or(0.0);
        if (frame < 0.0 || frame > 9e15 || frame != std::floor(frame))
            table.refuse(row, fmt::format("{} is not a frame", column.name), "give a whole number");
        v = static_cast<std::uint64_t>(frame);
    }
    template <class T>
    void read_into(std::optional<T>& v) const
    {
        if (table.cell(row, column.name))
            read_into(v.emplace());
    }
};

cell_value read_value(const text_table& t, std::size_t row, const trial_column& c)
{
    if (!t.has(c.name) || !t.cell(row, c.name))
        return {};
    trial_row r;
    return std::visit(
        [&](auto member) -> cell_value {
            auto& v = r.*member;
            cell_reader{t, row, c}.read_into(v);
            if constexpr (requires { *v; })
                return *v;
            else
                return v;
        },
        c.member);
}

// Adds all cells of a line. Columns that are not in trial_columns are added as texts.
void add_cells(trial_cells& into, const text_table& t, std::size_t row)
{
    for (const trial_column& c : trial_columns)
        into.emplace_back(c.name, read_value(t, row, c));
    for (const std::string& name : t.columns())
        if (std::ranges::find(trial_columns, name, &trial_column::name) == trial_columns.end()) {
            const auto text = t.cell(row, name);
            into.emplace_back(name, text ? cell_value(std::string(*text)) : cell_value());
        }
}

} // namespace

const std::array<trial_column, 29> trial_columns{{
    {"onset", "First frame of the first stimulus at the DAC, since the run's first sample there", "s",
     &trial_row::onset_s},
    {"duration",
     "From the first frame of the first stimulus to the last frame of the last, including the gap", "s",
     &trial_row::duration_s},
    {"trial", "Place in the sequence, from 1; a trial that comes again keeps it", "", &trial_row::trial,
     column_use::analysis, 1},
    {"attempt", "Number of the attempt at the trial", "", &trial_row::attempt, column_use::analysis, 1},
    {"group", "Group of the participant", "", &trial_row::group, column_use::some},
    {"session", "Number of the session, from 1", "", &trial_row::session, column_use::some, 1},
    {"motion", "Target motion; the methods are how it was rendered", "", &trial_row::motion,
     column_use::analysis},
    {"method_1", "Method of the first stimulus", "", &trial_row::method_1, column_use::analysis},
    {"method_2", "Method of the second stimulus; n/a if there is only one", "", &trial_row::method_2},
    {"method_3", "Method of the third stimulus", "", &trial_row::method_3, column_use::third},
    {"response", "", "", &trial_row::response, column_use::analysis},
    {"response_time", "From the last stimulus frame at the DAC to the answer", "s",
     &trial_row::response_time_s, column_use::analysis},
    {"early", "Whether the answer came sooner after the stimulus than min_response_s; n/a without an answer",
     "", &trial_row::early, column_use::nobody},
    {"rating", "The rating; n/a in other tasks", "", &trial_row::rating},
    {"value", "Value that the run varies, for the comparison; n/a in a trial without a stimulus", "",
     &trial_row::value, column_use::values},
    {"start", "Value from which the participant began to move the comparison", "", &trial_row::start,
     column_use::own},
    {"moves", "Number of the participant's moves; both stimuli play again after each", "", &trial_row::moves,
     column_use::own},
    {"track", "Track of the adaptive procedure, from 1", "", &trial_row::track, column_use::own, 1},
    {"intensity_estimate", "The number above 0 that the participant gave", "", &trial_row::intensity_estimate,
     column_use::own},
    {"target", "The target in the same form as the response", "", &trial_row::target, column_use::own},
    {"void", "Whether the trial does not count; it comes again at the end of the run", "",
     &trial_row::is_void, column_use::analysis},
    {"xruns", "Gaps in the sound while the stimuli played, as the device reports them", "",
     &trial_row::xruns},
    {"stream", "Counts openings of the device, from 1", "", &trial_row::stream},
    {"frame_1", "First frame of the first stimulus in that stream", "", &trial_row::frame_1},
    {"frame_2", "First frame of the second stimulus in that stream", "", &trial_row::frame_2},
    {"frame_3", "First frame of the third stimulus in that stream", "", &trial_row::frame_3,
     column_use::third},
    {"plan_1", "SHA-256 of the first stimulus' plan: sourcedata/sub-CODE/plans", "", &trial_row::plan_1},
    {"plan_2", "SHA-256 of the second stimulus' plan", "", &trial_row::plan_2},
    {"plan_3", "SHA-256 of the third stimulus' plan", "", &trial_row::plan_3, column_use::third},
}};

bool has_column(const run_outline& run, const trial_column& c)
{
    return c.use == column_use::values  ? !run.vary.empty()
           : c.use == column_use::third ? find_run_task(run).properties().has_three_stimuli
           : c.use == column_use::own
               ? std::ranges::count(find_run_task(run).properties().columns, c.name) != 0 &&
                     find_run_task(run).has_own_columns(run)
               : true;
}

named_cells make_cells(const trial_row& r, const std::vector<const run_outline*>& runs)
{
    named_cells cells;
    for (const trial_column& c : trial_columns) {
        std::string text = std::visit([&](auto member) { return format_value(r.*member); }, c.member);
        if (c.name == "intensity_estimate" && r.intensity_estimate)
            text = r.response; // the number with all its digits: format_value() would round it
        if (c.use == column_use::some ? text != "n/a" : std::ranges::any_of(runs, [&](auto* run) {
                return has_column(*run, c);
            }))
            cells.emplace_back(c.name, std::move(text));
    }
    return cells;
}

std::vector<trial_row> read_rows(const text_table& t, const run_outline& run)
{
    for (const trial_column& c : trial_columns)
        if (c.use != column_use::nobody && c.use != column_use::some && has_column(run, c))
            t.need_column(c.name);
    return read_cells(t);
}

std::vector<trial_row> read_cells(const text_table& t)
{
    std::vector<trial_row> all(t.rows());
    for (const trial_column& c : trial_columns)
        for (std::size_t i = 0; i < all.size() && t.has(c.name); ++i)
            std::visit([&](auto member) { cell_reader{t, i, c}.read_into(all[i].*member); }, c.member);
    return all;
}

std::vector<trial_cells> read_study(const std::filesystem::path& folder, const selection& who)
{
    const dataset d = read_dataset({folder}, who);
    std::vector<trial_cells> all;
    for (const std::string& code : d.participants) {
        const std::vector<session_number> sessions = list_sessions(folder, code);
        for (const run_outline& run : d.experiment.runs)
            for (const session_number session : sessions) {
                const std::filesystem::path file = table_path(code, session, run);
                if (!exists_in_study(folder, file))
                    continue;
                const text_table t(folder / file);
                for (std::size_t row = 0; row < t.rows(); ++row) {
                    all.push_back({{"participant", code},
                                   {"run", run.name},
                                   {"task", std::string(find_run_task(run).name())},
                                   {"simulated", d.simulated}});
                    add_cells(all.back(), t, row);
                }
            }
    }
    return all;
}

} // namespace tactor::study
