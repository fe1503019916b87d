// SPDX-License-Identifier: MIT
/// \file
/// For the tests of the player with its real threads.
#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <utility>

#include <tactor/player.hpp>

#include "fake_dac.hpp"

namespace tactor::test {

/// The fake clock stands still while the test thinks, and runs as fast as it can when it runs: neither is a
/// reason to give up.
inline player_options patient(const drive_limits& limits = {})
{
    player_options o;
    o.limits = limits;
    o.stall_s = 600.0;
    o.horizon_s = 600.0;
    return o;
}

/// Lets the DAC run in a thread of its own for as long as it lives: for the calls that block. What it plays
/// from then on is kept only where a test says that it reads it: it is up to 170 MB a second.
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
