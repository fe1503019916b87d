// OSC messages are parsed by liblo. Bundles are parsed here, because liblo reads bundles only in its own
// server, which delivers their messages in its own order and time.
#include "net/osc.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <lo/lo_lowlevel.h>

#include <tactor/error.hpp>

namespace tactor::net {
namespace {

constexpr std::string_view bundle_mark{"#bundle\0", 8};
constexpr std::size_t time_bytes = 8;
constexpr std::size_t size_bytes = 4;
constexpr std::size_t most_depth = 8;
constexpr std::size_t most_messages = 256;

[[noreturn]] void throw_bad_packet(std::string why)
{
    throw error(error_kind::bad_input, "packet", std::move(why), "send an OSC 1.0 message or bundle");
}

// Reads a big-endian number.
std::uint64_t read_big_endian(std::string_view bytes)
{
    std::uint64_t n = 0;
    for (const char c : bytes)
        n = n << 8U | static_cast<unsigned char>(c);
    return n;
}

// Converts an NTP timestamp: seconds since 1900, and a fraction. If the first bit of the seconds is 0, they
// count from 2036. The value 1 means "immediately", and so does 0, which some programs send.
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

struct freed {
    void operator()(lo_message m) const noexcept { lo_message_free(m); }
};
using owned_message = std::unique_ptr<std::remove_pointer_t<lo_message>, freed>;

// Reads a value at an address that may be unaligned: values of 8 bytes are at multiples of 4.
template <typename T>
T read(const lo_arg* at)
{
    T v{};
    std::memcpy(&v, at, sizeof v);
    return v;
}

osc_value read_value(char tag, const lo_arg* at)
{
    switch (tag) {
    case 'i':
        return std::int64_t{read<std::int32_t>(at)};
    case 'h':
        return read<std::int64_t>(at);
    case 'f':
        return double{read<float>(at)};
    case 'd':
        return read<double>(at);
    case 's':
    case 'S':
        return std::string(static_cast<const char*>(static_cast<const void*>(at))); // possibly unaligned
    default:
        return osc_other{tag};
    }
}

const char* words(int code)
{
    switch (code) {
    case -LO_EINVALIDPATH:
        return "its address is not padded with zeros";
    case -LO_EINVALIDTYPE:
    case -LO_EBADTYPE:
        return "its types do not begin with a comma, do not end, or are not padded with zeros";
    case -LO_EINVALIDARG:
        return "a value is incomplete, or has an unknown type";
    default:
        return "its types do not match its length";
    }
}

// Parses a message of a packet. The argument must not be a bundle.
osc_message read_message(std::string_view bytes)
{
    if (!bytes.starts_with('/'))
        throw error(error_kind::bad_input, "message", "its address does not begin with /",
                    "send an address, types and values, as OSC 1.0 requires");
    const std::size_t end = bytes.find('\0');
    if (end == std::string_view::npos)
        return {.address = std::string(bytes), .fault = "its address does not end"};
    // Some old programs omit the type tags of a message without values.
    if (bytes.size() == (end / 4 + 1) * 4 && bytes.find_first_not_of('\0', end) == std::string_view::npos)
        return {.address = std::string(bytes.substr(0, end))};
    std::string copy(bytes); // liblo may write to it
    int failed = 0;
    const owned_message m(lo_message_deserialise(copy.data(), copy.size(), &failed));
    if (!m)
        return {.address = std::string(bytes.substr(0, end)), .fault = words(-failed)};
    osc_message read{.address = copy.c_str()};
    const std::string_view tags = lo_message_get_types(m.get());
    lo_arg** const values = lo_message_get_argv(m.get());
    for (std::size_t i = 0; i < tags.size(); ++i)
        read.values.push_back(read_value(tags[i], values[i]));
    return read;
}

// Parses a message or a bundle. A bundle replaces the time by its own time.
void read_element(std::vector<osc_message>& all, std::string_view bytes, std::optional<std::int64_t> at,
                  std::size_t depth)
{
    if (!bytes.starts_with(bundle_mark)) {
        if (all.size() == most_messages)
            throw_bad_packet(fmt::format("it has more than {} messages", most_messages));
        all.push_back(read_message(bytes));
        all.back().unix_ns = at;
        return;
    }
    if (depth == most_depth)
        throw_bad_packet(fmt::format("its bundles nest deeper than {}", most_depth));
    bytes.remove_prefix(bundle_mark.size());
    if (bytes.size() < time_bytes)
        throw_bad_packet("a bundle has no time");
    at = unix_time(read_big_endian(bytes.substr(0, time_bytes)));
    bytes.remove_prefix(time_bytes);
    while (!bytes.empty()) {
        if (bytes.size() < size_bytes)
            throw_bad_packet("a bundle ends within a size");
        const std::uint64_t size = read_big_endian(bytes.substr(0, size_bytes));
        bytes.remove_prefix(size_bytes);
        if (size > bytes.size() || size == 0 || size % 4 != 0)
            throw_bad_packet(fmt::format("an element has {} bytes, but {} are left", size, bytes.size()));
        read_element(all, bytes.substr(0, size), at, depth + 1);
        bytes.remove_prefix(size);
    }
}

} // namespace

bool has_osc_support() noexcept
{
    return true;
}

std::vector<osc_message> parse_osc(std::string_view packet)
{
    if (packet.empty())
        throw_bad_packet("it is empty");
    if (packet.size() % 4 != 0)
        throw_bad_packet(fmt::format("{} bytes are not a multiple of 4", packet.size()));
    std::vector<osc_message> all;
    read_element(all, packet, {}, 0);
    return all;
}

std::string osc_packet(const std::string& address, const std::vector<osc_value>& values)
{
    const owned_message m(lo_message_new());
    if (!m)
        throw std::bad_alloc();
    for (const osc_value& v : values) {
        using whole = std::numeric_limits<std::int32_t>;
        if (const auto* n = std::get_if<std::int64_t>(&v))
            lo_message_add_int32(
                m.get(), static_cast<std::int32_t>(std::clamp<std::int64_t>(*n, whole::min(), whole::max())));
        else if (const auto* x = std::get_if<double>(&v))
            lo_message_add_float(m.get(), static_cast<float>(*x));
        else if (const auto* s = std::get_if<std::string>(&v))
            lo_message_add_string(m.get(), s->c_str());
    }
    std::string bytes(lo_message_length(m.get(), address.c_str()), '\0');
    std::size_t size = bytes.size();
    lo_message_serialise(m.get(), address.c_str(), bytes.data(), &size);
    return bytes;
}

} // namespace tactor::net
