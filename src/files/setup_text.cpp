// SPDX-License-Identifier: MIT
#include "files/setup_text.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/access.hpp"
#include "core/trajectory/impl.hpp"
#include "files/vibration_file.hpp"

namespace tactor::detail {
namespace {

/// Builder of a text with headings and lines "key = value".
class lines {
public:
    void begin_table(std::string_view heading) { all_ += fmt::format("\n{}\n", heading); }

    template <class T>
    void add(std::string_view key, const T& v)
    {
        if constexpr (std::is_enum_v<T>)
            add_value(key, toml_string(to_string(v)));
        else if constexpr (std::is_arithmetic_v<T>)
            add_value(key, fmt::format("{}", v));
        else
            add_value(key, toml_string(v));
    }
    /// Adds a line if there is a value.
    template <class T>
    void add(std::string_view key, const std::optional<T>& v)
    {
        if (v)
            add(key, *v);
    }
    /// Adds a line unless the value is the default.
    template <class T>
    void add_unless_default(std::string_view key, const T& v, const T& usual)
    {
        if (v != usual)
            add(key, v);
    }
    void add_value(std::string_view key, std::string_view value)
    {
        all_ += fmt::format("{} = {}\n", key, value);
    }
    /// Adds a line with [[a, b], ...] unless the list is empty. `row` returns "a, b" for an element.
    template <class List, class Row>
    void add_rows(std::string_view key, const List& list, Row row)
    {
        std::string text;
        for (const auto& entry : list)
            text += fmt::format("{}[{}]", text.empty() ? "" : ", ", row(entry));
        if (!list.empty())
            add_value(key, "[" + text + "]");
    }
    bool empty() const { return all_.empty(); }
    std::string take() { return std::move(all_); }

private:
    std::string all_;
};

std::string line_text(const gpio_line_name& l)
{
    if (!l.name.empty())
        return fmt::format("name = {}", toml_string(l.name));
    return fmt::format("chip = {}, offset = {}", toml_string(l.chip), l.offset.value_or(0));
}

// Converts seconds to milliseconds. With 15 digits, reading the text gives the original number of
// milliseconds.
std::string ms(double s)
{
    return fmt::format("{:.15g}", s * 1e3);
}

std::string output_text(const output_settings& o)
{
    lines out;
    out.add("pcm", o.pcm);
    out.add("rate", o.rate);
    out.add("channels", o.channels);
    out.add("period_frames", o.period_frames);
    out.add("periods", o.periods);
    return out.empty() ? "" : "\n[output]\n" + out.take();
}

void add_lines(lines& out, const setup& u)
{
    if (u.amplifier) {
        out.begin_table("[amplifier]");
        out.add_value("line", fmt::format("{{ {} }}", line_text(u.amplifier->line)));
        out.add("active_low", u.amplifier->active_low);
        out.add_value("settle_ms", ms(u.amplifier->settle_s));
    }
    if (!u.sync)
        return;
    out.begin_table("[sync]");
    if (u.sync->out)
        out.add_value("out",
                      fmt::format("{{ {}, pulse_ms = {} }}", line_text(*u.sync->out), ms(u.sync->pulse_s)));
    out.add("channel", u.sync->channel);
    if (u.sync->in)
        out.add_value("in", fmt::format("{{ {}, edge = \"{}\", debounce_ms = {}, pull = \"{}\" }}",
                                        line_text(*u.sync->in), to_string(u.sync->edge),
                                        ms(u.sync->debounce_s), to_string(u.sync->pull)));
    if (!u.sync->code)
        return;
    const code_settings& c = *u.sync->code;
    std::string code = fmt::format("bit_ms = {}, pulse_ms = {}, lsl = {}", ms(c.bit_s), ms(c.pulse_s), c.lsl);
    if (c.channel)
        code += fmt::format(", channel = {}", *c.channel);
    if (!c.chip.empty())
        code += fmt::format(", chip = {}, offsets = [{}]", toml_string(c.chip), fmt::join(c.offsets, ", "));
    if (!c.serial.empty())
        code += fmt::format(", serial = {}, baud = {}", toml_string(c.serial), c.baud);
    out.add_value("code", "{ " + code + " }");
    out.begin_table("[sync.codes]");
    for (const auto& [key, n] : {std::pair("stimulus", &c.stimulus),
                                 {"standard", &c.standard},
                                 {"catch", &c.caught},
                                 {"answer", &c.answer},
                                 {"void", &c.made_void}}) {
        if (!n->by) {
            out.add(key, n->first);
            continue;
        }
        const std::string first = n->first ? fmt::format("first = {}, ", *n->first) : "";
        const char* const quote = n->by->empty() ? "" : "\"";
        out.add_value(key,
                      fmt::format("{{ {}by = [{}{}{}] }}", first, quote, fmt::join(*n->by, "\", \""), quote));
    }
}

std::string value_text(const written_value& d)
{
    if (const auto* text = std::get_if<std::string>(&d.value))
        return toml_string(*text);
    if (const bool* flag = std::get_if<bool>(&d.value))
        return fmt::format("{}", *flag);
    return fmt::format("{}", std::get<double>(d.value));
}

void add_serve(lines& out, const std::vector<written_value>& serve)
{
    if (!serve.empty())
        out.begin_table("[serve]");
    for (auto d = serve.begin(); d != serve.end();) {
        std::string text = value_text(*d);
        const auto first = d++;
        for (; first->in_list && d != serve.end() && d->in_list && d->name == first->name; ++d)
            text += ", " + value_text(*d);
        out.add_value(first->name, first->in_list ? "[" + text + "]" : text);
    }
}

// Returns the limit of all tactors if it is the same for all, otherwise nothing.
std::optional<double> shared_limit(const array& a)
{
    const double first = a.tactors.empty() ? 0.0 : a.tactors.front().max_dbfs;
    const bool same = std::all_of(a.tactors.begin(), a.tactors.end(),
                                  [first](const tactor_spec& t) { return t.max_dbfs == first; });
    return same && first != 0.0 ? std::optional(first) : std::nullopt;
}

// Adds a tactor. `shared_dbfs` is the limit in [array].
void add_tactor(lines& out, const tactor_spec& t, double shared_dbfs)
{
    out.begin_table("[[tactor]]");
    out.add("x_mm", t.position.x_mm);
    out.add("y_mm", t.position.y_mm);
    out.add("channel", t.channel);
    out.add_unless_default("gain_db", t.gain_db, 0.0);
    out.add_unless_default("max_dbfs", t.max_dbfs, shared_dbfs);
    if (t.thresholds.empty())
        out.add("threshold_dbfs", t.threshold_dbfs);
    out.add_rows("threshold_dbfs", t.thresholds,
                 [](const threshold_point& p) { return fmt::format("{}, {}", p.hz, p.dbfs); });
    out.add_unless_default("polarity", t.polarity, 1);
    out.add_unless_default("actuator", t.actuator, actuator_kind::unknown);
    if (t.rise_s)
        out.add_value("rise_ms", ms(*t.rise_s));
    out.add("displacement_um_at_0dbfs", t.displacement_um_at_0dbfs);
}

[[noreturn]] void refuse(const stroke& s, const std::string& why, const std::string& hint)
{
    throw error(error_kind::bad_input, fmt::format("stroke \"{}\"", s.name), why, hint);
}

std::string pair(const profile_point& p)
{
    return fmt::format("{}, {}", p.part, p.value);
}

void add_timed_points(lines& out, const trajectory::impl& i, const timed_points& law)
{
    out.add_rows("timed", *law.points, [&](const timed_point& p) {
        return fmt::format("{}, {}, {}, {}", p.t_s, p.position.x_mm, p.position.y_mm, p.intensity * i.gain);
    });
    if (law.duration_s() != i.duration_s)
        out.add("duration_s", i.duration_s);
}

// Writes the current speeds and times: the movement may have been stretched to another duration.
void add_movement(lines& out, const trajectory::impl& i, const drawn_path& law)
{
    const pace& p = *law.moves;
    const movement& m = p.definition();
    const double longer = i.duration_s / p.total_s();
    out.add_unless_default("easing", m.easing, easing_kind::linear);
    if (m.speed_mm_s.empty())
        out.add("duration_s", i.duration_s);
    const double faster =
        m.speed_mm_s.empty() ? 1.0 : travel_time_s(m, law.way.length_mm()) / (p.moving_s() * longer);
    out.add_rows("speed_mm_s", m.speed_mm_s, [&](const profile_point& v) {
        return pair({v.part, v.value * faster});
    });
    out.add_rows("pauses", m.rests, [&](const rest& r) {
        return fmt::format("{}, {}, {}", r.part, r.time_s * longer, r.intensity);
    });
}

void add_path(lines& out, const stroke& s, const trajectory::impl& i, const drawn_path& law)
{
    out.add("path", law.way.svg());
    const bool varies = law.moves && !law.moves->definition().intensity.empty();
    const double strength = law.intensity * i.gain;
    if (varies)
        out.add_rows("intensity", law.moves->definition().intensity, [strength](const profile_point& p) {
            return pair({p.part, p.value * strength});
        });
    else
        out.add_unless_default("intensity", strength, 1.0);
    if (law.moves)
        add_movement(out, i, law);
    else if (s.speed_mm_s && law.way.length_mm() / *s.speed_mm_s == i.duration_s)
        out.add("speed_mm_s", *s.speed_mm_s);
    else
        out.add("duration_s", i.duration_s);
}

void add_sound(lines& out, const stroke& s)
{
    if (s.sound.carrier_profile.empty() && s.sound.carrier_times.empty())
        out.add("carrier_hz", s.sound.carrier_hz);
    out.add_rows("carrier_hz", s.sound.carrier_times,
                 [](const carrier_time& p) { return fmt::format("{}, {}", p.t_s, p.hz); });
    out.add_rows("carrier_profile", s.sound.carrier_profile,
                 [](const carrier_part& p) { return fmt::format("{}, {}", p.part, p.hz); });
    if (s.sound.wave) {
        const waveform& w = *s.sound.wave;
        const bool recorded = w.kind == waveform_kind::recording;
        // An absolute path, because the new file may be in another folder.
        out.add("waveform",
                recorded ? std::filesystem::absolute(waveform_text(w)).string() : waveform_text(w));
        if (w.kind == waveform_kind::noise)
            out.add("noise_seed", w.seed);
        if (recorded)
            out.add("texture", w.texture);
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
    out.add("algorithm", s.choices.algorithm);
    out.add("phantom", s.choices.phantom);
    out.add("faces", s.choices.faces);
    out.add("soa_s", s.choices.soa_s);
    out.add("burst_s", s.choices.burst_s);
    out.add_unless_default("level_db", s.choices.level_db, 0.0);
    if (s.fit && s.fit->group != 0)
        refuse(s, "its group is fitted as a whole", "call apply_fits() first");
    if (s.fit && s.fit->unit_square)
        refuse(s, "its places are parts of an array", "call apply_fits() first");
    if (s.fit) {
        out.add("fit", true);
        out.add("fit_margin_mm", s.fit->margin_mm);
    }
}

// Writes the start. If `follows` is false, no stroke comes before this one in the file, so the start cannot
// be relative to another stroke.
void add_start(lines& out, const stroke& s, bool follows)
{
    if (s.anchor.from != start_from_kind::piece && follows)
        out.add("start_from", s.anchor.from);
    if (s.anchor.from == start_from_kind::piece || follows)
        out.add("start_s", s.start_s);
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
        add_timed_points(out, i, std::get<timed_points>(i.law));
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
    lines out;
    out.add("name", a.name);
    out.add_unless_default("site", a.site, {});
    out.add_unless_default("up", a.up, {});
    if (a.place)
        out.add_value("place", fmt::format("[{}, {}]", a.place->x_mm, a.place->y_mm));
    out.add("turn", a.turn_deg);
    out.add("body", a.body_mm);
    const std::optional<double> limit_dbfs = shared_limit(a);
    out.add("max_dbfs", limit_dbfs);
    for (const tactor_spec& t : a.tactors)
        add_tactor(out, t, limit_dbfs.value_or(0.0));
    return "[array]\n" + out.take();
}

std::string format_settings(const setup& besides)
{
    lines out;
    add_lines(out, besides);
    if (const auto& l = besides.limits) {
        out.begin_table("[limits]");
        out.add("power_dbfs", l->power_dbfs);
        out.add("max_drive_s", l->max_drive_s);
        out.add("window_s", l->window_s);
    }
    add_serve(out, besides.serve);
    if (!besides.defaults.empty())
        out.begin_table("[defaults]");
    for (const written_value& d : besides.defaults)
        out.add_value(d.name, value_text(d));
    return output_text(besides.output) + out.take() + (besides.texture ? texture_text(*besides.texture) : "");
}

std::string array_text(const array& a, const setup& besides)
{
    return array_text(a) + format_settings(besides);
}

std::string format_calibration(const calibration_origin& o)
{
    lines out;
    out.begin_table("[calibration]");
    out.add("participant", o.participant);
    out.add("method", o.method);
    out.add("rule", o.rule);
    out.add("carrier_hz", o.carrier_hz);
    out.add("interval_s", o.interval_s);
    out.add("feedback", o.feedback);
    out.add("masker", o.masker);
    out.add("date", o.date);
    out.add("seed", o.seed);
    out.add("simulated", o.simulated);
    for (const calibrated_tactor& t : o.tactors) {
        out.begin_table("[[calibration.tactor]]");
        out.add("tactor", t.tactor);
        out.add("threshold_dbfs", t.threshold_dbfs);
        out.add("sd_db", t.sd_db);
        out.add("posterior_sd_db", t.posterior_sd_db);
        out.add("trials", t.trials);
    }
    return out.take();
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
