// SPDX-License-Identifier: MIT
#include "files/setup_text.hpp"

#include <optional>
#include <utility>

#include <fmt/format.h>

namespace tactor::detail {
namespace {

std::string line_text(const gpio_line_name& l)
{
    if (!l.name.empty())
        return fmt::format("name = {}", toml_string(l.name));
    return fmt::format("chip = {}, offset = {}", toml_string(l.chip), l.offset.value_or(0));
}

// Writes milliseconds. 15 digits give the number that was divided.
std::string ms(double s)
{
    return fmt::format("{:.15g}", s * 1e3);
}

template <typename T>
void add(std::string& to, std::string_view key, const std::optional<T>& v)
{
    if (v)
        to += fmt::format("{} = {}\n", key, *v);
}

std::string output_text(const output_settings& o)
{
    std::string s;
    if (o.pcm)
        s += fmt::format("pcm = {}\n", toml_string(*o.pcm));
    add(s, "rate", o.rate);
    add(s, "channels", o.channels);
    add(s, "period_frames", o.period_frames);
    add(s, "periods", o.periods);
    return s.empty() ? s : "\n[output]\n" + s;
}

std::string lines_text(const setup& u)
{
    std::string s;
    if (u.amplifier)
        s += fmt::format("\n[amplifier]\nline = {{ {} }}\nactive_low = {}\nsettle_ms = {}\n",
                         line_text(u.amplifier->line), u.amplifier->active_low, ms(u.amplifier->settle_s));
    if (!u.sync)
        return s;
    s += "\n[sync]\n";
    if (u.sync->out)
        s += fmt::format("out = {{ {}, pulse_ms = {} }}\n", line_text(*u.sync->out), ms(u.sync->pulse_s));
    add(s, "channel", u.sync->channel);
    if (u.sync->in)
        s += fmt::format("in = {{ {}, edge = \"{}\", debounce_ms = {}, pull = \"{}\" }}\n",
                         line_text(*u.sync->in), to_string(u.sync->edge), ms(u.sync->debounce_s),
                         to_string(u.sync->pull));
    return s;
}

std::string limits_text(const limit_settings& l)
{
    std::string s = "\n[limits]\n";
    add(s, "power_dbfs", l.power_dbfs);
    add(s, "max_drive_s", l.max_drive_s);
    add(s, "window_s", l.window_s);
    return s;
}

std::string list_text(const std::vector<threshold_point>& points)
{
    std::string s;
    for (const threshold_point& p : points)
        s += fmt::format("{}[{}, {}]", s.empty() ? "" : ", ", p.hz, p.dbfs);
    return fmt::format("threshold_dbfs = [{}]\n", s);
}

std::string tactor_text(const tactor_spec& t)
{
    std::string s = fmt::format("\n[[tactor]]\nx_mm = {}\ny_mm = {}\nchannel = {}\n", t.position.x_mm,
                                t.position.y_mm, t.channel);
    if (t.gain_db != 0.0)
        s += fmt::format("gain_db = {}\n", t.gain_db);
    if (t.max_dbfs != 0.0)
        s += fmt::format("max_dbfs = {}\n", t.max_dbfs);
    if (t.thresholds.empty())
        add(s, "threshold_dbfs", t.threshold_dbfs);
    else
        s += list_text(t.thresholds);
    if (t.polarity != 1)
        s += fmt::format("polarity = {}\n", t.polarity);
    if (t.actuator != actuator_kind::unknown)
        s += fmt::format("actuator = \"{}\"\n", to_string(t.actuator));
    if (t.rise_s)
        s += fmt::format("rise_ms = {}\n", ms(*t.rise_s));
    add(s, "displacement_um_at_0dbfs", t.displacement_um_at_0dbfs);
    return s;
}

std::string calibrated_text(const calibrated_tactor& t)
{
    std::string s = fmt::format("\n[[calibration.tactor]]\ntactor = {}\n", t.tactor);
    add(s, "threshold_dbfs", t.threshold_dbfs);
    add(s, "sd_db", t.sd_db);
    return s + fmt::format("trials = {}\n", t.trials);
}

std::string value_text(const written_value& d)
{
    if (const auto* text = std::get_if<std::string>(&d.said))
        return toml_string(*text);
    const auto* flag = std::get_if<bool>(&d.said);
    return flag != nullptr ? fmt::format("{}", *flag) : fmt::format("{}", std::get<double>(d.said));
}

} // namespace

std::string toml_string(std::string_view s)
{
    std::string q = "\"";
    for (const char c : s)
        if (c == '"' || c == '\\')
            q += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            q += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
        else
            q += c;
    return q + '"';
}

std::string array_text(const array& a)
{
    std::string s = fmt::format("[array]\nname = {}\n", toml_string(a.name));
    for (const auto& [key, text] : {std::pair("site", &a.site), std::pair("up", &a.up)})
        if (!text->empty())
            s += fmt::format("{} = {}\n", key, toml_string(*text));
    if (a.place)
        s += fmt::format("place = [{}, {}]\n", a.place->x_mm, a.place->y_mm);
    add(s, "turn", a.turn_deg);
    add(s, "body", a.body_mm);
    for (const tactor_spec& t : a.tactors)
        s += tactor_text(t);
    return s;
}

std::string besides_text(const setup& besides)
{
    std::string s = output_text(besides.output) + lines_text(besides);
    if (besides.limits)
        s += limits_text(*besides.limits);
    if (!besides.defaults.empty())
        s += "\n[defaults]\n";
    for (const written_value& d : besides.defaults)
        s += fmt::format("{} = {}\n", d.name, value_text(d));
    return s;
}

std::string array_text(const array& a, const setup& besides)
{
    return array_text(a) + besides_text(besides);
}

std::string origin_text(const calibration_origin& o)
{
    std::string s = fmt::format("\n[calibration]\nparticipant = {}\nmethod = {}\n",
                                toml_string(o.participant), toml_string(o.method));
    const auto quote = [](const std::optional<std::string>& text) {
        return text ? std::optional(toml_string(*text)) : std::nullopt;
    };
    add(s, "rule", quote(o.rule));
    s += fmt::format("carrier_hz = {}\ninterval_s = {}\n", o.carrier_hz, o.interval_s);
    add(s, "feedback", o.feedback);
    add(s, "masker", quote(o.masker));
    add(s, "date", quote(o.date));
    add(s, "seed", o.seed);
    s += fmt::format("simulated = {}\n", o.simulated);
    for (const calibrated_tactor& t : o.tactors)
        s += calibrated_text(t);
    return s;
}

} // namespace tactor::detail
