// SPDX-License-Identifier: MIT
#include "engine/live.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <new>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/trajectory/units.hpp"
#include "plan/job.hpp"
#include "rt/clock.hpp"
#include "synth/mix/mixer.hpp"
#include "synth/score/frames.hpp"
#include "synth/score/levels.hpp"
#include "synth/tone/make_timbre.hpp"

namespace tactor::engine {
namespace {

constexpr std::size_t live_knots = 33;    // maximum number of knots of a course
constexpr double least_live_soa_s = 0.01; // minimum SOA of bursts

// Adds the delay of one point.
void count(live_delay& d, std::int64_t ns) noexcept
{
    const double s = 1e-9 * static_cast<double>(ns);
    d.least_s = d.points == 0 ? s : std::min(d.least_s, s);
    d.most_s = d.points == 0 ? s : std::max(d.most_s, s);
    ++d.points;
    d.mean_s += (s - d.mean_s) / static_cast<double>(d.points);
}

} // namespace

std::size_t live_reserve(const stream_setup& s) noexcept
{
    // In one period a continuous stroke needs two lines and a fade. A stroke of bursts needs the bursts that
    // begin in the period and the bursts that still sound.
    const double bursts = 2.0 + s.period_frames / (least_live_soa_s * s.rate);
    return live_voices * static_cast<std::size_t>(std::ceil(std::max(3.0, bursts))) *
           ((s.channels + synth::drives_per_event - 1) / synth::drives_per_event);
}

live_voice::live_voice(const live_setup& s)
    : setup_(s),
      points_(
          live_course{.amplitudes = std::vector<double>(s.channels * (s.window == 0 ? 1 : live_knots), 0.0)}),
      from_(s.channels, 0.0),
      to_(s.channels, 0.0)
{
}

void live_voice::request(action w) noexcept
{
    // The first request counts, with two exceptions: a cancel replaces an end, and a failure replaces both.
    action now = requested_.load(std::memory_order_relaxed);
    while (now < w && !requested_.compare_exchange_weak(now, w, std::memory_order_release)) {
    }
}

void live_voice::fail(std::string why) noexcept
{
    failure_ = std::move(why);
    request(action::fail);
}

void live_voice::record_movement(point p, std::int64_t at_ns) noexcept
{
    if (!newest_)
        begun_ns_ = at_ns;
    const double way_mm = newest_ ? distance_mm(*newest_, p) : 0.0;
    newest_ = p;
    length_mm_.store(length_mm_.load(std::memory_order_relaxed) + way_mm, std::memory_order_relaxed);
    farthest_mm_.store(
        std::max({farthest_mm_.load(std::memory_order_relaxed), std::abs(p.x_mm), std::abs(p.y_mm)}),
        std::memory_order_relaxed);
    moving_s_.store(1e-9 * static_cast<double>(at_ns - begun_ns_), std::memory_order_relaxed);
}

std::string live_voice::doubt() const
{
    return detail::unit_warning({length_mm_.load(std::memory_order_relaxed),
                                 moving_s_.load(std::memory_order_relaxed),
                                 farthest_mm_.load(std::memory_order_relaxed), detail::pace_source::live});
}

void live_voice::wait(std::uint64_t frames) noexcept
{
    if (points_.fetch()) {
        has_point_ = true;
        idle_ = 0;
    } else if (requested() == action::go_on) {
        idle_ += frames; // the producer need not send points after it has requested the end
    }
}

bool live_voice::try_begin(ticket t, std::uint64_t next) noexcept
{
    has_point_ = points_.fetch() || has_point_;
    if (!has_point_)
        return false;
    ticket_ = t;
    first_ns_ = points_.value().at_ns;
    has_begun_ = true;
    base_ = next;
    end_ = next;
    next_burst_ = next;
    set_target_amplitudes(0);
    length_ = setup_.step;
    place_ = 0;
    idle_ = 0;
    return true;
}

bool live_voice::render(synth::mixer& m, std::uint64_t frames, std::uint64_t offset,
                        const clock_line& clock) noexcept
{
    const dac_times t{offset, clock};
    bool fits = true;
    if (setup_.bursts) {
        const std::uint64_t end = m.position() + frames;
        for (; fits && next_burst_ < end; next_burst_ += setup_.soa)
            fits = add_burst(m, next_burst_, t);
    } else {
        fits = follow(m, frames, t);
    }
    // The next burst takes the newest point; until then the point waits.
    idle_ = setup_.bursts && points_.has_new_value() ? 0 : idle_ + frames;
    rendered_.store(m.position() + frames - base_, std::memory_order_relaxed);
    return fits;
}

// Renders a continuous stroke: amplitudes change linearly from one point to the next, and the carrier
// continues.
bool live_voice::follow(synth::mixer& m, std::uint64_t frames, const dac_times& t) noexcept
{
    const std::uint64_t end = m.position() + frames;
    bool fits = true;
    for (std::uint64_t at = m.position(); fits && at < end;) {
        if (place_ >= length_) {
            std::swap(from_, to_);
            take(at, t);
            length_ = std::max(setup_.step, end - at);
            set_target_amplitudes(at + length_ - base_);
            place_ = 0;
        }
        const std::uint64_t n = std::min(end - at, length_ - place_);
        const double start = static_cast<double>(place_) / static_cast<double>(length_);
        const double stop = static_cast<double>(place_ + n) / static_cast<double>(length_);
        synth::drive_event e;
        e.start = at;
        e.phase_frame = at - base_;
        e.length = static_cast<std::uint32_t>(n);
        fits = add(m, e, [&](std::size_t c) {
            const double d = to_[c] - from_[c];
            return std::pair(from_[c] + d * start, from_[c] + d * stop);
        });
        at += n;
        place_ += n;
        end_ = at;
    }
    return fits;
}

// Takes the newest point, if there is one. It applies from frame `at` on.
void live_voice::take(std::uint64_t at, const dac_times& t) noexcept
{
    if (!points_.fetch())
        return;
    idle_ = 0;
    if (!t.clock.valid())
        return;
    count(later_, t.clock.time_at(t.offset + at) - points_.value().at_ns);
}

live_delay live_voice::delay(std::int64_t started_ns) const noexcept
{
    live_delay all = later_;
    count(all, started_ns - first_ns_);
    return all;
}

// Sets to_ to the amplitudes that the newest course has at a frame of the stroke.
void live_voice::set_target_amplitudes(std::uint64_t frame) noexcept
{
    const live_course& c = points_.value();
    const std::size_t last = c.knots - 1;
    const std::uint64_t elapsed = std::min(frame - std::min(frame, c.start), c.length);
    const std::uint64_t scaled = elapsed * last;
    const std::uint64_t knot = c.length == 0 ? last : scaled / c.length;
    const double* a = &c.amplitudes[knot * setup_.channels];
    std::copy(a, a + setup_.channels, to_.begin());
    if (knot == last)
        return;
    const double part = static_cast<double>(scaled % c.length) / static_cast<double>(c.length);
    for (std::size_t n = 0; n < setup_.channels; ++n)
        to_[n] += (a[setup_.channels + n] - a[n]) * part;
}

bool live_voice::add_burst(synth::mixer& m, std::uint64_t at, const dac_times& t) noexcept
{
    take(at, t);
    synth::drive_event e;
    e.start = at;
    e.phase_frame = setup_.restart ? 0 : at - base_;
    e.phase_origin = at - base_ - e.phase_frame;
    e.window = setup_.duration;
    const double half_cycles = 2.0 * setup_.cycles_per_frame;
    e.ramp = synth::is_between_zeros(half_cycles * static_cast<double>(e.phase_frame),
                                     half_cycles * static_cast<double>(e.phase_frame + setup_.duration))
                 ? setup_.ramp
                 : setup_.cut_ramp;
    e.release = synth::release_frames(setup_.envelope, setup_.rate, setup_.duration, e.ramp);
    e.shape = setup_.envelope.kind;
    e.length = static_cast<std::uint32_t>(setup_.duration);
    end_ = at + setup_.duration;
    set_target_amplitudes(at - base_);
    return add(m, e, [this](std::size_t c) { return std::pair(to_[c], to_[c]); });
}

bool live_voice::fade(synth::mixer& m, std::uint32_t frames) noexcept
{
    synth::drive_event e;
    e.start = m.position();
    e.phase_frame = e.start - base_;
    e.ramp_position = frames; // the falling half of the window
    e.window = 2 * std::uint64_t{frames};
    e.ramp = frames;
    e.length = frames;
    end_ = e.start + frames;
    return frames == 0 || add(m, e, [this](std::size_t c) {
               const double a = amplitude(c);
               return std::pair(a, a);
           });
}

double live_voice::amplitude(std::size_t channel) const noexcept
{
    const double part = static_cast<double>(place_) / static_cast<double>(length_);
    return from_[channel] + (to_[channel] - from_[channel]) * part;
}

// Adds an event for all channels. `part` returns a channel's amplitudes at the start and end of the event.
template <typename Part>
bool live_voice::add(synth::mixer& m, synth::drive_event e, Part part) noexcept
{
    e.cycles_per_frame = setup_.cycles_per_frame;
    e.sound = setup_.sound.get();
    e.score = ticket_;
    e.drives = 0;
    for (std::size_t c = 0; c < setup_.channels; ++c) {
        const auto [from, to] = part(c);
        if (from == 0.0 && to == 0.0)
            continue;
        e.drive[e.drives++] = {.from = from, .to = to, .channel = static_cast<std::uint32_t>(c)};
        if (e.drives == synth::drives_per_event) {
            if (!m.add(e))
                return false;
            e.drives = 0;
        }
    }
    return e.drives == 0 || m.add(e);
}

void smoothing::to(std::uint64_t frame, const place& p)
{
    if (!places_.empty() && places_.back().from == frame)
        places_.back().where = p;
    else
        places_.push_back({frame, p});
    // Keeps the newest place that is older than the window, and drops older ones.
    const auto counts = std::find_if(places_.begin() + 1, places_.end(),
                                     [&](const entry& g) { return g.from + window_ > frame; });
    places_.erase(places_.begin(), counts - 1);
}

smoothing::place smoothing::at(std::uint64_t frame) const
{
    place mean{{0.0, 0.0}, 0.0};
    point silent{0.0, 0.0};
    double touched = 0.0; // fraction of the window with a touch
    std::uint64_t rest = window_;
    std::uint64_t end = frame;
    for (auto g = places_.rbegin(); g != places_.rend() && rest != 0; ++g) {
        const bool oldest = g + 1 == places_.rend();
        const std::uint64_t n = oldest ? rest : std::min(rest, end - std::min(end, g->from));
        const double part = static_cast<double>(n) / static_cast<double>(window_);
        point& sum = g->where.intensity > 0.0 ? mean.at : silent;
        sum.x_mm += part * g->where.at.x_mm;
        sum.y_mm += part * g->where.at.y_mm;
        touched += g->where.intensity > 0.0 ? part : 0.0;
        mean.intensity += part * g->where.intensity;
        rest -= n;
        end = g->from;
    }
    if (touched == 0.0)
        return {silent, mean.intensity};
    mean.at.x_mm /= touched;
    mean.at.y_mm /= touched;
    return mean;
}

} // namespace tactor::engine

