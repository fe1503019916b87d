// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <unistd.h>

#include "files/setup_text.hpp"
#include "python/binding.hpp"
#include "session/device.hpp"
#include "session/device_stream.hpp"
#include "session/live_remarks.hpp"

namespace tactor::python {
namespace {

using namespace py::literals;
using free_call = py::call_guard<without_lock>;

struct log_line {
    log_kind kind;
    std::string text;
};

using event = std::variant<stroke_report, log_line>;

/// Queue of a player's events for a Python thread. Threads of the player add events, and never wait for the
/// interpreter.
class event_queue {
public:
    void put(event e)
    {
        {
            const std::lock_guard lock(mutex_);
            if (std::holds_alternative<log_line>(e) && waiting_.size() >= most_waiting)
                return; // drops unread log lines; there are at most as many reports as strokes
            waiting_.push_back(std::move(e));
        }
        there_.notify_one();
    }

    /// Closes the queue: no more events are added. next() still returns the events that are waiting.
    void close()
    {
        {
            const std::lock_guard lock(mutex_);
            closed_ = true;
        }
        there_.notify_all();
    }

    /// Waits for the next event. Returns nothing if the queue is closed and empty.
    std::optional<event> next()
    {
        std::unique_lock lock(mutex_);
        there_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
        if (waiting_.empty())
            return {};
        event e = std::move(waiting_.front());
        waiting_.pop_front();
        return e;
    }

private:
    static constexpr std::size_t most_waiting = 4096;

    std::mutex mutex_;
    std::condition_variable there_;
    std::deque<event> waiting_;
    bool closed_ = false;
};

bool is_built_in(const array& a)
{
    return session::is_preset(array_presets(), a.name) &&
           detail::array_text(a) == detail::array_text(preset_array(a.name));
}

// Returns the configuration that applies, with array `a`, or with its own array if `a` is null. If `a` is a
// preset and the configuration's array has the same places, the configuration's array replaces it. If `s` has
// no rate or format, sets it from [defaults].
session::environment read_environment(session::settings& s, const array* a)
{
    session::environment e = session::read_environment(s);
    if (a == nullptr)
        return e;
    if (!s.array_name && is_built_in(*a)) {
        e.tactors = session::resolve_preset(*a, e);
        return e;
    }
    // The number of channels applies only to the channel map of the configuration's array.
    if (!std::ranges::equal(e.tactors.tactors, a->tactors, {}, &tactor_spec::channel, &tactor_spec::channel))
        e.config.output.channels.reset();
    e.tactors = *a;
    return e;
}

/// A player for Python. All functions may be called from any thread. In a forked process, those that use the
/// player throw errors, and the destructor does not touch objects of the parent.
class player_handle {
public:
    /// Opens the device. Values that `s` does not contain come from the configuration, otherwise they are
    /// defaults. `keep` is player_options::keep_drive_time. Call it without the interpreter's lock.
    /// \throws error.
    player_handle(const array& a, session::settings s, bool keep, bool wants_log)
    {
        const session::environment e = read_environment(s, &a);
        const render_options sound = session::find_render_options(s, e);
        alsa_options device = session::device_options(s, s.stream, e, sound.channels, sound.rate);
        const auto events = events_;
        if (wants_log)
            device.log = [events](log_kind k, std::string_view text) {
                events->put(log_line{k, std::string(text)});
            };
        session::prepare_server(device.pcm);
        const bool waits_for_edges = !s.stream.no_gpio && e.config.sync && e.config.sync->in;
        // Opens the lines before threads start, because this forks the process that holds the amplifier's
        // line.
        open_->lines = session::lent_lines(session::open_lines(s.stream, e, waits_for_edges));
        player_options o;
        o.limits = session::find_limits(s.stream, e);
        o.require_realtime = s.stream.require_realtime;
        o.keep_drive_time = keep;
        o.log = device.log;
        session::configure_realtime_kit(s.stream);
        open_->card.ask = !s.stream.no_desktop;
        open_->stream = std::make_unique<player>(session::open_device(device, e.tactors, open_->card),
                                                 e.tactors, o, open_->lines.lend());
        if (detail::array_text(e.tactors) != detail::array_text(a))
            configured_ = e.tactors;
        doubt_ = e.array_doubt;
        open_->stream->on_report([events](const stroke_report& r) { events->put(r); });
        setup_ = open_->stream->setup();
    }
    ~player_handle()
    {
        if (forked()) { // Leak the parent's objects: destroying them affects its device.
            static_cast<void>(open_.release());
            return;
        }
        // Releases the lock, because threads of the player may be waiting for it to destroy Python objects.
        std::optional<without_lock> free;
        if (PyGILState_Check() != 0)
            free.emplace();
        close();
    }
    player_handle(const player_handle&) = delete;
    player_handle& operator=(const player_handle&) = delete;

