// SPDX-License-Identifier: MIT
/// \file
/// The table of options. It has one row for each option that a user may set, and all front ends are made from
/// it. This file also declares the values of all options, and the conversion of errors about options to
/// messages of a front end.
///
/// An error has a field ("soa_s"), a place in a file, and marks in its texts (core/marks.hpp). Each front end
/// has a spelling, which determines how field and marks are written: cli/settings.cpp ("--soa"),
/// server/faults.cpp ("options.soa"), python/options.cpp ("soa"), study/experiment/definition.cpp. If the
/// option comes from [defaults], locate_default_error() adds the place in [defaults] to the error. No front
/// end parses the text of an error.
#pragma once

#include <array>
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

/// Options for opening, playing and recording a stream.
struct stream_options {
    std::optional<double> latency_ms = {};
    std::optional<unsigned> period_frames = {};
    std::optional<unsigned> periods = {};
    bool require_realtime = false;
    double reopen_s = 0.0; ///< longest wait for a lost device, s
    bool void_on_xrun = false;
    bool arm = false; ///< strokes wait for an edge on the line `in` of [sync]
    double sync_delay_ms = 50.0;
    bool live = false;                   ///< points come from standard input
    std::optional<double> smooth_s = {}; ///< smoothing time of these points
    bool no_gpio = false;
    bool no_desktop = false; ///< if true, asks neither RealtimeKit nor sound servers nor logind
    bool verbose = false;    ///< if true, writes the log to standard error
    std::string log = {};    ///< file to which log lines are appended; empty if none
    std::optional<double> power_dbfs = {};
    std::optional<double> max_drive_s = {};
    std::optional<double> drive_window_s = {};
};

/// Greatest number of rows in the table.
inline constexpr std::size_t most_options = 128;

/// Values of all options. A value comes from the user, otherwise from [defaults], otherwise it is the
/// built-in default.
struct option_values {
    std::optional<std::string> path_data = {};   ///< SVG path data, used as the stroke
    std::optional<std::string> shape = {};       ///< name of a shape, used as the stroke
    std::optional<std::string> array_name = {};  ///< name of a preset or a file
    std::optional<std::string> config_file = {}; ///< name of the configuration file
    std::optional<std::string> pcm = {};
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {};
    std::optional<double> usual_speed_mm_s = {};   ///< speed for strokes without a time or speed
    std::optional<double> intensity_max = {};      ///< value that means intensity 1 in a recording
    std::optional<std::string> position = {};      ///< place on the body; only its touches are played
    std::optional<actuator_numbers> actuator = {}; ///< [texture] from a file
    bool fit = false;
    double fit_margin_mm = 0.0;
    std::optional<unsigned> rate = {};
    std::optional<unsigned> channels = {};
    std::optional<format_kind> format = {};
    bool compensate = false; ///< true: bursts are moved for the observer low_speed
    observer_kind observer = observer_kind::centroid;
    low_speed_observer low_speed = {};
    detail::spread_choice spread = {};
    plan_options plan = {};
    render_options render = {};
    stream_options stream = {};

    std::uint64_t place = 0;                          ///< bits of enum `place` for the current front end
    std::bitset<most_options> by_user = {};           ///< rows that the user set
    std::map<std::size_t, source_place> in_file = {}; ///< rows set by [defaults], with their places

    /// Returns true if the user set the option. \pre An option with this name exists.
    bool gives(std::string_view name) const;
    bool gives(const option& o) const;
};

/// Headings of the groups of options in help and manual.
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
inline constexpr std::array<std::string_view, 5> kind_names{"number", "whole", "choice", "flag", "text"};

/// Places where an option may be set, and other properties of an option. Each is one bit.
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
    by_client = 1 << 13,      ///< requests for strokes by clients of the service
    live = 1 << 14,           ///< strokes that receive their points one by one
    in_plan = 1 << 15,        ///< Python's plan() and Score.plan()
    in_score = 1 << 16,       ///< Python's Score()
    in_compare = 1 << 17,     ///< Python's compare()
    planning = 1 << 18,       ///< affects planning, so it is refused for existing plans
    through_server = 1 << 19, ///< allowed with play --socket, though clients do not send it
    in_stroke = 1 << 20,      ///< a stroke file has a key with the name of its field
    in_player = 1 << 21,      ///< Python's Player()
    shown_first = 1 << 22,    ///< shown by --help, because most people need it
    unstated = 1 << 23,       ///< a report on methods leaves out its default value
    file_only = 1 << 24,      ///< used by commands, but set only in [defaults] of a file
};

/// A bit of enum `place`, and the name of this place.
struct place_name {
    place bit;
    std::string_view name;
};

/// Returns the commands that have options from the table, in the order of the help.
[[nodiscard]] std::span<const place_name> command_names() noexcept;

/// A value from a front end: nothing, a flag, a number (which may be an integer), or a text or choice.
using value = std::variant<std::monostate, bool, double, std::string>;

/// Functions that set and get the member for an option.
struct access {
    /// Sets the member.
    /// \pre The value has the option's kind, is within bounds, and is one of the choices. An empty value
    ///         clears an option that has a rival.
    /// \throws error (bad_input) for a text that cannot be parsed.
    void (*set)(option_values&, const value&) = nullptr;
    value (*get)(const option_values&) = nullptr;
};

