// SPDX-License-Identifier: MIT
#include "study/analysis/analysis.hpp"

#include <algorithm>
#include <cmath>

#include "study/statistics/tests.hpp"

namespace tactor::study {
namespace {

double score_of(const trial& t, const run_outline& run)
{
    switch (run.task) {
    case task_kind::choose:
        return last_chosen(t, run) ? 100.0 : 0.0;
    case task_kind::rate:
        return t.response;
    case task_kind::identify:
        break;
    }
    return t.response == t.motion ? 100.0 : 0.0;
}

} // namespace

bool last_chosen(const trial& t, const run_outline& run) noexcept
{
    return (t.response == 1 ? t.method_1 : t.method_2) + 1 == run.methods.size();
}

std::optional<cell_values> compute_cells(const run_outline& run, const std::vector<trial>& trials)
{
    const std::size_t rows = run.task == task_kind::choose ? 1 : run.methods.size();
    cell_values sums(rows, std::vector<double>(run.motions.size(), 0.0));
    std::vector<std::vector<std::size_t>> counts(rows, std::vector<std::size_t>(run.motions.size(), 0));
    for (const trial& t : trials) {
        const std::size_t row = run.task == task_kind::choose ? 0 : t.method_1;
        sums[row][t.motion] += score_of(t, run);
        ++counts[row][t.motion];
    }
    for (std::size_t i = 0; i < rows; ++i)
        for (std::size_t j = 0; j < run.motions.size(); ++j) {
            if (counts[i][j] == 0)
                return {};
            sums[i][j] /= static_cast<double>(counts[i][j]);
        }
    return sums;
}

double rounding_in(const run_outline& run) noexcept
{
    return few_digits * (run.task == task_kind::rate ? static_cast<double>(run.scale) : 100.0);
}

std::optional<double> compared_value(const run_outline& run, const cell_values& cells)
{
    if (run.task != task_kind::rate)
        return mean(cells.back());
    if (cells.size() < 2)
        return {};
    const double difference = mean(cells.back()) - mean(cells.front());
    return std::abs(difference) > rounding_in(run) ? difference : 0.0;
}

double first_chosen(const std::vector<trial>& trials)
{
    const auto first =
        std::count_if(trials.begin(), trials.end(), [](const trial& t) { return t.response == 1; });
    return 100.0 * static_cast<double>(first) / static_cast<double>(trials.size());
}

} // namespace tactor::study
