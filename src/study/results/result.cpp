// SPDX-License-Identifier: MIT
#include "study/results/result.hpp"

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"

namespace tactor::study {
namespace {

// Collector of the reasons why figures in a run's rows are missing or doubtful.
class weak_figures {
public:
    explicit weak_figures(const run_analysis& r) : run_(r)
    {
        for (const bool of_pairs : {false, true}) // comparisons of pairs come last
            for (const result& row : r.results)
                if (of_pairs == (std::holds_alternative<tukey_list>(row.value) ||
                                 std::holds_alternative<paired_list>(row.value)))
                    std::visit(*this, row.value);
    }

    explained_figures finish()
    {
        for (const noted& n : noted_) {
            std::vector<std::string> whose;
            for (const auto& [code, conditions] : n.whose)
                if (!conditions.empty())
                    whose.push_back("sub-" + code +
                                    (conditions.size() < n.conditions
                                         ? fmt::format(" ({})", fmt::join(conditions, ", "))
                                         : ""));
            if (!whose.empty())
                add(n.figure, fmt::format("{}: {}{}", n.why, fmt::join(whose, ", "), n.hint),
                    n.hint.empty() ? all_.missing : all_.doubtful);
        }
        if (run_.n == 1)
            all_.missing.push_back(run_.run.name + ": one participant: tests need two");
        return std::move(all_);
    }

    template <class T>
    void operator()(const T&)
    {
    }

    void operator()(const cell_means& v)
    {
        for (const cell_mean& m : v.means) {
            const std::string name = v.method.empty() ? m.name : v.method + ", " + m.name;
            if (v.against)
                explain(name, m.test);
            else if (m.test.n > 1 && !m.test.ci)
                add(name, "no variance over participants, so no interval");
            const std::size_t conditions = &m == v.means.data() ? v.rows : v.rows * (v.means.size() - 1);
            if (m.test.n > 1 && conditions > 1 && !m.test.ci_within)
                add(name, "no variance within participants, so no interval within participants");
        }
    }

    void operator()(const interval_share& v) { explain("first interval", v.test); }
    void operator()(const method_difference& v) { explain("methods", v.test); }

    void operator()(const worth_list& v)
    {
        for (std::size_t i = 0; i < v.worths.size(); ++i)
            if (run_.n != 0 && !v.worths[i].log_worth)
                add("worth of " + v.methods[i],
                    fmt::format("the choices between {} and {}, directly and through other methods, all go "
                                "one way or are missing, so this worth is not finite",
                                v.methods[i], v.methods[0]));
    }

    void operator()(const effect_list& v)
    {
        for (const auto& [effect_name, e] : v.effects) {
            const std::string name = (v.of_groups ? "groups compared, " : "") + effect_name;
            if (!e)
                continue;
            if (e->ms_error && !e->f)
                add(name, "the error has no variance, so no F");
            if (e->epsilon_gg && !e->epsilon_hf)
                add(name, "too few participants for the epsilon of Huynh and Feldt");
            if (e->epsilon_gg && !e->mauchly_w)
                add(name, "too few participants, or too little variance, for Mauchly's test");
        }
        if (v.of_groups && !v.effects.front().second->ms_error)
            add("groups", "too few participants to compare them");
    }

    void operator()(const tukey_list& v)
    {
        if (!v.pairs.empty() && !v.pairs[0].q && run_.n > 1)
            add(v.method.empty() ? "motion" : v.method, "the error has no variance, so no Tukey");
    }

    void operator()(const paired_list& v) { explain_pairs(v.method, v.motions, v.pairs); }

    void operator()(const figure_comparison& v)
    {
        if (v.groups && v.groups->effects.front().second && !v.groups->effects.front().second->ms_error)
            add("groups, " + v.figure, "too few participants to compare them");
        explain_pairs(v.figure, v.levels, v.pairs);
    }