/// A row of the table.
struct option {
    std::string_view name = {};  ///< "level_dbfs"; the command line has - instead of _
    std::string_view field = {}; ///< "soa_s", in the library and in stroke files; empty if equal to `name`
    std::string_view unit = {};  ///< "s", "mm", "Hz"; empty if none
    kind what = kind::number;
    detail::bounds allowed = {};
    std::string_view range = {}; ///< bounds in words, where `allowed` alone is not enough
    std::vector<std::string_view> (*choices)() = nullptr;
    std::string_view shown = {};  ///< type in help: "HZ[:DEPTH]"; empty if it follows from unit or choices
    std::string_view letter = {}; ///< short name on the command line
    std::string_view in = group::stroke;
    std::string_view help = {}; ///< a line with the default
    std::uint64_t where = 0;
    std::string_view rival = {};                  ///< name of an option that excludes this one
    bool (*used)(const option_values&) = nullptr; ///< returns true if the value is used; null: always
    std::string_view needs = {}; ///< marks of options that make this one useful, with | between alternatives
    access to = {};

    [[nodiscard]] std::string_view field_name() const noexcept { return field.empty() ? name : field; }
    /// Returns true if a plan stores the value as part of its sound.
    [[nodiscard]] bool is_sound() const noexcept
    {
        return (where & in_score) != 0 && (where & in_defaults) != 0;
    }
};

/// Returns all rows, in the order of the help and the manual.
[[nodiscard]] std::span<const option> all() noexcept;

/// Returns the row with this name or field, or null if there is none. In names, _ and - are equal.
[[nodiscard]] const option* find(std::string_view name) noexcept;
/// Returns the index of a row in the table.
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

/// Returns the name with - instead of _.
[[nodiscard]] std::string dashed(const option& o);
/// Returns the names of all rows that have a bit of `where`, with - instead of _.
[[nodiscard]] std::vector<std::string> dashed_names(std::uint64_t where);
/// Returns a value in the form for messages.
[[nodiscard]] std::string value_text(const value& v);
/// Returns an error about an option. The texts may contain marks.
[[nodiscard]] error refusal(const option& o, std::string_view why, std::string_view hint);

/// Returns the type of a value in the form for the help: "S", "a|b|c".
[[nodiscard]] std::string type_text(const option& o);
/// Returns the names of a choice's values, separated by ", ".
[[nodiscard]] std::string choices_text(const option& o);
/// Returns the bounds of an option in words: "0 to 10 s".
[[nodiscard]] std::string range_text(const option& o);

/// Parses a text that a user typed, such as "0.07", "s16" or "true".
/// \throws error (bad_input) about the option. The error contains the bounds or choices.
value read_text(const option& o, const std::string& text);

/// Returns a typed value after checking it. A number must be within the bounds, a text must be one of the
/// choices.
/// \throws error (bad_input) as read_text() does.
value read_value(const option& o, const value& v);

/// Sets an option to a value from read_text() or read_value().
/// \throws error (bad_input) about the option, for a text that cannot be parsed.
void put(option_values& w, const option& o, const value& v);

/// Returns bounds in words: "0 to 10 s".
std::string range_text(detail::bounds b, std::string_view unit);

/// Parses a finite number within bounds.
/// \throws error (bad_input) about `what`. The message contains the text and the allowed range, which is
///         `range`, or `b` if `range` is empty. If the text has a unit, the message also contains the number
///         without it.
double parse_number(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit,
                    std::string range = {});
/// Parses an integer within bounds.
/// \throws error (bad_input) as parse_number() does.
double parse_whole(std::string_view what, const std::string& text, detail::bounds b, std::string_view unit);

/// Returns the start of a hint that continues with a range. If -v would be within bounds, the hint begins
/// with "did you mean -12? Use ", otherwise it is "use ".
std::string sign_hint(detail::bounds b, double v);

/// The word of a front end for a mark, or for a field that is not in the table: {"command:devices",
/// "devices()"}. A word for the mark "array" also applies to {array=palm}; in the word, {} stands for the
/// value. An empty word drops the mark and its clause.
struct own_word {
    std::string_view mark;
    std::string_view here;
};

/// Rules by which a front end writes options.
struct spelling {
    /// Returns the name of an option, or the option with a value: "--timing", "--timing fit". The value of a
    /// flag is "true".
    std::string (*write)(const option& o, std::string_view value) = nullptr;
    std::uint64_t where = ~std::uint64_t{0}; ///< bits of its options; fields are written for other options
    std::span<const own_word> own = {};
};

/// Replaces the marks of a text by words of a front end. Keeps braces that are not marks. If `in_file` is
/// true, keys of stroke files are written as fields.
std::string spell(std::string_view text, const spelling& by, bool in_file = false);
/// Returns a field in the words of a front end.
std::string spell_field(std::string_view field, const spelling& by);
/// Returns an error in the words of a front end: replaces its subject and its marks.
error spell(const error& e, const spelling& by);

} // namespace tactor::options
