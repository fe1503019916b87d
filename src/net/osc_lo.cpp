// SPDX-License-Identifier: MIT
// Messages, by liblo.
#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

#include <lo/lo_lowlevel.h>

#include <tactor/error.hpp>

#include "net/osc.hpp"

namespace tactor::net {
namespace {

struct freed {
    void operator()(lo_message m) const noexcept { lo_message_free(m); }
};
using owned_message = std::unique_ptr<std::remove_pointer_t<lo_message>, freed>;

// Reads a value at any address: values of 8 bytes are at multiples of 4.
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
        return std::string(static_cast<const char*>(static_cast<const void*>(at))); // at any address
    default:
        return osc_other{tag};
    }
}

const char* words(int code)
{
    switch (code) {
    case -LO_EINVALIDPATH:
        return "its address is not filled up with zeros";
    case -LO_EINVALIDTYPE:
    case -LO_EBADTYPE:
        return "its types do not begin with a comma, do not end, or are not filled up with zeros";
    case -LO_EINVALIDARG:
        return "a value does not end within it, or is of no known type";
    default:
        return "its types and its length do not agree";
    }
}

} // namespace

bool osc_is_built() noexcept
{
    return true;
}

osc_message parse_osc_message(std::string_view bytes)
{
    if (!bytes.starts_with('/'))
        throw error(error_kind::bad_input, "message", "its address does not begin with /",
                    "OSC 1.0: an address, types, values");
    const std::size_t end = bytes.find('\0');
    if (end == std::string_view::npos)
        return {.address = std::string(bytes), .fault = "its address does not end"};
    // Old senders send no types in a message without values.
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
