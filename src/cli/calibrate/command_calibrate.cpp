// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/say.hpp"
#include "cli/session/page_options.hpp"
#include "cli/settings.hpp"
#include "core/sha256.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "files/setup_text.hpp"
#include "options/option.hpp"
#include "rt/clock.hpp"
#include "session/device.hpp"
#include "session/process.hpp"
#include "study/bids/study_folder.hpp"
#include "study/calibrate/calibration.hpp"
#include "study/calibrate/calibration_files.hpp"
#include "study/calibrate/person.hpp"
#include "study/data/page_words.hpp"
#include "study/experiment/trials.hpp"
#include "study/masking/masking.hpp"

namespace tactor::cli {
namespace {

// An option that applies only to some methods.
struct method_option {
    const char* name;
    bool of_staircase;
    bool of_quest;
};

constexpr method_option all_method_options[] = {{"--rule", true, false},      {"--steps", true, false},
                                                {"--reversals", true, false}, {"--discard", true, false},
                                                {"--feedback", true, true},   {"--practice", true, true},
                                                {"--trials", false, true},    {"--stop-sd", false, true}};

struct calibrate_options {
    study::calibration_settings settings; ///< settings from options on the command line
    std::string output;
    std::string log; ///< empty for a log next to the output
    std::optional<std::string> tactors;
    std::optional<std::string> simulate;
    std::optional<std::uint32_t> seed;
    std::vector<std::string> keypads; ///< input devices of the participant
    page_options page;
    std::optional<study::page_words> words; ///< words on the page; not set for English
    std::string masker;                     ///< PCM device of the masking noise; empty if none
    study::masking_options masking;
    std::vector<method_option> method_options; ///< options on the command line that depend on the method
    bool has_start = false;                    ///< true with --start-dbfs: no ceiling may lower it
    bool resume = false;
};

constexpr double most_seed = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t most_steps = 20;
constexpr double least_quest_trials = 5;
constexpr double most_quest_trials = 200; // computing the next trial takes less than a millisecond

std::uint32_t parse_whole_option(const char* option, const std::string& text, double low, double high)
{
    return static_cast<std::uint32_t>(options::parse_whole(option, text, {low, high}, ""));
}

std::vector<double> steps(const std::string& text)
{
    std::vector<double> all;
    for (const std::string_view part : detail::split(text, ','))
        all.push_back(options::parse_number("--steps", std::string(part), {0.01, 60.0}, "dB"));
    if (all.size() > most_steps)
        refuse_option("--steps", fmt::format("{} steps are too many", all.size()),
                      fmt::format("give at most {}", most_steps));
    return all;
}

void add_staircase_options(CLI::App& c, calibrate_options& o)
{
    study::staircase_options& s = o.settings.staircase;
    begin_group(c, "Staircase");
    add_text_option(c, "--rule", "1up3down|1up2down",
                    "find the level at which 79.4 % of the answers are right (default), or 70.7 %",
                    [&s](const std::string& t) {
                        s.right_for_down = choose("--rule", t, {"1up3down", "1up2down"}) == 0 ? 3 : 2;
                    });
    add_text_option(c, "--steps", "DB,DB,...",
                    "step sizes; the next one applies after every second reversal (default 4,2,1)",
                    [&s](const std::string& t) { s.steps_db = steps(t); });
    add_text_option(c, "--reversals", "N", "number of reversals of a staircase (default 12)",
                    [&s](const std::string& t) {
                        s.reversals = parse_whole_option("--reversals", t, 2, study::most_reversals);
                    });
    add_text_option(c, "--discard", "N", "number of reversals at the start that do not count (default 4)",
                    [&s](const std::string& t) {
                        s.discard = parse_whole_option("--discard", t, 0, study::most_reversals);
                    });
    add_text_option(c, "--feedback", "on|off", "tell the participant which answer was right (default on)",
                    [&o](const std::string& t) {
                        o.settings.feedback = choose("--feedback", t, {"on", "off"}) == 0;
                    });
    add_text_option(
        c, "--practice", "N", "number of practice trials, which do not count (default 0)",
        [&o](const std::string& t) { o.settings.practice = parse_whole_option("--practice", t, 0, 1000); });
    begin_group(c, "QUEST+");
    add_text_option(
        c, "--trials", "N", "number of trials of a tactor (default 30)", [&o](const std::string& t) {
            o.settings.trials = parse_whole_option("--trials", t, least_quest_trials, most_quest_trials);
        });
    add_text_option(c, "--stop-sd", "DB",
                    "stop a tactor when the standard deviation of its threshold falls below this",
                    [&o](const std::string& t) {
                        o.settings.stop_sd_db = options::parse_number("--stop-sd", t, {0.1, 20.0}, "dB");
                    });
    begin_group(c);
}

void add_masker_options(CLI::App& c, calibrate_options& o)
{
    begin_group(c, "Masker");
    CLI::Option* masker = add_masker_option(
        c, o.masker, "play masking noise on this second device, in stereo, in both intervals");
    add_text_option(c, "--masker-noise", "white|pink", "colour of the noise (default white)",
                    [&o](const std::string& t) {
                        o.masking.color = choose("--masker-noise", t, {"white", "pink"}) == 0
                                              ? study::noise_color::white
                                              : study::noise_color::pink;
                    })
        ->needs(masker);
    add_text_option(c, "--masker-dbfs", "DB", "level of the noise, root of the mean square (default -30)",
                    [&o](const std::string& t) {
                        o.masking.level_dbfs =
                            options::parse_number("--masker-dbfs", t, detail::bounds_of::masker_dbfs, "dBFS");
                    })
        ->needs(masker);
    begin_group(c);
}

// Distance of levels from a power limit, dB. At exactly the limit, rounding errors may trigger it.
constexpr double power_margin_db = 1e-3;

unsigned parse_tactor(std::string_view text, const std::string& all, std::size_t n)
{
    const auto i = detail::parse_number_text<std::uint64_t>(text);
    if (!i)
        refuse_option("--tactors", fmt::format("\"{}\" is not a list of tactors", all),
                      "give numbers and ranges, such as 0,3-5");
    if (*i >= n)
        refuse_option("--tactors", fmt::format("there is no tactor {}", text),
                      n == 1 ? std::string("use 0, the only tactor of the array")
                             : fmt::format("use 0 to {}", n - 1));
    return static_cast<unsigned>(*i);
}

std::vector<unsigned> parse_tactors(const std::string& text, std::size_t n)
{
    std::vector<unsigned> all;
    for (const std::string_view part : detail::split(text, ',')) {
        const std::size_t dash = part.find('-');
        const unsigned first = parse_tactor(part.substr(0, dash), text, n);
        const unsigned last = dash == part.npos ? first : parse_tactor(part.substr(dash + 1), text, n);
        if (last < first)
            refuse_option("--tactors", fmt::format("\"{}\" runs backwards", part),
                          fmt::format("write {}-{}", last, first));
        for (unsigned i = first; i <= last; ++i) {
            if (std::find(all.begin(), all.end(), i) != all.end())
                refuse_option("--tactors", fmt::format("tactor {} is named twice", i),
                              "name each tactor once");
            all.push_back(i);
        }
    }
    return all;
}

// Refuses an interval that is longer than the limit on drive time. For an adjustment, also refuses pulses
// that drive a tactor for longer than the pauses between pulses allow. Trials of a staircase need no such
// check, because each can wait for a pause.
void check_drive_time(const study::calibration_settings& c, const drive_limits& l)
{
    constexpr double rounding_s = 1e-9;
    if (l.max_drive_s >= l.window_s)
        return;
    const double leak = l.max_drive_s / (l.window_s - l.max_drive_s);
    const bool steady = !asks(c.method);
    if (c.interval_s > l.max_drive_s + rounding_s ||
        (steady && c.interval_s > leak * study::interval_gap_s + rounding_s))
        refuse_option("--interval",
                      fmt::format("{} of {} s, with pauses of {} s, would drive a tactor for longer than "
                                  "max_drive_s allows, {:.4g} s in {:.4g} s",
                                  steady ? "steady pulses" : "intervals", c.interval_s, study::interval_gap_s,
                                  l.max_drive_s, l.window_s),
                      "use a shorter interval, or raise max_drive_s in [limits]");
}

void add_calibrate_options(CLI::App& c, calibrate_options& o)
{
    study::calibration_settings& s = o.settings;
    add_text_option(c, "--participant", "CODE", "the participant: letters and digits",
                    [&s](const std::string& t) {
                        study::check_code(t);
                        s.participant = t;
                    })
        ->required();
    c.add_option("-o,--output", o.output, "array file to write, with the thresholds")
        ->type_name("FILE.toml")
        ->required();
    add_text_option(
        c, "--method", "staircase|quest|adjustment",
        "ask about two intervals, by a staircase (default) or QUEST+, or let the participant set a level",
        [&s](const std::string& t) {
            s.method = static_cast<study::calibration_method>(
                choose("--method", t, {"staircase", "quest", "adjustment"})); // as in the enumeration
        });
    add_text_option(c, "--tactors", "LIST", "tactors to measure, in this order, such as 0,3-5 (default all)",
                    [&o](const std::string& t) { o.tactors = t; });
    add_text_option(
        c, "--interval", "S", "duration of each interval or pulse (default 0.5)", [&s](const std::string& t) {
            s.interval_s = options::parse_number("--interval", t, detail::bounds_of::interval_s, "s");
        });
    add_text_option(
        c, "--start-dbfs", "DB", "level of the first trial (default -20)", [&o, &s](const std::string& t) {
            s.staircase.start_dbfs = options::parse_number("--start-dbfs", t, {study::floor_dbfs, 0}, "dBFS");
            o.has_start = true;
        });
    add_staircase_options(c, o);
    add_masker_options(c, o);
    add_page_options(c, o.page);
    add_text_option(c, "--page-words", "FILE",
                    "take the words of the page from [page] of this experiment's definition",
                    [&o](const std::string& t) { o.words = study::load_page_words(t); });
    add_keypad_option(c, o.keypads);
    add_text_option(c, "--log", "FILE.tsv",
                    "table with a line for each trial (default: the output's name with .tsv)",
                    [&o](const std::string& t) { o.log = t; });
    c.add_flag("--resume", o.resume, "continue the session of the log");
    add_text_option(c, "--simulate", "SPEC",
                    "let a model answer, without a device: seed=1,threshold=-45,spread=2,lapse=0.02",
                    [&o](const std::string& t) { o.simulate = t; });
    add_text_option(c, "--seed", "N", "seed of the order of intervals (default: from the participant's code)",
                    [&o](const std::string& t) { o.seed = parse_whole_option("--seed", t, 0, most_seed); });
}

// Checks the extensions of output and log. If the log has no name, derives its name from the output.
void resolve_file_names(calibrate_options& o)
{
    namespace fs = std::filesystem;
    if (fs::path(o.output).extension() != ".toml")
        refuse_option("-o", fmt::format("\"{}\" does not end in .toml", o.output),
                      "end the name in .toml, such as me.toml");
    if (o.log.empty())
        o.log = fs::path(o.output).replace_extension(".tsv").string();
    else if (fs::path(o.log).extension() != ".tsv")
        refuse_option("--log", fmt::format("\"{}\" does not end in .tsv", o.log),
                      "end the name in .tsv, such as me.tsv");
}

// Refuses an option that does not apply to the chosen method.
void check_method(const calibrate_options& o)
{
    using enum study::calibration_method;
    constexpr std::string_view names[] = {"a staircase", "QUEST+", "an adjustment"}; // as in the enumeration
    const study::calibration_method m = o.settings.method;
    for (const method_option& one : o.method_options)
        if (!(m == staircase ? one.of_staircase : m == quest && one.of_quest))
            refuse_option(one.name, fmt::format("{} does not use it", names[static_cast<std::size_t>(m)]),
                          fmt::format("leave out {}, or use --method {}", one.name,
                                      to_string(one.of_staircase ? staircase : quest)));
}

void check_calibrate_options(const calibrate_options& o, const settings& s)
{
    const study::calibration_settings& c = o.settings;
    check_method(o);
    if (c.staircase.reversals < c.staircase.discard + 2)
        refuse_option("--discard",
                      fmt::format("discarding {} of {} reversals leaves fewer than two", c.staircase.discard,
                                  c.staircase.reversals),
                      "discard fewer, or add reversals");
    if (const double most = study::max_noise_dbfs(o.masking.color); o.masking.level_dbfs > most)
        refuse_option("--masker-dbfs",
                      fmt::format("{} dBFS is too high: the peaks of this noise reach full scale at {} dBFS",
                                  o.masking.level_dbfs, most),
                      "lower the level, and turn up the headphone amplifier");
    check_page_options(o.page, o.simulate.has_value());
    if (o.words && !o.page.is_shown())
        refuse_option("--page-words", "only the participant's page uses it",
                      "add --display page, or leave out --page-words");
    if (const std::string asked = find_stream_option(s); o.simulate && !asked.empty())
        refuse_option(asked, "a simulated session plays nothing",
                      fmt::format("leave out {} or --simulate", asked));
    if (o.simulate && !o.keypads.empty())
        refuse_option("--keypad", "a simulated session has no participant",
                      "leave out --keypad or --simulate");
}

// Returns the settings for this array, adjusted to its limits.
study::calibration_settings resolve_calibration(const calibrate_options& o, const settings& s,
                                                const environment& e)
{
    check_calibrate_options(o, s);
    study::calibration_settings c = o.settings;
    const array& a = e.tactors;
    const drive_limits limits = session::find_limits({}, e);
    if (!o.masker.empty() && !o.simulate) {
        c.masker = fmt::format("{} noise, {} dBFS", to_string(o.masking.color), o.masking.level_dbfs);
        c.masker_pcm = o.masker;
    }
    c.carrier_hz = s.plan.carrier_hz;
    const unsigned rate = session::find_render_options(s, e).rate;
    if (c.carrier_hz >= 0.5 * rate)
        refuse_option("--carrier",
                      fmt::format("{} Hz cannot be played at a rate of {} Hz", c.carrier_hz, rate),
                      fmt::format("use a carrier below {} Hz, half the rate", 0.5 * rate));
    check_drive_time(c, limits);
    if (o.tactors) {
        c.tactors = parse_tactors(*o.tactors, a.tactors.size());
    } else {
        c.tactors.resize(a.tactors.size());
        std::iota(c.tactors.begin(), c.tactors.end(), 0U);
    }
    for (const unsigned t : c.tactors) {
        const double ceiling = std::min({0.0, a.tactors[t].max_dbfs, limits.power_dbfs - power_margin_db});
        if (o.has_start && c.start_dbfs() > ceiling)
            refuse_option(
                "--start-dbfs",
                fmt::format(
                    "the start level of {3:.4g} dBFS is above the limit of tactor {0}, {1:.4g} dBFS from {2}",
                    t, ceiling, ceiling < a.tactors[t].max_dbfs ? "power_dbfs in [limits]" : "max_dbfs",
                    c.start_dbfs()),
                "use a lower start level");
        c.ceilings_dbfs.push_back(ceiling);
    }
    c.simulate = o.simulate.value_or("");
    c.seed = o.seed.value_or(static_cast<std::uint32_t>(study::default_seed(c.participant)));
    constexpr std::size_t day = 10; // length of a date such as 2026-11-21
    c.date = study::acq_time_text(rt::unix_ns()).substr(0, day);
    return c;
}

std::string format_tactors(const std::vector<unsigned>& tactors)
{
    return fmt::format("{} {}", tactors.size() == 1 ? "tactor" : "tactors", fmt::join(tactors, ", "));
}

void print_ceilings(const study::calibration_settings& c)
{
    std::map<double, std::vector<unsigned>, std::greater<>> tactors; // tactors by their ceiling
    for (std::size_t i = 0; i < c.tactors.size(); ++i)
        tactors[c.ceilings_dbfs[i]].push_back(c.tactors[i]);
    std::string all;
    for (const auto& [ceiling_dbfs, of_ceiling] : tactors)
        all += fmt::format("{}{:.4g} dBFS at {}", all.empty() ? "" : "; ", ceiling_dbfs,
                           format_tactors(of_ceiling));
    say(stderr, "tactor: highest level: {}\n", all);
    if (const auto unlimited = tactors.find(0.0); unlimited != tactors.end())
        say(stderr,
            "tactor: warning: no max_dbfs limits {}: the level may reach full scale (set max_dbfs in "
            "[array] or [[tactor]] of the array file)\n",
            format_tactors(unlimited->second));
}

constexpr double paper_sl_db = 7.0; // Park et al. 2016

// Returns the other tables of the array's own file. If the array is in the configuration file, returns only
// the number of channels, because tactor also reads the configuration together with another array file.
setup read_other_tables(const environment& e)
{
    setup s;
    if (!e.array_file.empty() && e.array_file != e.config_name)
        s = load_setup(e.array_file);
    else if (!e.array_file.empty())
        s.output.channels = e.config.output.channels;
    return s;
}

const char* missing_threshold_reason(study::staircase_end end)
{
    return end == study::staircase_end::below_range ? "right answers at a level that nobody can feel"
                                                    : "not felt";
}

void print(const study::tactor_threshold& t, double ceiling_dbfs)
{
    if (!t.threshold_dbfs) {
        say(stdout, "tactor {:>3}  {}, {}\n", t.tactor, missing_threshold_reason(t.end),
            counted(t.trials, "trial"));
        say(stderr, "tactor: warning: tactor {} has no threshold ({}): --sl will refuse it\n", t.tactor,
            missing_threshold_reason(t.end));
        return;
    }
    say(stdout, "tactor {:>3}  {:>7.2f} dBFS, {}sd {:.2f} dB, {}{}\n", t.tactor, *t.threshold_dbfs,
        t.posterior_sd_db ? "posterior " : "", t.posterior_sd_db.value_or(t.sd_db.value_or(0.0)),
        counted(t.trials, "trial"),
        t.staircases == 1 ? "" : ", with a second staircase: the first ended too high");
    const double missing = *t.threshold_dbfs + paper_sl_db - ceiling_dbfs;
    if (missing > 0.0)
        say(stderr,
            "tactor: warning: tactor {}: a level {} dB above its threshold of {:.2f} dBFS exceeds its limit "
            "by {:.2f} dB\n",
            t.tactor, paper_sl_db, *t.threshold_dbfs, missing);
}

// Runs the remaining trials. Each trial is in the log before the next one begins.
template <typename Who, typename After>
void ask(study::calibration& c, study::calibration_log& log, Who& who, const After& after)
{
    while (!c.done()) {
        const study::calibration_record r = c.answer(who.answer(c.next()));
        log.append(r);
        after(r);
    }
}

// Runs the trials with a participant. Returns the signal that ended the session, or 0.
int run_threshold_trials(study::calibration& c, study::calibration_log& log, const settings& s,
                         const environment& e, const calibrate_options& asked)
{
    if (!asked.page.is_shown() && asked.keypads.empty())
        session::check_standard_input();
    const render_options render = session::find_render_options(s, e);
    const session::stream_options& o = s.stream;
    const alsa_options device = session::device_options(s, o, e, render.channels, render.rate);
    const std::string server = session::prepare_server(device.pcm);
    net::owned_fd listening = open_page(asked.page);
    study::stage stage(device, o, e);
    const study::page_words words = asked.words.value_or(study::page_words());
    std::optional<study::participant_page> page; // after `stage`, whose blocked signals its thread inherits
    if (listening)
        page.emplace(words, e.tactors, std::move(listening));
    study::person who(stage, e.tactors, render, c.settings(), {page ? &*page : nullptr, asked.keypads},
                      words);
    session::warn_of_server(server);
    if (!asked.masker.empty()) {
        study::masking_options noise = asked.masking;
        noise.seed = fmt::format("{}/calibrate/{}/noise", c.settings().seed, c.settings().participant);
        stage.set_masking(asked.masker, noise);
    }
    show(study::time_text(c) + ".\n");
    const study::stage::interruption why = study::run_until_interrupted(stage, [&] {
        try {
            ask(c, log, who, [&](const study::calibration_record& r) { who.show_feedback(r); });
        } catch (...) {
            who.show_end(); // the session is over for the participant in any case
            throw;
        }
        who.show_end();
    });
    return why.signal;
}

// Warns about thresholds from another session that this session will remove.
void warn_of_replaced_thresholds(const environment& e, const study::calibration_settings& s)
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
            earlier->participant, earlier->simulated ? "'s, simulated" : "'s", format_tactors(left),
            left.size() == 1 ? "is" : "are");
}

