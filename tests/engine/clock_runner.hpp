// SPDX-License-Identifier: MIT
/// \file
/// Support for tests of the player with its real threads.
#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <utility>

#include <tactor/player.hpp>

#include "fake_dac.hpp"

namespace tactor::test {

/// Options with long limits: the fake clock stands still while the test thinks and outruns time while it
/// runs.
inline player_options patient(const drive_limits& limits = {})
{
    player_options o{.horizon_s = 600.0, .stall_s = 600.0, .limits = limits};
    return o;
}

/// Runs the DAC in a thread for as long as it lives, for calls that block. Keeps what it plays from then on
/// only where a test reads it: up to 170 MB a second.
class running_clock {
public:
    enum class capture_kind { dropped, kept };

    /// `each`: called after each period, in that thread.
    explicit running_clock(
        fake_dac& dac, capture_kind k = capture_kind::dropped, std::function<void()> each = [] {})
        : thread_([this, &dac, k, each = std::move(each)] {
              if (k == capture_kind::dropped)
                  dac.stop_capture();
              while (!end_) {
                  if (dac.queued() >= 192)
                      dac.advance_queued(96);
                  std::this_thread::yield();
                  each();
              }
          })
    {
    }
    ~running_clock()
    {
        end_ = true;
        thread_.join();
    }

private:
    std::atomic<bool> end_{false};
    std::thread thread_;
};

} // namespace tactor::test
