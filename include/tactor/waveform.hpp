// SPDX-License-Identifier: MIT
/// \file
/// What sounds on a tactor: waveform, modulation, and how a burst rises and falls.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>

namespace tactor {
inline namespace v0 {

/// The shapes have the carrier's frequency and those of their harmonics that are below half the rate; each
/// begins where it crosses zero upwards. Noise lies between two frequencies. The peak of each is the
/// amplitude that is asked for: a square has up to 1.6 times a sine's power, and noise a tenth of it.
enum class waveform_kind { sine, square, triangle, sawtooth, noise, recording };
TACTOR_KIND(waveform_kind);

/// How recorded samples are laid along a stroke: as the carrier's cycle; in their own time, from the stroke's
/// first frame on; or along the path, by its length. Samples that are shorter than the stroke are repeated.
enum class texture_kind { cycle, time, length };
TACTOR_KIND(texture_kind);

/// Samples of one channel.
struct recording {
    std::string file = {};    ///< where they came from, for messages
    double rate_hz = 48000.0; ///< above 0
    /// Finite, in any unit, and not all the same. Only their shape is played: their mean is taken out, and
    /// their peak becomes 1.
    std::vector<float> samples = {};
    /// SHA-256 of the file's bytes, 64 lower-case hexadecimal digits; empty for samples that came from none.
    std::string sha256 = {};
    /// Samples that the file's header announces and the file does not have: it was cut short.
    std::uint64_t missing = 0;

    friend bool operator==(const recording&, const recording&) = default;
};

/// The frequencies of noise are at least so far from each other and from 0, Hz.
inline constexpr double least_noise_hz = 1.0;
/// Most samples of a recording that is a cycle, or lies along a path by its length.
inline constexpr std::size_t most_cycle_samples = std::size_t{1} << 16;
/// Most samples of any recording.
inline constexpr std::size_t most_recording_samples = std::size_t{1} << 22;

/// A plain value; the recording is shared.
struct waveform {
    waveform_kind kind = waveform_kind::sine;
    double low_hz = 50.0;   ///< noise: its frequencies, >= least_noise_hz, below half the rate
    double high_hz = 500.0; ///< noise: at least least_noise_hz above low_hz
    std::uint64_t seed = 1; ///< noise: the same number gives the same noise
    std::shared_ptr<const recording> recorded = {}; ///< recording only
    texture_kind texture = texture_kind::cycle;     ///< recording only
    /// texture_kind::length: length of path on which the whole recording lies once, mm; 0: the whole path.
    double texture_mm = 0.0;

    /// Compares recordings by their contents.
    TACTOR_API friend bool operator==(const waveform& a, const waveform& b);
};

/// Amplitude modulation: the vibration times (1 + depth sin(2 pi hz t)) / (1 + depth), so that its peak
/// stays; t is 0 where the carrier begins.
struct modulation {
    double hz = 0.0;    ///< 0: none; at most 20000
    double depth = 1.0; ///< 0 to 1

    friend bool operator==(const modulation&, const modulation&) = default;
};

/// "sine", "square", "triangle", "sawtooth", "noise:LO-HI" or the name of a WAV file, relative to `folder`,
/// which is read: one channel of integers or floats. May block on the file system.
/// \throws error (bad_input) for any other text.
[[nodiscard]] TACTOR_API waveform parse_waveform(std::string_view text,
                                                 const std::filesystem::path& folder = {});

/// Whether parse_waveform() would open a file for this text: to refuse it from somebody who may not name
/// files.
[[nodiscard]] TACTOR_API bool waveform_names_file(std::string_view text) noexcept;

/// The text that parse_waveform() takes: for noise with its frequencies, for a recording its file.
[[nodiscard]] TACTOR_API std::string waveform_text(const waveform& w);

/// "HZ" or "HZ:DEPTH". \throws error (bad_input).
[[nodiscard]] TACTOR_API modulation parse_modulation(std::string_view text);

/// Reads a WAV file (RIFF, RF64 or BW64) of one channel: integers of 8 to 32 bits, A-law, u-law, or floats of
/// 32 or 64 bits. Needs libsndfile, which is loaded by the first call.
/// \throws error with its name: bad_input; not_available where libsndfile is missing.
[[nodiscard]] TACTOR_API recording load_recording(const std::filesystem::path& file);

/// Checks ranges; what depends on the sample rate is checked when a score is made.
/// \throws error (bad_input) naming the field.
TACTOR_API void validate(const waveform& w);
TACTOR_API void validate(const modulation& m);

/// How a burst rises and falls: like half a cycle of a cosine, by a straight line, or by an exponential that
/// ends after five of its time constants. `tukey` is raised_cosine with ramps that are a part of the burst.
enum class envelope_kind { raised_cosine, linear, exponential, tukey };
TACTOR_KIND(envelope_kind);

/// The envelope of every burst, and of a continuous stroke as a whole. Where both ramps do not fit, they are
/// shortened in the same ratio.
struct burst_envelope {
    envelope_kind kind = envelope_kind::raised_cosine;
    std::optional<double> attack_s = {};  ///< s, from 0; none: render_options::ramp_s
    std::optional<double> release_s = {}; ///< s, from 0; none: render_options::ramp_s
    double tukey_part = 0.5; ///< tukey: part of the burst in both ramps, 0 to 1; in place of other ramps

    friend bool operator==(const burst_envelope&, const burst_envelope&) = default;
};

/// The name of a kind, or "tukey:PART". The ramps are not set. \throws error (bad_input).
[[nodiscard]] TACTOR_API burst_envelope parse_envelope(std::string_view text);

/// The text that parse_envelope() takes; it does not have the ramps.
[[nodiscard]] TACTOR_API std::string envelope_text(const burst_envelope& e);

} // namespace v0
} // namespace tactor
