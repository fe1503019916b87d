// SPDX-License-Identifier: MIT
/// \file
/// Vibrations of other programs' files, as textures and as strokes that rest.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/stroke.hpp>
#include <tactor/waveform.hpp>

#include "files/toml_reader.hpp"

namespace tactor::detail {

/// Longest list of values or events of such a file.
inline constexpr std::size_t most_vibration_values = 100'000;
/// Highest sum, over all points of an envelope, of the events or strokes that sound there.
inline constexpr std::size_t most_meetings = 20'000'000;

/// Reads a .haptic file of version 1. \throws error (bad_input).
vibration read_haptic(std::string_view text, const std::string& name);
/// Reads an AHAP file. \throws error (bad_input).
vibration read_ahap(std::string_view text, const std::string& name);

/// Reads the text of an actuator file (ACF), JSON5. \throws error (bad_input) that names the file.
actuator_numbers read_actuator(std::string_view text, const std::string& name);
/// Reads the table [texture]: the numbers of an actuator, or the name of its file (ACF).
/// \throws error (bad_input).
actuator_numbers read_texture(const toml_table& t, const std::filesystem::path& folder);
/// Writes the table [texture], which does not refer to other files.
std::string texture_text(const actuator_numbers& a);

/// Returns true for the name of a file of one of these formats.
bool is_vibration_file(const std::filesystem::path& file);
/// Reads a file of one of these formats as a recording. \throws error (bad_input).
recording load_vibration(const std::filesystem::path& file);

/// Returns strokes that rest in the middle of the array and play the vibration: its envelope, and one or two
/// for each emphasis.
std::vector<stroke> make_vibration_strokes(const vibration& v, const std::string& name);

/// Time in which a step of the envelope of such a stroke happens: its points ascend.
inline constexpr double step_s = 1e-6;

/// Longest touch for which a .haptic file has an emphasis.
inline constexpr double longest_short_s = 0.03;

/// A touch that is so short.
struct short_touch {
    double t_s = 0.0;
    double lasts_s = 0.0;
    double amplitude = 0.0;
    double hz = 0.0;
    double square = 0.0; ///< part of the amplitude whose wave is a square
};

/// Strokes as one actuator plays them: the amplitudes of all places add up.
class joined_strokes {
public:
    /// Joins strokes that have no groups. Their times count from the earliest start, or from 0. `strokes`
    /// must outlive this. \throws error (bad_input) for too many points that meet, or see resolve_start_s().
    explicit joined_strokes(std::span<const stroke> strokes);

    double duration_s() const noexcept { return duration_s_; }
    /// Returns the short touches, in order of time. Touches with the same start are one.
    const std::vector<short_touch>& touches() const noexcept { return touches_; }

    /// Sound of the longer strokes at a time.
    struct sound {
        double amplitude = 0.0; ///< may exceed 1
        double hz = 0.0;        ///< mean by amplitude
        std::size_t strokes = 0;
    };
    /// Returns the sound at a time that is no knot. The times of calls ascend.
    sound at(double t_s);
    /// Returns true if a longer stroke has carriers over time.
    bool has_carriers_over_time() const
    {
        return std::any_of(parts_.begin(), parts_.end(),
                           [](const part& p) { return !p.of->sound.carrier_times.empty(); });
    }
    /// Returns the times between which amplitudes and the frequency of a single stroke are linear.
    const std::vector<double>& knots() const noexcept { return knots_; }

private:
    struct part {
        double from_s;
        double to_s;
        double gain;
        const stroke* of;
        std::vector<timed_value> hz;
    };

    double duration_s_ = 0.0;
    std::vector<short_touch> touches_;
    std::vector<double> knots_;
    std::vector<part> parts_;         ///< in order of start
    std::size_t next_ = 0;            ///< part that has not begun
    std::vector<std::size_t> active_; ///< parts that sound
};

/// Sorts times. If two times are within a step of the envelope, keeps only the later one. Always keeps the
/// first time, and at least two times.
void merge_steps(std::vector<double>& times);

} // namespace tactor::detail
