// SPDX-License-Identifier: MIT
// Paths and strokes as bytes.
#include <concepts>
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
#include "python/binding.hpp"

namespace tactor::python {
namespace {

[[noreturn]] void refuse()
{
    throw error(error_kind::bad_input, "pickle", "its bytes are not those of a path or stroke",
                "make it anew with this version of tactor");
}

/// Appends values: those with members() by these, closed sets by their names, all else as it lies in memory.
class writer {
public:
    template <class... T>
    void operator()(const T&... values)
    {
        (put(values), ...);
    }
    std::string take() { return std::move(bytes_); }

private:
    template <class T>
    void put(const T& v)
    {
        if constexpr (requires { members(*this, v); }) {
            members(*this, v);
        } else if constexpr (std::is_enum_v<T>) {
            put(std::string(to_string(v)));
        } else {
            static_assert(std::is_trivially_copyable_v<T>);
            bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
        }
    }
    void put(const std::string& text)
    {
        put(std::uint64_t{text.size()});
        bytes_ += text;
    }
    template <class T>
    void put(const std::vector<T>& list)
    {
        put(std::uint64_t{list.size()});
        for (const T& v : list)
            put(v);
    }
    template <class T>
    void put(const std::optional<T>& v)
    {
        put(v.has_value());
        if (v)
            put(*v);
    }
    void put(const std::shared_ptr<const recording>& samples)
    {
        put(samples != nullptr);
        if (samples)
            put(*samples);
    }

    std::string bytes_;
};

/// Reads values in the order of a writer.
class reader {
public:
    explicit reader(std::string_view bytes) : left_(bytes) {}

    template <class... T>
    void operator()(T&... values)
    {
        (get(values), ...);
    }
    template <class T>
    T next()
    {
        T v{};
        get(v);
        return v;
    }
    /// Reads a number of things that take at least so many bytes each.
    std::size_t count(std::size_t bytes_each)
    {
        const auto n = next<std::uint64_t>();
        if (n > left_.size() / bytes_each)
            refuse();
        return static_cast<std::size_t>(n);
    }
    void end() const
    {
        if (!left_.empty())
            refuse();
    }

private:
    template <class T>
    void get(T& v)
    {
        if constexpr (requires { members(*this, v); }) {
            members(*this, v);
        } else if constexpr (std::is_enum_v<T>) {
            v = from_string<T>(next<std::string>());
        } else {
            if (left_.size() < sizeof v)
                refuse();
            std::memcpy(&v, left_.data(), sizeof v);
            left_.remove_prefix(sizeof v);
        }
    }
    void get(bool& v) { v = next<char>() != 0; }
    void get(std::string& text)
    {
        text = left_.substr(0, count(1));
        left_.remove_prefix(text.size());
    }
    template <class T>
    void get(std::vector<T>& list)
    {
        list.resize(count(std::is_trivially_copyable_v<T> ? sizeof(T) : 1));
        for (T& v : list)
            get(v);
    }
    template <class T>
    void get(std::optional<T>& v)
    {
        if (next<bool>())
            get(v.emplace());
    }
    void get(std::shared_ptr<const recording>& samples)
    {
        if (next<bool>())
            samples = std::make_shared<const recording>(next<recording>());
    }

