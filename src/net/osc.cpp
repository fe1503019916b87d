// SPDX-License-Identifier: MIT
// Bundles. liblo reads them only in its own server, in its own order and time.
#include "net/osc.hpp"

#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::net {
namespace {

constexpr std::string_view bundle_mark{"#bundle\0", 8};
constexpr std::size_t time_bytes = 8;
constexpr std::size_t size_bytes = 4;
constexpr std::size_t most_depth = 8;
constexpr std::size_t most_messages = 256;

[[noreturn]] void broken(std::string why)
{
    throw error(error_kind::bad_input, "packet", std::move(why), "OSC 1.0: a message or a bundle");
}

// Reads a big-endian number.
std::uint64_t number(std::string_view bytes)
{
    std::uint64_t n = 0;
    for (const char c : bytes)
        n = n << 8U | static_cast<unsigned char>(c);
    return n;
}

// Converts a time of NTP: seconds since 1900, or since 2036 if their first bit is not set, and a fraction. 1
// means "at once", and so do the zeros that some send instead.
std::optional<std::int64_t> unix_time(std::uint64_t tag)
{
    constexpr std::uint64_t from_1900 = 2'208'988'800;
    const std::uint64_t seconds = tag >> 32U;
    if (seconds == 0)
        return {};
    const bool next_era = (seconds & 0x80000000U) == 0;
    const std::uint64_t since_1900 = seconds + (next_era ? std::uint64_t{1} << 32U : 0);
    const std::uint64_t fraction_ns = ((tag & 0xffffffffU) * 1'000'000'000U) >> 32U;
    return static_cast<std::int64_t>((since_1900 - from_1900) * 1'000'000'000U + fraction_ns);
}

using messages = std::vector<osc_message>;

void read_element(messages& all, std::string_view bytes, std::optional<std::int64_t> at, std::size_t depth);

void read_bundle(messages& all, std::string_view bytes, std::size_t depth)
{
    if (depth > most_depth)
        broken(fmt::format("its bundles nest deeper than {}", most_depth));
    bytes.remove_prefix(bundle_mark.size());
    if (bytes.size() < time_bytes)
        broken("a bundle without its time");
    const auto at = unix_time(number(bytes.substr(0, time_bytes)));
    bytes.remove_prefix(time_bytes);
    while (!bytes.empty()) {
        if (bytes.size() < size_bytes)
            broken("a bundle that ends within a size");
        const std::uint64_t size = number(bytes.substr(0, size_bytes));
        bytes.remove_prefix(size_bytes);
        if (size > bytes.size() || size == 0 || size % 4 != 0)
            broken(fmt::format("an element of {} bytes where {} are left", size, bytes.size()));
        read_element(all, bytes.substr(0, size), at, depth);
        bytes.remove_prefix(size);
    }
}

void read_element(messages& all, std::string_view bytes, std::optional<std::int64_t> at, std::size_t depth)
{
    if (bytes.starts_with(bundle_mark))
        return read_bundle(all, bytes, depth + 1);
    if (all.size() == most_messages)
        broken(fmt::format("more than {} messages", most_messages));
    all.push_back(parse_osc_message(bytes));
    all.back().unix_ns = at;
}

} // namespace

std::vector<osc_message> parse_osc(std::string_view packet)
{
    if (packet.empty() || packet.size() % 4 != 0)
        broken(fmt::format("{} bytes are no multiple of 4", packet.size()));
    messages all;
    read_element(all, packet, {}, 0);
    return all;
}

} // namespace tactor::net
