// SPDX-License-Identifier: MIT
#include "cli/play/open_device.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <tactor/tactor.hpp>

namespace tactor::cli {

std::string find_array_that_fits(alsa_options o)
{
    std::multimap<unsigned, std::string> by_channels;
    for (const std::string& name : array_presets())
        by_channels.emplace(preset_array(name).channels(), name);
    o.log = {};
    o.wider = true;
    const unsigned needed = o.channels;
    for (auto a = by_channels.rbegin(); a != by_channels.rend(); ++a) {
        o.channels = a->first;
        try {
            if (o.channels < needed && open_alsa(o) != nullptr)
                return a->second;
        } catch (const error&) { // NOLINT(bugprone-empty-catch): not that one
        }
    }
    return {};
}

std::unique_ptr<sink> open_device(const alsa_options& o)
{
    try {
        return open_alsa(o);
    } catch (const error& e) {
        const std::string smaller = e.field() == "channels" ? find_array_that_fits(o) : "";
        if (smaller.empty())
            throw;
        throw e.reworded(e.subject(), e.why(), fmt::format("{}; the array {} fits", e.hint(), smaller));
    }
}

} // namespace tactor::cli