    const stream_setup& setup() const noexcept { return setup_; }
    /// Returns the configuration's array if it has replaced a preset.
    const std::optional<array>& configured() const noexcept { return configured_; }
    /// Returns a warning about the array, or "" if there is none.
    const std::string& doubt() const noexcept { return doubt_; }
    event_queue& events() noexcept { return *events_; }
    bool forked() const noexcept { return ::getpid() != owner_; }
    void refuse_child() const
    {
        if (forked())
            throw error(error_kind::runtime, "player",
                        "it belongs to the process that this one was forked from",
                        "open a player in this process, or play in the parent");
    }

    /// Calls `f` with the player. After the player has been closed, calls `g` instead.
    /// \throws error (runtime) in a forked process.
    template <class F, class G>
    auto use(F&& f, G&& once_closed) const
    {
        refuse_child();
        const std::shared_lock lock(open_->mutex);
        return open_->stream != nullptr ? f(*open_->stream) : once_closed();
    }

    /// Calls `f` with the player. \throws error (runtime) if the player has been closed, or in a forked
    /// process.
    template <class F>
    auto use(F&& f) const
    {
        return use(std::forward<F>(f), []() -> std::invoke_result_t<F, player&> {
            throw error(error_kind::runtime, "player", "it is closed", "open a new one");
        });
    }

    /// Return values of the player. After it has been closed, return the last values.
    /// \throws error in a forked process.
    player_stats stats() const
    {
        return use([](player& p) { return p.stats(); }, [this] { return open_->last_stats; });
    }
    std::optional<std::string> ended() const
    {
        return use(&end_reason, [this] { return open_->last_end; });
    }

    /// Returns player::drive_time_doubt(), or "" after the player has been closed.
    /// \throws error in a forked process.
    std::string drive_time_doubt() const
    {
        return use([](player& p) { return p.drive_time_doubt(); }, [] { return std::string(); });
    }

    /// Cancels a stroke. Returns false if the stroke has already ended, as all strokes have after the player
    /// has been closed.
    /// \throws error in a forked process.
    bool cancel(stroke_id id) const
    {
        return use([id](player& p) { return p.cancel(id); }, [] { return false; });
    }
    bool closed() const
    {
        return !forked() && use([](player&) { return false; }, [] { return true; });
    }

    /// Fades out, stops and closes the stream. All strokes have been reported when it returns. A second call
    /// does nothing.
    void close()
    {
        use([](player& p) { p.stop(); }, [] {});
        std::unique_ptr<player> ended;
        {
            const std::unique_lock lock(open_->mutex);
            ended = std::move(open_->stream);
            if (ended != nullptr) {
                open_->last_stats = ended->stats();
                open_->last_end = end_reason(*ended);
            }
        }
        ended.reset();
        {
            const std::unique_lock lock(open_->mutex);
            open_->lines = session::lent_lines();
            open_->card.reserved.reset();
        }
        events_->close();
    }

private:
    static std::optional<std::string> end_reason(const player& p)
    {
        const auto end = p.ended();
        return end ? std::optional(end->why) : std::nullopt;
    }

    // State that a forked process must neither use nor destroy.
    struct open_state {
        mutable std::shared_mutex mutex;
        session::lent_lines lines;
        session::card_claim card;
        std::unique_ptr<player> stream;
        player_stats last_stats; ///< this and the next member: values after the stream has been closed
        std::optional<std::string> last_end;
    };

