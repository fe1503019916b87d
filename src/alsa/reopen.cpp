// SPDX-License-Identifier: MIT
#include <algorithm>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

namespace tactor {

std::unique_ptr<sink> reopen_alsa(const alsa_options& o,
                                  const std::function<bool(std::chrono::milliseconds)>& pause)
{
    constexpr std::chrono::milliseconds longest{5000};
    if (!pause)
        throw error(errc::bad_input, "reopen_alsa", "there is nothing that waits", "give a function");
    for (std::chrono::milliseconds wait{100}; pause(wait); wait = std::min(2 * wait, longest)) {
        try {
            return open_alsa(o);
        } catch (const error& e) {
            // Not there yet, or udev has not given it to its group yet.
            if (e.kind() != errc::not_available)
                throw;
        }
    }
    return nullptr;
}

} // namespace tactor
