// SPDX-License-Identifier: MIT
#include "alsa/names.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "alsa/handle.hpp"
#include "alsa/library_messages.hpp"

namespace tactor::pcm {
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
        const c_text direction(snd_device_name_get_hint(*h, "IOID")); // none: both
        if (name != nullptr && (direction == nullptr || std::string_view(direction.get()) != "Input"))
            names.push_back({name.get(), description == nullptr ? "" : one_line(description.get())});
    }
    return names;
}

// The system's configuration, kept from being reread meanwhile.
class system_configuration {
public:
    system_configuration() { snd_config_update_ref(&top_); }
    ~system_configuration()
    {
        if (top_ != nullptr)
            snd_config_unref(top_);
    }
    system_configuration(const system_configuration&) = delete;
    system_configuration& operator=(const system_configuration&) = delete;
    snd_config_t* get() const noexcept { return top_; }

private:
    snd_config_t* top_ = nullptr;
};

bool is_compound(snd_config_t* c)
{
    return snd_config_get_type(c) == SND_CONFIG_TYPE_COMPOUND;
}

template <typename Visit>
void each_member(snd_config_t* compound, Visit visit)
{
    snd_config_iterator_t i = snd_config_iterator_first(compound);
    for (; i != snd_config_iterator_end(compound); i = snd_config_iterator_next(i)) {
        snd_config_t* member = snd_config_iterator_entry(i);
        const char* id = nullptr;
        if (snd_config_get_id(member, &id) == 0 && id != nullptr)
            visit(std::string(id), member);
    }
}

// Stock names such as front or dmix are strings that lead to a card's functions: the hints have them.
bool stands_alone(snd_config_t* definition)
{
    snd_config_t* found = nullptr;
    return is_compound(definition) && snd_config_search(definition, "type", &found) == 0 &&
           snd_config_search(definition, "@args", &found) < 0;
}

// These touch nothing beyond what they open.
bool is_harmless(std::string_view type)
{
    constexpr std::array types{"hw",   "null",  "file",  "plug", "linear", "lfloat", "copy",  "route",
                               "rate", "multi", "empty", "asym", "mulaw",  "alaw",   "adpcm", "iec958"};
    return std::find(types.begin(), types.end(), type) != types.end();
}

constexpr int deepest = 8; // of plugins on plugins; a definition may name itself

class plugin_search {
public:
    explicit plugin_search(snd_config_t* top) : top_(top) {}

    std::string of_name(const char* base, const std::string& name, int depth) const
    {
        snd_config_t* definition = nullptr;
        if (depth > deepest || snd_config_search_definition(top_, base, name.c_str(), &definition) < 0)
            return {};
        const std::unique_ptr<snd_config_t, deleter<snd_config_delete>> owned(definition);
        return is_compound(definition) ? of_definition(definition, depth + 1) : "";
    }

private:
    std::string of_definition(snd_config_t* definition, int depth) const
    {
        std::string found;
        each_member(definition, [&](const std::string& id, snd_config_t* member) {
            const char* said = nullptr;
            if (!found.empty() || id == "capture" || id == "hint")
                return;
            if (is_compound(member))
                found = of_definition(member, depth);
            else if (snd_config_get_string(member, &said) < 0 || said == nullptr)
                return;
            else if (id == "type")
                found = is_harmless(said) ? "" : said;
            else if (id == "pcm")
                found = of_name("pcm", said, depth);
            else if (id == "slave")
                found = of_name("pcm_slave", said, depth);
        });
        return found;
    }

    snd_config_t* top_;
};

} // namespace

std::vector<std::string> defined_pcms(snd_config_t* top)
{
    std::vector<std::string> names;
    snd_config_t* pcms = nullptr;
    if (top != nullptr && snd_config_search(top, "pcm", &pcms) == 0 && is_compound(pcms))
        each_member(pcms, [&](const std::string& id, snd_config_t*) { names.push_back(id); });
    return names;
}

std::vector<std::string> defined_pcms()
{
    return defined_pcms(system_configuration().get());
}

std::vector<known_name> known_names()
{
    const library_messages silent;
    std::vector<known_name> names = hinted();
    const system_configuration system;
    snd_config_t* pcms = nullptr;
    if (system.get() == nullptr || snd_config_search(system.get(), "pcm", &pcms) < 0 || !is_compound(pcms))
        return names;
    each_member(pcms, [&](const std::string& id, snd_config_t* definition) {
        const auto same = [&](const known_name& n) { return n.name == id; };
        if (stands_alone(definition) && std::none_of(names.begin(), names.end(), same))
            names.push_back({id, ""});
    });
    return names;
}

std::string lasting_plugin(const std::string& name)
{
    const library_messages silent;
    const system_configuration system;
    return system.get() == nullptr ? "" : plugin_search(system.get()).of_name("pcm", name, 0);
}

} // namespace tactor::pcm
