// SPDX-License-Identifier: MIT
#include "study/tasks/drawn.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "study/data/text_table.hpp"
#include "study/results/model.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

// Reads a cell with a drawing. \throws error (bad_input) with file and line.
drawing read_cell(const text_table& t, std::size_t row, std::string_view column, drawing_kind kind)
{
    std::optional<drawing> d = read_drawing(t.need(row, column));
    if (!d || (kind == drawing_kind::place && d->size() != 1))
        t.refuse(row,
                 kind == drawing_kind::place ? fmt::format("{} is not a place", column)
                                             : fmt::format("{} is not a drawn path", column),
                 kind == drawing_kind::place ? "give TIME X Y in s and mm: 0 12.5 -3"
                                             : "give TIME X Y of each point in s and mm: 0 1 2;0.1 3 2");
    return *std::move(d);
}

std::string to_cell(const std::optional<double>& v)
{
    return v ? fmt::format("{}", *v) : "n/a";
}

} // namespace

trial_answers drawn_task::list_answers(const run_definition&, const page_words&) const
{
    return {.draws = kind_};
}

void drawn_task::record_answer(trial_row& row, const run_definition&, const trial_answer& answer) const
{
    row.response = to_text(answer.drawn);
}

void drawn_task::read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const
{
    r.method_1 = find_place(t, row, "method_1", o.methods);
    r.drawn = read_cell(t, row, "response", kind_);
    r.target = read_cell(t, row, "target", kind_);
}

void drawn_task::score(trial& r, const run_outline&, std::string_view, const trial_answer& answer) const
{
    r.drawn = answer.drawn;
}

std::vector<named_value> drawn_task::measure(const run_outline&, const std::vector<trial>& trials,
                                             sigmoid) const
{
    return list_drawn_figures(kind_, trials);
}

std::vector<std::vector<result_outline>> drawn_task::outline_results() const
{
    std::vector<result_outline> rows =
        outline_figure_results({{{"drawings"}, outline_figures<drawn_answers>()}});
    if (kind_ == drawing_kind::place)
        rows.push_back({{"confusion", "*"}, answer_counts{}});
    return {std::move(rows)};
}

std::vector<result> drawn_task::analyse(const run_outline& o, const run_people& people, sigmoid) const
{
    const bool is_place = kind_ == drawing_kind::place;
    std::vector<result> rows = analyse_conditions(
        o, people, o.methods, {}, "drawings", is_place ? "Places drawn, mm" : "Paths drawn",
        [&](const condition_trials& c) { return measure_drawings(o, kind_, c, people); });
    if (is_place)
        for (answer_counts& c : count_nearest_targets(o, people)) {
            const std::string method = c.method;
            rows.push_back({{"confusion", method}, "Nearest target with " + method, std::move(c)});
        }
    return rows;
}

main_comparison drawn_task::name_comparison(const run_outline&) const
{
    return make_comparison(list_drawn_figures(kind_, {}).front().name.front(), "t", {});
}

// Lists the columns for places and their errors, or for the figures of paths.
std::vector<std::string_view> drawn_task::list_columns(const run_outline&) const
{
    if (kind_ == drawing_kind::place)
        return {"x", "y", "target_x", "target_y", "error"};
    return {"distance", "frechet", "length", "direction", "curvature"};
}

named_texts drawn_task::describe_trial(const trial& t, const run_outline& own, const run_outline&) const
{
    named_texts cells{{"method", own.methods[t.method_1]}};
    if (kind_ == drawing_kind::place) {
        const tactor::point& at = t.drawn.front().at;
        const tactor::point& target = t.target.front().at;
        for (const auto& [column, v] : {std::pair("x", at.x_mm),
                                        {"y", at.y_mm},
                                        {"target_x", target.x_mm},
                                        {"target_y", target.y_mm},
                                        {"error", distance_mm(at, target)}})
            cells.emplace_back(column, to_cell(v));
        return cells;
    }
    const path_errors e = compare_paths(t.drawn, t.target);
    for (const auto& [column, v] : {std::pair("distance", std::optional(e.distance_mm)),
                                    {"frechet", e.frechet_mm},
                                    {"length", e.length},
                                    {"direction", e.direction},
                                    {"curvature", e.curvature}})
        cells.emplace_back(column, to_cell(v));
    return cells;
}

std::string drawn_task::format_r_model(const run_outline& o, const model_factors& f) const
{
    return format_model_call(o, f, {kind_ == drawing_kind::place ? "lmer(error" : "lmer(distance"});
}

} // namespace tactor::study
