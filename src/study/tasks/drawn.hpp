// SPDX-License-Identifier: MIT
/// \file
/// A task whose answer is a place or a path that the participant draws on the page, on a picture of the hand.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "study/results/drawings.hpp"
#include "study/tasks/balanced.hpp"

namespace tactor::study {

class drawn_task : public balanced_task {
public:
    drawn_task(facts f, drawing_kind kind) : balanced_task(std::move(f), list_methods), kind_(kind) {}

    trial_answers list_answers(const run_definition& r, const page_words& w) const override;
    void record_answer(trial_row& row, const run_definition& r, const trial_answer& answer) const override;
    std::vector<std::string> list_responses(const run_outline&) const override { return {}; }
    std::string name_response(const run_outline&, std::string_view) const override { return {}; }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override;
    void score(trial& r, const run_outline& o, std::string_view method_1,
               const trial_answer& answer) const override;

    // Results.

    std::vector<named_value> measure(const run_outline& o, const std::vector<trial>& trials,
                                     sigmoid kind) const override;
    std::vector<std::vector<result_outline>> outline_results() const override;
    std::vector<result> analyse(const run_outline& o, const run_people& people, sigmoid kind) const override;
    main_comparison name_comparison(const run_outline& o) const override;
    std::vector<std::string_view> list_columns(const run_outline& o) const override;
    named_texts describe_trial(const trial& t, const run_outline& own,
                               const run_outline& whole) const override;
    std::string format_r_model(const run_outline& o, const model_factors& f) const override;

private:
    drawing_kind kind_;
};

} // namespace tactor::study
