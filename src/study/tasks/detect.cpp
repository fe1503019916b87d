// SPDX-License-Identifier: MIT
#include "study/data/text_table.hpp"
#include "study/experiment/simulated.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

class detect final : public task {
public:
    detect()
        : task({.name = "detect",
                .trial = "One stimulus or none",
                .response = "Whether a stimulus was felt: 1 yes, 2 no",
                .questions = {"Did you feel it?", "Did you feel it?", "Did you feel it?"},
                .keys = {"choices", "catch", "vary", "values", "trials_per_value"},
                .measures = true})
    {
    }

    void read_outline(const detail::toml_table& t, run_definition& r) const override
    {
        run_outline& o = r.outline;
        r.catch_share = t.number("catch", {0.0, 0.9}).value_or(0.0);
        o.catches = r.catch_share > 0.0;
        if (o.catches)
            refuse_method_name(t, o, catch_name);
        if (t.has("vary"))
            read_values(t, o, read_vary(t, o));
        read_trials(t, o);
    }
    std::vector<std::string> usual_choices(const page_words& w) const override { return {w["yes"], w["no"]}; }

    std::vector<planned_trial> list_cells(const run_definition& r) const override
    {
        return list_value_cells(r, false);
    }

    void read_row(trial& r, const text_table& t, std::size_t row, const run_outline& o) const override
    {
        const bool is_silent = o.catches && t.need(row, "method_1") == catch_name;
        if (!is_silent && !o.vary.empty())
            read_comparison(r, t, row, o);
        else if (!is_silent)
            r.method_1 = find_place(t, row, "method_1", o.methods);
        else if (!o.vary.empty() && t.cell(row, "value"))
            t.refuse(row, "a trial without a stimulus has a value", "n/a");
        score(r, o, t.need(row, "method_1"), read_one_of_two(t, row));
    }
    void score(trial& r, const run_outline& o, std::string_view method_1, double answer) const override
    {
        task::score(r, o, method_1, answer);
        r.positive = r.response == 1;
        r.signal = !o.catches || method_1 != catch_name;
    }

    double simulate(const simulated_run& who, const planned_trial& t, random_numbers& r) const override
    {
        if (double key = 0.0; lapses(who, r, key))
            return key;
        const bool is_silent = who.definition.methods[t.method_1].silent;
        if (is_silent && !who.run.outline.vary.empty())
            return 2;
        if (const auto value = find_value(who.definition, t))
            return feels_more(who, *value, r) ? 1 : 2;
        const double felt = is_silent ? 0.0 : who.truth.dprime;
        return felt + r.normal() > 0.5 * who.truth.dprime ? 1 : 2;
    }
};

} // namespace

const task& detect_task()
{
    static const detect one;
    return one;
}

} // namespace tactor::study
