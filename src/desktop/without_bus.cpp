// SPDX-License-Identifier: MIT
// Replacement without sd-bus: grants nothing.
#include <utility>

#include "desktop/desktop.hpp"

namespace tactor::desktop {

struct reservation::impl {};
struct sleep_watch::impl {};

bool request_realtime(pid_t, int) noexcept
{
    return false;
}

reservation::reservation(std::unique_ptr<impl> i) : impl_(std::move(i))
{
}

reservation::~reservation() = default;

std::unique_ptr<reservation> reservation::take(unsigned, std::function<bool()>, std::string&)
{
    return nullptr;
}

sleep_watch::sleep_watch(std::function<void(bool)>)
{
}

sleep_watch::~sleep_watch() = default;

} // namespace tactor::desktop