int write_result(const calibrate_options& o, const environment& e, const setup& besides,
                 const study::calibration& c)
{
    const array a = study::merge_thresholds(e.tactors, e.config.calibration, c.settings(), c.thresholds());
    const study::calibration_settings& s = c.settings();
    const bool simulated = !s.simulate.empty();
    study::write_new_output(
        o.output, fmt::format("# Thresholds of {} at {} Hz in intervals of {} s (tactor calibrate).\n{}{}{}",
                              s.participant, s.carrier_hz, s.interval_s,
                              simulated ? "# SIMULATED: no person answered.\n" : "",
                              detail::array_text(a, besides), study::calibration_text(s, c.thresholds())));
    say(stdout, "{}{}\n", s.participant, simulated ? ": SIMULATED, no person answered" : "");
    for (std::size_t i = 0; i < c.thresholds().size(); ++i)
        print(c.thresholds()[i], s.ceilings_dbfs[i]);
    for (const study::doubtful_threshold& d : study::find_doubtful_thresholds(a, s, c.thresholds()))
        say(stderr,
            "tactor: warning: tactor {}: the threshold is likely to be too high: {} (measure it again: "
            "--tactors {} --array {} -o ANOTHER.toml)\n",
            d.tactor, d.why, d.tactor, o.output);
    say(stdout, "{} is written: --array {} --sl {}\n", o.output, o.output, paper_sl_db);
    return status_ok;
}

