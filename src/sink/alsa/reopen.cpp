// SPDX-License-Identifier: MIT
#include <algorithm>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "core/log.hpp"

namespace tactor {
inline namespace v0 {

std::unique_ptr<sink> reopen_alsa(const alsa_options& o, const std::function<bool(double)>& pause)
{
    constexpr double longest_s = 5.0;
    if (!pause)
        throw error(error_kind::bad_input, "reopen_alsa", "there is nothing that waits", "give a function");
    detail::log(o.log, log_kind::info, "waiting for PCM \"{}\" to come back", o.pcm);
    for (double wait_s = 0.1; pause(wait_s); wait_s = std::min(2.0 * wait_s, longest_s)) {
        try {
            std::unique_ptr<sink> s = open_alsa(o);
            detail::log(o.log, log_kind::info, "PCM \"{}\" is back", o.pcm);
            return s;
        } catch (const error& e) {
            // Not there yet, or udev has not given it to its group yet.
            if (e.kind() != error_kind::not_available)
                throw;
            detail::log(o.log, log_kind::debug, "not back yet: {}", e.what());
        }
    }
    return nullptr;
}

} // namespace v0
} // namespace tactor
