// SPDX-License-Identifier: MIT
/// \file
/// The stream to a device: players one after the other, as often as the device is lost and comes back.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>

#include <tactor/tactor.hpp>

#include "rt/event_fd.hpp"
#include "session/environment.hpp"
#include "session/lines.hpp"
#include "session/stream_policy.hpp"

namespace tactor::session {

/// Adds a further player's counters.
void add_stats(player_stats& sum, const player_stats& more);

struct stream_parts {
    std::function<std::unique_ptr<sink>()> open = {}; ///< blocks shortly. \throws error
    lent_lines lines = {};
    array tactors = {};
    player_options player = {};
    stream_times times = {};
    stream_setup wished = {}; ///< the setup before the device was ever there
    /// A stroke of the player with that number begins or has ended: as player::on_begin(), on_report().
    std::function<void(std::uint64_t, stroke_id, std::optional<std::int64_t> at_dac_ns)> begun = {};
    std::function<void(std::uint64_t, const stroke_report&)> ended = {};
};

/// Returns the parts of a stream on a PCM, with the lines of the configuration: call it before threads and
/// locked memory, as open_lines(). \throws error as that.
stream_parts open_parts(const alsa_options& device, const stream_options& o, const environment& e, bool arm);

/// Has no thread: what blocks is handed out as work. One thread calls all members.
class device_stream : private stream_policy {
public:
    explicit device_stream(stream_parts p);
    ~device_stream() { finish(); }
    device_stream(const device_stream&) = delete;
    device_stream& operator=(const device_stream&) = delete;

    using stream_policy::end, stream_policy::is_out, stream_policy::is_over, stream_policy::reason,
        stream_policy::set_busy, stream_policy::state, stream_policy::time, stream_policy::wake;

    /// Looks at what has happened. Call it when descriptor() is readable, after work, and at the time that it
    /// returns. Does not block.
    std::optional<time> step(time now = time::clock::now());
    /// Returns what step() found to do, or nothing: opens or closes the device and blocks, in any thread.
    std::function<void()> work();
    /// Does the work here, if there is any, and returns whether there was. Blocks.
    bool work_here();
    /// Cancels all strokes. If the buffer is too long to wait for their fades, step() then closes the device;
    /// wake() opens it again.
    void cancel_all();
    /// Closes for good, here: fades out, stops, settles. No work may be under way. Blocks.
    void finish() noexcept;

    /// Readable when a stroke began or ended, the amplifier switched, or the player wrote to its log.
    int descriptor() const noexcept { return news_.fd(); }
    void take_news() noexcept { news_.consume(); }

    /// The player, or null.
    player* current() const noexcept { return player_.get(); }
    /// Number of the player, from 1; of the last one where there is none.
    std::uint64_t number() const noexcept { return number_; }
    /// Reason why the latest opening failed; null: it did not.
    const std::exception_ptr& failure() const noexcept { return failure_; }
    /// Latest setup of the device.
    const stream_setup& setup() const noexcept { return setup_; }
    /// Counters of all players.
    player_stats stats() const;
    amplifier_state amplifier() const noexcept { return parts_.lines.amplifier(); }

private:
    struct outcome;

    void open(outcome& o, double proof_s);
    void close(outcome& o);
    void settle();

    rt::event_fd news_;
    stream_parts parts_;
    act due_ = act::nothing;
    std::shared_ptr<outcome> outcome_; ///< of work under way
    std::unique_ptr<player> player_;
    std::uint64_t number_ = 0;
    std::exception_ptr failure_;
    stream_setup setup_;
    player_stats before_;               ///< of the players before this one
    bool drive_time_looked_at_ = false; ///< of the work
};

} // namespace tactor::session
