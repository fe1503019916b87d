// SPDX-License-Identifier: MIT
#include "sink/alsa/route.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "sink/alsa/error_text.hpp"
#include "sink/alsa/handle.hpp"

namespace tactor::alsa {
namespace {

using types = std::vector<std::string>;

constexpr int deepest = 32; // maximum depth of plugins: a definition may refer to itself
constexpr std::size_t most_types =
    1024; // maximum number of types of one PCM; also stops definitions that double at each step

// Types that affect only the device at their end.
constexpr std::array harmless{"hw",    "null",  "plug", "linear", "lfloat", "copy",  "route", "rate",
                              "multi", "empty", "asym", "mulaw",  "alaw",   "adpcm", "iec958"};
// Types that start or set the mixer of a card ("ctl_elems" is a type of hooks), or that talk to a server.
constexpr std::array lasting{"dmix", "dshare", "softvol", "hooks", "ctl_elems", "pulse", "pipewire", "jack"};

using c_text = std::unique_ptr<char, deleter<std::free>>;

// Returns the member of a compound with that name, or null. Accepts null and other types of node.
snd_config_t* member(snd_config_t* compound, const char* id)
{
    snd_config_t* found = nullptr;
    return compound != nullptr && snd_config_get_type(compound) == SND_CONFIG_TYPE_COMPOUND &&
                   snd_config_search(compound, id, &found) == 0
               ? found
               : nullptr;
}

// Returns a value as text; empty for null and for a compound.
std::string value_text(snd_config_t* value)
{
    // snd_config_get_ascii() of libasound 1.2.8 asserts that a number is shorter than 12 characters.
    long number = 0;
    if (value != nullptr && snd_config_get_integer(value, &number) >= 0)
        return fmt::to_string(number);
    char* text = nullptr;
    if (value == nullptr || snd_config_get_ascii(value, &text) < 0 || text == nullptr)
        return {};
    const c_text freed(text);
    return text;
}

// Returns the text of a string, which the node owns; null for null and for other types of node.
const char* string_value(snd_config_t* value)
{
    const char* text = nullptr;
    return value != nullptr && snd_config_get_string(value, &text) >= 0 ? text : nullptr;
}

// Returns the definition of a name under `base`; null if there is none.
configuration look_up(snd_config_t* top, const char* base, const std::string& name)
{
    snd_config_t* definition = nullptr;
    snd_config_search_definition(top, base, name.c_str(), &definition);
    return configuration(definition);
}

// Returns the definition of a slave, or null if there is none. If `slave` is the name of a definition,
// `named` owns the returned definition.
snd_config_t* find_slave(snd_config_t* top, snd_config_t* slave, configuration& named)
{
    const char* name = string_value(slave);
    if (name == nullptr)
        return slave;
    named = look_up(top, "pcm_slave", name);
    return named.get();
}

// Reads a number as libasound does: in any base, without further text. Returns most_channels for a number
// that no device has.
std::optional<unsigned> parse_channel_number(const std::string& s)
{
    char* end = nullptr;
    const long n = std::strtol(s.c_str(), &end, 0);
    if (s.empty() || *end != '\0')
        return {};
    return n < 0 || n > long{most_channels} ? most_channels : static_cast<unsigned>(n);
}

// Returns the number of channels of a slave; most_channels if its definition gives none. `slave`: definition
// or name.
unsigned slave_channels(snd_config_t* top, snd_config_t* slave)
{
    configuration named;
    return parse_channel_number(value_text(member(find_slave(top, slave, named), "channels")))
        .value_or(most_channels);
}

// Returns the fault of a definition's channel tables, which libasound does not check. Empty if there is none.
std::string find_table_fault(snd_config_t* top, snd_config_t* definition)
{
    const std::string type = value_text(member(definition, "type"));
    std::set<unsigned> bound;
    std::string fault;
    const auto below = [&](std::optional<unsigned> channel, unsigned most) {
        if (channel && *channel >= most && fault.empty())
            fault = fmt::format("type {} has a channel beyond the largest possible, {}", type, most);
    };
    for (const char* table : {"ttable", "bindings"})
        for_each_member(member(definition, table), [&](const std::string& client, snd_config_t* row) {
            const std::optional<unsigned> channel = parse_channel_number(client);
            below(channel, most_channels);
            bound.insert(channel.value_or(0));
            for_each_member(row, [&](const std::string& to, snd_config_t*) {
                below(parse_channel_number(to), most_channels);
            });
            if (type == "share")
                below(parse_channel_number(value_text(row)),
                      slave_channels(top, member(definition, "slave")));
        });
    unsigned next = 0;
    while (bound.contains(next))
        ++next;
    if (type == "multi" && fault.empty() && next < bound.size())
        fault = fmt::format("type multi leaves a gap in its bindings: it has no channel {}", next);
    return fault;
}

class walker {
public:
    explicit walker(snd_config_t* top) : top_(top) {}

