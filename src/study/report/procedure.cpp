// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/experiment/sequence.hpp"
#include "study/report/markdown.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

const run_definition* run_of(const session_facts& s, std::size_t run)
{
    return s.design ? &s.design->runs.at(run) : nullptr;
}

// What the definition says of a run.
template <class F>
std::string of_run(const study_facts& f, std::size_t run, const F& say)
{
    return told(f, [&](const session_facts& s) {
        const run_definition* r = run_of(s, run);
        return r == nullptr ? std::string() : std::string(say(*r));
    });
}

std::string task_text(const run_outline& r)
{
    switch (r.task) {
    case task_kind::choose:
        return fmt::format("two stimuli of one motion, by {} and by {}, one after the other; one was chosen",
                           plain(r.methods[0]), plain(r.methods[1]));
    case task_kind::rate:
        return fmt::format("one stimulus ({}), rated from 1 to {}", plain_list(r.methods), r.scale);
    case task_kind::identify:
        break;
    }
    return fmt::format("one stimulus ({}); one of {} was named", plain_list(r.methods),
                       counted(r.motions.size(), "motion"));
}

std::string run_text(const study_facts& f, const run_outline& o, std::size_t run)
{
    std::string text = fmt::format("\n**{}** ({}): {}. Motions: {}.\n", plain(o.name), to_string(o.task),
                                   task_text(o), plain_list(o.motions));
    text +=
        fmt::format("- Attribute: {}\n", of_run(f, run, [](const run_definition& r) { return r.attribute; }));
    text += fmt::format("- Question: {}\n",
                        of_run(f, run, [](const run_definition& r) { return plain(r.question); }));
    text += fmt::format("- Animation of the target before the first stimulus: {}\n",
                        told(f, [&](const session_facts& s) { return animation_text(s, run); }));
    text +=
        fmt::format("- Trials: {}; practice trials before, which do not count: {}\n",
                    o.trials == 0 ? std::string(not_recorded) : fmt::format("{}", o.trials),
                    of_run(f, run, [](const run_definition& r) { return fmt::format("{}", r.practice); }));
    if (o.task == task_kind::rate)
        text += fmt::format("- Labels of the scale: {}\n", of_run(f, run, [](const run_definition& r) {
                                return r.labels.empty() ? std::string("none") : plain_list(r.labels);
                            }));
    text += fmt::format("- Break after the run: {}\n", of_run(f, run, [](const run_definition& r) {
                            return r.break_s > 0.0 ? digits(r.break_s) + " s" : std::string("none");
                        }));
    return text;
}

// How often each cell came, of the trials that count.
std::string cells_text(const dataset& d, std::size_t run)
{
    std::vector<double> counts;
    const run_outline& r = d.experiment.runs[run];
    for (const std::vector<run_data>& own : d.data) {
        if (own[run].trials.empty())
            continue;
        std::map<std::pair<std::size_t, std::size_t>, unsigned> cells;
        for (std::size_t motion = 0; motion < r.motions.size(); ++motion)
            for (std::size_t method = 0; method < r.methods.size(); ++method)
                cells[{motion, method}] = 0;
        for (const trial& t : own[run].trials)
            ++cells[{t.motion, t.method_1}];
        for (const auto& [cell, n] : cells)
            counts.push_back(n);
    }
    return fmt::format("- {}: trials that count for each motion and {}, of each participant: {}\n",
                       plain(r.name), r.task == task_kind::choose ? "order of the two methods" : "method",
                       range_text(counts));
}

std::string order_of(const session_facts& s)
{
    std::vector<std::string> runs;
    for (const json_value& one : s.facts()["order"].list())
        runs.push_back(one.need_text());
    return plain_list(runs);
}

// The session file's numbers are whole: as digits() they would lose some of theirs.
std::string seed_of_session(const session_facts& s)
{
    return plain(s.facts()["seed"].words());
}

std::string randomisation(const study_facts& f)
{
    const bool own = std::any_of(f.sessions.begin(), f.sessions.end(),
                                 [](const session_facts& s) { return s.design.has_value(); });
    std::string text = "\n### Order and randomisation\n\n";
    text +=
        fmt::format("Order of the runs: {}.\n\nSeeds: {}.\n\n", told(f, order_of), told(f, seed_of_session));
    if (own)
        text +=
            fmt::format("The order of the runs is a row of a Williams square (Williams 1949), chosen by the "
                        "participant's code. In each run\nmotions and methods, or motions and orders of the "
                        "two methods, come equally often as far as the number of trials\nallows, in a random "
                        "order (Fisher-Yates) with no more than {} trials of one motion in a row, drawn anew "
                        "until that is\nso. Random numbers: xoshiro256** (Blackman and Vigna 2018), seeded "
                        "by the SHA-256 of \"seed/experiment/code/run\";\nbounded draws after Lemire (2019). "
                        "A void trial comes again at the end of its run, exempt from that.\n\n",
                        most_in_a_row);
    return text;
}

} // namespace

std::string procedure_section(const study_facts& f, const dataset& d)
{
    std::string text = "\n## Procedure\n\n";
    text += fmt::format("Experiment: {}, with {}. Gap between the two stimuli of a choice: {}.\n",
                        plain(d.experiment.name), counted(d.experiment.runs.size(), "run"),
                        told(f, [](const session_facts& s) {
                            return s.design ? digits(s.design->gap_s) + " s" : std::string();
                        }));
    text += fmt::format("Rest before each trial: {}.\n", told(f, [](const session_facts& s) {
                            return !s.design              ? std::string()
                                   : s.design->rest_s > 0 ? digits(s.design->rest_s) + " s"
                                                          : std::string("none");
                        }));
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i)
        text += run_text(f, d.experiment.runs[i], i);
    text += randomisation(f);
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i)
        text += cells_text(d, i);
    return text + fmt::format("\n### As it was held\n\n"
                              "Masking noise: {}.\n\nDisplay: {}.\n\nConsent: {}.\n\n"
                              "Tactors that the participant confirmed to feel before the runs: {}.\n",
                              told(f, masking_text), told(f, display_text), told(f, consent_text),
                              told(f, walk_text));
}

} // namespace tactor::study
