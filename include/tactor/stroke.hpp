// SPDX-License-Identifier: MIT
/// \file
/// A stroke: a path, and the target's position on it at each time.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/choices.hpp>
#include <tactor/error.hpp>
#include <tactor/path.hpp>
#include <tactor/waveform.hpp>

namespace tactor {
inline namespace v0 {

/// Progress from rest to rest. u is the elapsed part of the time (0 to 1). The covered part of the length is:
enum class easing_kind {
    linear,       ///< u: constant speed
    in_out,       ///< u^2 (3 - 2 u): the speed is a parabola, at most 1.5 times the mean
    minimum_jerk, ///< u^3 (10 - 15 u + 6 u^2), as hands reach (Flash and Hogan 1985); at most 1.875 times the
                  ///< mean
};
TACTOR_KIND(easing_kind);

/// A value at a part of the path's length: 0 is its start, 1 its end.
struct profile_point {
    double part = 0.0;
    double value = 0.0;

    friend bool operator==(const profile_point&, const profile_point&) = default;
};

/// A pause of the target at a part of the path.
struct rest {
    double part = 0.0;
    double time_s = 0.0;    ///< above 0
    double intensity = 1.0; ///< factor during the pause, 0 to 1; 0 is silence

    friend bool operator==(const rest&, const rest&) = default;
};

/// Movement of a target along a path. The default has constant speed. A profile is linear between its points,
/// and constant before the first point and after the last. The parts of its points ascend. A speed profile is
/// linear in length, not in time: between two points the speed grows or falls exponentially in time.
struct movement {
    /// Time of the whole movement, rests included. None: it follows from the speeds.
    std::optional<double> duration_s = {};
    /// Easing of each stretch from rest to rest. It does not change the time that the stretch takes.
    easing_kind easing = easing_kind::linear;
    /// Speeds, above 0; if duration_s is set, only their ratios count. Empty: constant.
    std::vector<profile_point> speed_mm_s = {};
    std::vector<profile_point> intensity = {}; ///< factors, 0 to 1. Empty: 1
    std::vector<rest> rests = {};              ///< parts ascend

    friend bool operator==(const movement&, const movement&) = default;
};

/// Position of the target at one time. Times are in seconds from the start of the stroke.
struct timed_point {
    double t_s = 0.0;
    point position = {};
    double intensity = 1.0; ///< linear, 0 to 1; 1 is the requested intensity
};

/// A time at which the target is on a line of the grid.
struct meeting {
    double t_s = 0.0;
    point position = {};

    friend bool operator==(const meeting&, const meeting&) = default;
};

/// Position and intensity over time (rendering model, section 2). Immutable. Copies and moves share the
/// contents, so a moved-from trajectory keeps its value. Any thread.
class TACTOR_API trajectory {
public:
    /// Makes a touch that rests at (0, 0) mm for a second.
    trajectory();

    /// Makes a touch that moves along a path at constant speed for `duration_s`. If the path is a single
    /// place, the touch rests there.
    /// \throws error (bad_input) unless 0 < duration_s <= 86400.
    [[nodiscard]] static trajectory along(path p, double duration_s, double intensity = 1.0);

    /// Makes a touch that moves along a path as `m` describes. If `m` has no duration, the duration follows
    /// from the speeds of `m`. If `m` has no speeds either, the speed is default_speed_mm_s.
    /// \throws error (bad_input) for parts that do not ascend from 0 to 1, speeds that are not above 0, and
    ///         rests that take the whole duration or more.
    /// \throws error (bad_input) for a path that is a single place if `m` has no duration, or has rests or an
    ///         intensity profile.
    [[nodiscard]] static trajectory along(path p, const movement& m, double intensity = 1.0);

    /// Makes a touch that moves linearly between timed points: at least two, times strictly ascending from
    /// 0, all numbers finite.
    /// \throws error (bad_input) that names the point, counted from 1.
    [[nodiscard]] static trajectory timed(std::vector<timed_point> points);

    [[nodiscard]] double duration_s() const noexcept;
    [[nodiscard]] double length_mm() const noexcept;

    /// Returns the position at a time, clamped to 0 ... duration. O(log n).
    [[nodiscard]] point position(double t_s) const noexcept;
    /// Returns the intensity A_v at a time, which is clamped in the same way.
    [[nodiscard]] double intensity(double t_s) const noexcept;

    /// Returns the same movement with another duration, rests included. Throws like along().
    [[nodiscard]] trajectory with_duration(double duration_s) const;

    /// Returns the same movement at another mean speed, not counting rests. The rests of a movement along a
    /// path keep their time. A movement without length stays as it is.
    /// \throws error (bad_input) unless speed_mm_s is finite, above 0 and gives a possible duration.
    [[nodiscard]] trajectory with_speed(double speed_mm_s) const;

    /// Returns the movement backwards: at time t the new movement is where this movement is at duration - t.
    [[nodiscard]] trajectory reversed() const;

    /// Returns the same movement with every intensity multiplied by `factor`.
    /// \throws error (bad_input) unless factor is >= 0 and no intensity gets above 1.
    [[nodiscard]] trajectory with_intensity(double factor) const;

    /// Returns the times, ascending, at which the target meets the line x = x_mm (or y = y_mm), as
    /// path::meets_x() defines it. If the target rests on the line, the result is the time of its arrival.
    [[nodiscard]] std::vector<double> meets_x(double x_mm) const;
    [[nodiscard]] std::vector<double> meets_y(double y_mm) const;

    trajectory(const trajectory&) noexcept = default; ///< also used for moves, see path
    trajectory& operator=(const trajectory&) noexcept = default;

    struct impl;

private:
    friend struct detail::access;
    explicit trajectory(std::shared_ptr<const impl> p) noexcept : impl_(std::move(p)) {}

    std::shared_ptr<const impl> impl_;
};

/// Speed of a stroke that has neither a duration nor a speed.
inline constexpr double default_speed_mm_s = 60.0;

/// Remark that every user of the stroke must see.
enum class note_kind {
    none,          ///< no remark
    reconstructed, ///< a preset whose original is not in print
};
TACTOR_KIND(note_kind);

/// Carrier frequency at a part of the path.
struct carrier_part {
    double part = 0.0; ///< part of the path's length that the target has covered, 0 to 1
    double hz = 250.0; ///< 1 to 384000

    friend bool operator==(const carrier_part&, const carrier_part&) = default;
};

/// Carrier frequency at a time.
struct carrier_time {
    double t_s = 0.0;  ///< from the start of the stroke
    double hz = 250.0; ///< 1 to 384000

    friend bool operator==(const carrier_time&, const carrier_time&) = default;
};

/// Sound of one stroke. It replaces the sound that all strokes share.
struct stroke_sound {
    std::optional<double> carrier_hz = {};
    /// Carrier frequency along the path, in place of carrier_hz: linear between parts, which ascend. The
    /// phase is continuous through every change.
    std::vector<carrier_part> carrier_profile = {};
    /// Carrier frequency over time, in place of both: linear between times, which do not descend; the first
    /// holds before its time, and the last one after it.
    std::vector<carrier_time> carrier_times = {};
    std::optional<waveform> wave = {};
    std::optional<modulation> am = {};
};

/// Request to make a stroke as large as the array allows, see fit_strokes().
struct stroke_fit {
    double margin_mm = 0.0; ///< distance from the array's edge
    /// Strokes with the same number above 0 are fitted together, as a single picture. 0: this stroke is
    /// fitted alone.
    unsigned group = 0;
    /// Maps (0, 0) to (1, 1) mm to the box around the tactors, without a margin, instead of making the stroke
    /// as large as possible. Points outside the hull of the tactors move to its edge.
    bool unit_square = false;

    friend bool operator==(const stroke_fit&, const stroke_fit&) = default;
};

/// Places of a stroke's values in its file, for messages. Line 0: not from a file.
struct stroke_places {
    source_place choices = {}; ///< choices.soa_s, or else choices.burst_s
    source_place start = {};   ///< a start_s below 0
    source_place carrier = {}; ///< carrier_hz, carrier_profile or carrier_times
    source_place wave = {};
};

/// A stroke as the user described it.
struct stroke {
    std::string name = {};
    trajectory motion = {};
    /// Start in seconds, counted from `anchor`. None: when the stroke before it ends.
    std::optional<double> start_s = {};
    start_anchor anchor = {};
    /// Speed from which the duration follows; none if the input gives a time. fit_strokes() does not change
    /// the speed.
    std::optional<double> speed_mm_s = {};
    /// True if the input has neither a time nor a speed: default_speed_mm_s then applies, unless a set-up has
    /// another speed.
    bool usual_pace = false;
    std::optional<stroke_fit> fit = {};
    stroke_sound sound = {};
    stroke_choices choices = {};
    note_kind note = note_kind::none;
    std::string made_for = {}; ///< name of the array preset for which it was drawn, for messages
    /// Oddities of the input that were accepted. make_plan() passes them on to plan::warnings.
    std::vector<std::string> warnings = {};
    stroke_places places = {};
};

/// Returns the names of the built-in strokes: "park2016-1" ... "park2016-4" for palm-3x3, "wave-2x4" and
/// "round-2x4" for palm-2x4.
[[nodiscard]] TACTOR_API const std::vector<std::string>& stroke_presets();

/// Returns a built-in stroke by name.
/// \throws error (bad_input) that lists the presets.
[[nodiscard]] TACTOR_API stroke preset_stroke(std::string_view name);

/// Returns the names of the shapes for first steps: "tap", "line", "circle", "eight" and "spiral".
[[nodiscard]] TACTOR_API const std::vector<std::string>& stroke_shapes();

/// Returns a shape by name. The shape is fitted to the array on which it is played (stroke::fit). Its speed
/// is default_speed_mm_s; a tap takes 0.3 s.
/// \throws error (bad_input) that lists the shapes.
[[nodiscard]] TACTOR_API stroke shape_stroke(std::string_view name);

/// Reads one or more strokes from a file. The extension decides the format, see tactor.toml(5). May block on
/// the file system.
///
/// `intensity_max`, here and below, is the number that means intensity 1 in CSV and in timed points of TOML,
/// such as 255. Greater numbers are refused.
///
/// `position`, here and below, is the place on the body whose touches are read from a format that has
/// several. Empty: the first place, with a warning that names the others.
/// \throws error (bad_input) with file, line and column.
[[nodiscard]] TACTOR_API std::vector<stroke>
load_strokes(const std::filesystem::path& file, double intensity_max = 1.0, std::string_view position = {});

/// Reads strokes from an open descriptor, such as standard input, to its end. Guesses the format as
/// parse_strokes() does. `name` is used in messages. Blocks until the end of the input.
/// \throws error (bad_input) with line and column.
[[nodiscard]] TACTOR_API std::vector<stroke> load_strokes(int descriptor, const std::string& name,
                                                          double intensity_max = 1.0,
                                                          std::string_view position = {});

/// Reads strokes from TOML text. `name` is used in messages.
[[nodiscard]] TACTOR_API std::vector<stroke>
parse_strokes_toml(std::string_view text, const std::string& name, double intensity_max = 1.0);
/// Reads a stroke from CSV with a header line that names t_s, x_mm, y_mm and optionally intensity, in any
/// order. The time of the first line becomes time 0 of the stroke; it may be any time from -1e10 to 1e10 s.
/// If several lines have the same time, the last of them counts, and there is a warning. Where place or
/// intensity is nan, the touch is lifted. Rows that have nothing but commas are skipped.
[[nodiscard]] TACTOR_API std::vector<stroke> parse_strokes_csv(std::string_view text, const std::string& name,
                                                               double intensity_max = 1.0);
/// Reads strokes from an SVG document. Each subpath of each shape is a stroke, in document order. One user
/// unit is 1 mm, unless the document's width or height has a physical unit.
[[nodiscard]] TACTOR_API std::vector<stroke> parse_strokes_svg(std::string_view text,
                                                               const std::string& name);
/// Reads strokes in the format that the beginning of the text shows, or in TOML if the beginning shows no
/// format.
[[nodiscard]] TACTOR_API std::vector<stroke> parse_strokes(std::string_view text, const std::string& name,
                                                           double intensity_max = 1.0,
                                                           std::string_view position = {});

} // namespace v0
} // namespace tactor
