// SPDX-License-Identifier: MIT
#include "study/session/person_session.hpp"

#include <csignal>
#include <utility>

#include <fmt/format.h>

#include "files/json/json_value.hpp"
#include "session/say.hpp"
#include "study/bids/study_folder.hpp"
#include "study/session/prepared.hpp"
#include "study/session/trials.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::ordered_json;

constexpr const char* resume_hint = "what was answered is kept; --resume goes on";

// Makes the flow at the place where the session is.
session_flow make_flow(const prepared_experiment& p, const session_store& store)
{
    std::vector<flow_run> runs;
    for (const run_sequence& s : p.runs) {
        const run_definition& r = p.definition.runs[s.run];
        const auto practised = static_cast<unsigned>(store.practice_rows(r).size());
        runs.push_back({static_cast<unsigned>(s.practice.size()), practised, replay(p, s, store.rows(r)),
                        r.break_s > 0.0});
    }
    const bool consent = !p.definition.consent.empty() && !store.facts().contains("consent");
    return {std::move(runs), consent, static_cast<unsigned>(p.where.tactors.tactors.size())};
}

} // namespace

person_session::person_session(const prepared_experiment& p, session_store& store, stage& s,
                               const answering& with, target_display& display, session_devices devices)
    : p_(p),
      store_(store),
      stage_(s),
      page_(with.page),
      display_(display),
      devices_(std::move(devices)),
      keys_(s, with),
      flow_(make_flow(p, store))
{
    if (store.facts().contains("streams"))
        stream_ = static_cast<unsigned>(store.facts()["streams"].size());
}

void person_session::hold()
{
    session::say(stderr, "Keys of the experimenter: r repeats the trial, v makes the one before void, p "
                         "pauses, g goes on, q or Ctrl-C stops.\n");
    try {
        do {
            for (session_step s = flow_.next(); s.what != step_kind::over; s = flow_.next())
                step(s);
            stage_.fade_out();
        } while (!end());
    } catch (...) {
        on_page(idle_screen(p_, "over")); // however it ends, for the participant it is over
        throw;
    }
}

void person_session::on_page(page_screen s)
{
    if (page_ != nullptr)
        page_->show(std::move(s));
}

void person_session::step(const session_step& s)
{
    if (s.what != step_kind::trial)
        stage_.fade_out(); // noise through the run ends with it
    switch (s.what) {
    case step_kind::consent:
        return ask_consent();
    case step_kind::walk:
        return walk(s.tactor);
    case step_kind::introduce:
        return introduce(s);
    case step_kind::trial:
        return trial(s);
    case step_kind::rest:
        return rest(s);
    case step_kind::pause:
        return pause();
    case step_kind::refused:
        throw error(error_kind::runtime, "sub-" + p_.participant, "did not agree",
                    "there are no data of the session");
    case step_kind::not_felt:
        throw error(error_kind::runtime, fmt::format("tactor {}", s.tactor), "it was not felt",
                    "tactor check --walk finds out why; then begin again");
    case step_kind::over:
        return;
    }
}

// Counts an opening of the device and writes it down.
void person_session::note_stream()
{
    if (!begun_)
        return;
    ++stream_;
    const stream_setup& d = stage_.setup();
    json all = store_.facts().contains("streams") ? store_.facts()["streams"] : json::array();
    all.push_back(
        {{"stream", stream_},
         {"opened", acq_time_text(utc_now_ns())},
         {"device", devices_.pcm},
         {"masker", files::or_null(devices_.masker)},
         {"masking", devices_.masker.empty() ? json(nullptr) : masking_facts(p_.definition.masking)},
         {"display", page_ != nullptr   ? "page"
                     : display_.moves() ? "terminal with animation"
                                        : "terminal without animation"},
         {"format", std::string(to_string(d.format))},
         {"period_frames", d.period_frames},
         {"buffer_frames", d.buffer_frames},
         {"realtime", stage_.stats().realtime},
         {"locked_memory", stage_.locked_memory()}});
    store_.note("streams", all);
}

