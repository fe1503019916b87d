// SPDX-License-Identifier: MIT
#include "sink/alsa/devices/route.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "sink/alsa/configuration.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/library_messages.hpp"

namespace tactor::alsa {
namespace {

using types = std::vector<std::string>;

constexpr std::size_t most_types = 64; // of one PCM; also stops definitions that double at each step

// These affect only the device at their end.
constexpr std::array harmless{"hw",    "null",  "plug", "linear", "lfloat", "copy",  "route", "rate",
                              "multi", "empty", "asym", "mulaw",  "alaw",   "adpcm", "iec958"};
// These start a card's mixer, set it ("ctl_elems" is the type of hooks), or talk to a server.
constexpr std::array lasting{"dmix", "dshare", "softvol", "hooks", "ctl_elems", "pulse", "pipewire", "jack"};

class walker {
public:
    explicit walker(snd_config_t* top) : top_(top) {}

    void name(const char* base, const std::string& name, int depth)
    {
        snd_config_t* definition = nullptr;
        if (full(depth) || snd_config_search_definition(top_, base, name.c_str(), &definition) < 0)
            return;
        const std::unique_ptr<snd_config_t, deleter<snd_config_delete>> owned(definition);
        const char* other = nullptr;
        if (snd_config_get_string(definition, &other) >= 0 && other != nullptr)
            this->name(base, other, depth + 1);
        else
            add_definition(definition, depth + 1, false);
    }

    types found() && { return std::move(found_); }

private:
    bool full(int depth)
    {
        if (depth <= deepest && found_.size() < most_types)
            return false;
        if (found_.empty() || found_.back() != endless)
            found_.emplace_back(endless);
        return true;
    }

    // Adds the plugins of a definition. `slaves`: each member names a slave.
    void add_definition(snd_config_t* definition, int depth, bool slaves)
    {
        each_member(definition, [&](const std::string& id, snd_config_t* member) {
            const char* text = nullptr;
            if (id == "capture" || id == "hint")
                return;
            if (snd_config_get_type(member) == SND_CONFIG_TYPE_COMPOUND) {
                if (!full(depth))
                    add_definition(member, depth, id == "slaves");
            } else if (snd_config_get_string(member, &text) < 0 || text == nullptr)
                return;
            else if (id == "type")
                found_.emplace_back(text);
            else if (id == "pcm")
                name("pcm", text, depth);
            else if (slaves || id == "slave" || id == "playback")
                name("pcm_slave", text, depth);
        });
    }

    snd_config_t* top_;
    types found_ = {};
};

} // namespace

std::vector<std::string> find_route(snd_config_t* top, const std::string& name)
{
    const library_messages silent;
    if (top == nullptr)
        return {};
    walker w(top);
    w.name("pcm", name, 0);
    return std::move(w).found();
}

std::vector<std::string> find_route(const std::string& name)
{
    const library_messages silent;
    return find_route(system_configuration().read(), name);
}

std::string unsafe_type(const std::vector<std::string>& route)
{
    const auto bad = std::find_if_not(route.begin(), route.end(), [](const std::string& t) {
        return contains(harmless, t) || contains(lasting, t);
    });
    return bad == route.end() ? "" : *bad;
}

std::string lasting_type(const std::vector<std::string>& route)
{
    const auto bad = std::find_if_not(route.begin(), route.end(),
                                      [](const std::string& t) { return contains(harmless, t); });
    return bad == route.end() ? "" : *bad;
}

bool writes(const std::vector<std::string>& route)
{
    return std::find(route.begin(), route.end(), "file") != route.end();
}

std::string find_server(const std::vector<std::string>& route)
{
    constexpr std::array<std::pair<std::string_view, const char*>, 3> servers{
        {{"pipewire", "PipeWire"}, {"pulse", "PulseAudio"}, {"jack", "JACK"}}};
    for (const auto& [type, server] : servers)
        if (std::find(route.begin(), route.end(), type) != route.end())
            return server;
    return {};
}

} // namespace tactor::alsa