    // Visits the definition of a name and the definitions that it refers to.
    void name(const char* base, const std::string& name, int depth)
    {
        const configuration definition = full(depth) ? nullptr : look_up(top_, base, name);
        if (definition == nullptr)
            return;
        if (const char* other = string_value(definition.get()))
            this->name(base, other, depth + 1);
        else
            add_definition(definition.get(), depth + 1, false);
    }

    types found() && { return std::move(found_); }
    std::string fault() const
    {
        return contains(found_, endless) ? "its definition refers to itself, or to too many others" : fault_;
    }

private:
    bool full(int depth)
    {
        if (!found_.empty() && found_.back() == endless)
            return true;
        if (depth <= deepest && found_.size() < most_types)
            return false;
        found_.emplace_back(endless);
        return true;
    }

    // Adds the plugins of a definition. `slaves`: each member names a slave.
    void add_definition(snd_config_t* definition, int depth, bool slaves)
    {
        if (fault_.empty())
            fault_ = find_table_fault(top_, definition);
        for_each_member(definition, [&](const std::string& id, snd_config_t* member) {
            if (id == "capture" || id == "hint")
                return;
            if (snd_config_get_type(member) == SND_CONFIG_TYPE_COMPOUND) {
                if (!full(depth))
                    add_definition(member, depth, id == "slaves");
            } else if (const char* text = string_value(member)) {
                if (id == "type")
                    found_.emplace_back(text);
                else if (id == "pcm")
                    name("pcm", text, depth);
                else if (slaves || id == "slave" || id == "playback")
                    name("pcm_slave", text, depth);
            }
        });
    }

    snd_config_t* top_;
    types found_ = {};
    std::string fault_ = {};
};

using hints = std::unique_ptr<void*, deleter<snd_device_name_free_hint>>;

std::string join_lines(const char* lines)
{
    std::string s;
    for (const char c : std::string_view(lines))
        s += c == '\n' ? std::string(", ") : std::string(1, c);
    return s;
}

std::vector<known_name> list_hinted_names()
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
            names.push_back({name.get(), description == nullptr ? "" : join_lines(description.get())});
    }
    return names;
}

// Returns false for stock names such as front or dmix: their definitions are strings that lead to a card's
// functions. The hints list these names.
bool stands_alone(snd_config_t* definition)
{
    snd_config_t* found = nullptr;
    return snd_config_get_type(definition) == SND_CONFIG_TYPE_COMPOUND &&
           snd_config_search(definition, "type", &found) == 0 &&
           snd_config_search(definition, "@args", &found) < 0;
}

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
try {
    return find_route(read_configuration().get(), name);
} catch (const error& e) {
    if (e.kind() != error_kind::not_available)
        throw;
    return {};
}

std::string find_fault(snd_config_t* top, const std::string& name)
{
    const library_messages silent;
    walker w(top);
    w.name("pcm", name, 0);
    return w.fault();
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
    return contains(route, "file");
}

std::string find_server(const std::vector<std::string>& route)
{
    constexpr std::array<std::pair<std::string_view, const char*>, 3> servers{
        {{"pipewire", "PipeWire"}, {"pulse", "PulseAudio"}, {"jack", "JACK"}}};
    for (const auto& [type, server] : servers)
        if (contains(route, type))
            return server;
    return {};
}

std::string find_drive_time_device(const std::string& pcm, const std::vector<std::string>& route,
                                   const std::optional<card_place>& place, const stream_wiring& w)
{
    const bool several = std::any_of(w.outputs.begin(), w.outputs.end(), [](const auto& reached) {
        return !reached.empty() && reached.back() >= most_channels;
    });
    if (place && !several)
        return fmt::format("hw:CARD={},DEV={},SUBDEV={}", place->card, place->device, place->subdevice);
    return contains(route, "null") && !contains(route, "hw") ? std::string() : pcm;
}

std::vector<std::string> defined_pcms(snd_config_t* top)
{
    std::vector<std::string> names;
    snd_config_t* pcms = nullptr;
    if (top != nullptr && snd_config_search(top, "pcm", &pcms) == 0)
        for_each_member(pcms, [&](const std::string& id, snd_config_t*) { names.push_back(id); });
    return names;
}

