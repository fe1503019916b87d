// SPDX-License-Identifier: MIT
/// \file
/// A stroke: a path, and where on it the target is at each time.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/choices.hpp>
#include <tactor/error.hpp>
#include <tactor/path.hpp>
#include <tactor/waveform.hpp>

namespace tactor {
inline namespace v0 {

/// How a target gets from rest to rest. Where u is the part of the time, from 0 to 1, the part of the way is
enum class easing_kind {
    linear,       ///< u: at once at its speed
    in_out,       ///< u^2 (3 - 2 u): its speed is a parabola, at most 1.5 times the mean
    minimum_jerk, ///< u^3 (10 - 15 u + 6 u^2), as hands reach (Flash and Hogan 1985): at most 1.875 times
};
TACTOR_KIND(easing_kind);

/// A value at a part of the path's length, 0 at its start and 1 at its end.
struct profile_point {
    double part = 0.0;
    double value = 0.0;

    friend bool operator==(const profile_point&, const profile_point&) = default;
};

/// The target stays at a part of the path.
struct rest {
    double part = 0.0;
    double time_s = 0.0;    ///< more than 0
    double intensity = 1.0; ///< factor meanwhile, 0 to 1; 0 is silence

    friend bool operator==(const rest&, const rest&) = default;
};

/// How a target moves along a path. The default is even. A profile is linear between its points, and constant
/// before the first and after the last; parts ascend. Speeds are linear over the way, not over the time:
/// between two of them speed grows or falls exponentially in time.
struct movement {
    /// Time of the whole movement, rests included. None: the speeds give it.
    std::optional<double> duration_s = {};
    /// Of each stretch from rest to rest. The stretch takes the same time as without easing.
    easing_kind easing = easing_kind::linear;
    std::vector<profile_point> speed_mm_s =
        {}; ///< more than 0; with a duration their ratios count. Empty: even
    std::vector<profile_point> intensity = {}; ///< factors, from 0. Empty: 1
    std::vector<rest> rests = {};              ///< by ascending part

    friend bool operator==(const movement&, const movement&) = default;
};

/// Where the target is at one time. Times in seconds from the start of the stroke.
struct timed_point {
    double t_s = 0.0;
    point position = {};
    double intensity = 1.0; ///< linear, >= 0; 1 is the intensity asked for
};

/// A time at which the target is on a line of the grid.
struct meeting {
    double t_s = 0.0;
    point position = {};

    friend bool operator==(const meeting&, const meeting&) = default;
};

/// Position and intensity over time (rendering model, section 2). Immutable; copies and moves share it, and a
/// trajectory that was moved from keeps its value; any thread may call.
class TACTOR_API trajectory {
public:
    /// A touch that rests at (0, 0) mm for a second.
    trajectory();

    /// Along a path at constant speed in `duration_s`; on a path that is one place, a touch that rests there.
    /// \throws error (bad_input) unless 0 < duration_s <= 86400.
    [[nodiscard]] static trajectory along(path p, double duration_s, double intensity = 1.0);

    /// Along a path as `m` says: in its duration, else at its speeds (default_speed_mm_s where it has none).
    /// \throws error (bad_input) for a movement that cannot be: parts that do not ascend from 0 to 1, speeds
    ///         that are not above 0, rests that take all of the duration or more, and for a path that is one
    ///         place where there is no duration, or rests or a profile of intensities.
    [[nodiscard]] static trajectory along(path p, const movement& m, double intensity = 1.0);

    /// Linear between timed points: at least two, times strictly ascending from 0, finite.
    /// \throws error (bad_input) naming the point (counting from 1).
    [[nodiscard]] static trajectory timed(std::vector<timed_point> points);

    [[nodiscard]] double duration_s() const noexcept;
    [[nodiscard]] double length_mm() const noexcept;

    /// Position at a time, clamped to 0 ... duration. O(log n).
    [[nodiscard]] point position(double t_s) const noexcept;
    /// Intensity at a time (A_v), clamped in the same way.
    [[nodiscard]] double intensity(double t_s) const noexcept;

    /// The same movement in another time, rests included. Throws like along().
    [[nodiscard]] trajectory with_duration(double duration_s) const;

    /// The same movement at another mean speed, in which rests do not count. The rests of a movement along a
    /// path keep their time; a movement without length stays as it is.
    /// \throws error (bad_input) unless speed_mm_s is finite, above 0 and gives a possible duration.
    [[nodiscard]] trajectory with_speed(double speed_mm_s) const;

    /// Played backwards: at time t it is where this one is at duration - t.
    [[nodiscard]] trajectory reversed() const;

    /// The same movement with every intensity times `factor`. \throws error (bad_input) unless factor
    /// is finite and >= 0.
    [[nodiscard]] trajectory with_intensity(double factor) const;

    /// Times, ascending, at which the target meets x = x_mm (or y = y_mm): see path::meets_x. A
    /// target that rests on the line meets it when it arrives.
    [[nodiscard]] std::vector<double> meets_x(double x_mm) const;
    [[nodiscard]] std::vector<double> meets_y(double y_mm) const;

    trajectory(const trajectory&) noexcept = default; ///< for moves, too: see path
    trajectory& operator=(const trajectory&) noexcept = default;

    struct impl;

private:
    friend struct detail::access;
    explicit trajectory(std::shared_ptr<const impl> p) noexcept;

    std::shared_ptr<const impl> impl_;
};

/// Speed of a stroke that says neither duration nor speed.
inline constexpr double default_speed_mm_s = 60.0;

/// A remark that a user of the stroke must get.
enum class note_kind {
    none,
    reconstructed, ///< a preset whose original is not in print
};
TACTOR_KIND(note_kind);

/// The carrier at a part of the path.
struct carrier_part {
    double part = 0.0; ///< of the path's length that the target has covered, 0 to 1
    double hz = 250.0; ///< 1 to 384000

    friend bool operator==(const carrier_part&, const carrier_part&) = default;
};

/// The sound of a stroke, in place of what all strokes have.
struct stroke_sound {
    std::optional<double> carrier_hz = {};
    /// The carrier along the path, linear between parts, which ascend; in place of carrier_hz. Its phase goes
    /// on through every change.
    std::vector<carrier_part> carrier_profile = {};
    std::optional<waveform> wave = {};
    std::optional<modulation> am = {};
};

/// A stroke that is to be as large as the array has space for: see fit_strokes().
struct stroke_fit {
    double margin_mm = 0.0; ///< from the array's edge
    /// Strokes with the same number above 0 are fitted as one picture; 0: this one by itself.
    unsigned group = 0;

    friend bool operator==(const stroke_fit&, const stroke_fit&) = default;
};

/// The places of a stroke in its file, for messages. Line 0: it is not in a file.
struct stroke_places {
    source_place choices = {}; ///< of choices.soa_s, or else of choices.burst_s
    source_place start = {};   ///< of a start_s below 0
    source_place carrier = {}; ///< of carrier_hz, or of carrier_profile
    source_place wave = {};
};

/// One stroke as the user gave it.
struct stroke {
    std::string name = {};
    trajectory motion = {};
    /// Start in seconds, counted from `anchor`; none: when the stroke before it has ended.
    std::optional<double> start_s = {};
    start_anchor anchor = {};
    /// The speed from which the motion's time follows; none where a time is given. fit_strokes() keeps it.
    std::optional<double> speed_mm_s = {};
    /// The input says neither a time nor a speed: default_speed_mm_s holds, unless a set-up has another one.
    bool usual_pace = false;
    std::optional<stroke_fit> fit = {};
    stroke_sound sound = {};
    stroke_choices choices = {};
    note_kind note = note_kind::none;
    std::string made_for = {}; ///< name of the array preset that it is drawn for; messages name it
    /// Oddities of the input that were accepted; make_plan() hands them on to plan::warnings.
    std::vector<std::string> warnings = {};
    stroke_places places = {};
};

/// Names of the built-in strokes: "park2016-1" ... "park2016-4" for palm-3x3, "wave-2x4" and "round-2x4" for
/// palm-2x4.
[[nodiscard]] TACTOR_API const std::vector<std::string>& stroke_presets();

/// A built-in stroke by name. \throws error (bad_input) that lists the presets.
[[nodiscard]] TACTOR_API stroke preset_stroke(std::string_view name);

/// Names of the shapes for first steps: "tap", "line", "circle", "eight" and "spiral".
[[nodiscard]] TACTOR_API const std::vector<std::string>& stroke_shapes();

/// A shape by name, as large as the array on which it is played (stroke::fit): at
/// default_speed_mm_s, but a tap takes 0.3 s. \throws error (bad_input) that lists the shapes.
[[nodiscard]] TACTOR_API stroke shape_stroke(std::string_view name);

/// Reads a stroke file by its extension: .toml, .csv or .svg; see tactor.toml(5). One or more strokes.
/// May block on the file system.
/// \throws error (bad_input) with file, line and column.
[[nodiscard]] TACTOR_API std::vector<stroke> load_strokes(const std::filesystem::path& file);

/// Reads stroke file text from an open descriptor to its end, such as standard input, and guesses its kind as
/// parse_strokes() does; `name` stands for it in messages. Blocks until the end comes.
/// \throws error (bad_input) with line and column.
[[nodiscard]] TACTOR_API std::vector<stroke> load_strokes(int descriptor, const std::string& name);

/// Stroke file text in TOML; `name` stands for the file in messages.
[[nodiscard]] TACTOR_API std::vector<stroke> parse_strokes_toml(std::string_view text,
                                                                const std::string& name);
/// CSV with a header line naming t_s, x_mm, y_mm and optionally intensity, in any order.
/// The time of the first line is the stroke's zero, whatever it is (-1e10 to 1e10 s). Of lines with
/// equal times the last counts, with a warning.
[[nodiscard]] TACTOR_API std::vector<stroke> parse_strokes_csv(std::string_view text,
                                                               const std::string& name);
/// SVG document: each shape's subpaths are strokes, one after the other in document order.
/// One user unit is one millimetre, unless the document's width or height has a physical unit.
[[nodiscard]] TACTOR_API std::vector<stroke> parse_strokes_svg(std::string_view text,
                                                               const std::string& name);
/// Guesses the kind from the text (SVG if it starts with '<', CSV if its first line names t_s, else TOML).
[[nodiscard]] TACTOR_API std::vector<stroke> parse_strokes(std::string_view text, const std::string& name);

} // namespace v0
} // namespace tactor