namespace tactor {
inline namespace v0 {
namespace {

using engine::least_live_soa_s;

error make_live_error(std::string_view field, std::string_view why, std::string_view hint)
{
    return error(error_kind::bad_input, "live stroke", why, hint).with_field(field);
}

void check(const live_options& o, unsigned rate)
{
    if (o.plan.algorithm == algorithm_kind::tactile_brush)
        throw make_live_error("algorithm", "Tactile Brush needs the whole path in advance",
                              "use continuous or park2016");
    if (!(o.plan.carrier_hz > 0.0 && o.plan.carrier_hz < 0.5 * rate))
        throw make_live_error(
            "carrier_hz",
            fmt::format("a carrier of {} Hz cannot be rendered at a rate of {} Hz", o.plan.carrier_hz, rate),
            "use a carrier below half the rate, such as 250 Hz");
    if (!detail::bounds_of::timeout_s.holds(o.timeout_s))
        throw make_live_error("timeout_s", fmt::format("a time-out of {} s is out of range", o.timeout_s),
                              "give 0.001 to 86400 s");
    if (o.longest_s && !detail::bounds_of::timeout_s.holds(*o.longest_s))
        throw make_live_error("longest_s",
                              fmt::format("a longest duration of {} s is out of range", *o.longest_s),
                              "give 0.001 to 86400 s");
    if (!detail::bounds_of::smooth_s.holds(o.smooth_s))
        throw make_live_error("smooth_s", fmt::format("smoothing over {} s is out of range", o.smooth_s),
                              "give 0 (off) to 1 s");
    if (o.render.ramp_s && !detail::bounds_of::ramp_s.holds(*o.render.ramp_s))
        throw make_live_error("ramp_s", fmt::format("a ramp of {} s is out of range", *o.render.ramp_s),
                              "give 0 to 10 s");
    synth::check_envelope(o.render.envelope);
    static_cast<void>(o.plan.scale.amplitude(1.0)); // refuses an impossible scale
}

/// Returns a plan that has only the members that determine the sound.
plan sound_plan(const plan_options& o)
{
    if (o.wave.kind == waveform_kind::recording && o.wave.texture == texture_kind::length)
        throw make_live_error("texture", "the length of its path is not known in advance",
                              "play the recording with texture time or cycle");
    plan p;
    p.carrier_hz = o.carrier_hz;
    p.wave = o.wave;
    p.am = o.am;
    return p;
}

engine::live_setup live_setup(const stream_setup& s, const live_options& o)
{
    check(o, s.rate);
    engine::live_setup l;
    l.channels = s.channels;
    l.cycles_per_frame = o.plan.carrier_hz / s.rate;
    const plan heard = sound_plan(o.plan);
    l.sound = synth::make_timbre(heard, s.rate);
    l.envelope = o.render.envelope;
    l.rate = s.rate;
    l.step = std::max<std::uint64_t>(synth::frame_at(continuous_step_s, s.rate), 1);
    l.timeout = synth::frame_at(o.timeout_s, s.rate);
    if (o.longest_s)
        l.longest = synth::frame_at(*o.longest_s, s.rate);
    l.window = synth::frame_at(o.smooth_s, s.rate);
    l.bursts = o.plan.algorithm == algorithm_kind::park2016;
    if (!l.bursts)
        return l;
    const double duration_s = burst_duration_s(o.plan);
    if (o.plan.soa_s < least_live_soa_s)
        throw make_live_error("soa_s", fmt::format("an SOA of {} s is too short", o.plan.soa_s),
                              fmt::format("give {} s or more", least_live_soa_s));
    l.soa = synth::frame_at(o.plan.soa_s, s.rate);
    l.duration = std::min(synth::frame_at(duration_s, s.rate), l.soa);
    l.restart = o.render.phase == phase_kind::burst;
    const auto ramp = [&](std::optional<double> ramp_s) {
        return synth::attack_frames(synth::ramp_seconds(ramp_s, 0.0, duration_s, o.plan.carrier_hz),
                                    l.envelope, s.rate, l.duration);
    };
    // With a restart all bursts are equal; otherwise each burst begins at a different phase of the carrier.
    if (synth::crosses_zero(heard))
        l.ramp = ramp(l.restart ? o.render.ramp_s : o.render.ramp_s.value_or(0.0));
    else
        l.ramp = ramp(o.render.ramp_s.value_or(synth::default_ramp_s));
    l.cut_ramp = l.restart ? l.ramp : ramp(o.render.ramp_s.value_or(synth::default_ramp_s));
    return l;
}

/// Scope in which the current thread is marked as running a model.
class model_call {
public:
    explicit model_call(std::atomic<std::thread::id>& owner) noexcept : owner_(owner)
    {
        owner_.store(std::this_thread::get_id(), std::memory_order_relaxed);
    }
    ~model_call() { owner_.store({}, std::memory_order_relaxed); }
    model_call(const model_call&) = delete;
    model_call& operator=(const model_call&) = delete;

private:
    std::atomic<std::thread::id>& owner_;
};

/// Returns the levels of all tactors. Each tactor must have a level, because a point may come anywhere.
std::vector<synth::tactor_level> live_levels(const array& a, const render_options& o)
{
    const std::vector<std::size_t> unmeasured = synth::unmeasured_tactors(a, o);
    if (!unmeasured.empty())
        synth::refuse_unmeasured(a, unmeasured.front(), o);
    return synth::tactor_levels(a, o);
}

} // namespace

live_stroke::impl::impl(stroke_id number, const array& a, const layout& l, const stream_setup& s,
                        const live_options& o)
    : id(number),
      faces(l),
      model(detail::choose_model(l, o.plan)),
      outside(o.plan.outside),
      scale(o.plan.scale),
      levels(live_levels(a, o.render)),
      limits(synth::channel_limits(a, s.channels)),
      voice(live_setup(s, o)),
      window(voice.setup().window),
      smooth(window),
      most_knots(std::clamp<std::size_t>(window / voice.setup().step, 1, engine::live_knots - 1) + 1)
{
    drives.reserve(a.tactors.size());
    for (std::size_t i = 0; o.render.sl_db && i < levels.size(); ++i)
        levels[i].gain *= synth::threshold_factor(a.tactors[i], o.plan.carrier_hz);
}

bool live_stroke::impl::to(point p, double intensity, std::optional<std::int64_t> at_ns)
{
    const std::int64_t stamp = at_ns ? *at_ns : rt::monotonic_ns();
    if (!std::isfinite(p.x_mm) || !std::isfinite(p.y_mm))
        throw make_live_error(std::isfinite(p.x_mm) ? "y_mm" : "x_mm",
                              fmt::format("the point ({}, {}) is not finite", p.x_mm, p.y_mm),
                              "give finite numbers");
    if (stamp < 0)
        throw make_live_error("at_ns", fmt::format("a point at {} ns is before the clock's zero", stamp),
                              "give ns of CLOCK_MONOTONIC, or none for now");
    if (model_thread.load(std::memory_order_relaxed) == std::this_thread::get_id())
        throw error(error_kind::runtime, "live stroke", "its phantom model moves the stroke inside weights()",
                    "move the stroke from outside weights()");
    const std::lock_guard lock(mutex);
    if (voice.closed() || voice.requested() != engine::live_voice::action::go_on)
        return false;
    const point place = detail::clamp_to_array(faces, p);
    const bool inside = distance_mm(p, place) <= edge_tolerance_mm;
    if (!inside && outside == outside_kind::error)
        throw make_live_error("outside", fmt::format("({:.6g}, {:.6g}) is outside the array", p.x_mm, p.y_mm),
                              "use {outside=clamp} to play the nearest point of the array");
    const bool held = intensity > 1.0 && std::isfinite(intensity);
    const bool limited = write_course(place, held ? 1.0 : intensity);
    if (!excess.empty()) {
        voice.fail(std::move(excess));
        return false;
    }
    voice.draft().at_ns = stamp;
    voice.record_movement(p, stamp);
    voice.publish();
    points.fetch_add(1, std::memory_order_relaxed);
    limited_points.fetch_add(limited ? 1 : 0, std::memory_order_relaxed);
    if (held)
        voice.count_held_point();
    if (!inside)
        voice.count_outside_point();
    return true;
}

// Writes the course to a place. If the model refuses the point, the stroke continues. After any other failure
// the amplitudes are unknown, so the stroke ends.
bool live_stroke::impl::write_course(point p, double intensity)
{
    const auto failed = [this](std::string_view what) {
        voice.fail(
            fmt::format("phantom model \"{}\" failed: {}", model->name(), what.substr(0, what.find('\n'))));
    };
    const model_call now(model_thread);
    excess.clear(); // may hold text about an earlier point that was refused
    try {
        return compute_course({p, intensity}, voice.draft());
    } catch (const error& e) {
        if (e.kind() != error_kind::bad_input)
            failed(e.what());
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        failed(e.what());
        throw;
    } catch (...) {
        failed("it threw");
        throw;
    }
}

bool live_stroke::impl::compute_course(const engine::smoothing::place& p, engine::live_course& course)
{
    course.start = voice.rendered();
    course.length = 0;
    course.knots = 1;
    const std::span<double> all(course.amplitudes);
    if (window == 0)
        return write_amplitudes(p.at, p.intensity, all);
    engine::smoothing next = smooth; // `smooth` stays unchanged if a model throws
    next.to(course.start, p);
    course.length = next.frames_to_target();
    if (course.length != 0)
        course.knots = most_knots;
    bool limited = false;
    const std::size_t channels = limits.size();
    // Starts at the last knot, which has the requested intensity, so that an error names that intensity.
    for (std::size_t k = course.knots; k-- > 0;) {
        const std::uint64_t after = course.knots == 1 ? 0 : course.length * k / (course.knots - 1);
        const auto mean = next.at(course.start + after);
        const point q = detail::clamp_to_array(faces, mean.at);
        const bool held = write_amplitudes(q, mean.intensity, all.subspan(k * channels, channels));
        limited = limited || held;
    }
    smooth = std::move(next);
    return limited;
}

bool live_stroke::impl::write_amplitudes(point p, double intensity, std::span<double> by_channel)
{
    const double most = scale.amplitude(intensity);
    detail::compute_drives(*model, faces, p, most, drives);
    std::fill(by_channel.begin(), by_channel.end(), 0.0);
    bool limited = false;
    for (const drive& d : drives) {
        const synth::tactor_level& t = levels[d.tactor];
        if (t.channel >= by_channel.size())
            continue;
        if (d.amplitude > most * (1.0 + 1e-9) && excess.empty())
            excess = fmt::format(
                "phantom model \"{}\" gave tactor {} amplitude {:.6g}, above the requested {:.6g}",
                model->name(), d.tactor, d.amplitude, most);
        const double wanted = t.gain * d.amplitude;
        const double limit = limits[t.channel];
        by_channel[t.channel] = std::clamp(wanted, -limit, limit);
        limited = limited || std::abs(wanted) > limit;
    }
    return limited;
}

live_stroke::live_stroke(std::shared_ptr<impl> p) noexcept : impl_(std::move(p))
{
}

stroke_id live_stroke::id() const noexcept
{
    return impl_->id;
}

bool live_stroke::to(double x_mm, double y_mm, double intensity, std::optional<monotonic_time> at)
{
    return impl_->to({x_mm, y_mm}, intensity, at ? std::optional(rt::to_ns(*at)) : std::nullopt);
}

void live_stroke::end() noexcept
{
    impl_->voice.request(engine::live_voice::action::end);
}

void live_stroke::cancel() noexcept
{
    impl_->voice.request(engine::live_voice::action::cancel);
}

bool live_stroke::open() const noexcept
{
    return !impl_->voice.closed() && impl_->voice.requested() == engine::live_voice::action::go_on;
}

live_counts live_stroke::counts() const noexcept
{
    return {.points = impl_->points.load(std::memory_order_relaxed),
            .outside = impl_->voice.outside_points(),
            .limited = impl_->limited_points.load(std::memory_order_relaxed),
            .held = impl_->voice.held_points()};
}

} // namespace v0
} // namespace tactor
