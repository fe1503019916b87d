// SPDX-License-Identifier: MIT
/// \file
/// Descriptions of the members of each value in the results. JSON and the schema tactor-analysis/1 follow
/// from these descriptions. describe_row_member(io, name, value) describes a value as one member of an
/// object.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/members.hpp"
#include "study/results/result.hpp"

namespace tactor::study {

using detail::about;
using detail::by_name;
using detail::nullable;

inline constexpr detail::bounds probability{0.0, 1.0};
inline constexpr const char* paired_test = "paired t test, two-sided";
inline constexpr const char* unpaired_test = "t test with the pooled sd of all groups, two-sided";
inline constexpr about f_test{"F, degrees of freedom and p; for epsilon and Mauchly's W see tactor-json(5)"};

/// Returns both ends of an interval.
inline std::optional<std::array<double, 2>> list_ends(const std::optional<interval>& i)
{
    return i ? std::optional(std::array{i->first, i->second}) : std::nullopt;
}

template <class Io>
void describe_mean_members(Io& io, const t_test& t)
{
    constexpr about ends{"both ends of the 95 % interval"};
    io.describe_or_null("mean", t.mean, {"mean over participants"});
    io.describe_or_null("se", t.se, {"standard error", detail::from_0});
    io.describe_or_null("ci", list_ends(t.ci), ends);
    io.describe_or_null("ci_within", list_ends(t.ci_within), {"the same within participants"});
}

/// Describes t, its degrees of freedom and p. `text`: name of the test.
template <class Io>
void describe_t_members(Io& io, const t_test& t, const char* text)
{
    io.describe_or_null("t", t.t, {text});
    io.describe_or_null("df", t.df, {text, {1.0, detail::from_0.high}});
    io.describe_or_null("p", t.p, {text, probability});
}

/// Describes the test of a pair. `d`: name of the effect size.
template <class Io>
void describe_difference_members(Io& io, const paired_comparison& c, const char* text, const std::string& d)
{
    io.describe_or_null("difference", c.test.mean, {"mean of a minus mean of b"});
    io.describe_or_null("ci", list_ends(c.test.ci), {"both ends of its 95 % interval"});
    describe_t_members(io, c.test, text);
    io.describe_or_null("p_holm", c.p_holm, {"p adjusted by Holm for all pairs", probability});
    io.describe_or_null(d.c_str(), c.test.d, {"difference / sd"});
    io.describe_or_null((d + "_ci").c_str(), list_ends(c.test.d_ci), {"both ends of its 95 % interval"});
}

template <class Io>
void describe_test_members(Io& io, const t_test& t)
{
    describe_mean_members(io, t);
    describe_t_members(io, t, "t test, two-sided");
    io.describe_or_null("p_signflip", t.p_signflip,
                        {"exact p of the permutation test that changes signs", probability});
    io.describe_or_null("d", t.d, {"effect size"});
    io.describe_or_null("d_ci", list_ends(t.d_ci), {"both ends of its 95 % interval"});
}

template <class Io>
void describe_row_member(Io& io, const char* name, const std::monostate&)
{
    io.describe_or_null(name, std::optional<double>(), {"not computed"});
}

template <class Io>
void describe_row_member(Io& io, const char* name, const std::string& v)
{
    io(name, v, {"see tactor-json(5)"});
}

template <class Io>
void describe_row_member(Io& io, const char* name, double v)
{
    io(name, v, {"see tactor-json(5)"});
}

template <class Io>
void describe_row_member(Io& io, const char* name, const cell_means& v)
{
    const auto describe = [&v](auto& inner, const t_test& t) {
        v.against ? describe_test_members(inner, t) : describe_mean_members(inner, t);
    };
    io.object(name, {"means over participants"}, [&](auto& inner) {
        inner.object("all", {"for the participants' means over motions"},
                     [&](auto& all) { describe(all, v.means.front().test); });
        inner.named_objects("motion", std::vector(v.means.begin() + 1, v.means.end()), {"by motion"},
                            [&](auto& one, const cell_mean& m) {
                                describe(one, m.test);
                                if (v.against)
                                    one.describe_or_null("p_holm", m.p_holm,
                                                         {"p adjusted by Holm for all motions", probability});
                            });
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const interval_share& v)
{
    io.object(name, {"per cent of trials in which people chose the first interval"}, [&v](auto& inner) {
        inner.describe_or_null("mean", v.test.mean, {"mean over participants"});
        inner.describe_or_null("t", v.test.t, {"t test against 50"});
        inner.describe_or_null("p", v.test.p, {"t test against 50", probability});
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const method_difference& v)
{
    io.object(name, {"the last method minus the first"}, [&t = v.test](auto& inner) {
        inner.describe_or_null("difference", t.mean, {"mean difference"});
        inner.describe_or_null("ci", list_ends(t.ci), {"both ends of its 95 % interval"});
        describe_t_members(inner, t, paired_test);
        inner.describe_or_null("p_signflip", t.p_signflip,
                               {"exact p of the permutation test that changes signs", probability});
        inner.describe_or_null("d_z", t.d, {"mean / sd of the differences"});
        inner.describe_or_null("d_z_ci", list_ends(t.d_ci), {"both ends of its 95 % interval"});
    });
}

template <class Io>
void describe_effect_members(Io& io, const effect& e)
{
    const auto df = [](double v) { return v > 0.0 ? std::optional(v) : std::nullopt; };
    const auto bounded = [](const detail::bounds& range) { return about{f_test.text, range}; };
    io.describe_or_null("F", e.f, bounded(detail::from_0));
    io.describe_or_null("df1", df(e.df1), bounded({1.0, detail::from_0.high}));
    io.describe_or_null("df2", df(e.df2), bounded({1.0, detail::from_0.high}));
    io.describe_or_null("p", e.p, bounded(probability));
    io.describe_or_null("epsilon_gg", e.epsilon_gg, bounded(probability));
    io.describe_or_null("p_gg", e.p_gg, bounded(probability));
    io.describe_or_null("epsilon_hf", e.epsilon_hf, bounded(detail::from_0));
    io.describe_or_null("p_hf", e.p_hf, bounded(probability));
    io.describe_or_null("mauchly_w", e.mauchly_w, bounded(probability));
    io.describe_or_null("mauchly_p", e.mauchly_p, f_test); // the approximation of p may exceed 1
    io.describe_or_null("eta2_partial", e.eta2_partial, {"partial eta squared", probability});
    io.describe_or_null("eta2_generalised", e.eta2_generalised, {"generalised eta squared", probability});
}

template <class Io>
void describe_effects_members(Io& io, const effect_list& v)
{
    for (const auto& [factor, e] : v.effects)
        io.object_or_null(factor.c_str(), e, {"an effect; null if a factor has one level"},
                          [](auto& one, const effect& its) { describe_effect_members(one, its); });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const effect_list& v)
{
    io.object(name, {"analysis of variance"}, [&v](auto& inner) { describe_effects_members(inner, v); });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const tukey_list& v)
{
    io.list(name, v.pairs, {"all pairs of motions"}, [&v](auto& inner, const comparison& c, std::size_t) {
        inner.describe_derived("a", [&] { return v.motions[c.a]; }, {"the first motion"});
        inner.describe_derived("b", [&] { return v.motions[c.b]; }, {"the second motion"});
        inner("difference", c.difference, {"mean of a minus mean of b"});
        inner.describe_or_null("q", c.q, {"studentized range", detail::from_0});
        inner.describe_or_null("p", c.p, {"its p", probability});
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const paired_list& v)
{
    io.list(name, v.pairs, {"all pairs of motions"},
            [&v](auto& inner, const paired_comparison& c, std::size_t) {
                inner.describe_derived("a", [&] { return v.motions[c.a]; }, {"the first motion"});
                inner.describe_derived("b", [&] { return v.motions[c.b]; }, {"the second motion"});
                inner.describe_or_null("difference", c.test.mean, {"mean of a minus mean of b"});
                describe_t_members(inner, c.test, paired_test);
                inner.describe_or_null("p_holm", c.p_holm, {"p adjusted by Holm for all pairs", probability});
            });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const figure_comparison& v)
{
    io.object(name, {"a figure compared within participants"}, [&v](auto& inner) {
        inner("n", v.all.means.empty() ? std::size_t{} : v.all.means.front().n,
              {"participants with the figure at each level"});
        inner.named_objects("means", v.levels, v.all.means, {"by level"},
                            [](auto& one, const t_test& t) { describe_mean_members(one, t); });
        inner.list("pairs", v.pairs, {"all pairs of levels"},
                   [&v](auto& one, const paired_comparison& c, std::size_t) {
                       one.describe_derived("a", [&] { return v.levels[c.a]; }, {"the first level"});
                       one.describe_derived("b", [&] { return v.levels[c.b]; }, {"the second level"});
                       describe_difference_members(one, c, paired_test, "d_z");
                   });
        inner.object_or_null("anova", v.anova, {"effect of the levels; null with two or one"},
                             [](auto& one, const effect& e) { describe_effect_members(one, e); });
        inner.object_or_null(
            "group_anova", v.groups, {"effects of groups, levels and both; null if groups are not compared"},
            [&v](auto& one, const effect_list&) { describe_effects_members(one, *v.groups); });
        inner.named_objects("group_means", list_groups(v), v.by_group,
                            {"means over the levels, by group; empty if groups are not compared"},
                            [](auto& one, const level_means& m) {
                                const t_test& t = m.overall;
                                one("n", t.n, {"participants of the group with the figure"});
                                one.describe_or_null("mean", t.mean, {"mean over participants"});
                                one.describe_or_null("se", t.se, {"standard error", detail::from_0});
                                one.describe_or_null("ci", list_ends(t.ci),
                                                     {"both ends of the 95 % interval"});
                            });
        inner.list("group_pairs", v.group_pairs, {"all pairs of groups; empty if groups are not compared"},
                   [names = list_groups(v)](auto& one, const paired_comparison& c, std::size_t) {
                       one.describe_derived("a", [&] { return names[c.a]; }, {"the first group"});
                       one.describe_derived("b", [&] { return names[c.b]; }, {"the second group"});
                       describe_difference_members(one, c, unpaired_test, "d");
                   });
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const worth_list& v)
{
    by_name<nullable<double>> worths;
    by_name<nullable<double>> errors;
    for (std::size_t m = 0; m < v.methods.size(); ++m) {
        worths.all.push_back({v.methods[m], {v.worths[m].log_worth}});
        errors.all.push_back({v.methods[m], {v.worths[m].se}});
    }
    io.object(name, {"worths by the model of Bradley and Terry"}, [&](auto& inner) {
        inner("log_worth", worths, {"logarithm of the worth, by method"});
        inner("se", errors, {"standard errors, by method", detail::from_0});
        inner.describe_derived("reference", [&] { return v.methods.front(); }, {"the first method"});
    });
}

template <class Io>
void describe_map_members(Io& io, const std::vector<std::string>& methods, const scaled_methods& m)
{
    by_name<std::array<double, 2>> places;
    for (std::size_t i = 0; i < m.scaled.places.size(); ++i)
        places.all.emplace_back(methods[i], m.scaled.places[i]);
    io("differences", m.differences, {"by method and method, in their order", {0.0, 100.0}});
    io("places", places, {"x and y by method, in the unit of the differences"});
    io("stress", m.scaled.stress, {"Kruskal's stress-1 of the distances between places", detail::from_0});
}

template <class Io>
void describe_row_member(Io& io, const char* name, const method_map& v)
{
    io.object(name, {"methods in a plane, by classical scaling of the differences"}, [&](auto& inner) {
        inner("methods", v.methods, {"names in the order of the definition"});
        describe_map_members(inner, v.methods, v.all);
        inner.named_objects(
            "participants", v.codes, v.people, {"the same by code"},
            [&](auto& one, const scaled_methods& m) { describe_map_members(one, v.methods, m); });
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const answer_counts& v)
{
    by_name<by_name<std::size_t>> all;
    for (std::size_t i = 0; i < v.motions.size(); ++i) {
        by_name<std::size_t>& row = all.all.emplace_back(v.motions[i], by_name<std::size_t>()).second;
        for (std::size_t k = 0; k < v.motions.size(); ++k)
            row.all.emplace_back(v.motions[k], v.counts[i][k]);
    }
    io(name, all, {"number of answers, by motion played and motion answered"});
}

template <class Io>
void describe_function_members(Io& io, const fitted_function& m)
{
    const auto parameter = [&m](double psychometric::*p) {
        return m.fit ? std::optional(m.fit->parameters.*p) : std::nullopt;
    };
    constexpr about fitted{"parameters of the function, and figures that follow from them"};
    io.describe_or_null("alpha", parameter(&psychometric::threshold), fitted);
    io.describe_or_null("beta", parameter(&psychometric::slope), {fitted.text, detail::from_0});
    io.describe_or_null("lapse", parameter(&psychometric::lapse), {fitted.text, probability});
    io("guess", m.guess, {fitted.text, probability});
    io.describe_or_null("pse", m.pse, fitted);
    io.describe_or_null("jnd", m.jnd, {fitted.text, detail::from_0});
    io.describe_or_null("threshold", parameter(&psychometric::threshold), fitted);
    io.object("ci", {"bootstrapped 95 % intervals"}, [&m](auto& ci) {
        constexpr about ends{"both ends"};
        ci.describe_or_null("pse", list_ends(m.pse ? m.bootstrap.threshold : std::nullopt), ends);
        ci.describe_or_null("jnd", list_ends(m.jnd_ci), ends);
        ci.describe_or_null("threshold", list_ends(m.bootstrap.threshold), ends);
    });
    io.describe_or_null("deviance", m.fit ? std::optional(m.fit->deviance) : std::nullopt,
                        {"deviance of the fit", detail::from_0});
    io.describe_or_null("p_gof", m.bootstrap.p_gof, {"its p from the bootstrap", probability});
    io.list("answers", m.blocks, {"answers by value, ascending"},
            [](auto& one, const answer_block& b, std::size_t) {
                one("value", b.x, {"the value"});
                one("n", b.n, {"its trials", detail::above_0});
                one("positive", b.k, {"trials with a positive answer"});
            });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const psychometric_functions& v)
{
    by_name<nullable<double>> means;
    for (const measured_figure& f : v.figures)
        means.all.push_back({f.name, {f.test.mean}});
    io.object(name, {"psychometric functions"}, [&](auto& inner) {
        inner.one_of("function", v.family.kind == sigmoid::normal ? "normal" : "logistic",
                     {"normal", "logistic"}, {"kind of the function"});
        inner.one_of("axis", v.on_db_axis ? "dB" : "linear", {"dB", "linear"}, {"axis of the values"});
        inner.named_objects("participants", v.codes, v.people, {"by code"},
                            [](auto& one, const fitted_function& m) { describe_function_members(one, m); });
        inner("mean", means, {"means of the figures over participants"});
        inner.named_objects("tests", v.figures, {"tests of the figures"},
                            [](auto& one, const measured_figure& f) { describe_test_members(one, f.test); });
    });
}

/// Lists the participants who have figures.
template <class Person>
std::pair<std::vector<std::string>, std::vector<Person>>
list_measured_people(const measured<std::optional<Person>>& v)
{
    std::pair<std::vector<std::string>, std::vector<Person>> all;
    for (std::size_t i = 0; i < v.codes.size(); ++i)
        if (v.people[i]) {
            all.first.push_back(v.codes[i]);
            all.second.push_back(*v.people[i]);
        }
    return all;
}

template <class Io>
void describe_ratio_member(Io& io, const std::optional<difference_test>& ratio)
{
    io.object_or_null("likelihood_ratio", ratio, {"likelihood ratio of d' against 0, or null"},
                      [](auto& one, const difference_test& d) {
                          one("value", d.likelihood_ratio, {"the ratio", detail::from_0});
                          one("p", d.p, {"its p", probability});
                          one("studies", d.studies, {"number of simulated studies", detail::above_0});
                      });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const sensitivities& v)
{
    const auto [codes, people] = list_measured_people(v);
    io.object(name, {"sensitivity"}, [&, &codes = codes, &people = people](auto& inner) {
        inner.named_objects("participants", codes, people, {"by code"}, [](auto& one, const detection& d) {
            constexpr about rates{"corrected rates", probability};
            one("hits", d.hits, rates);
            one("false_alarms", d.false_alarms, rates);
            one("dprime", d.found.dprime, {"d'"});
            one("c", d.found.c, {"criterion"});
        });
        describe_test_members(inner, v.figures.front().test);
        describe_ratio_member(inner, v.ratio);
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const oddities& v)
{
    const auto [codes, people] = list_measured_people(v);
    io.object(name, {"sensitivity"}, [&, &codes = codes, &people = people](auto& inner) {
        inner.named_objects("participants", codes, people, {"by code"}, [](auto& one, const odd_answers& o) {
            one("right", o.counts.right, {"number of right answers"});
            one("trials", o.counts.trials, {"number of trials", detail::above_0});
            one("dprime", o.dprime, {"d'", detail::from_0});
        });
        describe_mean_members(inner, v.figures.front().test);
        inner.object("correct", {"right answers, per cent"},
                     [&v](auto& one) { describe_mean_members(one, v.figures.back().test); });
        describe_ratio_member(inner, v.ratio);
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const exponents& v)
{
    by_name<nullable<double>> people;
    for (std::size_t i = 0; i < v.codes.size(); ++i)
        people.all.push_back({v.codes[i], {v.people[i].exponent}});
    io.object(name, {"exponents"}, [&](auto& inner) {
        inner("participants", people, {"by code"});
        describe_test_members(inner, v.figures.front().test);
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const adjustments& v)
{
    io.object(name, {"values that participants adjusted to the standard"}, [&](auto& inner) {
        inner.named_objects(
            "participants", v.codes, v.people, {"by code"}, [](auto& one, const adjustment& a) {
                one.describe_or_null("constant_error", a.constant_error, {"pse minus the standard"});
                one.describe_or_null("pse", a.pse, {"mean of the values"});
                one.describe_or_null("sd", a.sd, {"their standard deviation", detail::from_0});
            });
        inner.object("constant_error", {"mean constant error, tested against 0"},
                     [&](auto& one) { describe_test_members(one, v.figures.front().test); });
        const std::vector<measured_figure> others(v.figures.begin() + 1, v.figures.end());
        inner.named_objects("means", others, {"means of pse and sd over participants"},
                            [](auto& one, const measured_figure& f) { describe_mean_members(one, f.test); });
    });
}

/// Returns points as pairs of x and y. For a place, returns only the first point.
inline std::optional<std::vector<std::array<double, 2>>> list_points(const std::vector<point>& all,
                                                                     drawing_kind kind)
{
    if (all.empty())
        return {};
    std::vector<std::array<double, 2>> listed;
    for (const point& p : all) {
        listed.push_back({p.x_mm, p.y_mm});
        if (kind == drawing_kind::place)
            break;
    }
    return listed;
}

/// Lists the participants' figures by code and name.
template <class Person>
by_name<by_name<nullable<double>>> list_values_by_code(const measured<Person>& v)
{
    by_name<by_name<nullable<double>>> people;
    for (std::size_t i = 0; i < v.codes.size(); ++i) {
        by_name<nullable<double>>& own =
            people.all.emplace_back(v.codes[i], by_name<nullable<double>>()).second;
        for (std::size_t k = 0; k < v.figures.size(); ++k)
            own.all.push_back({v.figures[k].name, {v.values[i][k]}});
    }
    return people;
}

template <class Io>
void describe_row_member(Io& io, const char* name, const interval_effects& v)
{
    io.object(name, {"a figure by the interval that held the standard or the stimulus"}, [&](auto& inner) {
        inner("figure", v.figure, {"pse, or right: per cent of right answers"});
        inner("participants", list_values_by_code(v), {"difference, second minus first, and both, by code"});
        inner.object("difference", {"mean difference, tested against 0"},
                     [&](auto& one) { describe_test_members(one, v.figures.front().test); });
        inner.named_objects("means", std::vector(v.figures.begin() + 1, v.figures.end()),
                            {"means of both over participants"},
                            [](auto& one, const measured_figure& f) { describe_mean_members(one, f.test); });
    });
}

template <class Io>
void describe_row_member(Io& io, const char* name, const drawn_answers& v)
{
    io.object(name, {"figures of drawings"}, [&](auto& inner) {
        inner("participants", list_values_by_code(v), {"figures by code"});
        inner.named_objects("means", v.figures, {"means of the figures over participants"},
                            [](auto& one, const measured_figure& f) { describe_mean_members(one, f.test); });
        constexpr about points{"points at equal parts of the length, mm; null with several motions"};
        inner.describe_or_null("target", list_points(v.target, v.kind), points);
        inner.describe_or_null("mean", list_points(v.mean, v.kind), points);
        std::vector<std::string> observers;
        for (const predicted_drawing& p : v.predicted)
            observers.push_back(p.observer);
        inner.named_objects(
            "predicted", observers, v.predicted, {"drawings predicted, by observer"},
            [&](auto& one, const predicted_drawing& p) {
                one.describe_or_null("points", list_points(p.points, v.kind), points);
                one("distance", p.distance_mm, {"mean distance from the mean drawing, mm", detail::from_0});
                one("frechet", p.frechet_mm, {"Frechet distance from the mean drawing, mm", detail::from_0});
            });
    });
}

template <class Io, detail::either<response_times> Times>
void members(Io& io, Times& v)
{
    by_name<nullable<double>> by;
    for (const auto& [condition, median_s] : v.by)
        by.all.push_back({condition, {median_s}});
    io.describe_or_null("median_s", v.median_s, {"median of the participants' medians, s"});
    io("by", by, {"the same by condition"});
}

template <class Io, detail::either<person_track> Track>
void members(Io& io, Track& v)
{
    io("participant", v.participant, {"code"});
    io.describe_or_null("session", v.track.session,
                        {"number of the session; null if there is only one", detail::above_0});
    io("track", v.track.track, {"number of the track, as in the tables", detail::above_0});
    constexpr about condition{"what it measures, and how"};
    io("motion", v.track.motion, condition);
    io("method", v.track.method, condition);
    io("procedure", v.track.procedure, condition);
    io("trials", v.track.trials, {"its trials that count, with those left out by drop_rule", detail::from_0});
    io("ended", v.track.ended, {"whether track_rule ended it"});
    io.describe_or_null("reversals", v.track.reversals, {"reversals of a staircase", detail::from_0});
    io.describe_or_null("sd", v.track.sd,
                        {"quest: posterior standard deviation of the threshold", detail::from_0});
}

template <class Io, detail::either<excluded_person> Person>
void members(Io& io, Person& v)
{
    io("participant", v.participant, {"code"});
    io("why", v.why, {"reason"});
}

} // namespace tactor::study
