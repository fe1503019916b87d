// SPDX-License-Identifier: MIT
#include "percept/compare.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace tactor::detail {

namespace {

prediction predict_low_speed(const array& a, const stroke& s, const plan& p, const low_speed_observer& o)
{
    prediction r;
    if (p.curve) {
        r.unpredicted = "continuous has no bursts, and this observer feels taps";
    } else {
        r.taps = predict_taps(a, s, p, o);
        r.tapped = summarise(r.taps);
        r.felt.rms_error_mm = r.tapped.rms_error_mm;
        r.felt.largest_error_mm = r.tapped.largest_error_mm;
    }
    return r;
}

void predict_people(comparison_row& row, const stroke& s, const array& a, const comparison_choice& choice,
                    const std::vector<drawn_person>& people)
{
    if (people.empty() || !row.unpredicted.empty())
        return;
    std::optional<low_speed_observer> taps;
    if (choice.observer.kind == observer_kind::low_speed)
        taps = choice.observer.low_speed;
    row.spread = predict_spread(people, a, s, *row.plan, taps, choice.keep_samples, choice.after_person);
}

// Predicts all rows at once, since they share the target.
void predict_centroids(comparison& c, const array& a, bool keep_samples)
{
    std::vector<comparison_row*> rows;
    std::vector<const plan*> plans;
    for (comparison_row& row : c.rows)
        if (row.plan) {
            rows.push_back(&row);
            plans.push_back(&*row.plan);
        }
    try {
        const std::vector<percept_summary> felt = predict_summaries(a, c.target, plans);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            rows[i]->felt = felt[i];
            if (keep_samples)
                rows[i]->samples = predict_percept(a, c.target, *plans[i]);
        }
    } catch (const error& e) {
        // The target is too long for any plan.
        if (e.kind() != error_kind::bad_input)
            throw;
        for (comparison_row* row : rows) {
            row->plan.reset();
            row->refused = e;
        }
    }
}

} // namespace

std::string prediction_note(const observer_choice& o)
{
    const std::string model = "a model's prediction, not a measurement: ";
    if (o.kind == observer_kind::low_speed)
        return model + describe(o.low_speed);
    return model + "the felt position is taken to be the centre of energy of the tactors that sound";
}

prediction predict(const array& a, const stroke& s, const plan& p, const observer_choice& o,
                   const std::function<void(const percept_sample&)>& each)
{
    if (o.kind == observer_kind::low_speed)
        return predict_low_speed(a, s, p, o.low_speed);
    const plan* const one = &p;
    return {.felt = predict_summaries(a, s, {&one, 1}, each).front()};
}

bool comparison::playable() const
{
    return std::any_of(rows.begin(), rows.end(), [](const comparison_row& r) { return r.plan.has_value(); });
}

comparison compare(const stroke& target, const array& a, const layout& faces, const plan_options& options,
                   const comparison_choice& choice)
{
    // The caller's choices count here, not the stroke's: plans are compared side by side.
    stroke s = target;
    s.choices.algorithm.reset();
    s.choices.phantom.reset();
    s.choices.faces.reset();
    comparison c{s, choice.observer, choice.compensate, choice.spread, options.faces};
    const std::vector<drawn_person> people = draw_people(choice.spread, a.tactors.size());
    for (const algorithm_kind algorithm : choice.algorithms)
        for (const phantom_kind phantom : choice.phantoms) {
            comparison_row row{{}, algorithm, phantom};
            plan_options o = options;
            o.algorithm = algorithm;
            o.phantom = phantom;
            try {
                row.plan = choice.compensate
                               ? make_compensated_plan(a, faces, s, o, choice.observer.low_speed).plan
                               : make_plan(a, faces, s, o);
                if (choice.observer.kind == observer_kind::low_speed)
                    static_cast<prediction&>(row) =
                        predict_low_speed(a, s, *row.plan, choice.observer.low_speed);
                predict_people(row, s, a, choice, people);
            } catch (const error& e) {
                if (e.kind() != error_kind::bad_input)
                    throw;
                row.plan.reset();
                row.refused = e;
            }
            c.rows.push_back(std::move(row));
        }
    if (choice.observer.kind == observer_kind::centroid)
        predict_centroids(c, a, choice.keep_samples);
    return c;
}

} // namespace tactor::detail
