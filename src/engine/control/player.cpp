// SPDX-License-Identifier: MIT
#include <tactor/player.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/version.hpp>

#include "core/access.hpp"
#include "core/kind_names.hpp"
#include "core/log.hpp"
#include "core/refused.hpp"
#include "core/words.hpp"
#include "engine/control/player_impl.hpp"
#include "engine/live.hpp"
#include "rt/clock.hpp"
#include "rt/thread.hpp"
#include "synth/score/levels.hpp"
#include "synth/score/score.hpp"

namespace tactor {
inline namespace v0 {

TACTOR_KIND_NAMES(start_kind, "start", {frame, "frame"}, {time, "time"}, {trigger, "trigger"});
TACTOR_KIND_NAMES(state_kind, "state", {finished, "finished"}, {cancelled, "cancelled"},
                  {interrupted, "interrupted"});
TACTOR_KIND_NAMES(reason_kind, "reason", {none, "none"}, {xrun, "xrun"}, {suspended, "suspended"},
                  {lost, "lost"}, {failed, "failed"}, {late, "late"}, {crowded, "crowded"},
                  {closed, "closed"}, {starved, "starved"}, {too_long, "too-long"}, {muted, "muted"},
                  {amplifier, "amplifier"}, {left_on, "left-on"}, {plan, "plan"}, {handler, "handler"});
TACTOR_KIND_NAMES(wait_kind, "wait", {ended, "ended"}, {timeout, "timeout"}, {taken, "taken"},
                  {unknown, "unknown"});

namespace {

// Converts a time to frames. Throws error for NaN and for times outside 0 to 600 s.
std::uint32_t to_frames(double seconds, unsigned rate, const char* name)
{
    if (!(seconds >= 0.0 && seconds <= 600.0))
        throw detail::bad_field(name, fmt::format("{} s", seconds), "give 0 to 600 s");
    return static_cast<std::uint32_t>(std::lround(seconds * rate));
}

std::int64_t to_ns(double seconds, const char* name)
{
    return std::int64_t{to_frames(seconds, 1'000'000, name)} * 1000;
}

// Returns the horizon, which is at least as long as drives need to come in time.
std::uint64_t horizon_frames(const player_options& o, const stream_setup& s)
{
    const std::uint64_t least = 2 * std::uint64_t{s.buffer_frames} + 4 * std::uint64_t{s.period_frames};
    return std::max<std::uint64_t>(to_frames(o.horizon_s, s.rate, "horizon_s"), least);
}

engine::loop_options loop_options(const player_options& o, std::vector<double> driven_s,
                                  bool counts_for_others, const stream_setup& s, bool amplifier)
{
    engine::loop_options l;
    l.fade_frames = to_frames(o.fade_s, s.rate, "fade_s");
    l.horizon_frames = horizon_frames(o, s);
    // The timeout grows with the period.
    const std::int64_t periods = 16LL * s.period_frames * 1'000'000'000 / s.rate;
    l.stall_ns = std::max(periods, to_ns(o.stall_s, "stall_s"));
    l.amplifier = amplifier;
    l.guards = synth::make_guards(o.limits, s.rate);
    if (counts_for_others && l.guards.drive_frames == 0.0)
        l.guards.drive_frames = std::numeric_limits<double>::infinity();
    l.driven_s = std::move(driven_s);
    return l;
}

// Returns a stream's setup, without the name of its device if drive time is not kept.
stream_setup make_book_setup(const player_options& o, stream_setup s)
{
    if (!o.keep_drive_time)
        s.device.clear();
    return s;
}

// Returns the options of a thread. `higher`: difference from the audio thread's SCHED_FIFO priority.
rt::thread_options thread_options(const player_options& o, const char* name, int higher, bool audio)
{
    return {.name = name,
            .fifo = o.realtime || o.require_realtime,
            .priority = std::clamp(std::clamp(o.priority, 1, 99) + higher, 1, 99),
            .audio = audio};
}

engine::driver_options driver_options(const player_lines& l, const stream_setup& s)
{
    const std::int64_t four_periods = 4LL * s.period_frames * 1'000'000'000 / s.rate;
    engine::driver_options d;
    d.amplifier.settle_ns = to_ns(l.settle_s, "settle_s");
    d.amplifier.proof_frames =
        std::max<std::uint64_t>(2ULL * s.period_frames, to_frames(l.proof_s, s.rate, "proof_s"));
    d.watchdog_ns = std::max(d.watchdog_ns, four_periods);
    return d;
}

// Checks the lines before there are threads that an error would have to stop.
player_lines require_valid(player_lines l, unsigned rate)
{
    to_frames(l.trigger_delay_s, rate, "trigger_delay_s");
    to_frames(l.settle_s, rate, "settle_s");
    to_frames(l.proof_s, rate, "proof_s");
    to_frames(l.pulse_s, rate, "pulse_s");
    return l;
}

float to_gain(double level_db)
{
    if (!(level_db >= player::least_level_db && level_db <= 0.0))
        throw error(error_kind::bad_input, "level_db", fmt::format("{} dB is out of range", level_db),
                    fmt::format("give {} to 0 dB", player::least_level_db));
    return static_cast<float>(std::pow(10.0, level_db / 20.0));
}

// Returns the end of a timeout, but at most a century from now, so that the clock cannot overflow.
monotonic_time deadline(std::chrono::duration<double> timeout)
{
    constexpr double century_s = 100.0 * 365.0 * 86400.0;
    const double wait_s = timeout.count() > 0.0 ? std::min(timeout.count(), century_s) : 0.0;
    return std::chrono::steady_clock::now() + std::chrono::nanoseconds(std::llround(wait_s * 1e9));
}

// Throws error if the stream did not start, or if a required real-time priority was refused.
void check_start(const engine::audio_thread& audio, const std::string& stream, const player_options& o)
{
    const io_result& r = audio.started();
    if (r.status == io_kind::lost)
        detail::throw_with_cause(
            error(error_kind::not_available, stream, "the device is gone", "plug it in again"), -r.code);
    if (r.status != io_kind::ok)
        detail::throw_with_cause(
            error(error_kind::runtime, stream,
                  fmt::format("it does not start ({})", engine::text(reason_kind::failed, r.code)),
                  "try another PCM, or a longer period"),
            -r.code);
    if (o.require_realtime && audio.fifo_error() != 0)
        detail::throw_with_cause(error(error_kind::not_available, "real-time priority",
                                       std::error_code(audio.fifo_error(), std::generic_category()).message(),
                                       rt::realtime_hint(probe_realtime_rights(), o.priority)),
                                 audio.fifo_error());
}

// Returns the sink.
// \throws error (bad_input) for null, and for a setup() without frames.
std::unique_ptr<sink> require_valid(std::unique_ptr<sink> s)
{
    if (s == nullptr)
        throw error(error_kind::bad_input, "player", "the sink is missing", "open one with open_alsa()");
    const stream_setup& setup = s->setup();
    if (setup.rate == 0 || setup.channels == 0 || setup.period_frames == 0 ||
        setup.buffer_frames < setup.period_frames)
        throw error(error_kind::bad_input, "player",
                    fmt::format("its sink has {} at {} Hz, {} a period and {} in its buffer",
                                counted(setup.channels, "channel"), setup.rate,
                                counted(setup.period_frames, "frame"), setup.buffer_frames),
                    "let setup() give numbers above 0, and a buffer of one period or more");
    return s;
}

constexpr const char* replan = "plan the stroke for the player's array";

void check_tactor(const score::impl& s, std::size_t i, std::span<const double> limits)
{
    constexpr double rounding = 1.0 + 1e-6;
    const std::uint32_t channel = s.tactors[i].channel;
    const double limit = limits[channel];
    if (limit == 0.0)
        throw error(
            error_kind::bad_input, "stroke",
            fmt::format("it drives tactor {} on channel {}, but the player's array has no tactor there", i,
                        channel),
            replan);
    if (s.peaks[i] > limit * rounding)
        throw error(error_kind::bad_input, "stroke",
                    fmt::format("it drives tactor {} at up to {:.4g} dBFS, but the player's array allows "
                                "{:.4g} dBFS on channel {}",
                                i, synth::in_db(s.peaks[i]), synth::in_db(limit), channel),
                    replan);
}

// Returns the array.
// \throws error: bad_input for a tactor on a channel that the stream does not have, not_available for a
//         tactor that shares its channel of the device.
const array& require_valid(const array& a, const stream_setup& s)
{
    validate(a);
    for (std::size_t i = 0; i < a.tactors.size(); ++i)
        if (a.tactors[i].channel >= s.channels)
            throw error(error_kind::bad_input, "player",
                        fmt::format("tactor {} of {} is on channel {}, but the stream has {} channel{}", i,
                                    a.name, a.tactors[i].channel, s.channels, s.channels == 1 ? "" : "s"),
                        fmt::format("open the stream with {} or more: they count from 0",
                                    counted(a.channels(), "channel")));
    if (const std::string lost = lost_tactor(a, s.wiring); !lost.empty())
        throw error(
            error_kind::not_available, fmt::format("stream on \"{}\"", s.name), lost,
            "in the PCM's ttable or bindings, route each channel to its own channel of the device with "
            "coefficient 1, or use {device=hw:CARD=NAME} to play on the card itself");
    return a;
}

// Checks that a score fits the player. `limits`: levels that the player's array allows, by channel of the
// stream; 0: no tactor.
// \throws error (bad_input) for a score that has another rate or number of channels, drives a channel without
// a tactor, drives a tactor beyond its limit, or has its marker on a tactor's channel.
void check_fit(const score& s, const stream_setup& stream, std::span<const double> limits)
{
    if (s.rate() != stream.rate || s.channels() != stream.channels)
        throw error(
            error_kind::bad_input, "stroke",
            fmt::format("it was made for {} at {} Hz, but the stream has {} at {} Hz",
                        counted(s.channels(), "channel"), s.rate(), stream.channels, stream.rate),
            "render the stroke with the stream's rate and channels, or open the stream with the score's")
            .with_field(s.channels() == stream.channels ? "rate"
                        : s.rate() == stream.rate       ? "channels"
                                                        : "");
    const score::impl& made = detail::access::of(s);
    for (std::size_t i = 0; i < made.peaks.size(); ++i)
        if (made.peaks[i] > 0.0)
            check_tactor(made, i, limits);
    if (made.marker && limits[*made.marker] > 0.0)
        throw error(error_kind::bad_input, "stroke",
                    fmt::format("its marker is on channel {}, but the player's array has a tactor there",
                                *made.marker),
                    "choose a spare channel for the marker")
            .with_field("marker_channel");
    const bool has_own = made.sounds.size() > made.plans.size();
    for (std::size_t i = 0; has_own && i < made.list.items.size(); ++i) {
        const synth::item& it = made.list.items[i];
        if (it.kind == synth::item_kind::own && made.limits[it.tactor] == 0.0 && limits[it.tactor] > 0.0)
            throw error(
                error_kind::bad_input, "samples",
                fmt::format(
                    "channel {} drives a tactor in the player's array, but none in the samples' array",
                    it.tactor),
                "make the score for the array that the player was opened with");
    }
}

} // namespace

void start_at::refuse_frame(long long stream_frame)
{
    throw error(error_kind::bad_input, "start", fmt::format("frame {} is before the stream", stream_frame),
                "give 0 or more, or use start_at::now()")
        .with_field("start");
}

player::player(std::unique_ptr<sink> s, const array& a, const player_options& o, player_lines lines)
try : impl_(std::make_shared<impl>(std::move(s), a, o, std::move(lines))) {
    impl_->start(o);
} catch (const error&) {
    throw;
} catch (const std::system_error& e) {
    detail::throw_resource_error("player", e.code().value(), e.what());
}

player::~player()
{
    impl_->close();
}

const stream_setup& player::setup() const noexcept
{
    return impl_->made;
}

stroke_id player::submit(const score& s, start_at start, double level_db)
{
    const float gain = to_gain(level_db);
    check_fit(s, impl_->out->setup(), impl_->limits);
    const std::lock_guard lock(impl_->mutex);
    impl_->check_open();
    const stroke_id id = impl_->next_id();
    impl_->feed.submit(id, s, start, gain);
    impl_->pump(); // if memory runs out here, the control thread does it later
    return id;
}

bool player::set_level(stroke_id id, double db)
{
    const float gain = to_gain(db);
    const std::lock_guard lock(impl_->mutex);
    if (!impl_->feed.set_gain(id, gain))
        return false;
    impl_->link.to_audio.signal();
    return true;
}

std::optional<std::uint64_t> player::first_frame(stroke_id id) const
{
    const std::lock_guard lock(impl_->mutex);
    return impl_->feed.find_first_frame(id);
}

std::size_t player::fire(monotonic_time t)
{
    return impl_->fire(rt::to_ns(t));
}

live_stroke player::begin(const live_options& o)
{
    const stream_setup& setup =
        impl_->out->setup(); // not under the lock, because a sink may be the program's own
    const std::unique_lock lock(impl_->mutex);
    impl_->check_open();
    if (!impl_->faces)
        impl_->faces.emplace(impl_->tactors);
    const stroke_id id = impl_->next_id();
    auto stroke = std::make_shared<live_stroke::impl>(id, impl_->tactors, *impl_->faces, setup, o);
    impl_->feed.submit(id, std::shared_ptr<engine::live_voice>(stroke, &stroke->voice));
    impl_->pump();
    return detail::access::make<live_stroke>(std::move(stroke));
}

bool player::on_end(stroke_id id, std::function<void(const stroke_report&)> done)
{
    if (!done)
        throw error(error_kind::bad_input, "on_end", "there is no function to call", "give a function");
    std::unique_lock lock(impl_->mutex);
    const auto found = impl_->find_report(id);
    if (found == impl_->ended.end()) {
        if (!impl_->feed.knows(id))
            return false;
        impl_->watchers.emplace(id, std::move(done));
        return true;
    }
    const stroke_report r = *found;
    lock.unlock();
    done(r);
    return true;
}

bool player::cancel(stroke_id id)
{
    const std::lock_guard lock(impl_->mutex);
    const bool known = impl_->feed.cancel(id);
    if (known) {
        impl_->link.to_audio.signal();
        impl_->link.to_control.signal(); // a stroke that had not been handed over is reported at once
    }
    return known;
}

bool player::cancel_all()
{
    const std::lock_guard lock(impl_->mutex);
    // A buffer longer than longest_stop_ns delays a fade too much. Ending the stream cuts what is in the
    // buffer.
    if (impl_->made.buffer_frames * rt::ns_per_s > engine::longest_stop_ns * impl_->made.rate)
        impl_->end_stream(false);
    if (impl_->stopping || impl_->feed.stream_over())
        return false;
    impl_->feed.cancel_all(impl_->last_id);
    impl_->link.to_audio.signal();
    impl_->link.to_control.signal();
    return true;
}

wait_result player::wait(stroke_id id, std::optional<std::chrono::duration<double>> timeout)
{
    impl& p = *impl_;
    std::unique_lock lock(p.mutex);
    const auto is_over = [&] { return p.find_report(id) != p.ended.end() || !p.feed.knows(id); };
    // The control thread would wait for itself.
    if (!p.control->is_current()) {
        if (timeout)
            p.news.wait_until(lock, deadline(*timeout), is_over);
        else
            p.news.wait(lock, is_over);
    }
    const auto found = p.find_report(id);
    if (found != p.ended.end()) {
        wait_result r(std::move(*found));
        p.ended.erase(found);
        return r;
    }
    if (p.feed.knows(id))
        return wait_kind::timeout;
    return id != stroke_id{} && id <= p.last_id ? wait_kind::taken : wait_kind::unknown;
}

void player::on_report(std::function<void(const stroke_report&)> handler)
{
    auto shared = handler ? std::make_shared<const impl::report_handler>(std::move(handler)) : nullptr;
    const std::lock_guard lock(impl_->mutex);
    impl_->handler.swap(shared); // the old handler is destroyed without the lock: it may call the player
}

void player::on_begin(std::function<void(stroke_id, std::optional<std::int64_t>)> handler)
{
    auto shared = handler ? std::make_shared<const impl::begin_handler>(std::move(handler)) : nullptr;
    const std::lock_guard lock(impl_->mutex);
    impl_->on_begun.swap(shared); // the old handler is destroyed without the lock, as above
}

void player::stop()
{
    impl_->stop(false);
}

std::optional<stream_end> player::ended() const
{
    const std::lock_guard lock(impl_->mutex);
    if (!impl_->feed.stream_over())
        return std::nullopt;
    return impl_->end();
}

player_position player::position() const noexcept
{
    const std::lock_guard lock(impl_->mutex);
    const engine::stream_status s = impl_->link.status.load();
    player_position p{.running = s.running, .played = s.played, .stroke = {}, .stroke_frame = s.stroke_frame};
    if (s.sounding)
        p.stroke = s.stroke;
    return p;
}

std::vector<double> player::drive_levels_s() const
{
    return impl_->drive_levels_s;
}

std::string player::drive_time_doubt() const
{
    return impl_->book.doubt();
}

player_stats player::stats() const
{
    const engine::counters& c = impl_->link.count;
    const auto get = [](const std::atomic<std::uint64_t>& a) { return a.load(std::memory_order_relaxed); };
    const std::uint64_t low = get(c.low_water);
    engine::pulse_stats pulses;
    if (impl_->pulses != nullptr) {
        const std::lock_guard lock(impl_->mutex);
        pulses = impl_->pulses->stats();
    }
    const std::uint64_t xruns = c.xruns.load(std::memory_order_acquire);
    std::vector<double> lengths;
    for (std::uint64_t n = xruns - std::min<std::uint64_t>(xruns, c.xrun_ns.size()); n < xruns; ++n)
        lengths.push_back(
            static_cast<double>(c.xrun_ns[n % c.xrun_ns.size()].load(std::memory_order_relaxed)) / 1e9);
    return {.periods = get(c.periods),
            .frames = get(c.frames),
            .xruns = xruns,
            .limited_frames = get(c.limited),
            .power_limited_frames = get(c.power_limited),
            .drives_cut = get(c.drives_cut),
            .stalls = get(c.stalls),
            .off_failures = get(c.off_failures),
            .left_on = impl_->link.amplifier.stuck.load(std::memory_order_relaxed) &&
                       !impl_->link.amplifier.off.load(std::memory_order_relaxed),
            .sync_pulses = pulses.sent,
            .sync_missed = pulses.missed,
            .sync_mean_late_s = pulses.mean_late_s,
            .sync_worst_late_s = pulses.worst_late_s,
            .ring_low_water = low == UINT64_MAX ? 0 : low,
            .latest_wakeup_s = static_cast<double>(get(c.late_frames)) / impl_->made.rate,
            .minor_faults = get(c.minor_faults),
            .major_faults = get(c.major_faults),
            .realtime =
                impl_->audio.fifo_error() == 0 && !c.realtime_given_up.load(std::memory_order_relaxed),
            .xrun_s = std::move(lengths)};
}

player::impl::impl(std::unique_ptr<sink> s, const array& a, const player_options& o, player_lines l)
    : out(require_valid(std::move(s))),
      stream(fmt::format("stream on \"{}\"", out->setup().name)),
      lines(require_valid(std::move(l), out->setup().rate)),
      feed(link, horizon_frames(o, out->setup())),
      tactors(require_valid(a, out->setup())),
      limits(synth::channel_limits(a, out->setup().channels)),
      log(o.log, link, o.limits),
      book(make_book_setup(o, out->setup()), synth::make_guards(o.limits, out->setup().rate)),
      drive_levels_s(book.has_device() ? book.levels() : std::vector<double>{}),
      loop(*out, link, limits,
           loop_options(o, drive_levels_s, book.has_device(), out->setup(), lines.amplifier != nullptr)),
      audio(loop, *out, link, thread_options(o, "tactor-audio", 0, true))
{
}

void player::impl::start(const player_options& o)
{
    try {
        check_start(audio, stream, o);
        made = out->setup();
        detail::log(log.function(), log_kind::info, "{} runs: {} at {} Hz, {} of {} frames{}", stream,
                    counted(made.channels, "channel"), made.rate, made.buffer_frames / made.period_frames,
                    made.period_frames, made.has_clock ? "" : ", timed by tactor");
        for (const std::string& odd : wiring_warnings(tactors, made.wiring))
            detail::log(log.function(), log_kind::warning, "{}: {}", stream, odd);
        if (const std::string doubt = book.doubt(); !doubt.empty())
            detail::log(log.function(), log_kind::warning, "{}: {}", stream, doubt);
        if (const int refused = audio.fifo_error(); refused == 0)
            detail::log(log.function(), log_kind::info, "the audio thread has real-time priority");
        else if (refused > 0)
            detail::log(log.function(), log_kind::warning, "the audio thread has no real-time priority: {}",
                        std::error_code(refused, std::generic_category()).message());
        // The amplifier's thread has a lower priority than the audio thread, which it watches, but still a
        // high one, because the line's holder waits for only 150 ms.
        if (lines.amplifier != nullptr)
            amplifier = std::make_unique<engine::amplifier_thread>(
                link, *lines.amplifier, driver_options(lines, out->setup()),
                thread_options(o, "tactor-amp", -5, false));
        // The pulse thread has a higher priority: it sleeps nearly always, and its work takes microseconds.
        if (lines.sync_out != nullptr) {
            pulses = std::make_unique<engine::trigger_thread>(link, *lines.sync_out,
                                                              to_ns(lines.pulse_s, "pulse_s"),
                                                              thread_options(o, "tactor-sync", 1, true));
            feed.set_trigger_thread(*pulses);
        }
        control = std::make_unique<control_thread>(*this);
        if (lines.trigger != nullptr)
            listen();
    } catch (...) {
        link.requests.push({.what = engine::request::kind::stop, .closing = true});
        link.to_audio.signal();
        audio.join();
        control.reset();
        amplifier.reset();
        throw;
    }
}

void player::impl::listen()
{
    const int fd = lines.trigger->descriptor();
    if (const int code = ::fcntl(fd, F_GETFD) < 0 ? errno : 0; code != 0)
        detail::throw_with_cause(
            error(error_kind::bad_input, "trigger",
                  fmt::format("its descriptor {}: {}", fd, std::generic_category().message(code)),
                  "keep edge_input::descriptor() open as long as the input lives"),
            code);
    control->watch(fd);
}

} // namespace v0
} // namespace tactor
