// SPDX-License-Identifier: MIT
/// \file
/// A sound server that has reserved a card, and releases it if asked, or not.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include <systemd/sd-bus.h>

#include "private_bus.hpp"

namespace tactor::test {

/// Returns the bus name and the object's path of a card.
inline std::string card_name(unsigned card)
{
    return "org.freedesktop.ReserveDevice1.Audio" + std::to_string(card);
}
inline std::string card_path(unsigned card)
{
    return "/org/freedesktop/ReserveDevice1/Audio" + std::to_string(card);
}

class sound_server {
public:
    enum class manner { agrees, refuses, silent };

    sound_server(
        unsigned card, manner m, std::function<void()> released = [] {})
    {
        server_.serve(card_name(card), card_path(card), [this, card, m, released](sd_bus_message* call) {
            if (sd_bus_message_is_method_call(call, "org.freedesktop.DBus.Properties", "Get") > 0)
                return sd_bus_reply_method_return(call, "v", "s", "Sound\nServer");
            if (sd_bus_message_is_method_call(call, "org.freedesktop.ReserveDevice1", "RequestRelease") <= 0)
                return 0;
            int priority = 0;
            sd_bus_message_read(call, "i", &priority);
            asked = priority;
            if (m == manner::silent)
                return 1;
            if (m == manner::refuses)
                return sd_bus_reply_method_return(call, "b", 0);
            released();
            const int sent = sd_bus_reply_method_return(call, "b", 1);
            server_.release(card_name(card));
            return sent;
        });
    }

    std::string own_name() const { return server_.own_name(); }

    std::atomic<int> asked = 0; ///< priority of the last request

private:
    peer server_;
};

} // namespace tactor::test
