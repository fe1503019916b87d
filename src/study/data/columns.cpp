// SPDX-License-Identifier: MIT
#include "study/data/columns.hpp"

#include <cmath>

#include <fmt/format.h>

namespace tactor::study {
namespace {

constexpr unsigned most_count = 1000000000;
constexpr std::size_t sha256_digits = 64;

std::string written(const std::string& text)
{
    return text.empty() ? "n/a" : text;
}

// Microseconds: a twentieth of a frame at 48 kHz.
std::string written(double seconds)
{
    return fmt::format("{:.6f}", seconds);
}

template <class T>
std::string written(const T& v)
{
    return fmt::format("{}", v);
}

template <class T>
std::string written(const std::optional<T>& v)
{
    return v ? written(*v) : "n/a";
}

// Reads a cell of a column by the type of the member that it goes to.
struct cell_reader {
    const text_table& table;
    std::size_t row;
    const trial_column& column;

    void into(std::string& v) const { v = table.cell(row, column.name).value_or(""); }
    void into(bool& v) const { v = table.truth(row, column.name); }
    void into(std::optional<bool>& v) const
    {
        if (table.cell(row, column.name))
            v = table.truth(row, column.name);
    }
    void into(std::optional<double>& v) const { v = table.number(row, column.name); }
    void into(double& v) const { v = table.number(row, column.name).value_or(v); }
    void into(std::optional<unsigned>& v) const
    {
        v = table.whole(row, column.name, column.least, most_count);
    }
    void into(unsigned& v) const { v = table.whole(row, column.name, column.least, most_count).value_or(v); }
    void into(std::optional<std::uint64_t>& v) const
    {
        const std::optional<double> frame = table.number(row, column.name);
        if (frame && (*frame < 0.0 || *frame > 9e15 || *frame != std::floor(*frame)))
            table.refuse(row, fmt::format("{} is no frame", column.name), "a whole number");
        v = frame ? std::optional(static_cast<std::uint64_t>(*frame)) : std::nullopt;
    }
};

} // namespace

const std::array<trial_column, 18> trial_columns{{
    {"onset", "First frame of the first stimulus at the DAC, since the run's first sample there", "s",
     &trial_row::onset_s},
    {"duration", "From the first frame of the first stimulus to the last of the last, the gap included", "s",
     &trial_row::duration_s},
    {"trial", "Place in the sequence, from 1; a trial that comes again keeps it", "", &trial_row::trial, 1},
    {"attempt", "How often the trial has been begun", "", &trial_row::attempt, 1},
    {"motion", "Target motion; the methods are how it was rendered", "", &trial_row::motion},
    {"method_1", "Method of the first stimulus", "", &trial_row::method_1},
    {"method_2", "Method of the second stimulus; n/a where there is one only", "", &trial_row::method_2},
    {"response", "", "", &trial_row::response},
    {"response_time", "From the last stimulus frame at the DAC to the answer", "s",
     &trial_row::response_time_s},
    {"early", "Whether the answer came sooner after the stimulus than min_response_s; n/a without an answer",
     "", &trial_row::early, 0, true},
    {"rating", "The rating; n/a where nothing is rated", "", &trial_row::rating, 1},
    {"void", "Whether the trial does not count; it comes again at the end of the run", "",
     &trial_row::is_void},
    {"xruns", "Gaps in the sound while the stimuli played, as the device tells them", "", &trial_row::xruns},
    {"stream", "Counts openings of the device, from 1", "", &trial_row::stream},
    {"frame_1", "First frame of the first stimulus in that stream", "", &trial_row::frame_1},
    {"frame_2", "First frame of the second stimulus in that stream", "", &trial_row::frame_2},
    {"plan_1", "SHA-256 of the first stimulus' plan: sourcedata/sub-CODE/plans", "", &trial_row::plan_1},
    {"plan_2", "SHA-256 of the second stimulus' plan", "", &trial_row::plan_2},
}};

named_cells make_cells(const trial_row& r)
{
    named_cells cells;
    for (const trial_column& c : trial_columns)
        cells.emplace_back(c.name, std::visit([&](auto member) { return written(r.*member); }, c.member));
    return cells;
}

std::vector<trial_row> read_rows(const text_table& t)
{
    for (const trial_column& c : trial_columns)
        if (!c.may_lack)
            t.need_column(c.name);
    std::vector<trial_row> all(t.rows());
    for (const trial_column& c : trial_columns)
        for (std::size_t i = 0; i < all.size() && t.has(c.name); ++i)
            std::visit([&](auto member) { cell_reader{t, i, c}.into(all[i].*member); }, c.member);
    return all;
}

bool is_cut_in_plan(const text_table& t)
{
    if (!t.is_open())
        return false;
    const std::string& column = t.columns().back();
    const std::size_t row = t.rows() - 1;
    const std::size_t length = t.cell(row, column).value_or("").size();
    if (column == "plan_1")
        return length != sha256_digits;
    return column == "plan_2" && length != (t.cell(row, "method_2") ? sha256_digits : 0);
}

text_table read_trials(const std::filesystem::path& table)
{
    text_table t(table, last_line::may_be_cut);
    if (is_cut_in_plan(t))
        t.leave_out_last();
    return t;
}

} // namespace tactor::study
