// SPDX-License-Identifier: MIT
#include "files/setup_text.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/trajectory/impl.hpp"

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

/// Lines "key = value", one after the other.
class lines {
public:
    void add(std::string_view key, double v) { append(key, fmt::format("{}", v)); }
    void add(std::string_view key, std::string_view text) { append(key, toml_string(text)); }
    void append(std::string_view key, std::string_view value)
    {
        all_ += fmt::format("{} = {}\n", key, value);
    }
    template <class T>
    void maybe(std::string_view key, const std::optional<T>& v)
    {
        if (v)
            add(key, *v);
    }
    /// [[a, b], ...]
    template <class List, class Row>
    void rows(std::string_view key, const List& list, Row row)
    {
        if (list.empty())
            return;
        std::string text;
        for (const auto& entry : list)
            text += fmt::format("{}[{}]", text.empty() ? "" : ", ", row(entry));
        append(key, "[" + text + "]");
    }
    std::string take() { return std::move(all_); }

private:
    std::string all_;
};

[[noreturn]] void refuse(const stroke& s, const std::string& why, const std::string& hint)
{
    throw error(error_kind::bad_input, fmt::format("stroke \"{}\"", s.name), why, hint);
}

std::string pair(const profile_point& p)
{
    return fmt::format("{}, {}", p.part, p.value);
}

void add_timed(lines& out, const trajectory::impl& i, const timed_points& law)
{
    out.rows("timed", *law.points, [&](const timed_point& p) {
        return fmt::format("{}, {}, {}, {}", p.t_s, p.position.x_mm, p.position.y_mm, p.intensity * i.gain);
    });
    if (law.duration_s() != i.duration_s)
        out.add("duration_s", i.duration_s);
}

// Speeds and times as they are now: the movement may have been stretched since it was said.
void add_movement(lines& out, const trajectory::impl& i, const drawn_path& law)
{
    const pace& p = *law.moves;
    const movement& m = p.given();
    const double longer = i.duration_s / p.total_s();
    if (m.easing != easing_kind::linear)
        out.add("easing", to_string(m.easing));
    if (m.speed_mm_s.empty())
        out.add("duration_s", i.duration_s);
    const double faster =
        m.speed_mm_s.empty() ? 1.0 : time_at_speeds_s(m, law.way.length_mm()) / (p.moving_s() * longer);
    out.rows("speed_mm_s", m.speed_mm_s, [&](const profile_point& v) {
        return pair({v.part, v.value * faster});
    });
    out.rows("pauses", m.rests, [&](const rest& r) {
        return fmt::format("{}, {}, {}", r.part, r.time_s * longer, r.intensity);
    });
}

void add_path(lines& out, const stroke& s, const trajectory::impl& i, const drawn_path& law)
{
    out.add("path", law.way.svg());
    const bool varies = law.moves && !law.moves->given().intensity.empty();
    const double strength = law.intensity * i.gain;
    if (varies)
        out.rows("intensity", law.moves->given().intensity, [strength](const profile_point& p) {
            return pair({p.part, p.value * strength});
        });
    else if (strength != 1.0)
        out.add("intensity", strength);
    if (law.moves)
        add_movement(out, i, law);
    else if (s.speed_mm_s && law.way.length_mm() / *s.speed_mm_s == i.duration_s)
        out.add("speed_mm_s", *s.speed_mm_s);
    else
        out.add("duration_s", i.duration_s);
}

void add_sound(lines& out, const stroke& s)
{
    if (s.sound.carrier_profile.empty())
        out.maybe("carrier_hz", s.sound.carrier_hz);
    out.rows("carrier_profile", s.sound.carrier_profile,
             [](const carrier_part& p) { return fmt::format("{}, {}", p.part, p.hz); });
    if (s.sound.wave) {
        const waveform& w = *s.sound.wave;
        const bool recorded = w.kind == waveform_kind::recording;
        // The new file may lie elsewhere.
        out.add("waveform",
                recorded ? std::filesystem::absolute(waveform_text(w)).string() : waveform_text(w));
        if (w.kind == waveform_kind::noise)
            out.add("noise_seed", static_cast<double>(w.seed));
        if (recorded)
            out.add("texture", to_string(w.texture));
        if (recorded && w.texture_mm > 0.0)
            out.add("texture_mm", w.texture_mm);
    }
    if (s.sound.am) {
        out.add("am_hz", s.sound.am->hz);
        out.add("am_depth", s.sound.am->depth);
    }
}

void add_choices(lines& out, const stroke& s)
{
    if (s.choices.algorithm)
        out.add("algorithm", to_string(*s.choices.algorithm));
    if (s.choices.phantom)
        out.add("phantom", to_string(*s.choices.phantom));
    if (s.choices.faces)
        out.add("faces", to_string(*s.choices.faces));
    out.maybe("soa_s", s.choices.soa_s);
    out.maybe("burst_s", s.choices.burst_s);
    if (s.choices.level_db != 0.0)
        out.add("level_db", s.choices.level_db);
    if (s.fit && s.fit->group != 0)
        refuse(s, "it is fitted together with others of its group", "apply_fits() fits them");
    if (s.fit) {
        out.append("fit", "true");
        out.add("fit_margin_mm", s.fit->margin_mm);
    }
}

// Writes the start. In a file of one stroke there is nothing that it could count from.
void add_start(lines& out, const stroke& s, bool follows)
{
    if (s.anchor.from != start_from_kind::piece && follows)
        out.add("start_from", to_string(s.anchor.from));
    if (s.anchor.from == start_from_kind::piece || follows)
        out.maybe("start_s", s.start_s);
}

std::string keys_text(const stroke& s, bool follows)
{
    lines out;
    if (!s.name.empty())
        out.add("name", s.name);
    const trajectory::impl& i = access::of(s.motion);
    if (const auto* drawn = std::get_if<drawn_path>(&i.law))
        add_path(out, s, i, *drawn);
    else
        add_timed(out, i, std::get<timed_points>(i.law));
    add_start(out, s, follows);
    add_sound(out, s);
    add_choices(out, s);
    return out.take();
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

std::string stroke_text(const stroke& s)
{
    return "[stroke]\n" + keys_text(s, false);
}

std::string strokes_text(std::span<const stroke> all)
{
    if (all.size() == 1)
        return stroke_text(all.front());
    std::string text;
    for (const stroke& s : all) {
        if (s.start_s && s.anchor.from != start_from_kind::piece && s.anchor.back != 1)
            refuse(s, "it starts after a group", "give it a start in seconds");
        text += fmt::format("{}[[stroke]]\n{}", text.empty() ? "" : "\n", keys_text(s, !text.empty()));
    }
    return text;
}

} // namespace tactor::detail
