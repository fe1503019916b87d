// SPDX-License-Identifier: MIT
#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"
#include "study/experiment/sequence.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

constexpr const char* nobody = "none: the session was simulated";

bool is_own(const session_facts& s)
{
    return s.facts()["schema"].text() == own_schema;
}

bool is_simulated(const session_facts& s)
{
    return s.facts()["simulated"].truth().value_or(false);
}

// Calls `say` for each opening of the device in which a trial of these runs counts, or for all openings if
// none does. Names the openings if their texts differ.
template <class F>
std::string over_streams(const session_facts& s, const std::set<unsigned>& used, const F& say)
{
    shared_texts texts;
    for (const json_value& one : s.facts()["streams"].list()) {
        const std::string number = one["stream"].words();
        if (!used.empty() && std::none_of(used.begin(), used.end(),
                                          [&](unsigned n) { return fmt::format("{}", n) == number; }))
            continue;
        std::string text = say(one);
        add_text(texts, text.empty() ? not_recorded : std::move(text), number);
    }
    if (texts.size() == 1)
        return texts.front().first == not_recorded ? "" : texts.front().first;
    std::string all;
    for (const auto& [text, numbers] : texts)
        all += fmt::format("{}{} ({} {} of the device)", all.empty() ? "" : ", ", text,
                           numbers.size() == 1 ? "opening" : "openings", fmt::join(numbers, ", "));
    return all;
}

std::set<unsigned> all_streams(const session_facts& s)
{
    std::set<unsigned> all;
    for (const std::set<unsigned>& of_run : s.streams)
        all.insert(of_run.begin(), of_run.end());
    return all;
}

std::string noise_words(const json_value& m)
{
    return fmt::format("{} noise of {} dBFS (root mean square), faded over {} s, {}",
                       plain(m["noise"].need_text()), digits(m["level_dbfs"].need_number()),
                       digits(m["fade_s"].need_number()),
                       m["while"].need_text() == "run" ? "through each run" : "while stimuli played");
}

// Describes the noise in an opening of the device. Sessions of older versions name the noise's device alone.
std::string masker_words(const json_value& stream, const json_value& asked)
{
    if (!stream["masker"].there())
        return "none";
    const json_value noise = stream["masking"].there() ? stream["masking"] : asked;
    return noise.there() ? fmt::format("{}, from {}", noise_words(noise), plain(stream["masker"].words()))
                         : "";
}

std::string animation_text(const session_facts& s, std::size_t run)
{
    if (!s.design)
        return "";
    if (!s.design->runs.at(run).animation)
        return "no";
    constexpr const char* asked = " (the definition asks for it)";
    if (is_simulated(s))
        return std::string(nobody) + asked;
    const std::string shown = over_streams(s, s.streams.at(run), [](const json_value& one) -> std::string {
        const std::string display = one["display"].words();
        return display == "page"                         ? "yes, on the page"
               : display == "terminal with animation"    ? "yes, on the terminal"
               : display == "terminal without animation" ? "no, the terminal could not show it"
                                                         : "";
    });
    return (shown.empty() ? std::string(not_recorded) : shown) + (shown.starts_with("yes") ? "" : asked);
}

std::string masking_text(const session_facts& s)
{
    const json_value asked = s.facts()["masking"];
    if (!is_own(s))
        return asked.there() ? noise_words(asked) : "";
    const std::string wanted =
        asked.there() ? fmt::format(" (the definition asks for {})", noise_words(asked)) : "";
    if (is_simulated(s))
        return nobody + wanted;
    const std::string played =
        over_streams(s, all_streams(s), [&](const json_value& one) { return masker_words(one, asked); });
    if (played.empty())
        return asked.there() ? not_recorded + wanted : "none";
    return played + (played.starts_with("none") ? wanted : "");
}

std::string display_text(const session_facts& s)
{
    if (is_simulated(s))
        return nobody;
    return over_streams(s, all_streams(s),
                        [](const json_value& one) { return plain(one["display"].words()); });
}

std::string consent_text(const session_facts& s)
{
    if (is_simulated(s))
        return nobody;
    if (const auto at = s.facts()["consent"].text())
        return "given on " + plain(*at);
    return s.design && s.design->consent.empty() ? "not asked for by the definition" : "";
}

std::string walk_text(const session_facts& s)
{
    if (is_simulated(s))
        return nobody;
    std::set<std::string> felt;
    std::string last;
    for (const json_value& one : s.facts()["walk"].list()) {
        felt.insert(one["tactor"].words());
        last = one["asked"].words();
    }
    return felt.empty() ? "" : fmt::format("{}, the last on {}", counted(felt.size(), "tactor"), plain(last));
}

// Returns a fact about a run from the definitions.
template <class F>
std::string run_fact(const study_facts& f, std::size_t run, const F& say)
{
    return join_texts(f, [&](const session_facts& s) {
        return s.design ? std::string(say(s.design->runs.at(run))) : std::string();
    });
}

