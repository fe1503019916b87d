// SPDX-License-Identifier: MIT
#include "study/session/experiment_session.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/path/shape.hpp"
#include "core/trajectory/impl.hpp"
#include "session/device.hpp"
#include "session/environment.hpp"
#include "session/walk.hpp"
#include "study/bids/dataset.hpp"
#include "study/bids/study_folder.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/session/sync_codes.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"
#include "synth/score/drive_room.hpp"

namespace tactor::study {
namespace {

// Threshold assumed for a tactor without a measured threshold if the session has no person.
constexpr double assumed_threshold_dbfs = -40.0;

// Gives the assumed threshold to each tactor that has none. Returns true if there was such a tactor. Throws
// error (bad_input) instead if `nobody_feels` is false, because a person needs measured thresholds.
bool assume_thresholds(array& a, bool nobody_feels)
{
    bool assumed = false;
    for (std::size_t i = 0; i < a.tactors.size(); ++i) {
        tactor_spec& t = a.tactors[i];
        if (t.threshold_dbfs || !t.thresholds.empty())
            continue;
        if (!nobody_feels)
            throw error(error_kind::bad_input, "--array",
                        fmt::format("tactor {} has no threshold, but the level is relative to thresholds", i),
                        "give --array FILE from tactor calibrate, or levels in dBFS");
        t.threshold_dbfs = assumed_threshold_dbfs;
        assumed = true;
    }
    return assumed;
}

// For a left hand, mirrors motions with `mirror`, and the strokes of methods, about the middle of the array.
// Does nothing if no motion has `mirror`. Throws error (bad_input) if a motion has `mirror` but the hand of
// the person is not given.
void mirror_for_hand(experiment_definition& d, const array& a, const session_request& r)
{
    const auto mirrored = std::ranges::find(d.motions, true, &motion_definition::mirror);
    if (mirrored == d.motions.end())
        return;
    if (r.who == audience::person && !r.hand)
        throw error(
            error_kind::bad_input, "--hand",
            fmt::format("motion \"{}\" is mirrored for left hands, but no hand is given", mirrored->name),
            "add --hand left or --hand right");
    if (r.hand != hand_kind::left)
        return;
    const auto [least, most] =
        std::ranges::minmax_element(a.tactors, {}, [](const tactor_spec& t) { return t.position.x_mm; });
    const double middle_mm = 0.5 * (least->position.x_mm + most->position.x_mm);
    const detail::affine exchanged{-1.0, 0.0, 0.0, 1.0, middle_mm, 0.0};
    const auto exchange = [&](stroke& s, std::string_view kind, const std::string& name) {
        s.motion = detail::map_trajectory(s.motion, {middle_mm, 0.0}, exchanged, {},
                                          fmt::format("{} \"{}\"", kind, name));
    };
    for (motion_definition& m : d.motions)
        if (m.mirror)
            for (stroke& s : m.strokes)
                exchange(s, "motion", m.name);
    for (method_definition& m : d.methods)
        for (stroke& s : m.strokes)
            exchange(s, "method", m.name);
}

// Keeps only the runs, motions and methods of a group.
void keep_group(experiment_definition& d, const std::string& name)
{
    const std::vector<group_outline>& groups = d.outline.groups;
    if (name.empty() && groups.empty())
        return;
    const auto own = std::ranges::find(groups, name, &group_outline::name);
    if (own == groups.end()) {
        std::vector<std::string> names;
        for (const group_outline& g : groups)
            names.push_back(g.name);
        throw error(error_kind::bad_input, "--group",
                    name.empty() ? "the definition has groups, but none is given"
                                 : fmt::format("there is no group \"{}\"", name),
                    names.empty() ? "leave out --group"
                                  : fmt::format("use one of {}", fmt::join(names, ", ")));
    }
    d.group = name;
    if (const auto array = d.group_arrays.find(name); array != d.group_arrays.end())
        d.array = array->second;
    const auto keep = [](std::vector<std::size_t>& places, const auto& all, const auto& names) {
        std::erase_if(places, [&](std::size_t i) { return std::ranges::count(names, all[i].name) == 0; });
    };
    for (std::size_t i = 0; i < d.runs.size(); ++i) {
        run_definition& r = d.runs[i];
        r.outline = own->runs[i];
        keep(r.motions, d.motions, r.outline.motions);
        keep(r.methods, d.methods, r.outline.methods);
    }
    std::erase_if(d.runs, [](const run_definition& r) { return r.motions.empty(); });
}

// Sets the number of the session, and keeps only the runs of this session. Throws error (bad_input) if the
// definition does not have this session, or has several sessions but `session` is missing.
void take_session(experiment_definition& d, session_number session)
{
    const unsigned all = d.outline.sessions;
    const bool several = all > 1;
    if (several != session.has_value() || session.value_or(1) > all)
        throw error(error_kind::bad_input, "--session",
                    session ? fmt::format("there is no session {}", *session)
                            : fmt::format("the definition has {} sessions, and none is chosen", all),
                    several ? fmt::format("use 1 to {}", all) : "leave out --session");
    d.session = session;
    std::erase_if(d.runs,
                  [n = session.value_or(1)](const run_definition& r) { return !r.outline.is_in_session(n); });
    if (d.runs.empty())
        throw error(error_kind::bad_input, "--session",
                    fmt::format("session {} has no run{}", session.value_or(1),
                                d.group.empty() ? "" : fmt::format(" of group \"{}\"", d.group)),
                    "add this session to sessions of a [[run]]");
}

// Throws error (bad_input) if a limit would change a trial even after the array has rested, because the trial
// would then always be void.
void check_limits(const experiment_definition& d, const planned_trial& t, const stimulus_set& stimuli,
                  const drive_limits& l, unsigned rate)
{
    const score s = stimuli.make_score(t, l);
    const bool too_long = !synth::drive_room(s.channels(), l, rate).wait(s, 0);
    if (!too_long && !synth::is_power_limited(s))
        return;
    const motion_definition& m = d.motions[t.motion];
    std::string by;
    for (const std::size_t method : t.list_methods())
        by += fmt::format("{} \"{}\"", by.empty() ? "method" : " and then with", d.methods[method].name);
    throw error(error_kind::bad_input, m.where,
                fmt::format("motion \"{}\" with {} exceeds {}", m.name, by,
                            too_long ? fmt::format("max_drive_s in [limits], {} s in {} s for one tactor",
                                                   l.max_drive_s, l.window_s)
                                     : fmt::format("power_dbfs in [limits], {:.4g} dB", l.power_dbfs)),
                too_long ? "use shorter strokes, or raise the limit if the actuators allow"
                         : "use a lower level, or raise the limit if the actuators allow");
}

// Returns true if an adaptive procedure chooses the value of a trial, or the participant adjusts it.
bool has_variable_value(const experiment_definition& d, const run_sequence& r, const planned_trial& t)
{
    return t.track > 0 || find_run_task(d.runs[r.run].outline).properties().moves_value;
}

// Checks the trials of all runs, including practice, with each value that they may have.
void check_limits(const experiment_definition& d, const std::vector<run_sequence>& runs,
                  const stimulus_set& stimuli, const drive_limits& l, unsigned rate)
{
    std::set<std::pair<std::size_t, std::vector<std::size_t>>> seen;
    for (const run_sequence& r : runs)
        for (const auto* list : {&r.practice, &r.trials})
            for (planned_trial t : *list)
                for (std::size_t v = 0;
                     v < (has_variable_value(d, r, t) ? d.runs[r.run].outline.values.size() : 1); ++v) {
                    if (has_variable_value(d, r, t))
                        set_value(t, d.runs[r.run], v);
                    if (seen.insert({t.motion, t.list_methods()}).second)
                        check_limits(d, t, stimuli, l, rate);
                }
}

// Returns warnings about the calibration, for a session whose level is relative to thresholds.
std::vector<std::string> calibration_doubts(const std::string& participant, const session::environment& e,
                                            const stimulus_set& stimuli)
{
    if (!e.config.calibration)
        return {};
    const calibration_origin& c = *e.config.calibration;
    std::vector<std::string> doubts;
    if (c.simulated)
        doubts.emplace_back("the thresholds are simulated, not measured");
    if (!participant.empty() && c.participant != participant)
        doubts.push_back(fmt::format("the thresholds belong to participant {}, but this is a session of {}",
                                     c.participant, participant));
    std::vector<const plan*> plans;
    for (const stimulus& s : stimuli.all())
        if (s.render.sl_db)
            for (const placed_plan& p : s.made.plans)
                plans.push_back(&p.plan);
    if (std::string other = session::carrier_warning(e, plans); !other.empty())
        doubts.push_back(std::move(other));
    return doubts;
}

// Passes the answer in a line to the adaptive procedure. Returns true if the answer ended the trial's track.
bool take_line(value_chooser& values, const trial_row& row)
{
    if (row.is_void || !row.track)
        return false;
    values.record_answer(*row.track, row.method_1, row.response == "2" ? 2 : 1);
    return values.has_ended(*row.track);
}

} // namespace

prepared_experiment prepare(const session_request& r, session::settings& s)
{
    experiment_definition d = load_definition(r.definition);
    const experiment_definition whole = d; // all groups share the numbers of [sync] code
    keep_group(d, r.group);
    if (!r.all_sessions)
        take_session(d, r.session);
    if (!s.array_name)
        s.array_name = d.array;
    session::environment e = session::read_environment(s);
    mirror_for_hand(d, e.tactors, r);
    const bool above_thresholds = uses_thresholds(d);
    const bool assumed = above_thresholds && assume_thresholds(e.tactors, r.who != audience::person);
    render_options render = session::find_render_options(s, e);
    if (d.level_dbfs)
        render.level_dbfs = *d.level_dbfs;
    else
        render.sl_db = d.sl_db;
    // A dry run may have no participant.
    const std::string code = r.participant.empty() ? "01" : r.participant;
    const std::uint64_t seed = r.seed.value_or(d.seed.value_or(default_seed(code)));
    const std::size_t row = r.row.value_or(default_row(d, code));
    if (row > count_rows(d))
        throw error(error_kind::bad_input, "--order", fmt::format("{} is out of range", row),
                    fmt::format("use 1 to {}", count_rows(d)));
    auto runs = make_sequence(d, code, seed, row);
    stimulus_set stimuli(d, e.tactors, render);
    if (r.who != audience::observer)
        for (unsigned i = 0; i < e.tactors.tactors.size(); ++i)
            static_cast<void>(make_walk_score(d, e.tactors, render, i));
    check_limits(d, runs, stimuli, session::find_limits({}, e), render.rate);
    std::vector<std::string> doubts;
    if (above_thresholds)
        doubts = calibration_doubts(r.participant, e, stimuli);
    std::vector<std::string> warnings = stimuli.warnings();
    warnings.insert(warnings.end(), doubts.begin(), doubts.end());
    code_numbers codes;
    if (const code_settings* const c = find_codes(e)) {
        codes = code_numbers(*c, whole);
        if (std::string same = shared_number_warning(codes); !same.empty())
            warnings.push_back(std::move(same));
    }
    check_pulses(e, d, stimuli, render.rate);
    if (std::string words = d.page.warning(); !words.empty() && r.who != audience::observer)
        warnings.push_back(std::move(words));
    if (assumed)
        warnings.push_back(
            fmt::format("tactors without a threshold: {} dBFS is assumed", assumed_threshold_dbfs));
    const std::string pcm = r.who == audience::person
                                ? session::device_options(s, {}, e, render.channels, render.rate).pcm
                                : "null";
    return {std::move(d),
            code,
            seed,
            std::move(e),
            pcm,
            render,
            assumed,
            std::move(runs),
            std::move(stimuli),
            std::move(warnings),
            std::move(doubts),
            r.hand,
            row,
            std::move(codes)};
}

score make_walk_score(const experiment_definition& d, const array& a, const render_options& o,
                      unsigned tactor)
{
    const double carrier_hz = d.methods.front().options.plan.carrier_hz;
    try {
        return score(a, session::walk_plan(a, tactor, carrier_hz), o);
    } catch (const error& e) {
        throw e.reworded(e.subject(), fmt::format("in the walk before the runs, {}", e.why()),
                         reword_hint(e.hint()));
    }
}

double find_lead_s(const prepared_experiment& p, const run_definition& r, const planned_trial& t)
{
    const double shown_s = r.animation ? find_duration_s(p.definition.motions[t.motion].strokes) : 0.0;
    return shown_s + stimulus_lead_s;
}

std::vector<run_time> session_times(const prepared_experiment& p)
{
    const double rate = p.render.rate;
    const auto frames = [&](double s) { return static_cast<std::uint64_t>(std::llround(s * rate)); };
    synth::drive_room room(p.render.channels, session::find_limits({}, p.where), p.render.rate);
    std::uint64_t now = 0;
    std::vector<run_time> all;
    for (const run_sequence& s : p.runs) {
        const run_definition& r = p.definition.runs[s.run];
        const std::uint64_t began = now;
        run_time t;
        for (const auto* trials : {&s.practice, &s.trials})
            for (const planned_trial& one : *trials) {
                const score stimuli = p.stimuli.make_score(one);
                now += frames(one.rest_s);
                const std::uint64_t lead = frames(find_lead_s(p, r, one));
                const std::uint64_t wait = room.wait(stimuli, now + lead).value_or(0);
                t.waits += wait > 0 ? 1 : 0;
                t.waits_s += static_cast<double>(wait) / rate;
                now += wait + lead;
                room.add_played_score(stimuli, now);
                now += stimuli.frames();
            }
        t.total_s = static_cast<double>(now - began) / rate;
        now += frames(r.break_s);
        all.push_back(t);
    }
    return all;
}

trial_row planned_row(const prepared_experiment& p, const run_definition& r, const planned_trial& t,
                      const pending_trial& which)
{
    const experiment_definition& d = p.definition;
    trial_row row;
    row.trial = which.trial;
    row.attempt = which.attempt;
    row.group = d.group;
    row.session = d.session;
    row.duration_s = static_cast<double>(p.stimuli.count_frames(t)) / p.render.rate;
    row.motion = d.motions[t.motion].name;
    row.target = find_run_task(r.outline).format_target(d.motions[t.motion]);
    const std::vector<std::size_t> methods = t.list_methods();
    for (std::size_t i = 0; i < methods.size(); ++i) {
        row.*stimuli_cells[i].method = d.methods[methods[i]].name;
        row.*stimuli_cells[i].plan = p.stimuli.at(t.motion, methods[i]).hash;
    }
    row.value = find_value(d, t);
    if (t.track > 0)
        row.track = t.track;
    return row;
}

void set_first_frames(trial_row& row, const std::vector<std::uint64_t>& begin,
                      std::optional<std::uint64_t> first_frame, std::uint64_t frames)
{
    for (std::size_t i = 0; first_frame && i < begin.size(); ++i)
        if (i == 0 || frames > begin[i])
            row.*stimuli_cells[i].frame = *first_frame + begin[i];
}

void set_response(trial_row& row, const run_definition& r, const trial_answer& response, double time_s)
{
    find_run_task(r.outline).record_answer(row, r, response);
    row.response_time_s = time_s;
    row.early = time_s < r.min_response_s;
}

run_queue replay(const prepared_experiment& p, const run_sequence& s, const std::vector<trial_row>& rows,
                 const std::filesystem::path& table)
{
    const run_definition& r = p.definition.runs[s.run];
    const auto values = find_run_task(r.outline).make_value_chooser(r);
    run_queue queue(s.trials);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const trial_row& row = rows[i];
        bool same = !queue.done();
        if (same) {
            const pending_trial next = queue.next();
            planned_trial t = s.trials[next.trial - 1];
            values->choose(t);
            if (find_run_task(r.outline).properties().moves_value && row.value)
                set_value(t, r, find_nearest(r.outline.values, *row.value));
            const trial_row planned = planned_row(p, r, t, next);
            same = row.trial == next.trial && row.attempt == next.attempt && row.motion == planned.motion &&
                   std::ranges::all_of(stimuli_cells, [&](const stimulus_cells& c) {
                       return row.*c.plan == planned.*c.plan;
                   });
        }
        if (!same)
            text_table(table, last_line::may_be_cut) // knows the line of the row
                .refuse(i, fmt::format("trial {}, attempt {} is out of order", row.trial, row.attempt),
                        "restore the original table of this session");
        queue.remove_next(row.is_void, take_line(*values, row));
    }
    return queue;
}

