// SPDX-License-Identifier: MIT
// The parts of a stroke in a TOML file: order and repeats, movement along the path (easing, profiles,
// pauses), sound, plan options that differ from the other strokes', and place. All functions throw error with
// file, line and column.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactor/stroke.hpp>

#include "core/path/shape.hpp"
#include "files/toml_reader.hpp"

namespace tactor::detail {

inline constexpr std::array<std::string_view, 3> order_keys{"repeat", "pause_s", "start_from"};

/// Range of turns and angles, degrees.
inline constexpr bounds turn_deg{-3600.0, 3600.0};

/// Most strokes of a file: more are the wrong file, or a slip in `repeat`.
inline constexpr std::size_t most_strokes = 100'000;

/// Strokes that are one entry of the file: their starts count from one another, and the first's is the
/// entry's.
struct entry {
    std::vector<stroke> strokes = {};
    double lead_s = 0.0; ///< from the entry's start to that of its first stroke
};

/// Strokes one after the other as the keys start_s and start_from of their tables say.
class sequence {
public:
    /// Strokes of a group, which count from its start, or of the whole file.
    enum class of { group, piece };
    explicit sequence(of what) noexcept : whole_piece_(what == of::piece) {}

    /// Adds what table `t` says.
    void add(const toml_table& t, entry e);

    entry take() && { return std::move(all_); }

private:
    struct last_entry {
        std::size_t size = 0;
        double lead_s = 0.0;
    };

    void place_first(const toml_table& t, stroke& first, double lead_s);
    void place(const toml_table& t, stroke& first, double lead_s) const;

    bool whole_piece_;
    entry all_;
    last_entry before_;
};

/// Returns the entry as often as `repeat` says, with `pause_s` between.
entry repeated(const toml_table& t, entry e);

/// Keys of the movement alone; speed_mm_s and intensity may be lists, too.
inline constexpr std::array<std::string_view, 2> movement_keys{"easing", "pauses"};

/// The pace that the file gives; numbers and lists.
struct told_pace {
    std::optional<double> duration_s = {};
    std::optional<double> speed_mm_s = {}; ///< the one speed
    double intensity = 1.0;                ///< the one intensity
    movement moves = {};                   ///< easing, lists and pauses
    std::string_view key = {};             ///< the first key that makes it uneven; empty: none

    /// Returns the seconds for a way, if the file gives them.
    std::optional<double> time_for(double length_mm) const
    {
        return speed_mm_s ? length_mm / *speed_mm_s : duration_s;
    }
};

/// Reads duration, speed, intensity, easing and pauses.
told_pace read_pace(const toml_table& t);

/// Returns a movement along a path at the pace that the file gives; `own_s` is the time of a preset, for a
/// file that gives none.
trajectory along_as_told(const toml_table& t, std::string_view kind, const path& way, const told_pace& told,
                         std::optional<double> own_s);

/// Returns the mean speed that a stroke keeps when it is fitted; none where its time was told.
std::optional<double> kept_speed(const told_pace& told, double length_mm);

/// The keys that read_sound() knows.
inline constexpr std::array<std::string_view, 7> sound_keys{
    "waveform", "am_hz", "am_depth", "noise_seed", "texture", "texture_mm", "carrier_profile"};

/// Fills in the sound; what is not said stays. WAV files are looked for in a folder; null: the text is no
/// file's, may come from anywhere, and may name none.
void read_sound(const toml_table& t, const std::filesystem::path* folder, stroke& s);

/// Reads a file as parse_strokes_toml() does a text; it may name other files.
std::vector<stroke> strokes_of_toml_file(std::string_view text, const std::string& name,
                                         double intensity_max);

inline constexpr std::array<std::string_view, 8> choice_keys{
    "algorithm", "phantom", "faces", "soa_s", "burst_s", "level_db", "fit", "fit_margin_mm"};

/// Returns the stroke with algorithm, phantom, faces, soa_s, burst_s, fit and fit_margin_mm as the file says.
stroke chosen(const toml_table& t, stroke s);

/// Reads fit and fit_margin_mm; nothing where nothing is to be fitted.
std::optional<stroke_fit> read_fit(const toml_table& t);

/// Returns the stroke as much stronger or weaker as level_db says.
stroke levelled(const toml_table& t, stroke s);

/// Reads mirror and rotate_deg. Returns the map that scales by `scale`, mirrors and then turns about the
/// origin.
affine read_turn(const toml_table& t, double scale = 1.0);

/// Returns the stroke mirrored, scaled, turned and moved as the keys mirror, scale, rotate_deg, translate_mm
/// and about_mm say; the very same without any. A stroke that says a speed keeps it.
stroke placed(const toml_table& t, stroke s);

/// Refuses line ends of CR alone, other separators than commas, and a header that is missing or in a comment,
/// with a message that says so. \throws error (bad_input) with `name`, line and column.
void refuse_other_columns(std::string_view text, const std::string& name);

/// Returns true for nan in any case and for NA.
bool is_missing(std::string_view value) noexcept;

} // namespace tactor::detail
