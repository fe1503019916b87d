// SPDX-License-Identifier: MIT
#include "study/session/person_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "files/json/json_value.hpp"
#include "rt/clock.hpp"
#include "session/say.hpp"
#include "session/walk.hpp"
#include "study/bids/study_folder.hpp"
#include "study/session/experiment_session.hpp"

namespace tactor::study {
namespace {

using json = nlohmann::ordered_json;

// Points of a path on the page: enough for a smooth curve.
constexpr double points_per_s = 200.0;
constexpr double most_points = 4000.0;

// Name, for messages, of the person who ends a session with q.
constexpr std::string_view experimenter = "the experimenter (q)";

bool names_stimuli(const experiment_definition& d, const run_definition& r)
{
    return find_run_task(r.outline).list_answers(r, d.page).names_stimuli;
}

page_screen idle_screen(const prepared_experiment& p, std::string_view key)
{
    return {.name = std::string(key), .text = p.definition.page[key]};
}

page_screen walk_screen(const prepared_experiment& p, unsigned tactor, bool asked)
{
    const page_words& w = p.definition.page;
    page_screen s{.name = "walk", .text = w["walk"]};
    s.where = {1, 1, false, tactor + 1, p.where.tactors.tactors.size()};
    if (!asked)
        return s;
    s.question = w["felt"];
    s.choices = {w["yes"], w["no"], w["again"]};
    s.keys = "ynr";
    if (tactor > 0) {
        s.choices.push_back(w["back"]);
        s.keys += 'b';
    }
    return s;
}

page_screen target_screen(const prepared_experiment& p, const session_step& s,
                          const std::vector<stroke>& target)
{
    page_screen shown = idle_screen(p, "target");
    shown.lasts_s = find_duration_s(target);
    shown.paths = sample_target(target, p.where.tactors,
                                std::clamp(std::ceil(shown.lasts_s * points_per_s), 50.0, most_points));
    shown.where = find_progress(p, s);
    return shown;
}

page_screen stimulus_screen(const prepared_experiment& p, const session_step& s, unsigned playing = 0)
{
    const run_definition& r = p.run_at(s.run);
    page_screen shown = idle_screen(p, "stimulus");
    shown.stimuli = r.stimuli > 1 ? static_cast<unsigned>(r.stimuli) : 0;
    if (names_stimuli(p.definition, r))
        shown.names = r.choices;
    shown.playing = playing;
    shown.where = find_progress(p, s);
    return shown;
}

} // namespace

person_session::person_session(const prepared_experiment& p, session_store& store, stage& s,
                               const answering& with, target_display display, session_devices devices,
                               sync_codes& codes)
    : p_(p),
      store_(store),
      stage_(s),
      page_(with.page),
      display_(std::move(display)),
      devices_(std::move(devices)),
      codes_(codes),
      keys_(s, with),
      asker_(keys_, with.page, p.definition.page),
      flow_(make_flow(p, store, true))
{
    if (store.facts().contains("streams"))
        stream_ = static_cast<unsigned>(store.facts()["streams"].size());
}

void person_session::run_session()
{
    session::say(stderr, "Keys of the experimenter: r repeats the trial, v makes the previous one void, p "
                         "pauses, g goes on, q or Ctrl-C stops.\n");
    try {
        do {
            for (session_step s = flow_.next(); s.what != step_kind::over; s = flow_.next())
                step(s);
            stage_.fade_out();
        } while (!end());
    } catch (...) {
        show_on_page(idle_screen(p_, "over")); // for the participant, the session is over in any case
        throw;
    }
}

void person_session::show_on_page(page_screen s)
{
    if (page_ != nullptr)
        page_->show(std::move(s));
}

void person_session::step(const session_step& s)
{
    if (s.what != step_kind::trial)
        stage_.fade_out();                           // noise that lasts through a run ends here
    if (const auto v = std::exchange(voided_, {})) { // only now, because a stimulus may have been playing
        codes_.send(code_event::made_void, *v, held_->find_trial(*v));
        const trial_row row{.trial = v->which.trial, .attempt = v->which.attempt, .stream = stream_};
        codes_.write(p_.run_at(v->run), row, held_->find_table(*v));
    }
    switch (s.what) {
    case step_kind::consent:
        return ask_consent();
    case step_kind::walk:
        return check_tactor(s.tactor);
    case step_kind::introduce:
        return introduce(s);
    case step_kind::trial:
        return run_trial(s);
    case step_kind::rest:
        return take_break(s);
    case step_kind::pause:
        return pause();
    case step_kind::ask:
        return ask_item(s);
    case step_kind::over:
        return;
    }
}

// Records in session.json that the device was opened, and gives the new stream a number.
void person_session::record_stream()
{
    if (!begun_)
        return;
    ++stream_;
    codes_.begin_stream();
    const stream_setup& d = stage_.setup();
    json all = store_.facts().contains("streams") ? store_.facts()["streams"] : json::array();
    listed_stream own{stream_, acq_time_text(rt::unix_ns()), devices_.pcm,
                      detail::omit_empty(devices_.masker)};
    if (own.masker)
        own.masking = list_noise(p_.definition.masking);
    own.display = page_ != nullptr ? "page"
                  : display_.moves ? "terminal with animation"
                                   : "terminal without animation";
    own.format = to_string(d.format);
    own.period_frames = d.period_frames;
    own.buffer_frames = d.buffer_frames;
    own.realtime = stage_.stats().realtime;
    own.locked_memory = stage_.locked_memory();
    all.push_back(files::make_document(own));
    store_.set_fact("streams", all);
}

// Records in session.json the pulses of the present stream that showed numbers of stimuli, if any.
void person_session::record_pulses()
{
    const listed_pulses& p = codes_.stream_pulses();
    if (p.sent + p.missed == 0)
        return;
    json all = store_.facts()["streams"];
    all.back()["pulses"] = files::make_document(p);
    store_.set_fact("streams", all);
}

void person_session::reopen_lost_device()
{
    if (!stage_.lost())
        return;
    show_on_page(idle_screen(p_, "wait"));
    if (!stage_.reopen())
        throw error(error_kind::runtime, devices_.pcm, "it did not come back", resume_hint);
    record_stream();
}

void person_session::introduce(const session_step& s)
{
    begin_store();
    const run_definition& r = p_.run_at(s.run);
    held_.emplace(p_, s.run, store_);
    const page_words& w = p_.definition.page;
    session::show_lines(fmt::format("\n{} {}/{}\n{}\n{}", w["part"], s.run + 1, p_.runs.size(),
                                    r.outline.question, make_trial_question(p_, s, {}).possible));
    show_on_page({.name = "introduce",
                  .question = r.outline.question,
                  .choices = {w["begin"]},
                  .keys = " ",
                  .back = flow_.can_go_back(),
                  .where = find_progress(p_, s)});
    if (keys_.can_come_early()) {
        session::show(page_ != nullptr ? "The participant begins, or press g.\n"
                                       : w["any_key_begins"] + "\n");
        wait_for_any_key();
    }
    // Meanwhile the experimenter may have made the last trial of the previous run void.
    if (flow_.next() == s)
        flow_.go_on();
}

// Blocks until somebody presses a key, or the experimenter changes the next step.
void person_session::wait_for_any_key()
{
    const session_step now = flow_.next();
    for (;;) {
        const session_key k = keys_.wait();
        if (!k.command || *k.command == operator_key::go_on || *k.command == operator_key::repeat ||
            (*k.command == operator_key::back && !flow_.can_go_back()))
            return;
        handle_key(*k.command);
        if (flow_.next() != now && flow_.next().what != step_kind::pause)
            return;
    }
}

char person_session::wait_for_key(std::string_view keys)
{
    for (;;) {
        const session_key k = keys_.wait();
        if (k.command == operator_key::quit)
            handle_key(*k.command);
        if (k.text.size() == 1 && keys.find(k.text) != keys.npos)
            return k.text.front();
    }
}

// Does not read lines, because a line answers the next question.
bool person_session::obey_keys()
{
    keys_.drop_keypad_keys();
    while (keys_.can_come_early()) {
        const auto k = keys_.poll();
        if (!k)
            break;
        if (k->command == operator_key::repeat)
            repeat_ = true;
        else if (k->command == operator_key::quit)
            quit_ = true;
        else if (k->command)
            handle_key(*k->command);
    }
    return !repeat_ && !quit_;
}

void person_session::handle_key(operator_key k)
{
    if (k == operator_key::quit)
        throw stage::interruption{SIGINT, experimenter};
    if (k == operator_key::void_last)
        return void_last_trial();
    if (k == operator_key::back)
        flow_.go_back();
    if (k == operator_key::pause) {
        session::say(stderr, "tactor: a pause comes before the next {}\n",
                     flow_.is_asking() ? "question" : "trial");
        flow_.pause();
    }
}

void person_session::take_break(const session_step& s)
{
    const double break_s = p_.run_at(s.run).break_s;
    session::show(fmt::format("\n{}: {:.0f} s\n", p_.definition.page["rest"], break_s));
    show_on_page({.name = "rest",
                  .text = p_.definition.page["rest"],
                  .lasts_s = break_s,
                  .where = find_progress(p_, s)});
    bool ended = false;
    const bool there = stage_.wait_for_seconds(break_s, [&](double) {
        for (auto k = keys_.can_come_early() ? keys_.poll() : std::nullopt; k; k = keys_.poll())
            if (k->command == operator_key::go_on)
                ended = true;
            else if (k->command)
                handle_key(*k->command);
        return !ended && flow_.next() == s;
    });
    if (!there)
        return reopen_lost_device(); // next() then returns the same break again
    if (flow_.next() == s)
        flow_.go_on();
}

// Shows the title and text of a questionnaire. On the page, waits until the participant begins.
void person_session::introduce(const questionnaire& q)
{
    session::show("\n");
    for (const std::string& text : {q.title, q.text})
        if (!text.empty())
            session::show_lines(text);
    if (page_ == nullptr || (q.title.empty() && q.text.empty()))
        return;
    show_on_page({.name = "questionnaire",
                  .text = q.text,
                  .question = q.title,
                  .choices = {p_.definition.page["begin"]},
                  .keys = " ",
                  .back = flow_.can_go_back()});
    session::show("The participant begins, or press g.\n");
    wait_for_any_key();
}

void person_session::ask_item(const session_step& s)
{
    const questionnaire& q = p_.definition.outline.questionnaires[s.form];
    if (introduced_.emplace(s.form, s.run).second)
        introduce(q);
    if (flow_.next() != s)
        return;
    keys_.drop_keys();
    // In a line of text, b is a letter and does not go back.
    const bool is_line = q.items[s.item].kind == item_kind::text && !keys_.can_come_early();
    const auto a = ask(
        make_item_question(q, s.item, p_.definition.page, flow_.can_go_back() && !is_line, page_ != nullptr));
    if (!a)
        return;
    begin_store();
    store_.keep_answer(q, preceding_run_name(p_, q, s.run), s.item, a->text);
    flow_.record_answer(s);
}

void person_session::pause()
{
    show_on_page(idle_screen(p_, "pause"));
    session::show(fmt::format("\n{}\n", p_.definition.page["pause"]));
    session::say(stderr, "tactor: paused; g goes on\n");
    const session_step now = flow_.next();
    while (flow_.next() == now) {
        const session_key k = keys_.wait();
        if (k.command == operator_key::go_on)
            flow_.go_on();
        else if (k.command && *k.command != operator_key::pause)
            handle_key(*k.command);
    }
}

bool person_session::end()
{
    show_on_page(idle_screen(p_, "over"));
    const page_words& w = p_.definition.page;
    session::show(fmt::format("\n{}\n", w["over"]));
    if (!keys_.is_terminal())
        return true;
    session::show(page_ != nullptr ? "g ends it.\n" : w["any_key_ends"] + "\n");
    wait_for_any_key();
    return flow_.next().what == step_kind::over;
}

std::string person_session::animate(const session_step& s, const planned_trial& t)
{
    constexpr const char* gone = "the device is gone";
    const std::vector<stroke>& target = p_.definition.motions[t.motion].strokes;
    const double duration_s = find_duration_s(target);
    if (page_ != nullptr) {
        page_->show(target_screen(p_, s, target));
        const bool began = page_->is_watched();
        const bool passed = stage_.wait_for_seconds(duration_s, [&](double) { return obey_keys(); });
        if (!passed)
            return gone;
        return (began && page_->is_watched()) || repeat_ || quit_ ? "" : "no page showed the target";
    }
    if (!display_.moves)
        session::show(p_.definition.page["target"] + "\n");
    const auto draw = display_.show(p_.where.tactors, target);
    draw(0.0);
    const bool passed = stage_.wait_for_seconds(duration_s, [&](double at_s) {
        const bool goes_on = obey_keys();
        draw(std::min(at_s, duration_s));
        return goes_on;
    });
    return passed ? "" : gone;
}

std::function<bool(double)> person_session::make_wait_function()
{
    return [this, announced = false](double) mutable {
        if (!std::exchange(announced, true)) {
            show_on_page(idle_screen(p_, "wait"));
            session::show(p_.definition.page["wait"] + " ");
        }
        return obey_keys();
    };
}

std::function<void(std::uint64_t)> person_session::make_stimulus_watcher(const session_step& s,
                                                                         const planned_trial& t)
{
    if (!t.method_2)
        return [](std::uint64_t) {};
    const std::vector<std::size_t> methods = t.list_methods();
    const std::vector<std::uint64_t> begin = p_.stimuli.starts(t);
    // Gaps have marks, too, so that the participant sees when each stimulus begins and ends.
    std::vector<std::pair<std::uint64_t, unsigned>> changes;
    for (std::size_t i = 0; i < methods.size(); ++i) {
        changes.emplace_back(begin[i], i + 1);
        if (i + 1 < methods.size())
            changes.emplace_back(begin[i] + p_.stimuli.at(t.motion, methods[i]).frames, 0);
    }
    return [this, s, changes, shown = std::size_t{0}](std::uint64_t frame) mutable {
        const run_definition& r = p_.run_at(s.run);
        for (; shown < changes.size() && frame >= changes[shown].first; ++shown) {
            const unsigned playing = changes[shown].second;
            show_on_page(stimulus_screen(p_, s, playing));
            if (playing > 0 && names_stimuli(p_.definition, r) && !r.choices.empty())
                session::show(fmt::format("{}... ", r.choices[playing - 1]));
        }
    };
}

given_stimulus person_session::play_stimuli(const session_step& s, const planned_trial& t, bool again)
{
    const score stimuli = p_.stimuli.make_score(t);
    const run_definition& r = p_.run_at(s.run);
    const double rest_s = again ? 0.0 : t.rest_s;
    if (rest_s > 0.0)
        show_on_page(stimulus_screen(p_, s));
    // Waits for the limits before it shows the target, because the stimulus follows the target at once.
    if (!stage_.wait_for_seconds(rest_s, [&](double) { return obey_keys(); }) ||
        !stage_.wait_for_room(stimuli, again ? stimulus_lead_s : find_lead_s(p_, r, t), make_wait_function()))
        return {.flaw = "the device is gone"};
    if (r.animation && !again)
        if (std::string flaw = animate(s, t); !flaw.empty())
            return {.flaw = std::move(flaw)};
    show_on_page(stimulus_screen(p_, s));
    given_stimulus g;
    if (!repeat_ && !quit_) {
        std::optional<noise_around> noise;
        if (!p_.definition.masking.through_run)
            noise.emplace(stage_);
        const auto mark = make_stimulus_watcher(s, t);
        g = codes_.play_stimuli(stimuli, s, t, [&](std::uint64_t frame) {
            mark(frame);
            if (!obey_keys())
                stage_.cancel();
        });
        if (g.flaw.empty())
            mark(stimuli.frames()); // shows marks that the watcher missed because the process was slow
    }
    obey_keys(); // drops keys that were pressed too early
    if (quit_)
        throw stage::interruption{SIGINT, experimenter};
    if (std::exchange(repeat_, false))
        g.flaw = "the experimenter repeated it";
    else
        g.flaw = g.fault();
    return g;
}

void person_session::run_trial(const session_step& s)
{
    const run_definition& r = p_.run_at(s.run);
    const planned_trial planned = held_->find_trial(s);
    planned_trial t = planned;
    const page_words& w = p_.definition.page;
    const page_progress where = find_progress(p_, s);
    session::show(fmt::format("\n{} {}/{}{}{}: ", w[s.practice ? "practice" : "trial"], s.which.trial,
                              where.may_end_early ? w["at_most"] + " " : "", where.trials,
                              s.which.attempt > 1 ? fmt::format(" ({})", w["repeated"]) : ""));
    given_stimulus g = play_stimuli(s, t, false);
    question q;
    std::optional<given_answer> a;
    unsigned moves = 0;
    while (g.flaw.empty() && (a = ask(q = make_trial_question(p_, s, t)))) {
        const auto next = find_run_task(r.outline).find_next_move(r, t, a->number);
        if (!next)
            break;
        moves += *next == t ? 0 : 1;
        t = *next;
        g = play_stimuli(s, t, true);
    }
    trial_row row = planned_row(p_, r, t, s.which);
    row.start = find_value(p_.definition, planned);
    row.moves = moves;
    row.stream = stream_;
    row.xruns = g.xruns;
    set_first_frames(row, p_.stimuli.starts(t), g.first_frame, g.frames);
    std::string flaw = g.flaw;
    std::optional<bool> right;
    if (flaw.empty()) {
        if (!a) {
            flaw = "the experimenter repeated it";
        } else {
            const trial_answer answer = read_trial_answer(q, *a, p_.where.tactors);
            set_response(row, r, answer, std::max(0.0, static_cast<double>(a->at_ns - g.ended_ns) * 1e-9));
            if (r.feedback || (s.practice && r.trains))
                right = find_run_task(r.outline).was_right(p_.definition, r, t, answer);
            codes_.send(code_event::answer, s, t, row.response);
        }
    }
    row.is_void = !flaw.empty();
    if (row.is_void) {
        codes_.send(code_event::made_void, s, t);
        session::show((s.practice ? "" : w["later"]) + "\n");
        session::say(stderr, "tactor: {}: trial {} is void: {}\n", r.outline.name, s.which.trial, flaw);
    }
    const std::int64_t started_ns = rt::unix_ns() - (g.first_frame ? rt::monotonic_ns() - g.started_ns : 0);
    const bool ends_track = held_->add(s, row, started_ns);
    flow_.record_trial(row.is_void, ends_track);
    // Comes after add(): if the process is killed while it sends the code, the answer is not lost.
    codes_.write(r, row, held_->find_table(s));
    if (!s.practice)
        record_pulses();
    if (right)
        show_feedback(*right);
    reopen_lost_device();
}

void person_session::show_feedback(bool right)
{
    const std::string& word = p_.definition.page[right ? "right" : "wrong"];
    session::show(word + "\n");
    show_on_page({.name = right ? "right" : "wrong", .text = word});
    constexpr double shown_s = 0.7;
    stage_.wait_for_seconds(shown_s, [&](double) { return obey_keys(); });
}

// Returns nothing if the experimenter changed the next step.
std::optional<given_answer> person_session::ask(const question& q)
{
    const session_step now = flow_.next();
    return asker_.ask(q, [&](operator_key k) {
        if (k == operator_key::repeat && now.what == step_kind::trial)
            return false;
        handle_key(k);
        const bool goes_on = flow_.next() == now || flow_.next().what == step_kind::pause;
        if (!goes_on)
            session::show("\n");
        return goes_on;
    });
}

void person_session::void_last_trial()
{
    if (!flow_.void_last_trial()) {
        session::say(stderr, "tactor: {}\n",
                     flow_.is_asking() ? "v does not work within a questionnaire; b goes one item back"
                                       : "there is no earlier trial that v can make void");
        return;
    }
    const run_definition& r = p_.run_at(flow_.last_trial_run());
    store_.void_last_trial(r);
    const trial_row row = store_.rows(r).back();
    held_.emplace(p_, flow_.last_trial_run(), store_);
    voided_ = {{step_kind::trial, 0, flow_.last_trial_run(), false, {row.trial, row.attempt}}};
    session::say(stderr, "tactor: {}: trial {} is void: the experimenter made it void\n", r.outline.name,
                 row.trial);
}

void person_session::ask_consent()
{
    const page_words& w = p_.definition.page;
    show_on_page({.name = "consent",
                  .text = p_.definition.consent,
                  .question = w["agree"],
                  .choices = {w["yes"], w["no"]},
                  .keys = "yn"});
    session::show_lines(p_.definition.consent + "\n");
    session::show(fmt::format("{} y {}, n {}: ", w["agree"], w["yes"], w["no"]));
    const bool agrees = wait_for_key("yn") == 'y';
    session::show(agrees ? w["yes"] + "\n\n" : w["no"] + "\n");
    if (!agrees)
        throw error(error_kind::runtime, "sub-" + p_.participant, "the participant did not agree",
                    "the session has no data");
    agreed_at_ = acq_time_text(rt::unix_ns());
    flow_.record_consent();
}

void person_session::check_tactor(unsigned tactor)
{
    const array& a = p_.where.tactors;
    const page_words& w = p_.definition.page;
    if (tactor == 0) {
        session::show_lines(w["walk"] + "\n");
        session::show(session::tactor_map_text(a) + "\n");
    }
    show_on_page(walk_screen(p_, tactor, false));
    const score s = make_walk_score(p_.definition, a, p_.render, tactor);
    const given_stimulus g = stage_.play_with_retry(s, make_wait_function());
    if (!g.flaw.empty()) {
        session::say(stderr, "tactor: tactor {}: {}\n", tactor, g.flaw);
        reopen_lost_device();
    }
    show_on_page(walk_screen(p_, tactor, true));
    session::show(fmt::format("{}: {} y {}, n {}, r {}{}: ", tactor, w["felt"], w["yes"], w["no"], w["again"],
                              tactor > 0 ? ", b " + w["back"] : ""));
    const char key = wait_for_key(tactor > 0 ? "ynrb" : "ynr");
    session::show(std::string{key, '\n'});
    if (key == 'y') {
        walked_.push_back({tactor, acq_time_text(rt::unix_ns())});
        flow_.record_felt_tactor();
    } else if (key == 'b') {
        flow_.return_to_last_tactor();
    } else if (key == 'n' && (page_ == nullptr || std::exchange(doubted_, tactor) == tactor)) {
        // On a page a finger may slip, so the first No only drives the tactor once more.
        throw error(error_kind::runtime, fmt::format("tactor {}", tactor), "it was not felt",
                    "find the cause with tactor check --walk, then begin again");
    }
}

// Creates the session's files at the first call, after consent and walk: a participant who does not agree or
// does not feel a tactor leaves no data.
void person_session::begin_store()
{
    if (std::exchange(begun_, true))
        return;
    const std::string now = acq_time_text(rt::unix_ns());
    store_.begin(p_.stimuli.all(), describe_events(p_));
    if (store_.facts()["date"].is_null()) // a new session, or one that ended before this point
        store_.set_fact("date", now);
    if (!agreed_at_.empty())
        store_.set_fact("consent", agreed_at_);
    // A resumed session keeps its earlier walks.
    json walks = store_.facts().value("walk", json::array());
    for (const listed_step& one : walked_)
        walks.push_back(files::make_document(one));
    store_.set_fact("walk", walks);
    store_.set_fact("sound_server", files::or_null(devices_.pcm_server));
    store_.set_fact("masker_sound_server", files::or_null(devices_.masker_server));
    record_stream();
}

} // namespace tactor::study