std::vector<known_name> known_names(snd_config_t* top)
{
    const library_messages silent;
    snd_config_t* pcms = nullptr;
    if (top == nullptr || snd_config_search(top, "pcm", &pcms) < 0)
        return {};
    std::vector<known_name> names = list_hinted_names();
    for_each_member(pcms, [&](const std::string& id, snd_config_t* definition) {
        const auto same = [&](const known_name& n) { return n.name == id; };
        if (stands_alone(definition) && std::none_of(names.begin(), names.end(), same))
            names.push_back({id, ""});
    });
    return names;
}

namespace {

constexpr int most_definitions =
    64; // maximum number of definitions of one PCM; also stops definitions that double at each step
constexpr std::size_t most_links = 1U << 19; // a table may connect every channel to every other

// Types that pass each channel on unchanged.
constexpr std::array straight{"plug",  "linear", "lfloat", "copy",  "rate",    "mulaw", "alaw",
                              "adpcm", "iec958", "empty",  "hooks", "softvol", "file",  "mmap_emul"};
// Types that map each channel to the slave's channel in their bindings.
constexpr std::array binding{"dmix", "dshare", "share"};

constexpr double least_gain = 1e-3; // -60 dB: less is not felt
constexpr double rounding = 1e-6;

// Lowest number of an output that stands for the end of a table, where ALSA clips. Lower numbers are channels
// of devices.
constexpr unsigned first_end = 1U << 30;

// Outputs that each channel reaches, and the factor on its samples at each output.
using outputs = std::vector<std::map<unsigned, double>>;

// A plugin on the route whose wiring is not known.
struct hidden {
    std::string by;
};

class tracer {
public:
    explicit tracer(snd_config_t* top) : top_(top) {}

    outputs named(const std::string& name, unsigned channels, int depth)
    {
        const configuration definition = look_up(top_, "pcm", name);
        if (definition == nullptr)
            throw hidden{fmt::format("{}, which is not defined", name)};
        return at(definition.get(), channels, depth);
    }

    /// Returns the plugin that sets a level; empty if none does.
    const std::string& level_by() const noexcept { return level_by_; }

private:
    // Returns the outputs of a definition, which may be the name of another definition.
    outputs at(snd_config_t* definition, unsigned channels, int depth)
    {
        if (depth > deepest || ++definitions_ > most_definitions)
            throw hidden{"too many definitions"};
        if (const char* other = string_value(definition))
            return named(other, channels, depth + 1);
        const std::string type = value_text(member(definition, "type"));
        if (type == "hw")
            return device(
                fmt::format("{},{}", value_text(member(definition, "card")),
                            parse_channel_number(value_text(member(definition, "device"))).value_or(0)),
                channels);
        if (type == "null")
            return device(fmt::format("null {}", definitions_), channels);
        if (type == "asym")
            return slave(member(definition, "playback"), channels, depth);
        if (type == "multi")
            return multi_outputs(definition, channels, depth);
        if (type == "route" || (type == "plug" && member(definition, "ttable") != nullptr))
            return table_outputs(definition, channels, depth);
        if (contains(binding, type) && member(definition, "bindings") != nullptr)
            return bound_outputs(definition, channels, depth);
        if (type == "softvol")
            level_by_ = "type softvol";
        if (contains(straight, type) || contains(binding, type))
            return slave(member(definition, "slave"), channels, depth);
        throw hidden{type.empty() ? "a definition without a type" : fmt::format("type {}", type)};
    }

    // Returns the outputs of a device. A device that is reached in several ways has the same outputs each
    // time.
    outputs device(const std::string& key, unsigned channels)
    {
        const unsigned first = devices_.try_emplace(key, devices_.size() * most_channels).first->second;
        outputs all(channels);
        for (unsigned c = 0; c < channels; ++c)
            all[c] = {{first + c, 1.0}};
        return all;
    }

    // Returns the outputs of a slave. `channels` applies if the slave's definition gives no number of
    // channels.
    outputs slave(snd_config_t* definition, unsigned channels, int depth)
    {
        configuration own;
        definition = find_slave(top_, definition, own);
        snd_config_t* pcm = member(definition, "pcm");
        if (pcm == nullptr)
            throw hidden{"a slave that is not defined"};
        long count = 0;
        if (snd_config_t* n = member(definition, "channels");
            n != nullptr && snd_config_get_integer(n, &count) >= 0)
            channels = static_cast<unsigned>(std::clamp(count, 0L, long{most_channels}));
        return at(pcm, channels, depth + 1);
    }

