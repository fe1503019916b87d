// SPDX-License-Identifier: MIT
#include "cli/calibrate/calibrate_options.hpp"

#include <filesystem>
#include <functional>
#include <limits>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/session/page_options.hpp"
#include "cli/settings.hpp"
#include "core/split.hpp"
#include "options/parse_number.hpp"
#include "study/bids/study_folder.hpp"

namespace tactor::cli {
namespace {

using take = std::function<void(const std::string&)>;

constexpr double most_seed = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t most_steps = 20;

std::uint32_t whole(const char* option, const std::string& text, double low, double high)
{
    return static_cast<std::uint32_t>(options::parse_whole(option, text, {low, high}, ""));
}

std::vector<double> steps(const std::string& text)
{
    std::vector<double> all;
    for (const std::string_view part : detail::split(text, ','))
        all.push_back(options::parse_number("--steps", std::string(part), {0.01, 60.0}, "dB"));
    if (all.size() > most_steps)
        refuse_option("--steps", fmt::format("{} steps", all.size()), fmt::format("at most {}", most_steps));
    return all;
}

void add_staircase_options(CLI::App& c, calibrate_options& o)
{
    study::staircase_options& s = o.settings.staircase;
    begin_group(c, "Staircase");
    const auto only = [&o](const char* name, const take& t) {
        return [&o, name, t](const std::string& text) {
            t(text);
            o.of_staircase.emplace_back(name);
        };
    };
    add_text(c, "--rule", "1up3down|1up2down",
             "find the level felt in 79.4 % of trials (default), or in 70.7 %",
             only("--rule", [&s](const std::string& t) {
                 s.right_for_down = choose("--rule", t, {"1up3down", "1up2down"}) == 0 ? 3 : 2;
             }));
    add_text(c, "--steps", "DB,DB,...", "steps; the next begins after every second reversal (default 4,2,1)",
             only("--steps", [&s](const std::string& t) { s.steps_db = steps(t); }));
    add_text(c, "--reversals", "N", "number of reversals of a staircase (default 12)",
             only("--reversals", [&s](const std::string& t) {
                 s.reversals = whole("--reversals", t, 2, static_cast<double>(study::most_reversals));
             }));
    add_text(c, "--discard", "N", "number of first reversals that do not count (default 4)",
             only("--discard", [&s](const std::string& t) {
                 s.discard = whole("--discard", t, 0, static_cast<double>(study::most_reversals));
             }));
    add_text(c, "--feedback", "on|off", "show the participant what was right (default on)",
             only("--feedback", [&o](const std::string& t) {
                 o.settings.feedback = choose("--feedback", t, {"on", "off"}) == 0;
             }));
    add_text(c, "--practice", "N", "first trials that do not count (default 0)",
             only("--practice",
                  [&o](const std::string& t) { o.settings.practice = whole("--practice", t, 0, 1000); }));
    begin_group(c);
}

void add_masker_options(CLI::App& c, calibrate_options& o)
{
    begin_group(c, "Masker");
    add_text(c, "--masker", "PCM", "play masking noise on this second device, in stereo, in both intervals",
             [&o](const std::string& t) {
                 if (t.empty())
                     refuse_option("--masker", "no device is named", "as hw:CARD=Phones");
                 o.masker = t;
             });
    add_text(
        c, "--masker-noise", "white|pink", "colour of the noise (default white)", [&o](const std::string& t) {
            o.masking.color = choose("--masker-noise", t, {"white", "pink"}) == 0 ? study::noise_color::white
                                                                                  : study::noise_color::pink;
            o.of_masker.emplace_back("--masker-noise");
        });
    add_text(c, "--masker-dbfs", "DB", "level of the noise, root of the mean square (default -30)",
             [&o](const std::string& t) {
                 o.masking.level_dbfs =
                     options::parse_number("--masker-dbfs", t, detail::bounds_of::masker_dbfs, "dBFS");
                 o.of_masker.emplace_back("--masker-dbfs");
             });
    begin_group(c);
}

} // namespace

void add_calibrate_options(CLI::App& c, calibrate_options& o)
{
    study::calibration_settings& s = o.settings;
    add_text(c, "--participant", "CODE", "the participant: letters and digits", [&s](const std::string& t) {
        study::check_code(t);
        s.participant = t;
    })->required();
    c.add_option("-o,--output", o.output, "array file to write, with the thresholds")
        ->type_name("FILE.toml")
        ->required();
    add_text(c, "--method", "staircase|adjustment",
             "ask about two intervals (default), or let the participant set a level",
             [&s](const std::string& t) {
                 s.method = choose("--method", t, {"staircase", "adjustment"}) == 0
                                ? study::calibration_method::staircase
                                : study::calibration_method::adjustment;
             });
    add_text(c, "--tactors", "LIST", "tactors to measure, in this order, such as 0,3-5 (default all)",
             [&o](const std::string& t) { o.tactors = t; });
    add_text(c, "--interval", "S", "duration of each interval or pulse (default 0.5)",
             [&s](const std::string& t) {
                 s.interval_s = options::parse_number("--interval", t, detail::bounds_of::interval_s, "s");
             });
    add_text(
        c, "--start-dbfs", "DB", "level of the first trial (default -20)", [&o, &s](const std::string& t) {
            s.staircase.start_dbfs = options::parse_number("--start-dbfs", t, {study::floor_dbfs, 0}, "dBFS");
            o.start_asked = true;
        });
    add_staircase_options(c, o);
    add_masker_options(c, o);
    add_page_options(c, o.page);
    add_text(c, "--page-words", "FILE",
             "take the words of the page from [page] of this experiment's definition",
             [&o](const std::string& t) { o.words = study::load_page_words(t); });
    add_keypad_option(c, o.keypads);
    add_text(c, "--log", "FILE.tsv",
             "table with a line for each trial (default: the output's name with .tsv)",
             [&o](const std::string& t) { o.log = t; });
    c.add_flag("--resume", o.resume, "continue the session of the log");
    add_text(c, "--simulate", "SPEC",
             "let a model answer, without a device: seed=1,threshold=-45,spread=2,lapse=0.02",
             [&o](const std::string& t) { o.simulate = t; });
    add_text(c, "--seed", "N", "seed of the order of intervals (default: from the participant's code)",
             [&o](const std::string& t) { o.seed = whole("--seed", t, 0, most_seed); });
}

void settle_names(calibrate_options& o)
{
    namespace fs = std::filesystem;
    if (fs::path(o.output).extension() != ".toml")
        refuse_option("-o", fmt::format("\"{}\" does not end in .toml", o.output),
                      "it will be an array file, as me.toml");
    if (o.log.empty())
        o.log = fs::path(o.output).replace_extension(".tsv").string();
    else if (fs::path(o.log).extension() != ".tsv")
        refuse_option("--log", fmt::format("\"{}\" does not end in .tsv", o.log), "as me.tsv");
}

} // namespace tactor::cli