    void operator()(const psychometric_functions& v)
    {
        note_missing(v);
        note(v, "lapse",
             fmt::format("it is at its limit of {}, so the slope may be wrong", v.family.most_lapse),
             " (see whether they mixed up the keys; add practice, or easier values)", [&](std::size_t i) {
                 return v.people[i].fit && v.people[i].fit->parameters.lapse >= v.family.most_lapse;
             });
        note(v, "guess",
             fmt::format("it is at its limit of {}: they felt something in most trials without a stimulus",
                         most_guess),
             " (see whether they mixed up the keys; add training)",
             [&](std::size_t i) { return v.people[i].guess >= most_guess; });
        note(v, "jnd", "it is larger than the range of the values", " (test values that are farther apart)",
             [&](std::size_t i) {
                 const fitted_function& f = v.people[i];
                 return f.jnd && *f.jnd > f.blocks.back().x - f.blocks.front().x;
             });
    }
    void operator()(const sensitivities& v) { note_missing(v); }
    void operator()(const oddities& v) { note_missing(v); }
    void operator()(const exponents& v) { note_missing(v); }
    void operator()(const adjustments& v) { note_missing(v); }
    void operator()(const interval_effects& v)
    {
        explain("time order", v.figures.front().test);
        note(v, "time order", "the answers of one order do not determine it", "",
             [&](std::size_t i) { return !v.values[i].front(); });
    }
    void operator()(const drawn_answers& v) { note_missing(v); }

private:
    // A missing or doubtful figure, with the affected conditions of each participant.
    struct noted {
        std::string figure;
        std::string why;
        std::string hint;           // empty if the figure is missing
        std::size_t conditions = 0; // number of all conditions
        std::vector<std::pair<std::string, std::vector<std::string>>> whose = {};
    };

    void add(std::string_view figure, std::string_view why, std::vector<std::string>& to)
    {
        to.push_back(fmt::format("{}: {}: {}", run_.run.name, figure, why));
    }
    void add(std::string_view figure, std::string_view why) { add(figure, why, all_.missing); }

    void explain(std::string_view figure, const t_test& t)
    {
        if (t.n < 2)
            return;
        if (!t.t)
            add(figure, "no variance over participants, so no t test");
        else if (!t.d_ci)
            add(figure, "the effect is too large for an interval");
        if (!t.p_signflip)
            add(figure, "too many participants for the exact test");
    }

    void explain_pairs(std::string_view of, const std::vector<std::string>& levels,
                       const std::vector<paired_comparison>& pairs)
    {
        for (const paired_comparison& c : pairs)
            if (c.test.n > 1 && !c.test.t)
                add(fmt::format("{}, {} - {}", of, levels[c.a], levels[c.b]),
                    "no variance over participants, so no t test");
    }

    // Records the participants for whom `is_weak(index)` is true. All conditions with the same figure and the
    // same reason share one text.
    template <class Person, class IsWeak>
    void note(const measured<Person>& v, std::string_view figure, std::string_view why, std::string_view hint,
              const IsWeak& is_weak)
    {
        auto at =
            std::ranges::find_if(noted_, [&](const noted& n) { return n.figure == figure && n.why == why; });
        if (at == noted_.end())
            at = noted_.insert(at, {std::string(figure), std::string(why), std::string(hint)});
        ++at->conditions;
        at->whose.resize(v.codes.size());
        for (std::size_t i = 0; i < v.codes.size(); ++i) {
            at->whose[i].first = v.codes[i];
            if (is_weak(i))
                at->whose[i].second.push_back(v.condition.empty() ? "all trials" : v.condition);
        }
    }

    template <class Person>
    void note_missing(const measured<Person>& v)
    {
        for (std::size_t k = 0; k < v.figures.size(); ++k)
            note(v, v.figures[k].name, "the answers do not determine it", "",
                 [&](std::size_t i) { return !v.values[i][k]; });
    }

