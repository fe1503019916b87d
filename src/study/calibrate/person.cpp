// SPDX-License-Identifier: MIT
#include "study/calibrate/person.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "rt/clock.hpp"
#include "session/say.hpp"

namespace tactor::study {
namespace {

constexpr double lead_s = 0.5; // pause before interval 1, so that it does not come as a surprise
constexpr int most_attempts = 5;

// Keys for the choices of make_adjustment_screen(), in order.
constexpr const char* level_keys = "-<>+an";

page_screen make_adjustment_screen(const page_words& w)
{
    return {.name = "question",
            .question = w["calibrate_set"],
            .choices = {w["calibrate_much_weaker"], w["calibrate_weaker"], w["calibrate_stronger"],
                        w["calibrate_much_stronger"], w["calibrate_that_is_it"], w["calibrate_not_felt"]},
            .keys = level_keys};
}

// Returns the place of the tactor and, if the number of trials is known, the place of the trial.
page_progress find_progress(const calibration_trial& t, const calibration_settings& s)
{
    page_progress p{t.place, s.tactors.size(), t.practice, 0, 1};
    if (t.practice || s.method == calibration_method::staircase)
        return p;
    p.trial = static_cast<unsigned>(t.on_tactor);
    p.trials = s.method == calibration_method::quest ? s.trials : adjustment_series;
    return p;
}

} // namespace

person::person(stage& s, const array& a, const render_options& render, const calibration_settings& c,
               const answering& with, const page_words& words)
    : stage_(s),
      array_(a),
      render_(render),
      settings_(c),
      page_(with.page),
      words_(words),
      keys_(s, with),
      asker_(keys_, with.page, words_)
{
    render_.ramp_s = interval_ramp_s;
    render_.sl_db = 0.0;
}

// Sets the level as the threshold of all tactors, and plays 0 dB above the threshold. The gains of the
// tactors do not apply to such a sensation level (--sl), so that the tactor gets exactly this level in dBFS.
score person::trial_score(unsigned tactor, double level_dbfs, double onset_s, double total_s) const
{
    array a = array_;
    for (tactor_spec& t : a.tactors) {
        t.threshold_dbfs = level_dbfs;
        t.thresholds.clear();
    }
    plan p;
    p.algorithm = "calibrate";
    p.carrier_hz = settings_.carrier_hz;
    burst b;
    b.onset_s = onset_s;
    b.duration_s = settings_.interval_s;
    b.position = a.tactors[tactor].position;
    b.drives = {{tactor, 1.0}};
    p.bursts.push_back(std::move(b));
    p.total_s = total_s;
    p.stroke_duration_s = total_s;
    return score(a, std::move(p), render_);
}

// Waits, because a limit could cut a stimulus short, and this would reveal the interval.
void person::wait_for_room(const score& s)
{
    const double wait_s = stage_.needed_delay_s(s, 0.0);
    if (wait_s == 0.0)
        return;
    session::show(fmt::format("a pause of {:.1f} s, so that no tactor vibrates for too long\n", wait_s));
    stage_.wait_for_seconds(wait_s, [](double) { return true; });
}

given_stimulus person::play(const calibration_trial& t, const score& s,
                            const std::function<void(double)>& watch)
{
    const std::string name = fmt::format("trial {}", t.number);
    for (int attempt = 1;; ++attempt) {
        given_stimulus g = stage_.play_score(
            s, 0.0, [&](std::uint64_t frame) { watch(static_cast<double>(frame) / s.rate()); });
        g.flaw = g.fault();
        if (g.flaw.empty())
            return g;
        if (stage_.lost() || attempt == most_attempts)
            throw error(error_kind::runtime, name, g.flaw, resume_hint);
        session::show(fmt::format("interrupted ({}): once more\n", g.flaw));
        wait_for_room(s);
    }
}

void person::begin()
{
    const bool choice = asks(settings_.method);
    show_on_page({.name = "introduce",
                  .text = words_[choice ? "calibrate_choose" : "calibrate_adjust"],
                  .choices = {words_["begin"]},
                  .keys = " "});
    session::show(
        choice ? "Two intervals, one of which vibrates. Which one? 1 or 2; guess if you do not know.\n"
               : "Set the level at which you just feel it: + and - by 2 dB, > and < by half a dB; a: that "
                 "is it;\n"
                 "n: not felt at any level.\n");
    if (!keys_.has_keys())
        return;
    session::show(page_ != nullptr ? "The participant begins, Ctrl-C ends; the answers are kept.\n"
                                   : "Any key begins, Ctrl-C ends; the answers are kept.\n");
    while (keys_.wait().text.empty())
        ;
}

// Pauses until the participant begins with the next tactor.
void person::take_break()
{
    show_on_page({.name = "introduce", .text = words_["rest"], .choices = {words_["begin"]}, .keys = " "});
    session::show("A break: the participant continues.\n");
    while (keys_.wait().text.empty())
        ;
}

void person::show_on_page(page_screen s)
{
    if (page_ == nullptr)
        return;
    s.where = where_;
    page_->show(std::move(s));
}

calibration_answer person::answer(const calibration_trial& t)
{
    where_ = find_progress(t, settings_);
    if (!std::exchange(begun_, true))
        begin();
    else if (page_ != nullptr && t.place > 1 && t.on_tactor == 1)
        take_break();
    return t.interval != 0 ? choose(t) : adjust(t);
}

calibration_answer person::choose(const calibration_trial& t)
{
    const double second_s = lead_s + settings_.interval_s + interval_gap_s;
    const double total_s = second_s + settings_.interval_s;
    const score s = trial_score(t.tactor, t.level_dbfs, t.interval == 1 ? lead_s : second_s, total_s);
    wait_for_room(s);
    session::show(fmt::format("trial {}{}:", t.number, t.practice ? " (practice)" : ""));
    unsigned shown = 0;
    const auto show_until = [&](unsigned now) {
        for (; shown < now; ++shown) {
            session::show(fmt::format(" interval {}", shown + 1));
            show_on_page({.name = "stimulus",
                          .text = fmt::format("{} {}", words_["calibrate_interval"], shown + 1),
                          .stimuli = 2,
                          .playing = shown + 1});
        }
    };
    const given_stimulus p = [&] {
        const noise_around noise(stage_);
        given_stimulus given = play(t, s, [&](double at_s) {
            show_until(at_s >= second_s ? 2 : at_s >= lead_s ? 1 : 0);
        });
        show_until(2); // in case `watch` was not called in time
        return given;
    }();
    keys_.drop_keys();
    const auto answer = asker_.ask(
        {.screen = {.name = "question",
                    .question = words_["calibrate_which"],
                    .choices = {"", ""},
                    .keys = "12",
                    .lowest = 1,
                    .greatest = 2,
                    .where = where_},
         .possible = "1 or 2",
         .prompt = " which? "},
        [](operator_key) { return true; }, fmt::format("trial {}", t.number));
    const double time_s = std::max(0.0, static_cast<double>(answer->at_ns - p.ended_ns) * 1e-9);
    calibration_answer a{.interval = static_cast<unsigned>(answer->number),
                         .response_time_s = std::round(time_s * 1e3) / 1e3};
    if (p.first_frame)
        a.onset_frame = *p.first_frame + static_cast<std::uint64_t>(std::llround(lead_s * s.rate()));
    return a;
}

calibration_answer person::adjust(const calibration_trial& t)
{
    const std::int64_t began_ns = rt::monotonic_ns();
    double level = t.level_dbfs;
    std::optional<calibration_answer> out;
    std::optional<std::uint64_t> onset;
    const auto press = [&](char k) {
        const double by = k == '+' ? 2.0 : k == '-' ? -2.0 : k == '>' ? 0.5 : k == '<' ? -0.5 : 0.0;
        level = std::clamp(level + by, floor_dbfs, t.ceiling_dbfs);
        if (k == 'a')
            out = {.set_dbfs = level};
        else if (k == 'n')
            out.emplace();
    };
    const auto take = [&] {
        while (!out) {
            const auto k = keys_.poll();
            if (!k)
                return;
            for (std::size_t i = 0; i < k->text.size() && !out; ++i)
                press(k->text[i]);
            if (!k->text.empty() && !out)
                show_on_page(make_adjustment_screen(words_)); // shows that the answer arrived
        }
    };
    keys_.drop_keys();
    wait_for_room(trial_score(t.tactor, level, 0.0, settings_.interval_s + interval_gap_s));
    session::show(fmt::format("series {}: + - > < a n\n", t.number));
    const noise_around noise(stage_);
    show_on_page(make_adjustment_screen(words_));
    while (!out) {
        const score s = trial_score(t.tactor, level, 0.0, settings_.interval_s + interval_gap_s);
        const given_stimulus p = play(t, s, [&](double) { take(); });
        onset = onset ? onset : p.first_frame;
        take();
        if (!out && keys_.has_ended())
            static_cast<void>(keys_.wait(fmt::format("trial {}", t.number))); // throws
    }
    out->response_time_s = std::round(static_cast<double>(rt::monotonic_ns() - began_ns) * 1e-6) / 1e3;
    out->onset_frame = onset;
    return *out;
}

void person::show_feedback(const calibration_record& r)
{
    if (!settings_.feedback || !r.correct)
        return;
    session::show(*r.correct ? "right\n" : "wrong\n");
    show_on_page({.name = *r.correct ? "right" : "wrong", .text = words_[*r.correct ? "right" : "wrong"]});
}

void person::show_end()
{
    where_.reset();
    show_on_page({.name = "over", .text = words_["over"]});
}

} // namespace tactor::study
