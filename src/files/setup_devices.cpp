// SPDX-License-Identifier: MIT
// [output], [amplifier], [sync], [limits] and [defaults].
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "core/bounds.hpp"
#include "files/setup_parts.hpp"

namespace tactor::detail {

namespace {

gpio_line_name read_line(const toml_table& t)
{
    gpio_line_name line;
    line.where = t.where();
    if (t.one_of({"chip", "name"}) == "name") {
        if (t.has("offset"))
            t.fail("offset", fmt::format("{} has both name and offset", t.title()), "a name is enough");
        line.name = *t.text("name");
        return line;
    }
    line.chip = *t.text("chip");
    line.offset = t.need(t.whole("offset", 0, 65535), "offset");
    return line;
}

std::optional<double> seconds(std::optional<double> ms)
{
    return ms ? std::optional(*ms * 1e-3) : std::nullopt;
}

written_value said_at(const toml_table& t, const toml_table::said_key& e, const toml::node& n, bool in_list)
{
    return {std::string(e.key), t.plain(n, e.key), in_list, t.where(n), e.key_at};
}

constexpr bounds any_level_db{min_db, 0.0};
constexpr bounds spread_db{0.0, -min_db};
constexpr unsigned any_number = std::numeric_limits<unsigned>::max();

calibrated_tactor read_tactor(const toml_table& t, std::vector<const toml_table*>& said)
{
    t.only({"tactor", "threshold_dbfs", "sd_db", "trials", "reversals_dbfs", "check_right",
            "check_below_right", "staircases"});
    const unsigned i = t.need(t.whole("tactor", 0, static_cast<unsigned>(said.size()) - 1), "tactor");
    if (said[i] != nullptr)
        t.fail("tactor", fmt::format("tactor {} has an entry already ({})", i, said[i]->where().text()),
               "it is measured once in a calibration");
    said[i] = &t;
    calibrated_tactor r{i, t.number("threshold_dbfs", any_level_db), t.number("sd_db", spread_db),
                        t.need(t.whole("trials", 0, any_number), "trials")};
    for (const char* key : {"check_right", "check_below_right", "staircases"})
        t.whole(key, 0, any_number);
    if (const toml::array* all = t.list("reversals_dbfs", "levels"))
        for (const toml::node& n : *all)
            t.to_number(n, "reversals_dbfs", any_level_db);
    return r;
}

} // namespace

void read_output(const toml_table& root, located_setup& out)
{
    const auto t = root.table("output", "[output]", "[output]");
    if (!t)
        return;
    t->only({"pcm", "rate", "channels", "period_frames", "periods"});
    output_settings& o = out.said.output;
    if (t->has("pcm")) {
        o.pcm = t->text("pcm");
        o.pcm_at = t->where("pcm");
        o.pcm_included = false;
    }
    if (t->has("rate"))
        o.rate = t->whole("rate", bounds_of::rate_hz);
    if (t->has("channels")) {
        o.channels = t->whole("channels", bounds_of::device_channels);
        out.channels_at = t->where("channels");
    }
    if (t->has("period_frames"))
        o.period_frames = t->whole("period_frames", {double(least_period_frames(o.rate.value_or(48'000))),
                                                     bounds_of::period_frames.high});
    if (t->has("periods"))
        o.periods = t->whole("periods", bounds_of::periods);
}

void read_amplifier(const toml_table& root, located_setup& out)
{
    const auto t = root.table("amplifier", "[amplifier]", "[amplifier]");
    if (!t)
        return;
    t->only({"line", "active_low", "settle_ms"});
    const toml_table line = t->need(t->table("line", "line", "line = { chip, offset } or { name }"), "line");
    amplifier_settings a;
    line.only({"chip", "offset", "name"});
    a.line = read_line(line);
    a.active_low = t->boolean("active_low").value_or(a.active_low);
    a.settle_s = seconds(t->number("settle_ms", {0.0, 10000.0})).value_or(a.settle_s);
    out.said.amplifier = a;
}

void read_sync(const toml_table& root, located_setup& out)
{
    const auto t = root.table("sync", "[sync]", "[sync]");
    if (!t)
        return;
    t->only({"out", "channel", "in"});
    sync_settings s;
    if (const auto pulse = t->table("out", "out", "out = { chip, offset, pulse_ms }")) {
        pulse->only({"chip", "offset", "name", "pulse_ms"});
        s.out = read_line(*pulse);
        s.pulse_s = seconds(pulse->number("pulse_ms", {0.0, 10000.0, true})).value_or(s.pulse_s);
    }
    if (const auto edge = t->table("in", "in", "in = { chip, offset, edge }")) {
        edge->only({"chip", "offset", "name", "edge", "debounce_ms", "pull"});
        s.in = read_line(*edge);
        s.edge = edge->kind<edge_kind>("edge").value_or(s.edge);
        s.debounce_s = seconds(edge->number("debounce_ms", {0.0, 10000.0})).value_or(s.debounce_s);
        s.pull = edge->kind<pull_kind>("pull").value_or(s.pull);
    }
    s.channel = t->whole("channel", bounds_of::marker_channel);
    out.sync_channel_at = t->where("channel");
    out.said.sync = s;
}

void read_limits(const toml_table& root, located_setup& out)
{
    const auto t = root.table("limits", "[limits]", "[limits]");
    if (!t)
        return;
    t->only({"power_dbfs", "max_drive_s", "window_s"});
    limit_settings l;
    l.power_dbfs = t->number("power_dbfs", bounds_of::power_dbfs);
    l.max_drive_s = t->number("max_drive_s", bounds_of::drive_s);
    l.window_s = t->number("window_s", bounds_of::drive_s);
    out.said.limits = l;
}

void read_defaults(const toml_table& root, setup& out)
{
    const auto t = root.table("defaults", "[defaults]", "[defaults]");
    if (!t)
        return;
    for (const toml_table::said_key& e : t->entries()) {
        std::erase_if(out.defaults, [&e](const written_value& d) { return d.name == e.key; });
        out.defaults.push_back(said_at(*t, e, *e.value, false));
    }
}

void read_serve(const toml_table& root, setup& out)
{
    const auto t = root.table("serve", "[serve]", "[serve]");
    if (!t)
        return;
    out.serve.clear();
    for (const toml_table::said_key& e : t->entries())
        if (const toml::array* list = e.value->as_array())
            for (const toml::node& n : *list)
                out.serve.push_back(said_at(*t, e, n, true));
        else
            out.serve.push_back(said_at(*t, e, *e.value, false));
}

void read_calibration(const toml_table& root, located_setup& said)
{
    const auto t = root.table("calibration", "[calibration]", "[calibration]");
    if (!t)
        return;
    if (!said.said.array)
        t->fail("there is no array that it is of",
                "it stands in an array file, as {command:calibrate} writes it");
    t->only({"participant", "method", "rule", "carrier_hz", "interval_s", "feedback", "masker", "date",
             "seed", "simulated", "tactor"});
    calibration_origin r;
    r.participant = t->need(t->text("participant"), "participant");
    r.method = t->need(t->choice("method", {"staircase", "adjustment"}), "method");
    r.rule = t->choice("rule", {"1up3down", "1up2down"});
    r.carrier_hz = t->need(t->number("carrier_hz", bounds_of::carrier_hz), "carrier_hz");
    r.interval_s = t->need(t->number("interval_s", bounds_of::interval_s), "interval_s");
    r.feedback = t->boolean("feedback");
    r.masker = t->text("masker");
    r.date = t->text("date");
    r.seed = t->whole("seed", 0, any_number);
    r.simulated = t->boolean("simulated").value_or(false);
    const std::vector<toml_table> entries = t->tables("tactor");
    std::vector<const toml_table*> seen(said.said.array->tactors.size());
    for (const toml_table& e : entries)
        r.tactors.push_back(read_tactor(e, seen));
    said.said.calibration = std::move(r);
}

} // namespace tactor::detail