    std::string_view left_;
};

template <class T, class Value>
concept either = std::same_as<std::remove_const_t<T>, Value>;

template <class Io>
void members(Io& io, either<recording> auto& r)
{
    io(r.file, r.rate_hz, r.samples, r.sha256, r.missing);
}

template <class Io>
void members(Io& io, either<waveform> auto& w)
{
    io(w.kind, w.low_hz, w.high_hz, w.seed, w.texture, w.texture_mm, w.recorded);
}

template <class Io>
void members(Io& io, either<movement> auto& m)
{
    io(m.easing, m.speed_mm_s, m.intensity, m.rests);
}

template <class Io>
void members(Io& io, either<stroke_fit> auto& f)
{
    io(f.margin_mm, f.group);
}

void members(writer& w, const path& p)
{
    const path::impl& i = detail::access::of(p);
    w(i.vertices, std::uint64_t{i.curves.size()});
    for (const auto& c : i.curves) {
        w(std::uint64_t{c.segment}, static_cast<char>(c.form.index()));
        std::visit([&w](const auto& form) { w(form); }, c.form);
    }
}

path get_path(reader& r)
{
    detail::outline o;
    r(o.vertices);
    if (o.vertices.size() < 2)
        refuse();
    for (std::size_t n = r.count(sizeof(detail::elliptic)); n > 0; --n) {
        const auto segment = r.next<std::uint64_t>();
        const bool ascends = o.curves.empty() || segment > o.curves.back().segment;
        if (segment + 1 >= o.vertices.size() || !ascends)
            refuse();
        const bool is_cubic = r.next<char>() == 0;
        o.curves.push_back(
            {static_cast<std::size_t>(segment),
             is_cubic ? detail::shape(r.next<detail::cubic>()) : detail::shape(r.next<detail::elliptic>())});
    }
    return detail::make_path(std::move(o), [] { return "pickle"; });
}

void members(writer& w, const trajectory& m)
{
    const trajectory::impl& i = detail::access::of(m);
    w(static_cast<char>(i.law.index()), i.duration_s, i.gain);
    if (const auto* drawn = std::get_if<detail::drawn_path>(&i.law)) {
        w(drawn->intensity, drawn->way, drawn->moves != nullptr);
        if (drawn->moves)
            w(drawn->moves->moving_s(), drawn->moves->given());
    } else {
        w(*std::get<detail::timed_points>(i.law).points);
    }
}

std::shared_ptr<const detail::pace> get_pace(reader& r)
{
    const auto moving_s = r.next<double>();
    auto m = r.next<movement>();
    detail::check_movement(m);
    detail::check_duration(moving_s);
    return std::make_shared<const detail::pace>(std::move(m), moving_s);
}

trajectory get_drawn(reader& r, double duration_s)
{
    const auto intensity = r.next<double>();
    detail::check_intensity("pickle", intensity);
    const path way = get_path(r);
    if (!r.next<bool>())
        return trajectory::along(way, duration_s, intensity);
    detail::check_duration(duration_s);
    detail::drawn_path law{way, intensity, get_pace(r)};
    return detail::access::make<trajectory>(
        std::make_shared<const trajectory::impl>(trajectory::impl{std::move(law), duration_s, 1.0}));
}

void members(reader& r, trajectory& m)
{
    const bool is_drawn = r.next<char>() == 0;
    const auto duration_s = r.next<double>();
    const auto gain = r.next<double>();
    m = is_drawn ? get_drawn(r, duration_s) : trajectory::timed(r.next<std::vector<timed_point>>());
    if (!is_drawn && m.duration_s() != duration_s)
        m = m.with_duration(duration_s);
    if (gain != 1.0) // one factor, unless the stroke was made stronger or weaker several times
        m = detail::scaled(m, gain);
}

template <class Io>
void members(Io& io, either<stroke> auto& s)
{
    io(s.name, s.motion, s.start_s, s.anchor.from, s.anchor.back, s.speed_mm_s, s.usual_pace);
    io(s.choices.algorithm, s.choices.phantom, s.choices.faces, s.choices.soa_s, s.choices.burst_s,
       s.choices.level_db, s.fit);
    io(s.sound.carrier_hz, s.sound.wave, s.sound.am, s.sound.carrier_profile, s.note, s.warnings);
}

template <class T>
std::string write(const T& v)
{
    writer w;
    w(v);
    return w.take();
}

} // namespace

std::string write_state(const path& p)
{
    return write(p);
}

std::string write_state(const stroke& s)
{
    return write(s);
}

path read_path(std::string_view state)
{
    reader r(state);
    path p = get_path(r);
    r.end();
    return p;
}

stroke read_stroke(std::string_view state)
{
    reader r(state);
    auto s = r.next<stroke>();
    r.end();
    if (s.sound.wave)
        validate(*s.sound.wave);
    return s;
}

} // namespace tactor::python
