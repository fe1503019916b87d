// SPDX-License-Identifier: MIT
/// \file
/// Sound of a tactor: waveform, modulation, and rise and fall of a burst.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/choices.hpp>

namespace tactor {
inline namespace v0 {

/// Shapes of the carrier. Square, triangle and sawtooth have the carrier's frequency and those of their
/// harmonics that are below half the rate. Each of these waves begins where it crosses zero upwards. Noise
/// lies between two frequencies. The peak of each waveform is the requested amplitude, but the power differs:
/// a square wave has up to 1.6 times the power of a sine, and noise has a tenth of the power of a sine.
enum class waveform_kind { sine, square, triangle, sawtooth, noise, recording };
TACTOR_KIND(waveform_kind);

/// Placement of recorded samples along a stroke. `cycle`: the samples are one cycle of the carrier. `time`:
/// they play at their own rate, from the stroke's first frame on. `length`: they lie along the length of the
/// path. Samples that are shorter than the stroke are repeated.
enum class texture_kind { cycle, time, length };
TACTOR_KIND(texture_kind);

/// Value at a time.
struct timed_value {
    double t_s = 0.0;
    double value = 0.0;

    friend bool operator==(const timed_value&, const timed_value&) = default;
};

/// Short event that stands out of a vibration.
struct emphasis {
    double t_s = 0.0;
    double amplitude = 1.0; ///< 0 to 1
    double frequency = 0.5; ///< 0 to 1: from emphasis_low to emphasis_high of actuator_numbers

    friend bool operator==(const emphasis&, const emphasis&) = default;
};

/// Meaning of the frequencies 0 to 1 of a vibration on an actuator. The default is that of the generic
/// actuator that the .haptic format publishes.
struct actuator_numbers {
    double gain = 1.0;      ///< of the vibration, 0 to 1
    double ducking = 0.5;   ///< factor of the vibration during an emphasis, 0 to 1
    double low_hz = 55.0;   ///< frequency 0
    double high_hz = 200.0; ///< frequency 1
    double emphasis_gain = 1.0;
    double fade_out = 0.0; ///< part by which an emphasis gets weaker up to its end, 0 to 1
    double emphasis_low_hz = 55.0;
    double emphasis_high_hz = 130.0;
    double emphasis_low_s = 0.027;
    double emphasis_high_s = 0.020;
    /// Shapes of an emphasis of frequency 0 and 1: sine, square, triangle or sawtooth. Between them it is a
    /// mixture of both.
    waveform_kind emphasis_low_wave = waveform_kind::sine;
    waveform_kind emphasis_high_wave = waveform_kind::square;

    friend bool operator==(const actuator_numbers&, const actuator_numbers&) = default;
};

/// A vibration as .haptic and AHAP files describe it. Values are linear between their times, which do not
/// descend from 0 on; the first holds before its time, and the last one after it.
struct vibration {
    double duration_s = 0.0;
    std::vector<timed_value> amplitude = {}; ///< 0 to 1
    std::vector<timed_value> frequency = {}; ///< 0 to 1: from low_hz to high_hz
    std::vector<emphasis> emphases = {};     ///< in order of time; the next ends one, unless own_actuator
    actuator_numbers actuator = {};
    bool own_actuator = false; ///< `actuator` belongs to the format: no other replaces it
    /// Parts of the file that were left out. make_plan() passes them on to plan::warnings.
    std::vector<std::string> notes = {};

    friend bool operator==(const vibration&, const vibration&) = default;
};

/// Samples of one channel.
struct recording {
    std::string file = {};    ///< file of origin, for messages
    double rate_hz = 48000.0; ///< above 0
    /// Finite, in any unit, and not all equal. Only their shape is played: the mean is removed, and the peak
    /// becomes 1.
    std::vector<float> samples = {};
    /// SHA-256 of the file's bytes, 64 lower-case hexadecimal digits; empty without a file.
    std::string sha256 = {};
    /// Number of samples that the file's header announces but the file does not have, because it was cut
    /// short.
    std::uint64_t missing = 0;
    /// The vibration from which the samples were made, if any. It plays instead of them, at the rate of the
    /// stream and with its own amplitudes; along a path by its length, its frequencies stay.
    std::optional<vibration> source = {};

    friend bool operator==(const recording&, const recording&) = default;
};

/// Least distance between the two frequencies of noise, and of each from 0, Hz.
inline constexpr double least_noise_hz = 1.0;
/// Highest number of samples of a recording with texture_kind::cycle or texture_kind::length.
inline constexpr std::size_t most_cycle_samples = std::size_t{1} << 16;
/// Highest number of samples of any recording.
inline constexpr std::size_t most_recording_samples = std::size_t{1} << 22;

/// A carrier's waveform. A plain value; copies share the recording.
struct waveform {
    waveform_kind kind = waveform_kind::sine;
    double low_hz = 50.0;   ///< noise: lower frequency, >= least_noise_hz, below half the rate
    double high_hz = 500.0; ///< noise: upper frequency, at least least_noise_hz above low_hz
    std::uint64_t seed = 1; ///< noise: the same number gives the same noise
    std::shared_ptr<const recording> recorded = {}; ///< recording only
    texture_kind texture = texture_kind::cycle;     ///< recording only
    /// texture_kind::length: length of path that the whole recording covers, mm; 0: the whole path.
    double texture_mm = 0.0;

    /// Compares recordings by their contents.
    TACTOR_API friend bool operator==(const waveform& a, const waveform& b);
};

/// Amplitude modulation. The vibration is multiplied by the following factor, which does not change its peak:
///
///     (1 + depth sin(2 pi hz t)) / (1 + depth)
///
/// t is 0 at the start of the carrier.
struct modulation {
    double hz = 0.0;    ///< 0: none; at most 20000
    double depth = 1.0; ///< 0 to 1

    friend bool operator==(const modulation&, const modulation&) = default;
};

/// Parses "sine", "square", "triangle", "sawtooth", "noise:LO-HI" or the name of a WAV file, relative to
/// `folder`. Reads that file: one channel of integers or floats. May block on the file system.
/// \throws error (bad_input) for any other text.
[[nodiscard]] TACTOR_API waveform parse_waveform(std::string_view text,
                                                 const std::filesystem::path& folder = {});

/// Returns true if parse_waveform() would open a file for this text. Use it to refuse such texts from clients
/// that must not open files.
[[nodiscard]] TACTOR_API bool waveform_names_file(std::string_view text) noexcept;

/// Returns the text from which parse_waveform() makes this waveform. It has the frequencies of noise or the
/// file of a recording.
[[nodiscard]] TACTOR_API std::string waveform_text(const waveform& w);

/// Parses "HZ" or "HZ:DEPTH".
/// \throws error (bad_input).
[[nodiscard]] TACTOR_API modulation parse_modulation(std::string_view text);

/// Reads a WAV file (RIFF, RF64 or BW64) of one channel: integers of 8 to 32 bits, or floats of 32 or 64
/// bits.
/// \throws error (bad_input) that names the file.
[[nodiscard]] TACTOR_API recording load_recording(const std::filesystem::path& file);

/// Highest number of bytes of own_samples, which stay in memory while they play. It is enough for 10 minutes
/// of nine channels of floats.
inline constexpr std::size_t most_own_bytes = std::size_t{1} << 30;

/// Your own samples for all channels of a stream. score::from_samples() makes a score of them.
struct own_samples {
    std::string file = {}; ///< file of origin, for messages
    unsigned rate = 48000; ///< Hz
    unsigned channels = 1; ///< sample i of each frame is for channel i of the stream
    format_kind format = format_kind::float32;
    /// Frames one after the other, little-endian, at most most_own_bytes. Full scale is 1.0 for floats and
    /// 2^(bits - 1) for integers.
    std::vector<std::byte> bytes = {};

    friend bool operator==(const own_samples&, const own_samples&) = default;
};

/// Reads a WAV file (RIFF, RF64 or BW64) of any number of channels. Integers of 8 to 32 bits and floats of 32
/// bits are read without loss. Floats of 64 bits become floats of 32 bits. For a moment the file is in memory
/// twice. Blocks on the file system.
/// \throws error (bad_input) that names the file, also if the file is cut short or has more than
///         most_own_bytes.
[[nodiscard]] TACTOR_API own_samples load_samples(const std::filesystem::path& file);

/// Checks ranges. The constructor of a score checks values that depend on the sample rate.
/// \throws error (bad_input) that names the field.
TACTOR_API void validate(const waveform& w);
TACTOR_API void validate(const modulation& m);

/// Shape of a burst's rise and fall: half a cycle of a cosine, a straight line, or an exponential that ends
/// after five time constants. `tukey` is raised_cosine with ramps whose length is a part of the burst's
/// duration.
enum class envelope_kind { raised_cosine, linear, exponential, tukey };
TACTOR_KIND(envelope_kind);

/// Envelope of every burst, and of a continuous stroke as a whole. If a burst is too short for both ramps,
/// they are shortened in the same ratio.
struct burst_envelope {
    envelope_kind kind = envelope_kind::raised_cosine;
    std::optional<double> attack_s = {};  ///< s, from 0; none: render_options::ramp_s
    std::optional<double> release_s = {}; ///< s, from 0; none: render_options::ramp_s
    /// tukey: part of the burst that both ramps take together, 0 to 1; replaces the other ramps.
    double tukey_part = 0.5;

    friend bool operator==(const burst_envelope&, const burst_envelope&) = default;
};

/// Parses the name of a kind, or "tukey:PART". Does not set the ramps.
/// \throws error (bad_input).
[[nodiscard]] TACTOR_API burst_envelope parse_envelope(std::string_view text);

/// Returns the text from which parse_envelope() makes this envelope, without the ramps.
[[nodiscard]] TACTOR_API std::string envelope_text(const burst_envelope& e);

} // namespace v0
} // namespace tactor
