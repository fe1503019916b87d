// SPDX-License-Identifier: MIT
// A stage on a DAC whose clock the test has.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "clock_runner.hpp"
#include "fake_dac.hpp"
#include "player_support.hpp"
#include "session/environment.hpp"
#include "sink/alsa/pcm_sink.hpp"
#include "study/session/stage.hpp"

namespace stage_test {

using namespace tactor;
using session::environment;
using namespace tactor::test;

inline constexpr std::size_t frame = 36; // bytes: nine channels of s32
inline constexpr double lead_s = 0.1;

inline constexpr const char* pairs = R"(
[experiment]
name = "pairs"
level = { dbfs = -20 }
gap_s = 0.0321
[[motion]]
name = "east"
path = "M0 20H40"
duration = 0.2
[[method]]
name = "a"
algorithm = "tactile-brush"
[[method]]
name = "b"
waveform = "triangle"
level_dbfs = -26
[[run]]
name = "r"
task = "choose"
attribute = "uniformity"
trials = 2
)";

inline environment nine_tactors(double longest_drive_s, double window_s,
                                std::optional<double> power_dbfs = {})
{
    environment e;
    e.tactors = palm();
    e.config.limits.emplace();
    e.config.limits->power_dbfs = power_dbfs;
    e.config.limits->max_drive_s = longest_drive_s;
    e.config.limits->window_s = window_s;
    return e;
}

// A stage on a DAC that runs as fast as it can.
struct set_up {
    fake_dac dac;
    environment where;
    study::stage there;
    std::optional<running_clock> clock; // after the stage, which blocks the signals of threads to come

    explicit set_up(double longest_drive_s = 5.0, double window_s = 10.0,
                    std::optional<double> power_dbfs = {})
        : where(nine_tactors(longest_drive_s, window_s, power_dbfs)), there(nine(), {}, where, source(dac))
    {
        clock.emplace(dac, running_clock::capture_kind::kept);
    }

    static session::stream_source source(fake_dac& d)
    {
        return [&d](session::stream_parts& p) {
            p.open = [&d] { return alsa::adopt(d.pcm(), nine()); };
            p.player = patient(p.player.limits);
            p.player.realtime = false;
        };
    }
};

inline bool sounds(const std::vector<std::byte>& bytes)
{
    return std::any_of(bytes.begin(), bytes.end(), [](std::byte b) { return b != std::byte{0}; });
}

// Does something when the stimulus has sounded for a while. Until then the DAC goes on step by step, so that
// it is not over before, however late this thread gets its turn.
class meanwhile {
public:
    meanwhile(set_up& s, std::function<void()> act)
    {
        s.clock.reset();
        thread_ = std::thread([&s, act = std::move(act)] {
            const auto step = [&s] {
                if (s.dac.queued() >= 192)
                    s.dac.advance_queued(96);
                std::this_thread::yield();
            };
            while (!s.there.position().stroke)
                step();
            const std::size_t heard = s.dac.captured_frames();
            while (s.dac.captured_frames() <= heard + 960)
                step();
            act();
            s.clock.emplace(s.dac, running_clock::capture_kind::kept);
        });
    }
    ~meanwhile() { thread_.join(); }

private:
    std::thread thread_;
};

inline const study::stage::watcher nobody = [](std::uint64_t) {};

} // namespace stage_test
