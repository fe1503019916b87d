// SPDX-License-Identifier: MIT
#include "cli/settings.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/option_words.hpp"
#include "cli/parse_number.hpp"
#include "core/kind_names.hpp"
#include "core/words.hpp"
#include "files/setup_defaults.hpp"

namespace tactor::cli {
namespace {

namespace of = detail::option_bounds;

constexpr int max_strokes = 10000; // on one command line
// The planner holds it to the timing law and says so in its words: no number is refused before.
constexpr const char* soa_range = "above 0.0473 to 0.07 s by the usual timing law; see --burst for others";

// A choice among names that the library can print: "a|b|c" and the value of the one given.
template <class Enum>
struct choice {
    std::string names(const char* separator) const
    {
        return fmt::format("{}", fmt::join(detail::names_of<Enum>(), separator));
    }

    Enum parse(const std::string& option, const std::string& text) const
    {
        if (const auto v = detail::kind_named<Enum>(text))
            return *v;
        throw error(error_kind::bad_input, option, fmt::format("\"{}\" is not known", text),
                    "one of " + names(", "));
    }
};

constexpr choice<algorithm_kind> algorithms;
constexpr choice<phantom_kind> phantoms;
constexpr choice<faces_kind> all_faces;
constexpr choice<timing_kind> timings;
constexpr choice<outside_kind> outsides;
constexpr choice<overlap_kind> overlaps;
constexpr choice<phase_kind> phases;
constexpr choice<observer_kind> observers;

// Options that only planning uses.
constexpr std::array planning_options{"duration",        "speed",
                                      "algorithm",       "phantom",
                                      "faces",           "soa",
                                      "burst",           "slope",
                                      "intercept",       "timing",
                                      "outside",         "fit",
                                      "fit-margin",      "snap",
                                      "drop-points",     "overlap",
                                      "carrier",         "compensate",
                                      "sigma-mm",        "sigma-v-mm-s",
                                      "waveform",        "am",
                                      "noise-seed",      "texture",
                                      "texture-mm",      "intensity-scale",
                                      "stevens-exponent"};

bool parse_flag(const std::string& what, const std::string& text)
{
    if (text == "true")
        return true;
    if (text == "false")
        return false;
    throw error(error_kind::bad_input, what, fmt::format("\"{}\" is neither true nor false", text));
}

bool parse_compensation(const std::string& text)
{
    if (text == "none" || text == "low-speed")
        return text != "none";
    throw error(error_kind::bad_input, "--compensate", fmt::format("\"{}\" is not known", text),
                "one of none, low-speed");
}

// The long name of "-D,--device", without its dashes.
std::string bare(std::string_view names)
{
    const std::size_t dashes = names.rfind("--");
    return std::string(dashes == std::string_view::npos ? names : names.substr(dashes + 2));
}

// What is wrong with the option's value, which stands in a file.
error said_at(const source_place& at, const std::string& name, const error& e)
{
    const std::string option = "--" + name;
    std::string why = fmt::format("{}: {}", e.subject(), e.why());
    if (const std::size_t said = why.find(option + ": "); said != std::string::npos)
        why.erase(said, option.size() + 2);
    return e.reworded(at.text(), fmt::format("{}: {}", name, why), e.hint()).with_place(at);
}

} // namespace

void add_force_option(CLI::App& command, bool& into)
{
    command.add_flag("--force", into, "replace a file that tactor did not write; never one that is read");
}

void add_format_option(CLI::App& command, std::string& into, const std::vector<std::string>& names,
                       const std::string& help)
{
    into = names.front();
    command
        .add_option_function<std::string>(
            "--format",
            [&into, names](const std::string& t) {
                if (std::find(names.begin(), names.end(), t) == names.end())
                    throw error(error_kind::bad_input, "--format", fmt::format("\"{}\" is not known", t),
                                fmt::format("one of {}", fmt::join(names, ", ")));
                into = t;
            },
            help)
        ->type_name(fmt::format("{}", fmt::join(names, "|")));
}

option_list::option_list(CLI::App& command, settings& into) : command_(command), settings_(into)
{
}

CLI::Option* option_list::value(const std::string& names, const std::string& type, const std::string& help,
                                setter set)
{
    CLI::Option* o = command_.add_option_function<std::string>(names, set, help)->type_name(type);
    by_name_[bare(names)] = {o, std::move(set)};
    return o;
}

CLI::Option* option_list::flag(const std::string& name, const std::string& help, bool& into)
{
    CLI::Option* o = command_.add_flag(name, into, help);
    by_name_[bare(name)] = {o, [name, &into](const std::string& t) { into = parse_flag(name, t); }};
    return o;
}

void option_list::add_stroke_options()
{
    settings& s = settings_;
    auto* strokes = command_.add_option(
        "STROKE", s.strokes,
        "preset (park2016-1 ... park2016-4; wave-2x4 and round-2x4 on palm-2x4), "
        "file (.toml, .csv, .svg; .json: a plan), or - for such a file on standard input");
    strokes->type_name("");
    strokes->expected(0, max_strokes);
    value("--path", "DATA", "SVG path data in mm instead of STROKE",
          [&s](const std::string& t) { s.path_data = t; });
    value("--shape", fmt::format("{}", fmt::join(stroke_shapes(), "|")),
          "as large as the array, instead of STROKE, for first steps", [&s](const std::string& t) {
              static_cast<void>(shape_stroke(t)); // refuses what is none
              s.shape = t;
          });
    add_array_options();
    add_timing_options();
    value("--phantom", phantoms.names("|"), "how strongly (default inverse-distance)",
          [&s](const std::string& t) { s.plan.phantom = phantoms.parse("--phantom", t); });
    value("--faces", all_faces.names("|"),
          "inverse-distance: three tactors round the point, or the closest three (default delaunay)",
          [&s](const std::string& t) { s.plan.faces = all_faces.parse("--faces", t); });
    auto* duration = value(
        "--duration", "S", "time of each stroke; default: the file's or preset's",
        [&s](const std::string& t) { s.duration_s = parse_number("--duration", t, 0.001, 86400, "s"); });
    auto* speed =
        value("--speed", "MM_PER_S", "speed instead of a time (default 60 where nothing says one)",
              [&s](const std::string& t) { s.speed_mm_s = parse_number("--speed", t, of::speed, "mm/s"); });
    duration->excludes(speed);
    value("--timing", timings.names("|"), "SOA as given, or fitted to end with the path (default fixed)",
          [&s](const std::string& t) { s.plan.timing = timings.parse("--timing", t); });
    value("--outside", outsides.names("|"),
          "paths that leave the array: refuse, or move to its edge "
          "(default error)",
          [&s](const std::string& t) { s.plan.outside = outsides.parse("--outside", t); });
    auto* fit = flag("--fit", "scale and centre what is drawn on the array", s.fit);
    value("--fit-margin", "MM", "--fit: distance kept from the array's edge (default 0)",
          [&s](const std::string& t) { s.fit_margin_mm = parse_number("--fit-margin", t, 0, 1e6, "mm"); })
        ->needs(fit);
    flag("--snap", "tactile-brush: move a start or end onto the grid", s.plan.snap);
    flag("--drop-points", "tactile-brush: leave crossings out until the timing is possible",
         s.plan.drop_points);
    value("--overlap", overlaps.names("|"), "bursts that overlap on one tactor (default energy)",
          [&s](const std::string& t) { s.plan.overlap = overlaps.parse("--overlap", t); });
    add_compensation_options();
}

void option_list::add_array_options()
{
    settings& s = settings_;
    value("--array", "NAME|FILE", "palm-3x3 (default), palm-2x4, or an array file",
          [&s](const std::string& t) { s.array_name = t; });
    value("--config", "FILE", "configuration, see tactor.toml(5)",
          [&s](const std::string& t) { s.config_file = t; });
}

void option_list::add_timing_options()
{
    settings& s = settings_;
    value("--algorithm", algorithms.names("|"), "who plays when (default park2016)",
          [&s](const std::string& t) { s.plan.algorithm = algorithms.parse("--algorithm", t); });
    value("--soa", "S", "onset to onset of two bursts (default 0.07)",
          [&s](const std::string& t) { s.plan.soa_s = parse_number("--soa", t, -1e9, 1e9, "s", soa_range); });
    value("--burst", "S", "duration of each burst (default: what the timing law gives for the SOA)",
          [&s](const std::string& t) { s.plan.burst_s = parse_number("--burst", t, of::burst, "s"); });
    value("--slope", "A", "slope of the timing law SOA = A duration + S (default 0.32)",
          [&s](const std::string& t) { s.slope = parse_number("--slope", t, of::slope, ""); });
    value("--intercept", "S", "intercept of the timing law (default 0.0473)",
          [&s](const std::string& t) { s.intercept_s = parse_number("--intercept", t, of::intercept, "s"); });
}

void option_list::add_observer_options()
{
    settings& s = settings_;
    value("--observer", observers.names("|"), "who is predicted to feel it (default centroid)",
          [&s](const std::string& t) { s.observer = observers.parse("--observer", t); });
}

void option_list::add_compensation_options()
{
    settings& s = settings_;
    value("--compensate", "none|low-speed", "move bursts so that the low-speed observer feels the target",
          [&s](const std::string& t) { s.compensate = parse_compensation(t); });
    value("--sigma-mm", "MM", "low-speed: how well places are known (default 5)", [&s](const std::string& t) {
        s.low_speed.sigma_mm = parse_number("--sigma-mm", t, least_sigma_mm, most_sigma_mm, "mm");
    });
    value("--sigma-v-mm-s", "MM_PER_S", "low-speed: which speeds are expected (default 100)",
          [&s](const std::string& t) {
              s.low_speed.sigma_v_mm_s =
                  parse_number("--sigma-v-mm-s", t, least_sigma_v_mm_s, most_sigma_v_mm_s, "mm/s");
          });
}

void option_list::add_carrier_option()
{
    settings& s = settings_;
    value("--carrier", "HZ", "frequency of the vibration (default 250)", [&s](const std::string& t) {
        s.plan.carrier_hz = parse_number("--carrier", t, of::carrier, "Hz");
    });
}

void option_list::add_sound_options()
{
    settings& s = settings_;
    add_carrier_option();
    add_waveform_options();
    value("--phase", phases.names("|"), "carrier starts with the stroke (default) or again with each burst",
          [&s](const std::string& t) { s.render.phase = phases.parse("--phase", t); });
    value("--ramp", "S",
          "raised-cosine ramp inside each burst (default: 0 between zero crossings, else 0.002)",
          [&s](const std::string& t) { s.render.ramp_s = parse_number("--ramp", t, of::ramp, "s"); });
    add_envelope_options();
    auto* level = value("--level-dbfs", "DB", "peak of the carrier for intensity 1 (default -12)",
                        [&s](const std::string& t) {
                            s.render.level_dbfs = parse_number("--level-dbfs", t, of::level_dbfs, "dBFS");
                        });
    auto* sl = value("--sl", "DB", "instead: dB above each tactor's threshold", [&s](const std::string& t) {
        s.render.sl_db = parse_number("--sl", t, of::sl, "dB SL");
    });
    level->excludes(sl);
    add_scale_options();
    add_rate_options();
}

void option_list::add_rate_options()
{
    settings& s = settings_;
    value("--rate", "HZ", "sample rate (default 48000)", [&s](const std::string& t) {
        s.rate = static_cast<unsigned>(parse_whole("--rate", t, of::rate, "Hz"));
    });
    value("--sample-format", "float|s16|s24|s24-4|s32",
          "samples (render: float; play: what the device takes)",
          [&s](const std::string& t) { s.format = from_string<format_kind>(t); });
}

void option_list::add_channels_option()
{
    settings& s = settings_;
    value("--channels", "N",
          "channels of the stream (default: the configuration's, else what the array needs)",
          [&s](const std::string& t) {
              s.channels = static_cast<unsigned>(
                  parse_whole("--channels", t, {1.0, double{max_pcm_channels}}, "channels"));
          });
}

void option_list::add_device_options(const char* otherwise)
{
    settings& s = settings_;
    value("-D,--device", "PCM",
          fmt::format("ALSA device, e.g. hw:CARD=Tactor (default: the configuration's, {})", otherwise),
          [&s](const std::string& t) { s.pcm = t; });
    add_channels_option();
}

bool option_list::given(const std::string& name) const
{
    const auto own = by_name_.find(name);
    const CLI::Option* o =
        own != by_name_.end() ? own->second.first : command_.get_option_no_throw("--" + name);
    return o != nullptr && o->count() != 0;
}

bool option_list::has(const std::string& name) const
{
    return by_name_.contains(name);
}

void option_list::apply_defaults(const setup& says)
{
    for (const auto& [name, text] : detail::default_texts(says.defaults)) {
        const auto o = by_name_.find(name);
        // Not an option of this command, or the command line says it, in one way or the other.
        if (o == by_name_.end() || given(name) || (name == "speed" && given("duration")) ||
            (name == "sl" && given("level-dbfs")) || (name == "level-dbfs" && given("sl")))
            continue;
        const source_place& at = says.defaults_at.at(name);
        try {
            o->second.second(text);
        } catch (const error& e) {
            throw said_at(at, name, e);
        }
        if (name == "speed") // what a stroke says itself comes first
            settings_.usual_speed_mm_s = std::exchange(settings_.speed_mm_s, std::nullopt);
        from_files_.insert_or_assign(name, at);
    }
}

void option_list::refuse_planning(const std::string& what) const
{
    for (const char* option : planning_options)
        if (given(option))
            throw error(error_kind::bad_input, fmt::format("--{}", option),
                        fmt::format("{} is planned already", what),
                        "plan the stroke anew with it, or leave it out");
}

void option_list::settle()
{
    check_sound();
    settle_scale();
    for (const char* option : {"sigma-mm", "sigma-v-mm-s"})
        if (!settings_.compensate && settings_.observer != observer_kind::low_speed && given(option))
            throw error(error_kind::bad_input, fmt::format("--{}", option), "nothing here uses it",
                        has("observer") ? "add --observer low-speed or --compensate low-speed"
                                        : "add --compensate low-speed");
}

int option_list::run(const std::function<int()>& act) const
{
    try {
        return act();
    } catch (const error& e) {
        const std::string field(e.field());
        const auto said = from_files_.find(bare(in_options(e.reworded(field, "", "")).subject()));
        if (e.place().line != 0 || said == from_files_.end())
            throw;
        throw said_at(said->second, said->first, in_options(e));
    }
}

} // namespace tactor::cli