void person_session::find_device()
{
    if (!stage_.lost())
        return;
    on_page(idle_screen(p_, "wait"));
    if (!stage_.reopen())
        throw error(error_kind::runtime, devices_.pcm, "it did not come back", resume_hint);
    note_stream();
}

void person_session::introduce(const session_step& s)
{
    begin_store();
    const run_definition& r = p_.run_at(s.run);
    practice_.emplace(store_, r, true);
    table_.emplace(store_, r, false);
    const page_words& w = p_.definition.page;
    session::show_lines(fmt::format("\n{} {}/{}\n{}\n{}", w["part"], s.run + 1, p_.runs.size(), r.question,
                                    choices_text(p_.definition, r)));
    on_page(introduce_screen(p_, s));
    if (keys_.come_early()) {
        session::show(page_ != nullptr ? "The participant begins, or g.\n" : w["any_key_begins"] + "\n");
        wait_for_any_key();
    }
    // The experimenter may have made the last trial of the run before void meanwhile.
    if (flow_.next() == s)
        flow_.go_on();
}

// Waits for a key, or until the experimenter has changed the next step.
void person_session::wait_for_any_key()
{
    const session_step now = flow_.next();
    for (;;) {
        const session_key k = keys_.wait();
        if (!k.asked || *k.asked == operator_key::go_on || *k.asked == operator_key::repeat)
            return;
        obey(*k.asked);
        if (flow_.next() != now && flow_.next().what != step_kind::pause)
            return;
    }
}

// Leaves lines alone: they answer the next question. Only keys come early.
bool person_session::heed()
{
    keys_.drop_pressed();
    while (keys_.come_early()) {
        const auto k = keys_.poll();
        if (!k)
            break;
        if (k->asked == operator_key::repeat)
            repeat_ = true;
        else if (k->asked == operator_key::quit)
            quit_ = true;
        else if (k->asked)
            obey(*k->asked);
    }
    return !repeat_ && !quit_;
}

void person_session::obey(operator_key k)
{
    switch (k) {
    case operator_key::void_last:
        return void_last();
    case operator_key::pause:
        flow_.pause();
        session::say(stderr, "tactor: a pause comes before the next trial\n");
        return;
    case operator_key::quit:
        throw stage::left{SIGINT, experimenter};
    case operator_key::repeat:
    case operator_key::go_on:
        return;
    }
}

void person_session::rest(const session_step& s)
{
    const double break_s = p_.run_at(s.run).break_s;
    session::show(fmt::format("\n{}: {:.0f} s\n", p_.definition.page["rest"], break_s));
    on_page(rest_screen(p_, s));
    bool ended = false;
    const bool there = stage_.pass(break_s, [&](double) {
        for (auto k = keys_.come_early() ? keys_.poll() : std::nullopt; k; k = keys_.poll())
            if (k->asked == operator_key::go_on)
                ended = true;
            else if (k->asked)
                obey(*k->asked);
        return !ended && flow_.next() == s;
    });
    if (!there)
        return find_device(); // and the break again
    if (flow_.next() == s)
        flow_.go_on();
}

void person_session::pause()
{
    on_page(idle_screen(p_, "pause"));
    session::show(fmt::format("\n{}\n", p_.definition.page["pause"]));
    session::say(stderr, "tactor: paused; g goes on\n");
    const session_step now = flow_.next();
    while (flow_.next() == now) {
        const session_key k = keys_.wait();
        if (k.asked == operator_key::go_on)
            flow_.go_on();
        else if (k.asked && *k.asked != operator_key::pause)
            obey(*k.asked);
    }
}

bool person_session::end()
{
    on_page(idle_screen(p_, "over"));
    const page_words& w = p_.definition.page;
    session::show(fmt::format("\n{}\n", w["over"]));
    if (!keys_.is_terminal())
        return true;
    session::show(page_ != nullptr ? "g ends.\n" : w["any_key_ends"] + "\n");
    wait_for_any_key();
    return flow_.next().what == step_kind::over;
}

} // namespace tactor::study