session_flow make_flow(const prepared_experiment& p, const session_store& store, bool with_person)
{
    std::vector<flow_run> runs;
    for (const run_sequence& s : p.runs) {
        const run_definition& r = p.definition.runs[s.run];
        const auto practised = static_cast<unsigned>(store.practice_rows(r).size());
        runs.push_back({static_cast<unsigned>(s.practice.size()), practised,
                        replay(p, s, store.rows(r), store.table(r)), r.break_s > 0.0});
    }
    std::vector<flow_form> forms;
    const std::vector<questionnaire>& all = p.definition.outline.questionnaires;
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t run = 0; run < (all[i].when == questionnaire_time::between ? runs.size() - 1 : 1);
             ++run)
            forms.push_back({i, all[i].when, run, all[i].items.size(),
                             store.count_answers(all[i], preceding_run_name(p, all[i], run))});
    const bool consent = with_person && !p.definition.consent.empty() && !store.facts().contains("consent");
    const std::size_t walk = with_person ? p.where.tactors.tactors.size() : 0;
    return {std::move(runs), consent, static_cast<unsigned>(walk), std::move(forms)};
}

std::string preceding_run_name(const prepared_experiment& p, const questionnaire& q, std::size_t run)
{
    return q.when == questionnaire_time::between ? p.run_at(run).outline.name : "";
}

