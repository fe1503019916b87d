// SPDX-License-Identifier: MIT
// Public functions of this folder in a library that was built without ALSA (-Dalsa=disabled).
#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "sink/alsa/plain_name.hpp"

namespace tactor {
inline namespace v0 {
namespace {

error no_alsa_error(std::string_view what)
{
    return {error_kind::not_available, what, "tactor was built without ALSA",
            "build it again with -Dalsa=enabled and libasound"};
}

} // namespace

std::unique_ptr<sink> open_alsa(const alsa_options& o)
{
    throw no_alsa_error(fmt::format("PCM \"{}\"", o.pcm));
}

std::unique_ptr<sink> reopen_alsa(const alsa_options& o, const std::function<bool(double)>&)
{
    throw no_alsa_error(fmt::format("PCM \"{}\"", o.pcm));
}

std::vector<pcm_info> list_pcms(const std::optional<alsa_options>&)
{
    throw no_alsa_error("devices");
}

pcm_route read_route(const std::string&)
{
    return {};
}

stream_wiring read_wiring(const std::string&, unsigned)
{
    return {};
}

// Checks only the form of a name, because no name leads to a device.
void require_device_name(const std::string& pcm)
{
    if (const std::string why = alsa::find_plain_name_fault(pcm); !why.empty())
        throw error(error_kind::bad_input, fmt::format("PCM \"{}\"", pcm), why,
                    "in an array file, name only a device, such as hw:CARD=Tactor");
}

std::optional<card_info> read_card(const std::string&)
{
    return {};
}

std::vector<process_info> card_holders(unsigned)
{
    return {};
}

} // namespace v0
} // namespace tactor
