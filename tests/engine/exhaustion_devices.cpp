// SPDX-License-Identifier: MIT
// Calls that throw: devices, lines and sinks.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <tactor/alsa.hpp>
#include <tactor/lines.hpp>
#include <tactor/sink.hpp>

#include "amplifier/line.hpp"
#include "exhaustion_calls.hpp"
#include "player_support.hpp"

namespace tactor::test {
namespace {

class deaf_sink final : public paced_sink {
public:
    using paced_sink::paced_sink;

private:
    io_kind take(std::uint64_t, std::span<const std::byte>) noexcept override { return io_kind::ok; }
};

} // namespace

call_table device_calls()
{
    using enum call_kind;
    const gpio_line_name line{.name = "no-such-line"};
    const call_kind looks = amplifier::built_in() ? opens : plain;
    return {
        {"open_alsa", [] { return open_alsa(nine()); }, opens_ends},
        {"open_alsa, of a card", [] { return open_alsa({.pcm = "hw:0", .channels = 2}); }, opens_ends},
        {"open_alsa, of nothing", [] { return open_alsa({.pcm = "no such PCM", .channels = 2}); },
         opens_ends},
        {"reopen_alsa", [] { return reopen_alsa(nine(), [n = 0](double) mutable { return n++ == 0; }); },
         opens_ends},
        {"reopen_alsa, never", [] { return reopen_alsa(nine(), {}); }},
        {"list_pcms", [] { return list_pcms(); }, opens_ends},
        {"list_pcms, that suit", [] { return list_pcms(nine()); }, opens_ends},
        {"read_route", [] { return read_route("null"); }, opens_ends},
        {"read_wiring", [] { return read_wiring("null", 2); }, opens_ends},
        {"require_device_name", [] { require_device_name("null"); }, opens_ends},
        {"require_device_name, of a command", [] { require_device_name("file:'|true',raw"); }},
        {"read_card", [] { return read_card("hw:0"); }, opens},
        {"card_holders", [] { return card_holders(0); }, opens},
        {"list_gpio", [] { return list_gpio(); }, opens},
        {"find_gpio_line", [line] { return find_gpio_line(line); }, looks},
        {"open_output", [line] { return open_output(line); }, looks},
        {"open_edges", [line] { return open_edges(line, edge_kind::rising); }, looks},
        {"open_amplifier", [line] { return open_amplifier({.line = line}); }, looks},
        {"paced_sink::paced_sink",
         []() -> std::unique_ptr<paced_sink> {
             return std::make_unique<deaf_sink>(stream_setup{.name = "deaf", .channels = 2, .rate = 48000});
         },
         opens},
    };
}

} // namespace tactor::test
