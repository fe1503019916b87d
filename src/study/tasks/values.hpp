// SPDX-License-Identifier: MIT
/// \file
/// Functions for tasks that vary a value or have two answers.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "files/toml_reader.hpp"
#include "options/option.hpp"
#include "study/data/definition.hpp"
#include "study/random/random.hpp"
#include "study/statistics/psychometric_fit.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {

// Read keys of [[run]]. All throw error (bad_input) with line and column.

/// Reads `trials`, or `trials_per_value` if the run has values.
void read_trials(const detail::toml_table& t, run_outline& o);
/// Finds a numeric option of a method; null for other names.
const options::option* find_numeric_option(std::string_view name);
/// Reads `vary` and the standard. Returns the bounds of the values.
detail::bounds read_vary(const detail::toml_table& t, run_outline& o);
/// Reads `values`.
void read_values(const detail::toml_table& t, run_outline& o, const detail::bounds& b);
/// Reads a list of numbers.
std::vector<double> read_numbers(const detail::toml_table& t, std::string_view key, const detail::bounds& b);
/// Reads a list of numbers, or one number.
std::vector<double> read_number_or_list(const detail::toml_table& t, std::string_view key,
                                        const detail::bounds& b);
/// Grid of a run's values.
struct value_grid {
    double least = 0.0; ///< ends of the range: least and greatest value
    double greatest = 0.0;
    double step = 0.0;                   ///< distance between two values
    std::vector<std::size_t> sizes = {}; ///< key `steps`, in multiples of `step`; empty if not given
};
/// Reads `range` and `steps`, and sets the run's values. They begin at the least value. The distance between
/// two values is the smallest of `steps`, or by default 1 dB for levels and a fortieth of the range for other
/// values. `own`: key that the error names if there is no range.
value_grid read_grid(const detail::toml_table& t, run_outline& o, const detail::bounds& b,
                     std::string_view own);
/// Returns the index of the value nearest to v.
std::size_t find_nearest(const std::vector<double>& values, double v);
/// Throws if a run has blocks by method. For runs with two methods in each trial.
void refuse_method_blocks(const detail::toml_table& t, const run_outline& o);
/// Throws if a method has the name `name`, which has another meaning in the run's tables.
void refuse_method_name(const detail::toml_table& t, const run_outline& o, std::string_view name);

/// Lists a trial for each motion, method and value. If a trial has another stimulus (a standard or silence),
/// lists both orders, or with `other_first` only the order in which the other stimulus comes first.
std::vector<planned_trial> list_value_cells(const run_definition& r, bool other_first);
/// Adds a trial with the value at index `place`. If there is another stimulus, adds both orders, or with
/// `other_first` only the order in which the other stimulus comes first.
void add_comparison(std::vector<planned_trial>& cells, std::size_t motion, const method_variants& v,
                    std::size_t place, bool other_first, unsigned track = 0);

// Read rows of tables. All throw error (bad_input) with file and line.

/// Returns the index of a cell's name in a list.
std::size_t find_place(const text_table& t, std::size_t row, std::string_view column,
                       const std::vector<std::string>& known);
/// Reads both methods of a trial, which must differ.
void read_pair(trial& r, const text_table& t, std::size_t row, const run_outline& o);
/// Reads the answer, a whole number in this range.
unsigned read_response(const text_table& t, std::size_t row, unsigned lowest = 1, unsigned greatest = 2);
/// Reads one of the run's values.
double read_value(const text_table& t, std::size_t row, const run_outline& o);
/// Reads the methods and the value of a trial, which may have a standard.
void read_comparison(trial& r, const text_table& t, std::size_t row, const run_outline& o);
/// Does the same for a trial whose other stimulus has the name `other` in the table. `other` is empty if
/// there is no other stimulus.
void read_comparison(trial& r, const text_table& t, std::size_t row, const run_outline& o,
                     std::string_view other);
/// Reads an answer from the columns `response` and `column`. One of the two cells may be empty; if neither is
/// empty, the cells must agree. `read`: function that reads a column.
template <class Read>
auto read_either_column(const text_table& t, std::size_t row, std::string_view column, const Read& read)
{
    const auto response = read("response");
    const auto own = read(column);
    if (!response && !own)
        t.refuse(row, fmt::format("the {} is missing", column), "give one, or make the trial void");
    if (response && own && *response != *own)
        t.refuse(row, fmt::format("response is {}, but {} is {}", *response, column, *own),
                 "correct the one that is wrong: in this task they are equal");
    return own ? *own : *response;
}

/// Returns true if the response chooses the comparison, or the second word if there is no standard.
bool is_positive_response(const run_outline& o, std::string_view method_1, unsigned response) noexcept;

// Simulated observers.

/// Returns the person's psychometric function for the method of a trial. Over people, the PSE has a normal
/// distribution, and the JND has a lognormal distribution, so that the JND stays positive.
psychometric find_psychometric(const simulated_run& who, const planned_trial& t);
/// Returns true with the probability that find_psychometric() gives for the value of a trial.
bool feels_more(const simulated_run& who, const planned_trial& t, random_numbers& r);
/// Returns the person's d' for the method of a trial. Over people, d' has a normal distribution, but values
/// below 0 become 0.
double find_dprime(const simulated_run& who, const planned_trial& t);
/// Returns the person's exponent for the method of a trial. Over people, the exponent has a normal
/// distribution.
double find_exponent(const simulated_run& who, const planned_trial& t);
/// Returns a random key, from 1 to `keys`, if the observer does not attend to the trial; else nothing.
/// simulation::lapse is the share of such trials.
std::optional<double> draw_lapse(const simulated_run& who, random_numbers& r, unsigned keys = 2);
/// Returns the answer to a trial with a comparison: 1 or 2, as is_positive_response() expects.
double simulate_comparison(const simulated_run& who, const planned_trial& t, random_numbers& r);
/// Computes the mean of the observer's judgements. Throws error (bad_input) if the observer cannot judge the
/// run's attribute.
void prepare_judge(simulated_run& who);
/// Points, on a line from 0 to 100, for a unit of -ln cost: a quarter of the line. On a scale from 1 to 5, a
/// unit is also a quarter of the scale.
inline constexpr double line_points = 25.0;
/// Returns the deviation of a judgement of a method from the mean judgement of all people: the worth of the
/// method for this person, plus noise.
double draw_deviation(const simulated_run& who, std::size_t method, random_numbers& r);
/// Returns a judgement of a stimulus: -ln of its cost, plus draw_deviation().
double judge(const simulated_run& who, std::size_t motion, std::size_t method, random_numbers& r);

} // namespace tactor::study