run_table::run_table(session_store& store, const run_definition& r, bool practice)
    : store_(store), run_(r), practice_(practice)
{
    std::vector<trial_row> rows;
    if (!practice)
        rows = store.rows(r);
    else if (store.resumed())
        rows = store.practice_rows(r);
    if (rows.empty())
        return;
    empty_ = false;
    first_stream_ = rows.front().stream;
    first_frame_ = rows.front().frame_1;
    if (!practice)
        if (const auto text = store.acq_time(r))
            began_ns_ = parse_acq_time(*text);
}

void run_table::add(trial_row row, std::int64_t started_ns, unsigned rate)
{
    if (std::exchange(empty_, false)) {
        first_stream_ = row.stream;
        first_frame_ = row.frame_1;
        began_ns_ = started_ns;
    }
    if (row.frame_1 && (began_ns_ || (first_frame_ && row.stream == first_stream_)))
        row.onset_s = onset_s(row.stream, *row.frame_1, started_ns, rate);
    if (practice_)
        store_.append_practice(run_, row);
    else
        store_.append(run_, row, acq_time_text(began_ns_.value_or(started_ns)));
}

double run_table::onset_s(unsigned stream, std::uint64_t frame, std::int64_t at_ns, unsigned rate) const
{
    if (first_frame_ && stream == first_stream_)
        return (static_cast<double>(frame) - static_cast<double>(*first_frame_)) / rate;
    return std::max(0.0, static_cast<double>(at_ns - began_ns_.value_or(at_ns)) * 1e-9);
}

held_run::held_run(const prepared_experiment& p, std::size_t place, session_store& store)
    : p_(p),
      sequence_(p.runs[place]),
      practice_(store, p.run_at(place), true),
      trials_(store, p.run_at(place), false),
      values_(find_run_task(p.run_at(place).outline).make_value_chooser(p.run_at(place)))
{
    for (const trial_row& row : store.rows(p.run_at(place)))
        take_line(*values_, row);
}

planned_trial held_run::find_trial(const session_step& s) const
{
    planned_trial t = (s.practice ? sequence_.practice : sequence_.trials)[s.which.trial - 1];
    if (!s.practice)
        values_->choose(t);
    return t;
}

bool held_run::add(const session_step& s, const trial_row& row, std::int64_t started_ns)
{
    (s.practice ? practice_ : trials_).add(row, started_ns, p_.render.rate);
    return !s.practice && take_line(*values_, row);
}

} // namespace tactor::study
