// SPDX-License-Identifier: MIT
// Paths and strokes as bytes.
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

/// Values as bytes: those with members() by these, closed sets by their names, all else as it lies in memory.
/// Writes them, or reads them in the same order.
class archive {
public:
    archive() = default;
    explicit archive(std::string_view written) : reads_(true), left_(written) {}

    bool reads() const noexcept { return reads_; }
    template <class... T>
    void operator()(T&&... values)
    {
        (one(values), ...);
    }
    template <class T>
    T next()
    {
        T v{};
        one(v);
        return v;
    }
    /// Writes, or reads and returns, a number of things that take at least so many bytes each.
    std::size_t count(std::uint64_t n, std::size_t bytes_each)
    {
        one(n);
        if (reads_ && n > left_.size() / bytes_each)
            refuse();
        return static_cast<std::size_t>(n);
    }
    /// Returns the bytes that it has written.
    std::string take() { return std::move(written_); }
    /// Refuses bytes that were not read.
    void end() const
    {
        if (!left_.empty())
            refuse();
    }

private:
    void bytes(void* at, std::size_t n)
    {
        if (!reads_) {
            written_.append(static_cast<const char*>(at), n);
            return;
        }
        if (left_.size() < n)
            refuse();
        std::memcpy(at, left_.data(), n);
        left_.remove_prefix(n);
    }
    template <class T>
    void one(T& v)
    {
        if constexpr (requires { members(*this, v); }) {
            members(*this, v);
        } else if constexpr (std::is_enum_v<T>) {
            std::string name(reads_ ? std::string_view() : to_string(v));
            one(name);
            if (reads_)
                v = from_string<T>(name);
        } else {
            static_assert(std::is_trivially_copyable_v<T>);
            bytes(&v, sizeof v);
        }
    }
    void one(bool& v)
    {
        char c = v ? 1 : 0;
        bytes(&c, 1);
        v = c != 0;
    }
    void one(std::string& text)
    {
        text.resize(count(text.size(), 1));
        bytes(text.data(), text.size());
    }
    template <class T>
    void one(std::vector<T>& list)
    {
        list.resize(count(list.size(), std::is_trivially_copyable_v<T> ? sizeof(T) : 1));
        for (T& v : list)
            one(v);
    }
    template <class T>
    void one(std::optional<T>& v)
    {
        bool there = v.has_value();
        one(there);
        if (there)
            one(v ? *v : v.emplace());
    }
    void one(std::shared_ptr<const recording>& samples)
    {
        bool there = samples != nullptr;
        one(there);
        if (!there)
            return;
        recording r = reads_ ? recording() : *samples;
        one(r);
        if (reads_)
            samples = std::make_shared<const recording>(std::move(r));
    }

    bool reads_ = false;
    std::string written_;
    std::string_view left_;
};

void members(archive& io, recording& r)
{
    io(r.file, r.rate_hz, r.samples, r.sha256, r.missing);
}

void members(archive& io, waveform& w)
{
    io(w.kind, w.low_hz, w.high_hz, w.seed, w.texture, w.texture_mm, w.recorded);
}

void members(archive& io, movement& m)
{
    io(m.easing, m.speed_mm_s, m.intensity, m.rests);
}

void members(archive& io, stroke_fit& f)
{
    io(f.margin_mm, f.group);
}

void put_path(archive& io, const path& p)
{
    const path::impl& i = detail::access::of(p);
    io(std::vector(i.vertices));
    io.count(i.curves.size(), 1);
    for (const auto& c : i.curves) {
        io(std::uint64_t{c.segment}, static_cast<char>(c.form.index()));
        std::visit([&io](auto form) { io(form); }, c.form);
    }
}

path get_path(archive& io)
{
    detail::outline o;
    io(o.vertices);
    if (o.vertices.size() < 2)
        refuse();
    for (std::size_t n = io.count(0, sizeof(detail::elliptic)); n > 0; --n) {
        const auto segment = io.next<std::uint64_t>();
        const bool ascends = o.curves.empty() || segment > o.curves.back().segment;
        if (segment + 1 >= o.vertices.size() || !ascends)
            refuse();
        const bool is_cubic = io.next<char>() == 0;
        o.curves.push_back(
            {static_cast<std::size_t>(segment), is_cubic ? detail::shape(io.next<detail::cubic>())
                                                         : detail::shape(io.next<detail::elliptic>())});
    }
    return detail::make_path(std::move(o), [] { return "pickle"; });
}

void put_motion(archive& io, trajectory::impl i)
{
    io(static_cast<char>(i.law.index()), i.duration_s, i.gain);
    const auto* drawn = std::get_if<detail::drawn_path>(&i.law);
    if (drawn == nullptr) {
        io(std::vector(*std::get<detail::timed_points>(i.law).points));
        return;
    }
    io(double{drawn->intensity});
    put_path(io, drawn->way);
    io(drawn->moves != nullptr);
    if (drawn->moves)
        io(drawn->moves->moving_s(), movement(drawn->moves->given()));
}

std::shared_ptr<const detail::pace> get_pace(archive& io)
{
    const auto moving_s = io.next<double>();
    auto m = io.next<movement>();
    detail::check_movement(m);
    detail::check_duration(moving_s);
    return std::make_shared<const detail::pace>(std::move(m), moving_s);
}

trajectory get_drawn(archive& io, double duration_s)
{
    const auto intensity = io.next<double>();
    detail::check_intensity("pickle", intensity);
    const path way = get_path(io);
    if (!io.next<bool>())
        return trajectory::along(way, duration_s, intensity);
    detail::check_duration(duration_s);
    detail::drawn_path law{way, intensity, get_pace(io)};
    return detail::access::make<trajectory>(
        std::make_shared<const trajectory::impl>(trajectory::impl{std::move(law), duration_s, 1.0}));
}

void members(archive& io, trajectory& m)
{
    if (!io.reads()) {
        put_motion(io, detail::access::of(m));
        return;
    }
    const bool is_drawn = io.next<char>() == 0;
    const auto duration_s = io.next<double>();
    const auto gain = io.next<double>();
    m = is_drawn ? get_drawn(io, duration_s) : trajectory::timed(io.next<std::vector<timed_point>>());
    if (!is_drawn && m.duration_s() != duration_s)
        m = m.with_duration(duration_s);
    if (gain != 1.0) // one factor, unless the stroke was made stronger or weaker several times
        m = detail::scaled(m, gain);
}

void members(archive& io, stroke& s)
{
    io(s.name, s.motion, s.start_s, s.anchor.from, s.anchor.back, s.speed_mm_s, s.usual_pace);
    io(s.choices.algorithm, s.choices.phantom, s.choices.faces, s.choices.soa_s, s.choices.burst_s,
       s.choices.level_db, s.fit);
    io(s.sound.carrier_hz, s.sound.wave, s.sound.am, s.sound.carrier_profile, s.note, s.warnings);
}

} // namespace

std::string write_state(const path& p)
{
    archive io;
    put_path(io, p);
    return io.take();
}

std::string write_state(const stroke& s)
{
    archive io;
    io(stroke(s));
    return io.take();
}

path read_path(std::string_view state)
{
    archive io(state);
    path p = get_path(io);
    io.end();
    return p;
}

stroke read_stroke(std::string_view state)
{
    archive io(state);
    auto s = io.next<stroke>();
    io.end();
    if (s.sound.wave)
        validate(*s.sound.wave);
    return s;
}

} // namespace tactor::python