    pid_t owner_ = ::getpid();
    stream_setup setup_;
    std::optional<array> configured_;
    std::string doubt_;
    std::shared_ptr<event_queue> events_ = std::make_shared<event_queue>();
    std::unique_ptr<open_state> open_ = std::make_unique<open_state>();
};

std::shared_ptr<player_handle> open(const std::shared_ptr<array_handle>& on, const std::string& pcm,
                                    const py::dict& options, const std::optional<std::string>& config,
                                    const std::optional<std::string>& array_file, bool wants_log, bool keep)
{
    session::settings s;
    s.place = options::in_player;
    s.pcm = pcm;
    s.config_file = config;
    s.array_name = array_file;
    set_player_options(s, options);
    const without_lock free;
    return std::make_shared<player_handle>(on->value(), std::move(s), keep, wants_log);
}

py::tuple report_tuple(const stroke_report& r)
{
    std::optional<double> started_s;
    if (r.started_ns)
        started_s = static_cast<double>(*r.started_ns) * 1e-9;
    return py::make_tuple(r.id.number, r.state, r.why, r.frames, started_s, r.late_s, r.delay, r.held_points,
                          r.outside_points, r.doubt);
}

py::object next_event(player_handle& h)
{
    std::optional<event> e;
    {
        const without_lock free;
        e = h.events().next();
    }
    if (!e)
        return py::none();
    if (const auto* r = std::get_if<stroke_report>(&*e))
        return report_tuple(*r);
    const auto& l = std::get<log_line>(*e);
    return py::make_tuple(l.kind, l.text);
}

monotonic_time to_time(double s)
{
    return monotonic_time(std::chrono::nanoseconds(std::llround(s * 1e9)));
}

std::uint32_t submit(const player_handle& h, const score& s, bool armed, std::optional<double> at_s,
                     std::optional<std::int64_t> frame)
{
    const start_at start = armed   ? start_at::trigger()
                           : at_s  ? start_at::time(to_time(*at_s))
                           : frame ? start_at::frame(*frame)
                                   : start_at::now();
    return h.use([&](player& p) { return p.submit(s, start).number; });
}

py::dict stats_dict(const player_handle& h)
{
    player_stats s;
    {
        const without_lock free;
        s = h.stats();
    }
    return py::dict("periods"_a = s.periods, "frames"_a = s.frames, "xruns"_a = s.xruns,
                    "limited_frames"_a = s.limited_frames, "power_limited_frames"_a = s.power_limited_frames,
                    "drives_cut"_a = s.drives_cut, "stalls"_a = s.stalls, "off_failures"_a = s.off_failures,
                    "left_on"_a = s.left_on, "sync_pulses"_a = s.sync_pulses, "sync_missed"_a = s.sync_missed,
                    "sync_mean_late_s"_a = s.sync_mean_late_s, "sync_worst_late_s"_a = s.sync_worst_late_s,
                    "ring_low_water"_a = s.ring_low_water, "latest_wakeup_s"_a = s.latest_wakeup_s,
                    "minor_faults"_a = s.minor_faults, "major_faults"_a = s.major_faults,
                    "realtime"_a = s.realtime, "xrun_s"_a = s.xrun_s);
}

py::dict setup_dict(const player_handle& h)
{
    const stream_setup& s = h.setup();
    return py::dict("name"_a = s.name, "channels"_a = s.channels,
                    "device_channels"_a = std::max(s.device_channels, s.channels), "rate"_a = s.rate,
                    "format"_a = s.format, "period_frames"_a = s.period_frames,
                    "buffer_frames"_a = s.buffer_frames, "batch"_a = s.batch, "has_clock"_a = s.has_clock);
}

py::dict position_dict(const player_handle& h)
{
    const player_position p = h.use([](player& q) { return q.position(); });
    py::dict d("running"_a = p.running, "played"_a = p.played, "stroke"_a = py::none(),
               "stroke_frame"_a = p.stroke_frame);
    if (p.stroke)
        d["stroke"] = p.stroke->number;
    return d;
}

// A live stroke and its player. In a forked process, the stroke must not be destroyed.
struct live_handle {
    live_handle(std::shared_ptr<player_handle> p, live_stroke s, double most)
        : of(std::move(p)),
          stroke(std::make_unique<live_stroke>(std::move(s))),
          intensity_max(most),
          remarks(most)
    {
    }
    ~live_handle()
    {
        if (of != nullptr && of->forked())
            static_cast<void>(stroke.release());
    }
    live_handle(live_handle&&) noexcept = default;
    live_handle& operator=(live_handle&&) = delete;

    /// Returns the live stroke. \throws error in a forked process.
    live_stroke& use() const
    {
        of->refuse_child();
        return *stroke;
    }

