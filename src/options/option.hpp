// SPDX-License-Identifier: MIT
/// \file
/// The table of options: one row for each thing that a user may set, from which all front ends are made; the
/// values of all options; and how errors about them become messages of a front end.
///
/// An error has a field ("soa_s"), a place in a file, and marks in its texts (core/marks.hpp). Each front end
/// has a spelling that writes field and marks: cli/settings.cpp ("--soa"), server/faults.cpp
/// ("options.soa"), python/options.cpp ("soa"), study/experiment/definition.cpp. at_default() puts the place
/// in [defaults] before an option's error. None of them looks into the words.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <tactor/choices.hpp>
#include <tactor/error.hpp>
#include <tactor/percept.hpp>
#include <tactor/plan.hpp>
#include <tactor/render.hpp>

#include "core/bounds.hpp"
#include "percept/compare.hpp"

namespace tactor::options {

struct option;

/// Opening, driving and recording of a stream.
struct stream_options {
    std::optional<double> latency_ms = {};
    std::optional<unsigned> period_frames = {};
    std::optional<unsigned> periods = {};
    bool require_realtime = false;
    double reopen_s = 0.0; ///< longest wait for a lost device
    bool void_on_xrun = false;
    bool arm = false; ///< strokes wait for an edge on the [sync] in line
    double sync_delay_ms = 50.0;
    bool live = false;                   ///< points come from standard input
    std::optional<double> smooth_s = {}; ///< smoothing of those points
    bool no_gpio = false;
    bool no_desktop = false; ///< ask neither RealtimeKit nor sound servers
    bool verbose = false;    ///< log on standard error
    std::string log = {};    ///< file that log lines are appended to; empty: none
    std::optional<double> power_dbfs = {};
    std::optional<double> max_drive_s = {};
    std::optional<double> drive_window_s = {};
};

/// Most rows that the table may have.
inline constexpr std::size_t most_options = 128;

/// Values of all options: the user's, else that of [defaults], else the built-in default.
struct option_values {
    std::optional<std::string> path_data = {};   ///< SVG path data in place of a stroke
    std::optional<std::string> shape = {};       ///< name of a shape in place of a stroke
    std::optional<std::string> array_name = {};  ///< preset or file
    std::optional<std::string> config_file = {}; ///< configuration file
    std::optional<std::string> pcm = {};
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {};
    std::optional<double> usual_speed_mm_s = {};   ///< speed of strokes that have neither a time nor a speed
    std::optional<double> intensity_max = {};      ///< value in a recording that means intensity 1
    std::optional<std::string> position = {};      ///< place on the body whose touches a file plays
    std::optional<actuator_numbers> actuator = {}; ///< [texture] of a file
    bool fit = false;
    double fit_margin_mm = 0.0;
    std::optional<unsigned> rate = {};
    std::optional<unsigned> channels = {};
    std::optional<format_kind> format = {};
    bool compensate = false; ///< used with the observer low_speed
    observer_kind observer = observer_kind::centroid;
    low_speed_observer low_speed = {};
    detail::spread_choice spread = {};
    plan_options plan = {};
    render_options render = {};
    stream_options stream = {};

    std::uint64_t place = 0;                          ///< front end: bits of `place`
    std::bitset<most_options> by_user = {};           ///< rows that the user set
    std::map<std::size_t, source_place> in_file = {}; ///< rows of [defaults], with their places

    /// Returns true if the user set the option. \pre An option has that name.
    bool gives(std::string_view name) const;
    bool gives(const option& o) const;
};

/// Headings under which help and manual list options.
namespace group {
inline constexpr std::string_view stroke = "Stroke";
inline constexpr std::string_view place = "Place";
inline constexpr std::string_view timing = "Timing";
inline constexpr std::string_view sound = "Sound";
inline constexpr std::string_view level = "Level";
inline constexpr std::string_view device = "Device";
inline constexpr std::string_view real_time = "Real time";
inline constexpr std::string_view output = "Output";
} // namespace group

enum class kind : std::uint8_t { number, whole, choice, flag, text };

/// Places where an option may be set, a bit each.
enum place : std::uint64_t {
    on_plan = 1,
    on_render = 1 << 1,
    on_plot = 1 << 2,
    on_compare = 1 << 3,
    on_play = 1 << 4,
    on_check = 1 << 5,
    on_calibrate = 1 << 6,
    on_experiment = 1 << 7,
    on_devices = 1 << 8,
    on_off = 1 << 9,
    on_serve = 1 << 10,
    on_convert = 1 << 25,
    on_any_command = ((1 << 11) - 1) | on_convert,
    in_defaults = 1 << 11,    ///< [defaults] of a configuration or array file
    in_method = 1 << 12,      ///< [[method]] of a definition
    by_client = 1 << 13,      ///< strokes that a client of the service requests
    live = 1 << 14,           ///< strokes that are fed point by point
    in_plan = 1 << 15,        ///< Python's plan() and Score.plan()
    in_score = 1 << 16,       ///< Python's Score()
    in_compare = 1 << 17,     ///< Python's compare()
    planning = 1 << 18,       ///< decides how a stroke is planned: refused together with a plan
    through_server = 1 << 19, ///< play --socket takes it, though no client sends it
    in_stroke = 1 << 20,      ///< a stroke file has a key of the field's name
    in_player = 1 << 21,      ///< Python's Player()
    shown_first = 1 << 22,    ///< --help explains it; most people need it
    unstated = 1 << 23,       ///< a report on methods does not state its default
    file_only = 1 << 24,      ///< commands use it, but only [defaults] of a file sets it for them
};

/// A place and its name there.
struct place_name {
    place bit;
    std::string_view name;
};

/// Returns the commands that take options of the table, in the order of help.
[[nodiscard]] std::span<const place_name> command_names() noexcept;

/// A value on its way from a front end: nothing, a flag, a number (whole ones, too), or a text or choice.
using value = std::variant<std::monostate, bool, double, std::string>;

/// Functions that set and get the member for which an option stands.
struct access {
    /// \pre The value is of the option's kind, in bounds, and one of the choices; or it is empty, which
    ///         clears an option that has a rival.
    /// \throws error (bad_input) for a text that cannot be read.
    void (*set)(option_values&, const value&) = nullptr;
    value (*get)(const option_values&) = nullptr;
};

/// A row of the table.
struct option {
    std::string_view name = {};  ///< "level_dbfs"; the command line writes - for _
    std::string_view field = {}; ///< name in the library and in stroke files: "soa_s"; empty: the name
    std::string_view unit = {};  ///< "s", "mm", "Hz"; empty: none
    kind what = kind::number;
    detail::bounds allowed = {};
    std::string_view range = {}; ///< bounds in words, unless these two numbers are enough
    std::vector<std::string_view> (*choices)() = nullptr;
    std::string_view shown = {};  ///< type of the value in help; empty: by unit or choices: "HZ[:DEPTH]"
    std::string_view letter = {}; ///< the command line's short name
    std::string_view in = group::stroke;
    std::string_view help = {}; ///< one line, with the default
    std::uint64_t where = 0;
    std::string_view rival = {};                  ///< name of the option that cannot be set together with it
    bool (*used)(const option_values&) = nullptr; ///< true if anything uses the value; null: always
    std::string_view needs = {}; ///< options to add if nothing uses it, as marks; alternatives separated by |
    access to = {};

