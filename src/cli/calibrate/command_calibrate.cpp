// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/calibrate/calibrate_options.hpp"
#include "cli/commands.hpp"
#include "cli/say.hpp"
#include "core/sha256.hpp"
#include "core/words.hpp"
#include "session/device.hpp"
#include "session/pipes.hpp"
#include "study/calibrate/calibration.hpp"
#include "study/calibrate/calibration_files.hpp"
#include "study/calibrate/person.hpp"

namespace tactor::cli {
namespace {

constexpr double paper_sl_db = 7.0; // Park et al. 2016

// Returns the other contents of the array's own file. A configuration is read anyway when its array is
// replaced, but for the channels.
setup read_other_tables(const environment& e)
{
    setup s;
    if (!e.array_file.empty() && e.array_file != e.config_name)
        s = load_setup(e.array_file);
    else if (!e.array_file.empty())
        s.output.channels = e.config.output.channels;
    return s;
}

std::string make_head(const study::calibration_settings& s)
{
    std::string t = fmt::format("# Thresholds of {} at {} Hz in intervals of {} s (tactor calibrate).\n",
                                s.participant, s.carrier_hz, s.interval_s);
    return s.simulate.empty() ? t : t + "# SIMULATED: nobody was asked.\n";
}

const char* why_none(study::staircase_end end)
{
    return end == study::staircase_end::below_range ? "right where nothing is left to feel" : "not felt";
}

void print(const study::tactor_threshold& t, double ceiling_dbfs)
{
    if (!t.threshold_dbfs) {
        say(stdout, "tactor {:>3}  {}, {}\n", t.tactor, why_none(t.end), counted(t.trials, "trial"));
        say(stderr, "tactor: warning: tactor {} has no threshold ({}): --sl will refuse it\n", t.tactor,
            why_none(t.end));
        return;
    }
    say(stdout, "tactor {:>3}  {:>7.2f} dBFS, sd {:.2f} dB, {}{}\n", t.tactor, *t.threshold_dbfs,
        t.sd_db.value_or(0.0), counted(t.trials, "trial"),
        t.staircases == 1 ? "" : ", a second staircase: the first ended too high");
    const double missing = *t.threshold_dbfs + paper_sl_db - ceiling_dbfs;
    if (missing > 0.0)
        say(stderr,
            "tactor: warning: tactor {}: {} dB above its threshold of {:.2f} dBFS are {:.2f} dB more than it "
            "may have\n",
            t.tactor, paper_sl_db, *t.threshold_dbfs, missing);
}

// Asks the trials that are left; each is in the log before the next.
template <typename Who, typename After>
void ask(study::calibration& c, study::calibration_log& log, Who& who, const After& after)
{
    while (!c.done()) {
        const study::calibration_record r = c.answer(who.answer(c.next()));
        log.append(r);
        after(r);
    }
}

// Returns the signal that ended it, or 0.
int ask_person(study::calibration& c, study::calibration_log& log, const settings& s, const environment& e,
               const calibrate_options& asked)
{
    if (!asked.page.shown() && asked.keypads.empty())
        session::check_standard_input();
    const render_options render = session::settle_render(s, e);
    const session::stream_options& o = s.stream;
    const alsa_options device = session::device_options(s, o, e, render.channels, render.rate);
    const std::string server = session::settle_server(device.pcm);
    net::owned_fd listening = open_page(asked.page);
    study::stage stage(device, o, e);
    const study::page_words words = asked.words.value_or(study::page_words());
    std::optional<study::participant_page> page; // its thread has the signals blocked that the stage takes
    if (listening)
        page.emplace(words, e.tactors, std::move(listening));
    study::person who(stage, e.tactors, render, c.settings(), {page ? &*page : nullptr, asked.keypads},
                      words);
    session::warn_of_server(server);
    if (!asked.masker.empty()) {
        study::masking_options noise = asked.masking;
        noise.seed = fmt::format("{}/calibrate/{}/noise", c.settings().seed, c.settings().participant);
        stage.mask(asked.masker, noise);
    }
    show(study::time_text(c) + ".\n");
    const study::stage::interruption why = study::until_interrupted(stage, [&] {
        ask(c, log, who, [&](const study::calibration_record& r) { who.tell(r); });
        who.thank();
    });
    return why.signal;
}

// Warns of thresholds that are not measured now: they would pass for this session's.
void warn_of_others(const environment& e, const study::calibration_settings& s)
{
    const auto& earlier = e.config.calibration;
    if (!earlier || !study::is_foreign(*earlier, s))
        return;
    const std::vector<tactor_spec>& all = e.tactors.tactors;
    std::vector<unsigned> left;
    for (unsigned i = 0; i < all.size(); ++i)
        if ((all[i].threshold_dbfs || !all[i].thresholds.empty()) &&
            std::find(s.tactors.begin(), s.tactors.end(), i) == s.tactors.end())
            left.push_back(i);
    if (!left.empty())
        say(stderr, "tactor: warning: the array file's thresholds are {}{}: those of {} {} left out\n",
            earlier->participant, earlier->simulated ? "'s, simulated" : "'s", name_tactors(left),
            left.size() == 1 ? "is" : "are");
}

int write_result(const calibrate_options& o, const environment& e, const setup& besides,
                 const study::calibration& c)
{
    const array a = study::with_thresholds(e.tactors, e.config.calibration, c.settings(), c.thresholds());
    study::write_new_output(o.output, make_head(c.settings()) + study::array_text(a, besides) +
                                          study::calibration_text(c.settings(), c.thresholds()));
    say(stdout, "{}{}\n", c.settings().participant,
        c.settings().simulate.empty() ? "" : ": SIMULATED, nobody was asked");
    for (std::size_t i = 0; i < c.thresholds().size(); ++i)
        print(c.thresholds()[i], c.settings().ceilings_dbfs[i]);
    for (const study::doubtful_threshold& d : study::find_doubtful(a, c.settings(), c.thresholds()))
        say(stderr,
            "tactor: warning: tactor {}: the threshold is likely to be too high: {} (measure it again: "
            "--tactors {} --array {} -o ANOTHER.toml)\n",
            d.tactor, d.why, d.tactor, o.output);
    say(stdout, "{} is written: --array {} --sl {}\n", o.output, o.output, paper_sl_db);
    return status_ok;
}

int calibrate(settings& s, calibrate_options& o)
{
    settle_names(o);
    std::error_code ignored;
    const bool there = o.resume && std::filesystem::exists(o.output, ignored);
    if (!there)
        study::check_new_output(o.output);
    const environment e = session::read_environment(s);
    study::calibration_settings begun = settle_calibration(o, s, e);
    std::optional<study::observer_settings> simulated;
    if (o.simulate)
        simulated = study::parse_observer(*o.simulate, begun.tactors, e.tactors.tactors.size());
    else if (!there && !session::names_device(s, e))
        throw error(error_kind::bad_input, "-D", "no device is configured", "-D PCM, or --simulate SPEC");
    const setup besides = read_other_tables(e);
    begun.array = detail::sha256_text(study::array_text(e.tactors, besides));
    if (there) {
        study::check_beginning(o.log, begun);
        study::check_finished(o.output, begun);
        say(stdout, "{} is there: the session is finished\n", o.output);
        return status_ok;
    }
    print_ceilings(begun);
    warn_of_others(e, begun);

    study::calibration_log log(o.log, o.resume, begun);
    study::calibration c(begun);
    std::optional<study::observer> observer;
    if (simulated)
        observer.emplace(*simulated, begun);
    replay(c, log, observer ? &*observer : nullptr);
    if (const auto kept = log.begin())
        say(stderr, "tactor: warning: {}: its last line was cut off: what is left of it is in {}\n", o.log,
            kept->string());
    if (log.lines().rows() > 0)
        say(stdout, "{}\n",
            c.done() ? "all trials are answered" : fmt::format("goes on at trial {}", c.next().number));
    int signal = 0;
    if (observer)
        ask(c, log, *observer, [](const study::calibration_record&) {});
    else if (!c.done())
        signal = ask_person(c, log, s, e, o);
    if (signal != 0) {
        if (c.next().number == 1)
            say(stderr, "tactor: ended before trial 1: nothing was answered\n");
        else
            say(stderr, "tactor: ended before trial {}: what was answered is in {}, and --resume goes on\n",
                c.next().number, o.log);
        return session::interrupt::status(signal);
    }
    return write_result(o, e, besides, c);
}

} // namespace

command add_calibrate(CLI::App& app)
{
    CLI::App* c = app.add_subcommand("calibrate", "Measure a participant's threshold at each tactor");
    auto s = std::make_shared<settings>();
    auto o = std::make_shared<calibrate_options>();
    add_calibrate_options(*c, *o);
    add_options(*c, *s, options::on_calibrate);
    c->footer("tactor calibrate --participant P07 -o P07.toml -D hw:CARD=Tactor\n"
              "tactor calibrate --participant P07 -o P07.toml -D hw:CARD=Tactor --resume\n"
              "tactor calibrate --participant S01 -o S01.toml --simulate threshold=-45,seed=1");
    return [s, o, c] {
        for (const char* name : {"--rule", "--steps", "--reversals", "--discard", "--feedback", "--practice"})
            if (o->of_staircase.empty() && c->count(name) > 0)
                o->of_staircase = name;
        return run_with(*s, [&] { return calibrate(*s, *o); });
    };
}

} // namespace tactor::cli