int calibrate(settings& s, calibrate_options& o)
{
    resolve_file_names(o);
    std::error_code ignored;
    const bool there = o.resume && std::filesystem::exists(o.output, ignored);
    if (!there)
        study::check_new_output(o.output);
    const environment e = session::read_environment(s);
    study::calibration_settings begun = resolve_calibration(o, s, e);
    std::optional<study::observer_settings> simulated;
    if (o.simulate)
        simulated = study::parse_observer(*o.simulate, begun.tactors, e.tactors.tactors.size());
    else if (!there && !session::has_configured_pcm(s, e))
        throw error(error_kind::bad_input, "-D", "no device is configured",
                    "give -D PCM, or --simulate SPEC");
    const setup besides = read_other_tables(e);
    begun.array = detail::sha256_text(detail::array_text(e.tactors, besides));
    if (there) {
        study::check_log_settings(o.log, begun);
        study::check_calibration_result(o.output, begun);
        say(stdout, "{} exists: the session is finished\n", o.output);
        return status_ok;
    }
    print_ceilings(begun);
    warn_of_replaced_thresholds(e, begun);

    study::calibration_log log(o.log, o.resume, begun);
    study::calibration c(begun);
    std::optional<study::observer> observer;
    if (simulated)
        observer.emplace(*simulated, begun);
    replay(c, log, observer ? &*observer : nullptr);
    if (const auto kept = log.begin())
        say(stderr, "tactor: warning: {}: its last line was incomplete and was moved to {}\n", o.log,
            kept->string());
    if (log.lines().rows() > 0)
        say(stdout, "{}\n",
            c.done() ? "all trials are answered" : fmt::format("continues at trial {}", c.next().number));
    int signal = 0;
    if (observer)
        ask(c, log, *observer, [](const study::calibration_record&) {});
    else if (!c.done())
        signal = run_threshold_trials(c, log, s, e, o);
    if (signal != 0) {
        if (c.next().number == 1)
            say(stderr, "tactor: ended before trial 1, without an answer\n");
        else
            say(stderr, "tactor: ended before trial {}: the answers are in {} (continue with --resume)\n",
                c.next().number, o.log);
        return session::interrupt::status(signal);
    }
    return write_result(o, e, besides, c);
}

} // namespace

int run_calibrate(command_line& line)
{
    calibrate_options o;
    add_calibrate_options(line.app, o);
    settings& s = add_options(line, options::on_calibrate);
    line.app.footer("tactor calibrate --participant P07 -o P07.toml -D hw:CARD=Tactor\n"
                    "tactor calibrate --participant P07 -o P07.toml -D hw:CARD=Tactor --resume\n"
                    "tactor calibrate --participant S01 -o S01.toml --simulate threshold=-45,seed=1");
    line.parse();
    for (const method_option& one : all_method_options)
        if (line.app.count(one.name) > 0)
            o.method_options.push_back(one);
    return calibrate(s, o);
}

} // namespace tactor::cli