    void link(std::map<unsigned, double>& from, const outputs& inner, std::optional<unsigned> to,
              double gain = 1.0)
    {
        if (!to || *to >= inner.size())
            return;
        if ((links_ += inner[*to].size()) > most_links)
            throw hidden{"too large a table"};
        for (const auto& [output, further] : inner[*to])
            from[output] += gain * further;
    }

    outputs table_outputs(snd_config_t* definition, unsigned channels, int depth)
    {
        outputs inner = slave(member(definition, "slave"), channels, depth);
        for (std::map<unsigned, double>& one : inner)
            one[next_end_++] = 1.0;
        outputs all(channels);
        snd_config_t* table = member(definition, "ttable");
        if (table == nullptr)
            throw hidden{"a route without a table"};
        for_each_member(table, [&](const std::string& client, snd_config_t* row) {
            const auto from = parse_channel_number(client);
            for_each_member(row, [&](const std::string& to, snd_config_t* gain) {
                double value = 0.0;
                if (!parse_channel_number(to)) // FL, FR: only the device knows their numbers
                    throw hidden{fmt::format("type route to a channel {}", to)};
                if (from && *from < channels && snd_config_get_ireal(gain, &value) >= 0 && value != 0.0)
                    link(all[*from], inner, parse_channel_number(to), value);
            });
        });
        return all;
    }

    outputs bound_outputs(snd_config_t* definition, unsigned channels, int depth)
    {
        const outputs inner = slave(member(definition, "slave"), most_channels, depth);
        outputs all(channels);
        for_each_member(member(definition, "bindings"), [&](const std::string& client, snd_config_t* to) {
            const auto from = parse_channel_number(client);
            if (from && *from < channels)
                link(all[*from], inner, parse_channel_number(value_text(to)));
        });
        return all;
    }

    outputs multi_outputs(snd_config_t* definition, unsigned channels, int depth)
    {
        std::map<std::string, outputs> slaves;
        outputs all(channels);
        snd_config_t* const defined = member(definition, "slaves");
        snd_config_t* const bindings = member(definition, "bindings");
        if (defined == nullptr || bindings == nullptr)
            throw hidden{"type multi without slaves or bindings"};
        for_each_member(defined, [&](const std::string& id, snd_config_t* one) {
            slaves.emplace(id, slave(one, most_channels, depth));
        });
        for_each_member(bindings, [&](const std::string& client, snd_config_t* to) {
            const auto from = parse_channel_number(client);
            const auto one = slaves.find(value_text(member(to, "slave")));
            if (from && *from < channels && one != slaves.end())
                link(all[*from], one->second, parse_channel_number(value_text(member(to, "channel"))));
        });
        return all;
    }

    snd_config_t* top_;
    int definitions_ = 0;
    std::size_t links_ = 0;
    unsigned next_end_ = first_end;
    std::string level_by_ = {};
    std::map<std::string, unsigned> devices_ = {}; ///< number of the first output of each device
};

bool is_straight(const outputs& all)
{
    for (unsigned c = 0; c < all.size(); ++c)
        if (all[c].size() != 1 || all[c].begin()->first != c ||
            std::abs(all[c].begin()->second - 1.0) > rounding)
            return false;
    return true;
}

// Removes outputs that are the end of a table. Returns the largest factor at such an output, 1 or more.
double take_ends(outputs& all)
{
    double most = 1.0;
    for (std::map<unsigned, double>& one : all) {
        const auto ends = one.lower_bound(first_end);
        for (auto i = ends; i != one.end(); ++i)
            most = std::max(most, std::abs(i->second));
        one.erase(ends, one.end());
    }
    return most;
}

void fill_wiring(const outputs& all, stream_wiring& w)
{
    for (const std::map<unsigned, double>& one : all) {
        w.outputs.emplace_back();
        w.gains.emplace_back();
        for (const auto& [output, gain] : one)
            if (std::abs(gain) >= least_gain) {
                w.outputs.back().push_back(output);
                w.gains.back().push_back(gain);
            }
    }
}

} // namespace

stream_wiring find_wiring(snd_config_t* top, const std::string& name, unsigned channels,
                          unsigned device_channels)
{
    const library_messages silent;
    stream_wiring w;
    if (top == nullptr)
        return w;
    try {
        tracer t(top);
        outputs all = t.named(name, device_channels, 0);
        all.resize(channels);
        w.most_gain = take_ends(all);
        if (!is_straight(all))
            fill_wiring(all, w);
        w.level_by = t.level_by();
    } catch (const hidden& h) {
        w.hidden_by = h.by;
    }
    return w;
}

} // namespace tactor::alsa