    std::shared_ptr<player_handle> of;
    std::unique_ptr<live_stroke> stroke;
    double intensity_max;
    session::live_remarks remarks; ///< used only with the interpreter's lock
};

live_handle begin(const std::shared_ptr<player_handle>& h, const array_handle& on, const py::dict& options,
                  double timeout_s, std::optional<double> longest_s, double smooth_s,
                  std::optional<double> most, const setup* file)
{
    option_values w;
    w.place = options::live;
    w.plan = live_options{}.plan;
    setup array_setup = file != nullptr ? *file : setup();
    std::erase_if(array_setup.defaults, [](const written_value& d) { // as in the tool
        return d.name == "algorithm" || d.name == "outside";
    });
    take_options(w, options, on.value().tactors.size(), &array_setup);
    if (w.plan.soa_s != plan_options{}.soa_s) // as plan() does, although a continuous stroke has no SOA
        static_cast<void>(burst_duration_s(w.plan));
    const double intensity_max = most ? *most : w.intensity_max.value_or(1.0);
    const without_lock free;
    return {h, h->use([&](player& p) {
                return p.begin({.plan = w.plan,
                                .render = w.render,
                                .timeout_s = timeout_s,
                                .longest_s = longest_s,
                                .smooth_s = smooth_s});
            }),
            intensity_max};
}

std::string devices(const array_handle* on, const std::optional<std::string>& array_file,
                    const std::optional<std::string>& pcm, std::optional<unsigned> rate,
                    const std::optional<std::string>& config)
{
    const without_lock free;
    session::settings s;
    s.pcm = pcm;
    s.rate = rate;
    s.config_file = config;
    s.array_name = array_file;
    const session::environment e = read_environment(s, on != nullptr ? &on->value() : nullptr);
    return session::devices_json(session::examine_devices(s, e));
}

void bind_live(py::module_& m)
{
    py::class_<live_handle>(m, "Live")
        .def_property_readonly("id", [](const live_handle& l) { return l.stroke->id().number; })
        .def(
            "to",
            [](const live_handle& l, double x, double y, double intensity, std::optional<double> at_s) {
                return l.use().to(x, y, intensity, at_s ? std::optional(to_time(*at_s)) : std::nullopt);
            },
            free_call())
        .def(
            "end", [](const live_handle& l) { l.use().end(); }, free_call())
        .def(
            "cancel", [](const live_handle& l) { l.use().cancel(); }, free_call())
        .def_property_readonly("intensity_max", [](const live_handle& l) { return l.intensity_max; })
        .def("remarks",
             [](live_handle& l, double x, double y, double intensity) {
                 return l.remarks.take(*l.stroke, {x, y}, intensity);
             })
        .def_property_readonly("open", [](const live_handle& l) { return l.stroke->open(); })
        .def("counts", [](const live_handle& l) {
            const live_counts c = l.stroke->counts();
            return py::dict("points"_a = c.points, "outside"_a = c.outside, "limited"_a = c.limited,
                            "held"_a = c.held);
        });
}

} // namespace

void bind_player(py::module_& m)
{
    m.def("devices", &devices);
    py::class_<player_handle, std::shared_ptr<player_handle>>(m, "Player")
        .def(py::init(&open))
        .def("next", &next_event)
        .def("submit", &submit, free_call())
        .def("live", &begin)
        .def(
            "cancel", [](const player_handle& h, std::uint32_t id) { return h.cancel(stroke_id{id}); },
            free_call())
        .def(
            "fire",
            [](const player_handle& h, double at_s) {
                return h.use([t = to_time(at_s)](player& p) { return p.fire(t); });
            },
            free_call())
        .def(
            "stop", [](const player_handle& h) { h.use([](player& p) { p.stop(); }); }, free_call())
        .def("ended", &player_handle::ended, free_call())
        .def("close", &player_handle::close, free_call())
        .def("refuse_child", &player_handle::refuse_child)
        .def_property_readonly("configured",
                               [](const player_handle& h) -> std::optional<array_handle> {
                                   return h.configured()
                                              ? std::optional<array_handle>(std::in_place, *h.configured())
                                              : std::nullopt;
                               })
        .def_property_readonly("doubt", &player_handle::doubt)
        .def_property_readonly("closed", &player_handle::closed)
        .def_property_readonly("forked", &player_handle::forked)
        .def("stats", &stats_dict)
        .def("setup", &setup_dict)
        .def("drive_time_doubt", &player_handle::drive_time_doubt)
        .def("position", &position_dict);
    bind_live(m);
}

} // namespace tactor::python
