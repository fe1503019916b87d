// SPDX-License-Identifier: MIT
#include "cli/compare_rows.hpp"

#include <algorithm>

#include "cli/option_words.hpp"

namespace tactor::cli {

bool comparison::playable() const
{
    return std::any_of(rows.begin(), rows.end(),
                       [](const comparison_row& r) { return r.schedule.has_value(); });
}

comparison compare(const stroke& s, const array& a, const layout& faces, const plan_options& options,
                   const comparison_choice& choice)
{
    comparison c{s};
    for (const algorithm method : choice.algorithms)
        for (const phantom_kind phantom : choice.phantoms) {
            comparison_row row{method, phantom};
            plan_options o = options;
            o.method = method;
            o.phantom = phantom;
            try {
                plan p = make_plan(a, faces, s, o);
                std::vector<percept_sample> samples = predict_percept(a, s, p);
                row.felt = summarise(samples);
                row.schedule = std::move(p);
                if (choice.keep_samples)
                    row.samples = std::move(samples);
            } catch (const error& e) {
                if (e.kind() != errc::bad_input)
                    throw;
                row.refused = in_options(e);
            }
            c.rows.push_back(std::move(row));
        }
    return c;
}

} // namespace tactor::cli