std::string task_text(const run_outline& r)
{
    if (r.task == task_kind::choose)
        return fmt::format("two stimuli of one motion, by {} and by {}, one after the other; one was chosen",
                           plain(r.methods[0]), plain(r.methods[1]));
    if (r.task == task_kind::rate)
        return fmt::format("one stimulus ({}), rated from 1 to {}", plain_list(r.methods), r.scale);
    return fmt::format("one stimulus ({}); one of {} was named", plain_list(r.methods),
                       counted(r.motions.size(), "motion"));
}

std::string run_text(const study_facts& f, const run_outline& o, std::size_t run)
{
    std::string text = fmt::format("\n**{}** ({}): {}. Motions: {}.\n", plain(o.name), to_string(o.task),
                                   task_text(o), plain_list(o.motions));
    text += fmt::format("- Attribute: {}\n",
                        run_fact(f, run, [](const run_definition& r) { return r.attribute; }));
    text += fmt::format("- Question: {}\n",
                        run_fact(f, run, [](const run_definition& r) { return plain(r.question); }));
    text += fmt::format("- Animation of the target before the first stimulus: {}\n",
                        join_texts(f, [&](const session_facts& s) { return animation_text(s, run); }));
    text +=
        fmt::format("- Trials: {}; practice trials before, which do not count: {}\n",
                    o.trials == 0 ? std::string(not_recorded) : fmt::format("{}", o.trials),
                    run_fact(f, run, [](const run_definition& r) { return fmt::format("{}", r.practice); }));
    if (o.task == task_kind::rate)
        text += fmt::format("- Labels of the scale: {}\n", run_fact(f, run, [](const run_definition& r) {
                                return r.labels.empty() ? std::string("none") : plain_list(r.labels);
                            }));
    text += fmt::format("- Break after the run: {}\n", run_fact(f, run, [](const run_definition& r) {
                            return r.break_s > 0.0 ? digits(r.break_s) + " s" : std::string("none");
                        }));
    return text;
}

// Returns the range of the numbers of trials that count in a cell.
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

std::string order_text(const session_facts& s)
{
    std::vector<std::string> runs;
    for (const json_value& one : s.facts()["order"].list())
        runs.push_back(one.need_text());
    return plain_list(runs);
}

std::string randomisation(const study_facts& f)
{
    const bool own = std::any_of(f.sessions.begin(), f.sessions.end(),
                                 [](const session_facts& s) { return s.design.has_value(); });
    std::string text = "\n### Order and randomisation\n\n";
    text +=
        fmt::format("Order of the runs: {}.\n\nSeeds: {}.\n\n", join_texts(f, order_text),
                    join_texts(f, [](const session_facts& s) { return plain(s.facts()["seed"].words()); }));
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

std::string rest_text(const rest_range& r)
{
    if (r.is_random())
        return fmt::format("{} to {} s, drawn for each trial", digits(r.least_s), digits(r.most_s));
    return r.least_s > 0.0 ? digits(r.least_s) + " s" : std::string("none");
}

// Returns the hand that wore the array, with the motions that were mirrored for it.
std::string hand_text(const session_facts& s)
{
    const std::string hand = plain(s.facts()["hand"].words());
    std::vector<std::string> mirrored;
    if (s.design && hand == "left")
        for (const motion_definition& m : s.design->motions)
            if (m.mirror)
                mirrored.push_back(m.name);
    return mirrored.empty() ? hand : fmt::format("{}, mirrored: {}", hand, plain_list(mirrored));
}

} // namespace

std::string procedure_section(const study_facts& f, const dataset& d)
{
    std::string text = "\n## Procedure\n\n";
    text += fmt::format("Experiment: {}, with {}. Gap between the two stimuli of a choice: {}.\n",
                        plain(d.experiment.name), counted(d.experiment.runs.size(), "run"),
                        join_texts(f, [](const session_facts& s) {
                            return s.design ? digits(s.design->gap_s) + " s" : std::string();
                        }));
    text += fmt::format("Rest before each trial: {}.\n", join_texts(f, [](const session_facts& s) {
                            return s.design ? rest_text(s.design->rest) : std::string();
                        }));
    if (const std::string hand = join_texts(f, hand_text); hand != not_recorded)
        text += fmt::format("Hand: {}.\n", hand);
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i)
        text += run_text(f, d.experiment.runs[i], i);
    text += randomisation(f);
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i)
        text += cells_text(d, i);
    return text + fmt::format("\n### As it was held\n\n"
                              "Masking noise: {}.\n\nDisplay: {}.\n\nConsent: {}.\n\n"
                              "Tactors that the participant confirmed to feel before the runs: {}.\n",
                              join_texts(f, masking_text), join_texts(f, display_text),
                              join_texts(f, consent_text), join_texts(f, walk_text));
}

} // namespace tactor::study
