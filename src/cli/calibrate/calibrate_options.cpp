// SPDX-License-Identifier: MIT
#include "cli/calibrate/calibrate_options.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/session/page_options.hpp"
#include "core/split.hpp"
#include "options/parse_number.hpp"

namespace tactor::cli {
namespace {

using take = std::function<void(const std::string&)>;

constexpr double most_seed = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t most_steps = 20;

void add(CLI::App& c, const std::string& names, const std::string& type, const std::string& help,
         const take& t)
{
    c.add_option_function<std::string>(names, t, help)->type_name(type);
}

std::uint32_t whole(const char* option, const std::string& text, double low, double high)
{
    return static_cast<std::uint32_t>(options::parse_whole(option, text, {low, high}, ""));
}

bool one_of(const char* option, const std::string& text, const char* yes, const char* no)
{
    if (text != yes && text != no)
        refuse_setting(option, fmt::format("\"{}\" is not known", text),
                       fmt::format("one of {}, {}", yes, no));
    return text == yes;
}

std::string code(const std::string& text)
{
    if (text.empty() || !std::all_of(text.begin(), text.end(), [](unsigned char ch) {
            return (ch >= '0' && ch <= '9') || (ch >= 'a' && ch <= 'z') || (ch >= 'A' && ch <= 'Z');
        }))
        refuse_setting("--participant", fmt::format("\"{}\" is no code", text),
                       "letters and digits only, as P07");
    return text;
}

std::vector<double> steps(const std::string& text)
{
    std::vector<double> all;
    for (const std::string_view part : detail::split(text, ','))
        all.push_back(options::parse_number("--steps", std::string(part), {0.01, 60.0}, "dB"));
    if (all.size() > most_steps)
        refuse_setting("--steps", fmt::format("{} steps", all.size()), fmt::format("at most {}", most_steps));
    return all;
}

void add_staircase_options(CLI::App& c, calibrate_options& o)
{
    study::staircase_options& s = o.settings.staircase;
    const auto only = [&o](const char* name, const take& t) {
        return [&o, name, t](const std::string& text) {
            t(text);
            o.of_staircase.emplace_back(name);
        };
    };
    add(c, "--rule", "1up3down|1up2down", "what is right in 79.4 % (default), or in 70.7 %",
        only("--rule", [&s](const std::string& t) {
            s.right_for_down = one_of("--rule", t, "1up3down", "1up2down") ? 3 : 2;
        }));
    add(c, "--steps", "DB,DB,...", "steps, the next from every second reversal on (default 4,2,1)",
        only("--steps", [&s](const std::string& t) { s.steps_db = steps(t); }));
    add(c, "--reversals", "N", "reversals before the threshold is taken (default 12)",
        only("--reversals", [&s](const std::string& t) {
            s.reversals = whole("--reversals", t, 2, static_cast<double>(study::most_reversals));
        }));
    add(c, "--discard", "N", "the first of them, which do not count (default 4)",
        only("--discard", [&s](const std::string& t) {
            s.discard = whole("--discard", t, 0, static_cast<double>(study::most_reversals));
        }));
    add(c, "--feedback", "on|off", "whether the participant is told what was right (default on)",
        only("--feedback",
             [&o](const std::string& t) { o.settings.feedback = one_of("--feedback", t, "on", "off"); }));
    add(c, "--practice", "N", "trials at first that do not count (default 0)",
        only("--practice",
             [&o](const std::string& t) { o.settings.practice = whole("--practice", t, 0, 1000); }));
}

void add_masker_options(CLI::App& c, calibrate_options& o)
{
    add(c, "--masker", "PCM", "masking noise on a second device, in stereo, through both intervals",
        [&o](const std::string& t) {
            if (t.empty())
                refuse_setting("--masker", "no device is named", "as hw:CARD=Phones");
            o.masker = t;
        });
    add(c, "--masker-noise", "white|pink", "which noise (default white)", [&o](const std::string& t) {
        o.masking.color = one_of("--masker-noise", t, "white", "pink") ? study::noise_color::white
                                                                       : study::noise_color::pink;
        o.of_masker.emplace_back("--masker-noise");
    });
    add(c, "--masker-dbfs", "DB", "level of the noise, root of the mean square (default -30)",
        [&o](const std::string& t) {
            o.masking.level_dbfs =
                options::parse_number("--masker-dbfs", t, detail::bounds_of::masker_dbfs, "dBFS");
            o.of_masker.emplace_back("--masker-dbfs");
        });
}

} // namespace

void refuse_setting(std::string_view option, const std::string& why, std::string_view hint)
{
    throw error(error_kind::bad_input, option, why, hint);
}

void add_calibrate_options(CLI::App& c, calibrate_options& o)
{
    study::calibration_settings& s = o.settings;
    c.add_option_function<std::string>(
         "--participant", [&s](const std::string& t) { s.participant = code(t); },
         "who is measured: letters and digits")
        ->type_name("CODE")
        ->required();
    c.add_option("-o,--output", o.output, "the array file to write, with the thresholds")
        ->type_name("FILE.toml")
        ->required();
    add(c, "--method", "staircase|adjustment", "two intervals and a question (default), or a level to set",
        [&s](const std::string& t) {
            s.method = one_of("--method", t, "staircase", "adjustment")
                           ? study::calibration_method::staircase
                           : study::calibration_method::adjustment;
        });
    add(c, "--tactors", "LIST", "which, in this order, as 0,3-5 (default all)",
        [&o](const std::string& t) { o.tactors = t; });
    add(c, "--interval", "S", "how long each interval or pulse is (default 0.5)", [&s](const std::string& t) {
        s.interval_s = options::parse_number("--interval", t, detail::bounds_of::interval_s, "s");
    });
    add(c, "--start-dbfs", "DB", "level of the first trial (default -20)", [&o, &s](const std::string& t) {
        s.staircase.start_dbfs = options::parse_number("--start-dbfs", t, {study::floor_dbfs, 0}, "dBFS");
        o.start_asked = true;
    });
    add_staircase_options(c, o);
    add_masker_options(c, o);
    add_page_options(c, o.page);
    add_keypad_option(c, o.keypads);
    add(c, "--log", "FILE.tsv", "a line for each trial (default: the output's name with .tsv)",
        [&o](const std::string& t) { o.log = t; });
    c.add_flag("--resume", o.resume, "go on with the session that the log is of");
    add(c, "--simulate", "SPEC",
        "nobody and no device: an observer, as seed=1,threshold=-45,spread=2,lapse=0.02",
        [&o](const std::string& t) { o.simulate = t; });
    add(c, "--seed", "N", "of the order of intervals (default: from the participant's code)",
        [&o](const std::string& t) { o.seed = whole("--seed", t, 0, most_seed); });
}

void settle_names(calibrate_options& o)
{
    namespace fs = std::filesystem;
    if (fs::path(o.output).extension() != ".toml")
        refuse_setting("-o", fmt::format("\"{}\" does not end in .toml", o.output),
                       "it will be an array file, as me.toml");
    if (o.log.empty())
        o.log = fs::path(o.output).replace_extension(".tsv").string();
    else if (fs::path(o.log).extension() != ".tsv")
        refuse_setting("--log", fmt::format("\"{}\" does not end in .tsv", o.log), "as me.tsv");
}

} // namespace tactor::cli