    [[nodiscard]] std::string_view field_name() const noexcept { return field.empty() ? name : field; }
    /// Returns true if a plan keeps the value as a part of its sound.
    [[nodiscard]] bool is_sound() const noexcept
    {
        return (where & in_score) != 0 && (where & in_defaults) != 0;
    }
};

/// Returns all rows, in the order of help and manual.
[[nodiscard]] std::span<const option> all() noexcept;

/// Returns the row of that name, with _ or - between its words, or of that field; null for none.
[[nodiscard]] const option* find(std::string_view name) noexcept;
/// Returns the place of a row in the table.
[[nodiscard]] inline std::size_t index(const option& o) noexcept
{
    return static_cast<std::size_t>(&o - all().data());
}

inline bool option_values::gives(const option& o) const
{
    return by_user[index(o)];
}

inline bool option_values::gives(std::string_view name) const
{
    return gives(*find(name));
}

/// Returns the name with - between its words.
[[nodiscard]] std::string dashed(const option& o);
/// Returns the names of all rows with a bit of `where`, with - between their words.
[[nodiscard]] std::vector<std::string> dashed_names(std::uint64_t where);
/// Returns a value as messages show it.
[[nodiscard]] std::string shown(const value& v);
/// Returns an error about an option. Its texts may have marks.
[[nodiscard]] error refusal(const option& o, std::string_view why, std::string_view hint);

/// Returns the value's type as help shows it: "S", "a|b|c".
[[nodiscard]] std::string type_text(const option& o);
/// Returns the values of a choice with ", " between them.
[[nodiscard]] std::string choices_text(const option& o);
/// Returns the bounds in words: "0 to 10 s".
[[nodiscard]] std::string range_text(const option& o);

/// Parses a text as people type it: "0.07", "s16", "true".
/// \throws error (bad_input) about the option, with its bounds or choices.
value read_text(const option& o, const std::string& text);

/// Checks a typed value and returns it: a number is within the bounds, a text one of the choices.
/// \throws error (bad_input) likewise.
value read_value(const option& o, const value& v);

/// Sets an option to a result of read_text() or read_value().
/// \throws error (bad_input), about the option, for a text that cannot be read.
void put(option_values& w, const option& o, const value& v);

/// Returns the bounds in words: "0 to 10 s".
std::string range_text(detail::bounds b, std::string_view unit);

/// Parses a finite number within bounds.
/// \throws error (bad_input) about `what`. The message has the text, the number without its unit if the text
///         has one, and the range: `range`, or `b` if that is empty.
double parse_number(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit,
                    std::string range = {});
/// Parses a whole number within bounds.
/// \throws error (bad_input) likewise.
double parse_whole(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit);

/// Returns the start of a hint before a range: "did you mean -12? Use " for a number that is out of bounds
/// without its minus sign, else "use ".
std::string sign_hint(detail::bounds b, double v);

/// A front end's own word for a mark, or for a field that is not in the table: {"command:devices",
/// "devices()"}. The mark "array" stands for {array=palm}, too, and {} in the word for its value. An empty
/// word drops the mark and its clause.
struct own_word {
    std::string_view mark;
    std::string_view here;
};

/// A front end's way to write options.
struct spelling {
    /// Name of an option, or its setting to a value: "--timing", "--timing fit". The value of a flag is
    /// "true".
    std::string (*write)(const option& o, std::string_view value) = nullptr;
    std::uint64_t where = ~std::uint64_t{0}; ///< bits of its options; others are written as fields
    std::span<const own_word> own = {};
};

/// Writes the marks of a text. Unknown braces stay. `in_file`: keys of stroke files are written as fields.
std::string spell(std::string_view text, const spelling& by, bool in_file = false);
/// Writes the name of a field.
std::string spell_field(std::string_view field, const spelling& by);
/// Writes what an error is about, and its marks.
error spell(const error& e, const spelling& by);

} // namespace tactor::options
