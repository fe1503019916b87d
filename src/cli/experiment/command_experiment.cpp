// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/experiment/experiment_options.hpp"
#include "cli/experiment/power.hpp"
#include "cli/play/play.hpp"
#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/words.hpp"
#include "net/listen.hpp"
#include "session/device.hpp"
#include "session/piece.hpp"
#include "session/process.hpp"
#include "study/bids/session_store.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/session/experiment_session.hpp"
#include "study/session/key_input.hpp"
#include "study/session/person_session.hpp"
#include "study/session/stage.hpp"
#include "study/session/sync_codes.hpp"

namespace tactor::cli {
namespace {

constexpr double patience_s = 3600.0; // longest wait for a lost device; Ctrl-C ends the wait

// Refuses runs in which the participant draws, unless the participant uses a page.
void check_answers(const study::prepared_experiment& p, bool on_page)
{
    for (const study::run_definition& r : p.definition.runs)
        if (!on_page && study::find_run_task(r.outline).list_answers(r, p.definition.page).draws ==
                            study::drawing_kind::path)
            throw error(error_kind::bad_input, r.where,
                        fmt::format("run \"{}\": participants can draw only on the page", r.outline.name),
                        "use --display page");
}

void check_noise(const study::prepared_experiment& p, const experiment_options& o)
{
    const bool none = !p.definition.masking.noise;
    if (none && !o.masker.empty())
        throw error(error_kind::bad_input, "--masker", "the definition has no masking noise",
                    "add [masking], or leave out --masker");
    if (!none && o.masker.empty())
        say(stderr, "tactor: warning: the definition's masking noise has no device: people near the array "
                    "hear the array (add --masker PCM)\n");
}

constexpr const char* masker_cure = "use --masker hw:CARD=NAME to play on the card itself";

// Returns the sound server between the program and a card. Refuses a server unless the options allow it.
std::string check_server(const std::string& pcm, const char* cure, const experiment_options& o)
{
    std::string server = session::prepare_server(pcm);
    if (!server.empty() && !o.allow_sound_server)
        throw error(error_kind::bad_input, pcm, session::server_note(server),
                    fmt::format("{}, or add --allow-sound-server", cure));
    session::warn_of_server(server, cure);
    return server;
}

// Warns if the device is not hardware, if the data would name the authors of the shipped definition, or if
// neither a page nor the terminal can show the moving target.
void warn_of_doubtful_setup(const study::prepared_experiment& p, const experiment_options& o)
{
    if (!session::is_felt(p.pcm))
        say(stderr, "tactor: warning: playing to \"{}\", not to hardware (-D PCM plays on hardware)\n",
            p.pcm);
    const std::vector<std::string>& authors = p.definition.authors;
    if (!authors.empty() && authors == study::load_definition(study::shipped_experiment).authors)
        say(stderr,
            "tactor: warning: the data name \"{}\" as their authors (set authors in a copy of the "
            "definition)\n",
            authors.front());
    const auto& runs = p.definition.runs;
    if (!o.page.is_shown() && !can_draw() &&
        std::any_of(runs.begin(), runs.end(), [](const auto& r) { return r.animation; }))
        say(stderr, "tactor: warning: the target cannot be drawn: standard output is not a terminal that can "
                    "move its cursor\n");
}

// Returns a function that shows the moving target on standard output, if this is a terminal.
std::function<void(double)> make_target_painter(const array& a, const std::vector<stroke>& target)
{
    const auto picture = std::make_shared<live_picture>(a);
    return [picture, &target, faces = layout(a), spans = study::list_spans(target),
            total_s = study::find_duration_s(target),
            now = instant{std::vector<double>(a.tactors.size(), 0.0), {}}](double t_s) mutable {
        now.targets.clear();
        for (std::size_t i = 0; i < target.size(); ++i)
            if (const auto p = study::find_place(target[i], spans[i], faces, t_s))
                now.targets.push_back(*p);
        picture->draw(now, t_s, total_s);
    };
}

// Refuses set-ups that could spoil the data: no device, a sound server without --allow-sound-server,
// masking noise without its device, a noise device without masking noise, and paths to draw without a page.
// Returns the devices.
// \throws error (bad_input).
study::session_devices check_real_session(const study::prepared_experiment& p, const experiment_options& o,
                                          const settings& s)
{
    if (!session::has_configured_pcm(s, p.where))
        throw error(error_kind::bad_input, "-D", "no device is configured",
                    "give -D PCM, or --simulate SPEC");
    check_answers(p, o.page.is_shown());
    check_noise(p, o);
    study::session_devices devices{p.pcm, check_server(p.pcm, session::server_cure, o), o.masker, {}};
    if (!o.masker.empty())
        devices.masker_server = check_server(o.masker, masker_cure, o);
    warn_of_doubtful_setup(p, o);
    return devices;
}

// Opens the device of the array, the device of the noise if there is one, and the lines for event codes. Sets
// `lines` to these lines.
// \throws error.
std::unique_ptr<study::stage> open_stage(const study::prepared_experiment& p, const experiment_options& o,
                                         const settings& s, study::coded_pulse*& lines)
{
    session::stream_options how = s.stream;
    how.reopen_s = patience_s;
    const alsa_options device = session::device_options(s, how, p.where, p.render.channels, p.render.rate);
    auto there =
        std::make_unique<study::stage>(device, how, p.where, study::make_code_source(how, p.where, lines));
    if (!o.masker.empty()) {
        study::masking_options noise = p.definition.masking.noise.value();
        noise.seed = fmt::format("{}/noise", study::session_seed(p.seed, p.definition, p.participant));
        there->set_masking(o.masker, noise);
    }
    return there;
}

// Runs the remaining trials with a participant. The participant uses the terminal, or a page if `listening`
// is a socket. Returns the reason why the session ended. \throws error.
study::stage::interruption hold_real_session(const study::prepared_experiment& p, const experiment_options& o,
                                             const settings& s, const study::session_devices& devices,
                                             net::owned_fd listening, study::session_store& store)
{
    study::coded_pulse* lines = nullptr;
    const std::unique_ptr<study::stage> there = open_stage(p, o, s, lines);
    std::optional<study::participant_page> page; // after `there`, whose blocked signals its thread inherits
    if (listening)
        page.emplace(p.definition.page, p.where.tactors, std::move(listening));
    study::sync_codes codes(p, store, there.get(), lines);
    const auto why = study::run_until_interrupted(*there, [&] {
        const study::answering with{page ? &*page : nullptr, o.keypads};
        const study::target_display display{can_draw(), make_target_painter};
        study::person_session(p, store, *there, with, display, devices, codes).run_session();
    });
    if (const study::listed_pulses& all = codes.pulses(); all.sent + all.missed != 0)
        say(stderr, "tactor: {} of codes: {} for stimuli, {} missed, late by {:.3f} ms, at worst {:.3f} ms\n",
            study::name_outputs(*study::find_codes(p.where)), counted(all.sent, "pulse"), all.missed,
            all.mean_late_s * 1e3, all.worst_late_s * 1e3);
    return why;
}

// Plays the noise of the definition, and its stimuli when keys are pressed. Ends at the key q or the end of
// the input.
void preview_noise(const study::prepared_experiment& p, study::stage& there)
{
    const std::vector<study::stimulus>& stimuli = p.stimuli.all();
    study::session_keys keys(there, {});
    std::size_t next = 0;
    bool on = false;
    const auto turn = [&] {
        on = !on;
        if (!on)
            there.fade_out();
        else if (!there.fade_in())
            throw error(error_kind::runtime, "--masker", "the noise does not play",
                        "list the devices: tactor devices");
        show(on ? "noise\n" : "silence\n");
    };
    const auto play = [&] {
        const score s = session::make_score(stimuli[next].made, p.where.tactors, stimuli[next].render);
        next = (next + 1) % stimuli.size();
        const study::given_stimulus g = there.play_score(s, 0.0, [](std::uint64_t) {});
        show(fmt::format("a stimulus of {:.2f} s{}\n", static_cast<double>(s.frames()) / s.rate(),
                         g.flaw.empty() ? "" : ": " + g.flaw));
        if (there.lost())
            throw error(error_kind::runtime, p.pcm, g.flaw);
        if (!on)
            there.fade_out();
    };
    turn();
    for (;;) {
        const auto key = keys.poll();
        if (!key && keys.has_ended())
            return;
        if (!key)
            there.wait_for(STDIN_FILENO);
        else if (key->text == "n")
            turn();
        else if (key->text == "s")
            play();
        else if (key->text == "q")
            return;
    }
}

// Runs --check-noise. Returns the exit status. \throws error.
int check_noise(const study::prepared_experiment& p, const experiment_options& o, const settings& s)
{
    static_cast<void>(check_real_session(p, o, s));
    const study::masking_options& noise = p.definition.masking.noise.value();
    study::coded_pulse* lines = nullptr;
    const std::unique_ptr<study::stage> there = open_stage(p, o, s, lines);
    show(fmt::format("{} noise, {} dBFS, on {}. n: noise on and off, s: a stimulus under it, q: quit.\n",
                     to_string(noise.color), noise.level_dbfs, o.masker));
    const int signal = study::run_until_interrupted(*there, [&] { preview_noise(p, *there); }).signal;
    return signal != 0 ? session::interrupt::status(signal) : 0;
}

int hold_session(const study::prepared_experiment& p, const experiment_options& o, const settings& s)
{
    study::session_devices devices;
    if (o.simulate)
        study::check_simulation(p, *o.simulate);
    else
        devices = check_real_session(p, o, s);
    net::owned_fd listening = o.simulate ? net::owned_fd() : open_page(o.page);
    study::study_folder folder(o.folder, p.definition, p.participant, o.simulate.has_value());
    for (const std::string& w : folder.check_other_sessions())
        say(stderr, "tactor: warning: {}: {}\n", o.folder, w);
    if (study::find_codes(p.where) == nullptr && folder.has_codes())
        say(stderr,
            "tactor: warning: {}: other sessions sent codes, but this one does not (set [sync] code in "
            "the array file)\n",
            o.folder);
    study::runs_in_order runs;
    for (const study::run_sequence& r : p.runs)
        runs.push_back(&p.definition.runs[r.run]);
    const study::start_kind start = !o.resume       ? study::start_kind::begin
                                    : o.new_session ? study::start_kind::either
                                                    : study::start_kind::resume;
    study::session_store store(folder, std::move(runs), study::describe_session(p, o.simulate, o.masker),
                               start);
    const std::string who = fmt::format("{}{}", study::session_name(p.participant, p.definition.session),
                                        o.simulate ? ": SIMULATED, no person answered" : "");
    store.check_tables();
    if (store.resumed() && study::make_flow(p, store, false).next().what == study::step_kind::over) {
        store.refuse_cut_lines();
        say(stdout, "{}: the session is finished\n", who);
        return status_ok;
    }
    store.check_writable(p.stimuli.all());
    if (store.resumed())
        for (const std::string& what : store.repair_tables())
            say(stderr, "tactor: warning: {}\n", what);
    study::stage::interruption why{0};
    if (o.simulate) {
        store.begin(p.stimuli.all(), study::describe_events(p));
        why.signal = study::simulate_session(p, *o.simulate, store);
    } else {
        why = hold_real_session(p, o, s, devices, std::move(listening), store);
    }
    if (why.signal != 0) {
        if (!store.begun())
            say(stderr,
                "tactor: ended by {} before the first trial or questionnaire was complete: nothing was "
                "written\n",
                why.by);
        else
            say(stderr, "tactor: ended by {}: the answers are in {} (continue with --resume)\n", why.by,
                o.folder);
        return session::interrupt::status(why.signal);
    }
    std::size_t trials = 0;
    for (const study::run_sequence& r : p.runs)
        trials += static_cast<std::size_t>(
            std::ranges::count(store.rows(p.definition.runs[r.run]), false, &study::trial_row::is_void));
    say(stdout, "{}: {} in {}, in {}\n", who, counted(trials, "trial"), counted(p.runs.size(), "run"),
        o.folder);
    return status_ok;
}

int run(experiment_options& o, settings& s)
{
    check_experiment_options(s, o);
    if (o.print) {
        fmt::print("{}", study::load_definition(o.session.definition).text);
        return status_ok;
    }
    o.session.who = o.dry_run    ? study::audience::nobody
                    : o.simulate ? study::audience::observer
                                 : study::audience::person;
    o.session.all_sessions = !o.power.empty();
    const study::prepared_experiment p = study::prepare(o.session, s);
    print_grouped_warnings(p.warnings);
    if (!o.power.empty())
        return print_power(p, o);
    if (!o.dry_run)
        return o.check_noise ? check_noise(p, o, s) : hold_session(p, o, s);
    if (o.format == "json")
        print_dry_run_json(p);
    else
        print_dry_run_text(p);
    return status_ok;
}

} // namespace

int run_experiment(command_line& line)
{
    experiment_options o;
    add_experiment_options(line.app, o);
    settings& s = add_options(line, options::on_experiment);
    line.app.footer(
        "tactor experiment park2016 --dry-run\n"
        "tactor experiment park2016 --participant 01 -o trial --simulate seed=1,sigma=1\n"
        "tactor experiment park2016 --participant P07 -o strokes --array P07.toml -D hw:CARD=Tactor");
    line.parse();
    return run(o, s);
}

} // namespace tactor::cli
