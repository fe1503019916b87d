// SPDX-License-Identifier: MIT
#include "study/bids/trial_row.hpp"

#include <cmath>

#include <fmt/format.h>

namespace tactor::study {
namespace {

constexpr unsigned most = 1000000000;
constexpr std::size_t sha256_digits = 64;

template <class T>
std::string cell_of(const std::optional<T>& v)
{
    return v ? fmt::format("{}", *v) : "n/a";
}

// Microseconds: a twentieth of a frame at 48 kHz.
std::string seconds(const std::optional<double>& v)
{
    return v ? fmt::format("{:.6f}", *v) : "n/a";
}

std::string cell_of(const std::string& text)
{
    return text.empty() ? "n/a" : text;
}

std::string text_in(const text_table& t, std::size_t row, std::string_view column)
{
    return std::string(t.cell(row, column).value_or(""));
}

std::optional<std::uint64_t> frame_in(const text_table& t, std::size_t row, std::string_view column)
{
    const std::optional<double> v = t.number(row, column);
    if (!v)
        return {};
    if (*v < 0.0 || *v > 9e15 || *v != std::floor(*v))
        t.refuse(row, fmt::format("{} is no frame", column), "a whole number");
    return static_cast<std::uint64_t>(*v);
}

} // namespace

named_cells cells_of(const trial_row& r)
{
    return {{"onset", seconds(r.onset_s)},
            {"duration", seconds(r.duration_s)},
            {"trial", fmt::format("{}", r.trial)},
            {"attempt", fmt::format("{}", r.attempt)},
            {"motion", r.motion},
            {"method_1", r.method_1},
            {"method_2", cell_of(r.method_2)},
            {"response", cell_of(r.response)},
            {"response_time", seconds(r.response_time_s)},
            {"rating", cell_of(r.rating)},
            {"void", fmt::format("{}", r.is_void)},
            {"xruns", fmt::format("{}", r.xruns)},
            {"stream", fmt::format("{}", r.stream)},
            {"frame_1", cell_of(r.frame_1)},
            {"frame_2", cell_of(r.frame_2)},
            {"plan_1", r.plan_1},
            {"plan_2", cell_of(r.plan_2)}};
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

std::vector<trial_row> read_rows(const text_table& t)
{
    for (const auto& [column, cell] : cells_of({}))
        t.need_column(column);
    std::vector<trial_row> all;
    for (std::size_t i = 0; i < t.rows(); ++i) {
        trial_row r;
        r.onset_s = t.number(i, "onset");
        r.duration_s = t.number(i, "duration").value_or(0.0);
        r.trial = t.whole(i, "trial", 1, most).value_or(0);
        r.attempt = t.whole(i, "attempt", 1, most).value_or(0);
        r.motion = text_in(t, i, "motion");
        r.method_1 = text_in(t, i, "method_1");
        r.method_2 = text_in(t, i, "method_2");
        r.response = text_in(t, i, "response");
        r.response_time_s = t.number(i, "response_time");
        r.rating = t.whole(i, "rating", 1, most);
        r.is_void = t.truth(i, "void");
        r.xruns = t.whole(i, "xruns", 0, most).value_or(0);
        r.stream = t.whole(i, "stream", 0, most).value_or(0);
        r.frame_1 = frame_in(t, i, "frame_1");
        r.frame_2 = frame_in(t, i, "frame_2");
        r.plan_1 = text_in(t, i, "plan_1");
        r.plan_2 = text_in(t, i, "plan_2");
        all.push_back(std::move(r));
    }
    return all;
}

} // namespace tactor::study