    const run_analysis& run_;
    explained_figures all_ = {};
    std::vector<noted> noted_ = {};
};

std::string describe_range(const std::vector<double>& values)
{
    const auto [least, most] = std::ranges::minmax(values);
    return fmt::format("{} to {}, mean {}", plain_number(least, 4), plain_number(most, 4),
                       plain_number(mean(values), 4));
}

} // namespace

const result* find_main_result(const std::vector<result>& results) noexcept
{
    const auto at = std::ranges::find(results, true, &result::is_main);
    return at != results.end() ? &*at : nullptr;
}

std::vector<std::string> describe_tracks(const run_analysis& r)
{
    std::vector<std::string> kinds{""}; // "" for all tracks, then each method and procedure
    std::map<std::string, std::vector<const played_track*>> tracks;
    for (const person_track& t : r.tracks) {
        const std::string kind = fmt::format("{}, {}", t.track.method, t.track.procedure);
        if (!tracks.contains(kind))
            kinds.push_back(kind);
        for (const std::string& of : {kinds.front(), kind})
            tracks[of].push_back(&t.track);
    }
    std::vector<std::string> texts;
    for (const std::string& kind : kinds) {
        const std::vector<const played_track*>& own = tracks.at(kind);
        if (!kind.empty() && own.size() == r.tracks.size())
            break;
        std::vector<double> trials;
        std::vector<double> reversals;
        std::vector<double> sds;
        for (const played_track* t : own) {
            trials.push_back(static_cast<double>(t->trials));
            if (t->reversals)
                reversals.push_back(static_cast<double>(*t->reversals));
            if (t->sd)
                sds.push_back(*t->sd);
        }
        texts.push_back(fmt::format("{}{} of {} ended by {}; trials of a track: {}",
                                    kind.empty() ? "" : kind + ": ",
                                    std::ranges::count(own, true, &played_track::ended),
                                    counted(own.size(), "track"), r.track_rule, describe_range(trials)));
        for (const auto& [name, all] : {std::pair("reversals", &reversals), {"posterior sd", &sds}})
            if (!all->empty() && (!kind.empty() || kinds.size() == 2))
                texts.back() += fmt::format("; {}: {}", name, describe_range(*all));
    }
    return texts;
}

bool has_table(const result_value& v)
{
    if (const auto* e = std::get_if<effect_list>(&v))
        return std::ranges::any_of(e->effects, [](const auto& one) { return one.second && one.second->f; });
    if (const auto* t = std::get_if<tukey_list>(&v))
        return !t->pairs.empty() && t->pairs[0].q;
    if (const auto* p = std::get_if<paired_list>(&v))
        return !p->pairs.empty();
    if (const auto* c = std::get_if<figure_comparison>(&v))
        return c->all.means.front().n != 0;
    if (const auto* counts = std::get_if<answer_counts>(&v))
        return counts->motions.size() > 1;
    return v.index() > 2; // false for null, a text or a number
}

explained_figures explain_figures(const run_analysis& r)
{
    return weak_figures(r).finish();
}

interval clamp_interval(const interval& i, const interval& possible)
{
    return {std::max(i.first, possible.first), std::min(i.second, possible.second)};
}

cell_means outline_cells(bool tested)
{
    return {.against = tested ? std::optional(0.0) : std::nullopt, .means = {{"all"}}};
}

std::vector<std::string> list_groups(const figure_comparison& c)
{
    std::vector<std::string> names;
    for (const level_means& m : c.by_group)
        names.push_back(m.group);
    return names;
}

effect_list outline_effects(const std::vector<std::string>& names)
{
    effect_list all;
    for (const std::string& name : names)
        all.effects.emplace_back(name, std::nullopt);
    return all;
}

std::vector<result_outline> outline_figure_results(const std::vector<result_outline>& named, bool intervals)
{
    std::vector<result_outline> all{{{"vary"}, std::string(), true}, {{"against"}, 0.0, true}};
    for (const result_outline& row : named) {
        all.push_back(row);
        all.push_back({{"by", "*", row.at.front()}, row.value, row.or_null, true});
    }
    if (intervals)
        all.push_back({{"time_order"}, outline_figures<interval_effects>(), false, true});
    all.push_back({{"group_anova"}, outline_effects({"group"}), false, true});
    for (const char* factor : {"method", "session"})
        all.push_back(outline_comparison(factor));
    return all;
}

result_outline outline_comparison(const std::string& factor)
{
    return {{factor + "s", "*"},
            figure_comparison{.factor = factor,
                              .figure = {},
                              .groups = outline_effects({"group", factor, "group:" + factor})},
            false,
            true};
}

result_outline outline_groups(bool methods)
{
    std::vector<std::string> names{"group", "motion", "group:motion"};
    if (methods)
        names.insert(names.end(), {"method", "group:method", "method:motion", "group:method:motion"});
    return {{"group_anova"}, outline_effects(names), false, true};
}

} // namespace tactor::study
