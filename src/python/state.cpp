// SPDX-License-Identifier: MIT
#include "python/state.hpp"

#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/access.hpp"
#include "core/path/impl.hpp"
#include "core/path/outline.hpp"
#include "core/trajectory/impl.hpp"

namespace tactor::python {
namespace {

[[noreturn]] void refuse()
{
    throw error(error_kind::bad_input, "pickle", "its bytes are not those of a path or stroke",
                "make it anew with this version of tactor");
}

class writer {
public:
    template <class T>
    void put(const T& v)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t at = bytes_.size();
        bytes_.resize(at + sizeof v);
        std::memcpy(bytes_.data() + at, &v, sizeof v);
    }
    void text(std::string_view t)
    {
        put(std::uint64_t{t.size()});
        bytes_ += t;
    }
    template <class T>
    void all(const std::vector<T>& list)
    {
        put(std::uint64_t{list.size()});
        for (const T& v : list)
            put(v);
    }
    void maybe(const std::optional<double>& v)
    {
        put(v.has_value());
        put(v.value_or(0.0));
    }
    std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

class reader {
public:
    explicit reader(std::string_view bytes) : left_(bytes) {}

    template <class T>
    T get()
    {
        T v{};
        if (left_.size() < sizeof v)
            refuse();
        std::memcpy(&v, left_.data(), sizeof v);
        left_.remove_prefix(sizeof v);
        return v;
    }
    // Of things that take so many bytes each.
    std::size_t count(std::size_t bytes_each)
    {
        const auto n = get<std::uint64_t>();
        if (n > left_.size() / bytes_each)
            refuse();
        return static_cast<std::size_t>(n);
    }
    template <class T>
    std::vector<T> all()
    {
        std::vector<T> list(count(sizeof(T)));
        for (T& v : list)
            v = get<T>();
        return list;
    }
    std::string text()
    {
        const std::string_view t = left_.substr(0, count(1));
        left_.remove_prefix(t.size());
        return std::string(t);
    }
    std::optional<double> maybe()
    {
        const bool there = get<char>() != 0;
        const double v = get<double>();
        return there ? std::optional(v) : std::nullopt;
    }
    void end() const
    {
        if (!left_.empty())
            refuse();
    }

private:
    std::string_view left_;
};

void put(writer& w, const path& p)
{
    const path::impl& i = detail::access::of(p);
    w.all(i.vertices);
    w.put(std::uint64_t{i.curves.size()});
    for (const auto& c : i.curves) {
        w.put(std::uint64_t{c.segment});
        w.put(static_cast<char>(c.form.index()));
        std::visit([&w](const auto& form) { w.put(form); }, c.form);
    }
}

void put(writer& w, const waveform& v)
{
    w.put(static_cast<char>(v.kind));
    w.put(v.low_hz);
    w.put(v.high_hz);
    w.put(v.seed);
    w.put(static_cast<char>(v.texture));
    w.put(v.texture_mm);
    w.put(v.recorded != nullptr);
    if (v.recorded) {
        w.text(v.recorded->file);
        w.put(v.recorded->rate_hz);
        w.all(v.recorded->samples);
        w.text(v.recorded->sha256);
        w.put(v.recorded->missing);
    }
}

waveform get_waveform(reader& r)
{
    const auto kind_of = [&r](auto values) {
        const auto i = static_cast<std::size_t>(r.get<unsigned char>());
        if (i >= values.size())
            refuse();
        return values[i];
    };
    waveform v;
    v.kind = kind_of(all_values<waveform_kind>());
    v.low_hz = r.get<double>();
    v.high_hz = r.get<double>();
    v.seed = r.get<std::uint64_t>();
    v.texture = kind_of(all_values<texture_kind>());
    v.texture_mm = r.get<double>();
    if (r.get<char>() != 0) {
        recording samples;
        samples.file = r.text();
        samples.rate_hz = r.get<double>();
        samples.samples = r.all<float>();
        samples.sha256 = r.text();
        samples.missing = r.get<std::uint64_t>();
        v.recorded = std::make_shared<const recording>(std::move(samples));
    }
    validate(v);
    return v;
}

path get_path(reader& r)
{
    detail::outline o;
    o.vertices = r.all<point>();
    if (o.vertices.size() < 2)
        refuse();
    for (std::size_t n = r.count(sizeof(detail::elliptic)); n > 0; --n) {
        const auto segment = r.get<std::uint64_t>();
        const bool ascends = o.curves.empty() || segment > o.curves.back().segment;
        if (segment + 1 >= o.vertices.size() || !ascends)
            refuse();
        const bool is_cubic = r.get<char>() == 0;
        o.curves.push_back(
            {static_cast<std::size_t>(segment),
             is_cubic ? detail::shape(r.get<detail::cubic>()) : detail::shape(r.get<detail::elliptic>())});
    }
    return detail::make_path(std::move(o), [] { return "pickle"; });
}

void put(writer& w, const movement& m, double moving_s)
{
    w.put(moving_s);
    w.text(to_string(m.easing));
    w.all(m.speed_mm_s);
    w.all(m.intensity);
    w.all(m.rests);
}

std::shared_ptr<const detail::pace> get_pace(reader& r)
{
    const double moving_s = r.get<double>();
    movement m;
    m.easing = from_string<easing_kind>(r.text());
    m.speed_mm_s = r.all<profile_point>();
    m.intensity = r.all<profile_point>();
    m.rests = r.all<rest>();
    detail::check_movement(m);
    detail::check_duration(moving_s);
    return std::make_shared<const detail::pace>(std::move(m), moving_s);
}

void put(writer& w, const trajectory& m)
{
    const trajectory::impl& i = detail::access::of(m);
    w.put(static_cast<char>(i.law.index()));
    w.put(i.duration_s);
    w.put(i.gain);
    if (const auto* drawn = std::get_if<detail::drawn_path>(&i.law)) {
        w.put(drawn->intensity);
        put(w, drawn->way);
        w.put(drawn->moves != nullptr);
        if (drawn->moves)
            put(w, drawn->moves->given(), drawn->moves->moving_s());
        return;
    }
    const auto& points = *std::get<detail::timed_points>(i.law).points;
    w.all(points);
}

trajectory get_trajectory(reader& r)
{
    const bool even = r.get<char>() == 0;
    const double duration_s = r.get<double>();
    const double gain = r.get<double>();
    const auto made = [&] {
        if (even) {
            const double intensity = r.get<double>();
            detail::check_intensity("pickle", intensity);
            const path way = get_path(r);
            if (r.get<char>() == 0)
                return trajectory::along(way, duration_s, intensity);
            detail::check_duration(duration_s);
            detail::drawn_path law{way, intensity, get_pace(r)};
            return detail::access::make<trajectory>(
                std::make_shared<const trajectory::impl>(trajectory::impl{std::move(law), duration_s, 1.0}));
        }
        const trajectory own = trajectory::timed(r.all<timed_point>());
        return own.duration_s() == duration_s ? own : own.with_duration(duration_s);
    }();
    // Times a factor: one, unless it was taken several times.
    return gain == 1.0 ? made : made.with_intensity(gain);
}

} // namespace

std::string state_of(const path& p)
{
    writer w;
    put(w, p);
    return w.take();
}

std::string state_of(const stroke& s)
{
    writer w;
    w.text(s.name);
    put(w, s.motion);
    w.maybe(s.start_s);
    w.maybe(s.sound.carrier_hz);
    w.maybe(s.speed_mm_s);
    w.put(s.usual_pace);
    w.text(to_string(s.anchor.from));
    w.put(s.anchor.back);
    w.text(s.choices.algorithm ? to_string(*s.choices.algorithm) : "");
    w.text(s.choices.phantom ? to_string(*s.choices.phantom) : "");
    w.text(s.choices.faces ? to_string(*s.choices.faces) : "");
    w.maybe(s.choices.soa_s);
    w.maybe(s.choices.burst_s);
    w.put(s.choices.level_db);
    w.maybe(s.fit ? std::optional(s.fit->margin_mm) : std::nullopt);
    w.put(s.fit ? s.fit->group : 0U);
    w.put(s.sound.wave.has_value());
    if (s.sound.wave)
        put(w, *s.sound.wave);
    w.put(s.sound.am.has_value());
    w.put(s.sound.am.value_or(modulation{}));
    w.all(s.sound.carrier_profile);
    w.text(to_string(s.note));
    w.put(std::uint64_t{s.warnings.size()});
    for (const std::string& t : s.warnings)
        w.text(t);
    return w.take();
}

path path_from(std::string_view state)
{
    reader r(state);
    path p = get_path(r);
    r.end();
    return p;
}

stroke stroke_from(std::string_view state)
{
    reader r(state);
    stroke s{r.text(), get_trajectory(r)}; // braces: in this order
    s.start_s = r.maybe();
    s.sound.carrier_hz = r.maybe();
    s.speed_mm_s = r.maybe();
    s.usual_pace = r.get<bool>();
    s.anchor.from = from_string<start_from_kind>(r.text());
    s.anchor.back = r.get<unsigned>();
    if (const std::string name = r.text(); !name.empty())
        s.choices.algorithm = from_string<algorithm_kind>(name);
    if (const std::string name = r.text(); !name.empty())
        s.choices.phantom = from_string<phantom_kind>(name);
    if (const std::string name = r.text(); !name.empty())
        s.choices.faces = from_string<faces_kind>(name);
    s.choices.soa_s = r.maybe();
    s.choices.burst_s = r.maybe();
    s.choices.level_db = r.get<double>();
    const auto margin_mm = r.maybe();
    const auto group = r.get<unsigned>();
    if (margin_mm)
        s.fit = stroke_fit{*margin_mm, group};
    if (r.get<char>() != 0)
        s.sound.wave = get_waveform(r);
    const bool modulated = r.get<char>() != 0;
    const auto am = r.get<modulation>();
    if (modulated)
        s.sound.am = am;
    s.sound.carrier_profile = r.all<carrier_part>();
    s.note = from_string<note_kind>(r.text());
    for (std::size_t n = r.count(1); n > 0; --n)
        s.warnings.push_back(r.text());
    r.end();
    return s;
}

} // namespace tactor::python
