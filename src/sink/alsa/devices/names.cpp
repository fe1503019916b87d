// SPDX-License-Identifier: MIT

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "sink/alsa/devices/route.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/library_messages.hpp"

namespace tactor::alsa {
namespace {

using hints = std::unique_ptr<void*, deleter<snd_device_name_free_hint>>;
using c_text = std::unique_ptr<char, deleter<std::free>>;

std::string one_line(const char* lines)
{
    std::string s;
    for (const char c : std::string_view(lines))
        s += c == '\n' ? std::string(", ") : std::string(1, c);
    return s;
}

std::vector<known_name> hinted()
{
    std::vector<known_name> names;
    void** first = nullptr;
    if (snd_device_name_hint(-1, "pcm", &first) < 0)
        return names;
    const hints all(first);
    for (void** h = first; *h != nullptr; ++h) {
        const c_text name(snd_device_name_get_hint(*h, "NAME"));
        const c_text description(snd_device_name_get_hint(*h, "DESC"));
        const c_text direction(snd_device_name_get_hint(*h, "IOID")); // null: both directions
        if (name != nullptr && (direction == nullptr || std::string_view(direction.get()) != "Input"))
            names.push_back({name.get(), description == nullptr ? "" : one_line(description.get())});
    }
    return names;
}

// Returns false for stock names such as front or dmix: their definitions are strings that lead to a card's
// functions. The hints list them.
bool stands_alone(snd_config_t* definition)
{
    snd_config_t* found = nullptr;
    return snd_config_get_type(definition) == SND_CONFIG_TYPE_COMPOUND &&
           snd_config_search(definition, "type", &found) == 0 &&
           snd_config_search(definition, "@args", &found) < 0;
}

} // namespace

std::vector<std::string> defined_pcms(snd_config_t* top)
{
    std::vector<std::string> names;
    snd_config_t* pcms = nullptr;
    if (top != nullptr && snd_config_search(top, "pcm", &pcms) == 0)
        each_member(pcms, [&](const std::string& id, snd_config_t*) { names.push_back(id); });
    return names;
}

std::vector<known_name> known_names(snd_config_t* top)
{
    const library_messages silent;
    snd_config_t* pcms = nullptr;
    if (top == nullptr || snd_config_search(top, "pcm", &pcms) < 0)
        return {};
    std::vector<known_name> names = hinted();
    each_member(pcms, [&](const std::string& id, snd_config_t* definition) {
        const auto same = [&](const known_name& n) { return n.name == id; };
        if (stands_alone(definition) && std::none_of(names.begin(), names.end(), same))
            names.push_back({id, ""});
    });
    return names;
}

} // namespace tactor::alsa
