// SPDX-License-Identifier: MIT

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "sink/alsa/devices/route.hpp"
#include "sink/alsa/library_messages.hpp"

namespace tactor::alsa {
namespace {

constexpr int most_definitions = 64;         // of one PCM; also stops definitions that double at each step
constexpr std::size_t most_links = 1U << 19; // a table may connect each channel to each

// These pass each channel on unchanged.
constexpr std::array straight{"plug",  "linear", "lfloat", "copy",  "rate",    "mulaw", "alaw",
                              "adpcm", "iec958", "empty",  "hooks", "softvol", "file",  "mmap_emul"};
// These map each channel to the slave's channel in their bindings.
constexpr std::array binding{"dmix", "dshare", "share"};

constexpr double least_gain = 1e-3; // -60 dB: less is not felt
constexpr double rounding = 1e-6;

// First number of an output that is the end of a table, where ALSA clips, and no channel of a device.
constexpr unsigned first_end = 1U << 30;

// For each channel: the outputs that it reaches, and the factor on its samples there.
using outputs = std::vector<std::map<unsigned, double>>;

// A plugin on the route that is not understood.
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
    // Returns the outputs of a definition, or of the name of one.
    outputs at(snd_config_t* definition, unsigned channels, int depth)
    {
        if (depth > deepest || ++definitions_ > most_definitions)
            throw hidden{"more definitions than anyone has"};
        if (const char* other = string_value(definition))
            return named(other, channels, depth + 1);
        const std::string type = value_text(member(definition, "type"));
        if (type == "hw")
            return device(fmt::format("{},{}", value_text(member(definition, "card")),
                                      channel_number(value_text(member(definition, "device"))).value_or(0)),
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

    // Returns the outputs of a device. A device that is reached in several ways is the same device.
    outputs device(const std::string& key, unsigned channels)
    {
        const unsigned first = devices_.try_emplace(key, devices_.size() * most_channels).first->second;
        outputs all(channels);
        for (unsigned c = 0; c < channels; ++c)
            all[c] = {{first + c, 1.0}};
        return all;
    }

    // Returns the outputs of a slave. `channels` counts if its definition gives no number.
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
            throw hidden{"a larger table than anyone has"};
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
        each_member(table, [&](const std::string& client, snd_config_t* row) {
            const auto from = channel_number(client);
            each_member(row, [&](const std::string& to, snd_config_t* gain) {
                double value = 0.0;
                if (!channel_number(to)) // FL, FR: only the device knows their numbers
                    throw hidden{fmt::format("type route to a channel {}", to)};
                if (from && *from < channels && snd_config_get_ireal(gain, &value) >= 0 && value != 0.0)
                    link(all[*from], inner, channel_number(to), value);
            });
        });
        return all;
    }

    outputs bound_outputs(snd_config_t* definition, unsigned channels, int depth)
    {
        const outputs inner = slave(member(definition, "slave"), most_channels, depth);
        outputs all(channels);
        each_member(member(definition, "bindings"), [&](const std::string& client, snd_config_t* to) {
            const auto from = channel_number(client);
            if (from && *from < channels)
                link(all[*from], inner, channel_number(value_text(to)));
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
        each_member(defined, [&](const std::string& id, snd_config_t* one) {
            slaves.emplace(id, slave(one, most_channels, depth));
        });
        each_member(bindings, [&](const std::string& client, snd_config_t* to) {
            const auto from = channel_number(client);
            const auto one = slaves.find(value_text(member(to, "slave")));
            if (from && *from < channels && one != slaves.end())
                link(all[*from], one->second, channel_number(value_text(member(to, "channel"))));
        });
        return all;
    }

    snd_config_t* top_;
    int definitions_ = 0;
    std::size_t links_ = 0;
    unsigned next_end_ = first_end;
    std::string level_by_ = {};
    std::map<std::string, unsigned> devices_ = {}; ///< with the number of the first output of each
};

bool is_straight(const outputs& all)
{
    for (unsigned c = 0; c < all.size(); ++c)
        if (all[c].size() != 1 || all[c].begin()->first != c ||
            std::abs(all[c].begin()->second - 1.0) > rounding)
            return false;
    return true;
}

// Removes the ends of tables. Returns the largest factor there, 1 or more.
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

void write_down(const outputs& all, stream_wiring& w)
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
            write_down(all, w);
        w.level_by = t.level_by();
    } catch (const hidden& h) {
        w.hidden_by = h.by;
    }
    return w;
}

} // namespace tactor::alsa
