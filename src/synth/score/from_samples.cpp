// SPDX-License-Identifier: MIT
// Scores made of the user's own samples.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/render.hpp>

#include "core/access.hpp"
#include "core/words.hpp"
#include "synth/score/levels.hpp"
#include "synth/score/score.hpp"
#include "synth/tone/own_samples.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using synth::bad_samples;
using synth::half_step;
using synth::in_db;
using synth::own_channel;

void check_shape(const own_samples& x, const render_options& o, unsigned channels)
{
    const std::size_t frame_bytes = x.channels * sample_bytes(x.format);
    std::string remix = "sox IN OUT remix"; // keeps the first channels, and adds silent ones
    for (unsigned c = 1; c <= channels; ++c)
        remix += c <= x.channels ? fmt::format(" {}", c) : " 0";
    if (x.rate != o.rate)
        throw bad_samples(
            x, fmt::format("its rate is {} Hz, but the stream's is {} Hz", x.rate, o.rate),
            fmt::format("use {{rate={}}}, or convert the file: sox IN -r {} OUT", x.rate, o.rate));
    if (x.channels != channels)
        throw bad_samples(
            x, fmt::format("it has {}, but the stream has {}", counted(x.channels, "channel"), channels),
            x.channels < channels
                ? fmt::format("add silent channels: {}", remix)
                : fmt::format("use {{channels={}}}, or leave some channels out: {}", x.channels, remix));
    if (x.bytes.empty())
        throw bad_samples(x, "it has no samples", "give one frame or more");
    if (x.bytes.size() % frame_bytes != 0)
        throw bad_samples(
            x, fmt::format("{} bytes are not a whole number of frames of {}", x.bytes.size(), frame_bytes),
            "give whole frames");
    if (x.bytes.size() > most_own_bytes)
        throw bad_samples(x, too_large_text(x.bytes.size()), "play the samples in pieces");
}

/// Throws error for the channel that exceeds its limit by the most, if any does.
void check_levels(const array& a, const own_samples& x, const std::vector<own_channel>& channels,
                  double level_dbfs)
{
    constexpr double float_rounding = 1e-6; // relative to a peak
    const own_channel* worst = nullptr;
    auto at = a.tactors.end();
    double over_db = 0.0;
    for (const own_channel& c : channels) {
        const auto t = std::find_if(a.tactors.begin(), a.tactors.end(),
                                    [&c](const tactor_spec& s) { return s.channel == c.channel; });
        const double limit_db = t == a.tactors.end() ? 0.0 : std::min(level_dbfs, t->max_dbfs);
        const double most = std::pow(10.0, limit_db / 20.0) * (1.0 + float_rounding) + half_step(x.format);
        if (c.peak > most && in_db(c.peak) - limit_db > over_db) {
            worst = &c;
            at = t;
            over_db = in_db(c.peak) - limit_db;
        }
    }
    if (worst == nullptr)
        return;
    const auto up = [](double db) { return std::ceil(db * 100.0 - 1e-6) / 100.0 + 0.0; };
    over_db = std::max(0.01, up(over_db));
    const double peak_db = up(in_db(worst->peak));
    std::string who = fmt::format("channel {}", worst->channel);
    std::string limit = "full scale";
    std::string more;
    if (at != a.tactors.end()) {
        const bool has_own = at->max_dbfs < level_dbfs;
        who += fmt::format(" (tactor {})", at - a.tactors.begin());
        limit = has_own ? fmt::format("its max_dbfs of {:.4g} dBFS", at->max_dbfs)
                        : fmt::format("the level of {:.4g} dBFS", level_dbfs);
        more = has_own          ? ", or raise max_dbfs"
               : peak_db <= 0.0 ? fmt::format(", or use {{level_dbfs={:.4g}}}", peak_db)
                                : "";
    }
    throw bad_samples(
        x, fmt::format("{} peaks at {:.2f} dBFS, {:.2f} dB above {}", who, peak_db, over_db, limit),
        fmt::format("make the samples quieter by {:.2f} dB{}", over_db, more));
}

/// Adds the sound of a channel as an item.
void add_channel(score::impl& s, own_channel c)
{
    for (std::size_t i = 0; i < s.tactors.size(); ++i)
        if (s.tactors[i].channel == c.channel)
            s.peaks[i] = std::min(c.peak, s.limits[c.channel]); // rounding may put the peak above the limit
    if (c.peak == 0.0)
        return;
    synth::item it;
    it.kind = synth::item_kind::own;
    it.length = s.frames;
    it.first = s.sounds.size();
    it.tactor = static_cast<std::uint16_t>(c.channel);
    s.list.items.push_back(it);
    synth::timbre sound;
    sound.form = synth::timbre::form_kind::own;
    sound.power = c.power;
    sound.own = std::make_shared<const own_channel>(std::move(c));
    s.sounds.push_back(std::make_shared<const synth::timbre>(std::move(sound)));
}

} // namespace

score score::from_samples(const array& a, own_samples s, const render_options& o)
{
    if (o.sl_db)
        throw bad_samples(s, "a sensation level needs a carrier, but samples have none",
                          "limit the peak instead, such as with {level_dbfs=-20}");
    array plain = a;
    for (tactor_spec& t : plain.tactors)
        t.gain_db = 0.0; // no level depends on it
    render_options exact = o;
    exact.envelope = {};
    const auto made = synth::begin_score(plain, exact);
    check_shape(s, o, made->channels);
    const auto all = std::make_shared<const own_samples>(std::move(s));
    std::vector<own_channel> channels = synth::read_channels(all);
    check_levels(a, *all, channels, o.level_dbfs);
    plan whole;
    whole.algorithm = "samples";
    made->frames = synth::count_frames(*all);
    whole.total_s = whole.stroke_duration_s = static_cast<double>(made->frames) / made->rate;
    made->plans.push_back({std::move(whole)});
    made->sounds.emplace_back();
    made->starts.push_back(0);
    made->ends.push_back(made->frames);
    made->peaks.resize(made->tactors.size());
    for (own_channel& c : channels)
        add_channel(*made, std::move(c));
    synth::end_items(*made, exact);
    return detail::access::make<score>(std::shared_ptr<const score::impl>(made));
}

} // namespace v0
} // namespace tactor
