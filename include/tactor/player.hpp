// SPDX-License-Identifier: MIT
/// \file
/// The engine: plays scores on a sink in real time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactor/api.hpp>
#include <tactor/array.hpp>
#include <tactor/gpio.hpp>
#include <tactor/render.hpp>
#include <tactor/sink.hpp>

namespace tactor {

/// Number of a submitted score, unique in one player.
using stroke_id = std::uint32_t;

/// How a submitted score ended. Each ends in exactly one of these.
enum class stroke_state {
    finished,    ///< its last frame reached the DAC
    cancelled,   ///< faded out because it was asked for
    interrupted, ///< an xrun, the loss of the device or a failure cut it
};

TACTOR_API std::string_view to_string(stroke_state s) noexcept;

struct stroke_report {
    stroke_id id = 0;
    stroke_state state = stroke_state::finished;
    std::uint64_t frames = 0; ///< frames of the score that were played
    std::string reason = {};  ///< why it was interrupted
};

struct player_options {
    double horizon_s = 0.5;        ///< how far ahead drives are handed to the audio thread
    double fade_s = 0.010;         ///< fade on cancel and stop
    double stall_s = 0.5;          ///< a device that stands still for so long (16 periods at least) is lost
    bool realtime = true;          ///< ask for SCHED_FIFO
    bool require_realtime = false; ///< \throws instead of going on without it
    int priority = 65;
};

/// Counters since the player was opened.
struct player_stats {
    std::uint64_t periods = 0;
    std::uint64_t frames = 0; ///< frames written
    std::uint64_t xruns = 0;
    std::uint64_t limited_frames = 0; ///< frames that the limiter changed
    std::uint64_t ring_low_water = 0; ///< fewest drives that waited while a stroke played
    double latest_wakeup_s = 0.0;
    /// Page faults of the audio thread after its first wake-ups: 0 where memory is locked. Counted once a
    /// second.
    std::uint64_t minor_faults = 0;
    std::uint64_t major_faults = 0; ///< those that had to wait for a disk
    bool realtime = false;          ///< the audio thread has SCHED_FIFO
    /// How long the stream stood in the newest 64 xruns, oldest first; 0 where the device cannot tell.
    std::vector<double> xrun_s = {};
};

/// Where the stream is, for displays.
struct player_position {
    bool running = false;
    std::uint64_t played = 0;             ///< frame at the DAC
    std::optional<stroke_id> stroke = {}; ///< the newest that sounds
    std::uint64_t stroke_frame = 0;       ///< its frame at the DAC
};

/// Lines that the player drives or listens to; each may be empty.
struct player_lines {
    std::unique_ptr<enable_line> amplifier = {}; ///< on only while the stream is known to run
    double settle_s = 0.010;                     ///< turn-on time of the amplifier, silence
    std::unique_ptr<enable_line> sync_out = {};  ///< a pulse at each stroke's first sample at the DAC
    double pulse_s = 0.005;
    std::unique_ptr<edge_input> trigger = {}; ///< starts armed strokes
    double trigger_delay_s = 0.050;           ///< from the edge to the first sample at the DAC
};

/// Owns the sink, the audio thread and the control thread. Its members may be called from any thread
/// but the audio thread; they lock, so that several producers are safe.
class TACTOR_API player {
public:
    /// Starts the stream with silence. `a` gives the limit of each channel.
    /// \throws error: not_available or runtime when the stream does not start.
    player(std::unique_ptr<sink> s, const array& a, const player_options& o = {}, player_lines lines = {});
    /// stop(), then closes.
    ~player();
    player(const player&) = delete;
    player& operator=(const player&) = delete;

    const stream_setup& setup() const noexcept;

    /// Plays a score as soon as possible, or from a frame of the stream on (a frame that has been written
    /// already means as soon as possible). Frames of the stream count on over an xrun. Several may sound at
    /// once. Does not block for the ring: drives that do not fit wait on the control side. \throws error:
    /// bad_input when rate or channels differ from the stream's, runtime when the
    ///         stream has ended.
    stroke_id submit(const score& s, std::optional<std::uint64_t> at_frame = {});

    /// Fades a stroke out. False when it has ended or is not known.
    bool cancel(stroke_id id);

    /// Blocks until the stroke has ended and returns how; nothing on time-out, for a stroke that is not
    /// known, and in the handler (which runs in the thread that would have to bring the report) for one
    /// that has not ended. Each report is given once by wait(), and to the handler when there is one; of
    /// those that nobody waits for, the 4096 newest are kept.
    std::optional<stroke_report> wait(stroke_id id, std::optional<std::chrono::nanoseconds> timeout = {});

    /// Called in the control thread for each ended stroke; it must not throw. Set it before the first
    /// submit().
    void on_report(std::function<void(const stroke_report&)> handler);

    /// Fades everything out, plays silence until it is out, stops. What that ends counts as cancelled
    /// (interrupted, where the destructor does it). Returns when that is done and reported; in the handler
    /// at once.
    void stop();

    player_position position() const noexcept;
    player_stats stats() const;

private:
    struct impl;
    std::unique_ptr<impl> impl_;
};

} // namespace tactor
