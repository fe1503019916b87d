// SPDX-License-Identifier: MIT
/// \file
/// The engine without its threads: a fake DAC, the audio loop and the feeder, stepped by hand.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <poll.h>

#include <doctest/doctest.h>

#include <tactor/sink.hpp>

#include "engine/audio/audio_loop.hpp"
#include "engine/control/feeder.hpp"
#include "engine/live.hpp"
#include "fake_dac.hpp"
#include "scores.hpp"
#include "sink/alsa/pcm_sink.hpp"

namespace tactor::test {

/// Another sink, of which a test changes single members.
class forwarding_sink : public sink {
public:
    explicit forwarding_sink(std::unique_ptr<sink> s) : inner_(std::move(s)) {}

    const stream_setup& setup() const noexcept override { return inner_->setup(); }
    io_kind prepare() noexcept override { return inner_->prepare(); }
    io_kind start() noexcept override { return inner_->start(); }
    io_kind resume() noexcept override { return inner_->resume(); }
    std::int64_t xrun_ns() noexcept override { return inner_->xrun_ns(); }
    std::size_t max_descriptors() const noexcept override { return inner_->max_descriptors(); }
    std::size_t descriptors(std::span<pollfd> f) noexcept override { return inner_->descriptors(f); }
    io_kind ready(std::span<pollfd> f) noexcept override { return inner_->ready(f); }
    io_result available() noexcept override { return inner_->available(); }
    io_result write(std::span<const std::byte> frames) noexcept override { return inner_->write(frames); }
    /// Writes the first n frames of those offered.
    io_result write_first(std::size_t n, std::span<const std::byte> frames) noexcept
    {
        return forwarding_sink::write(frames.first(n * setup().frame_bytes()));
    }
    stream_position position() noexcept override { return inner_->position(); }
    void drop() noexcept override { inner_->drop(); }

private:
    std::unique_ptr<sink> inner_;
};

/// Another sink, whose positions a test changes.
class position_sink final : public forwarding_sink {
public:
    using change = std::function<void(stream_position&)>;
    position_sink(std::unique_ptr<sink> s, change c) : forwarding_sink(std::move(s)), change_(std::move(c)) {}
    stream_position position() noexcept override
    {
        stream_position p = forwarding_sink::position();
        change_(p);
        return p;
    }

private:
    change change_;
};

struct rig_options {
    format_kind format = format_kind::s32;
    unsigned channels = 9;
    unsigned period = 96;
    unsigned periods = 3;
    unsigned sample_rate = rate;
    double limit = 1.0; ///< of each channel
    std::size_t ring = 2048;
    std::function<std::unique_ptr<sink>(std::unique_ptr<sink>)> wrap{};
    engine::loop_options loop{};
    fake_dac_options dac{};
    bool started = true;      ///< by the constructor
    std::int64_t slow_ns = 0; ///< time that each period takes beyond its frames
};

class rig {
public:
    explicit rig(const rig_options& o = {})
        : dac(o.dac),
          out(alsa::adopt(dac.pcm(), {.pcm = "fake",
                                      .channels = o.channels,
                                      .rate = o.sample_rate,
                                      .format = o.format,
                                      .period_frames = o.period,
                                      .periods = o.periods,
                                      .config_text = {}})),
          link(o.ring),
          feed(link, o.loop.horizon_frames),
          limits(o.channels, o.limit),
          loop(wrapped(o), link, limits, o.loop),
          options(o)
    {
        if (o.started)
            REQUIRE(start().status == io_kind::ok);
    }

    io_result start() { return loop.start(now); }

    stroke_id next_id() { return {++last_id}; }
    stroke_id last() const { return {last_id}; }

    /// Submits a live stroke.
    std::shared_ptr<live_stroke::impl> begin_live(const array& a, const live_options& o)
    {
        auto s = std::make_shared<live_stroke::impl>(next_id(), a, layout(a), out->setup(), o);
        feed.submit(last(), std::shared_ptr<engine::live_voice>(s, &s->voice));
        return s;
    }

    stroke_id submit(const score& s, std::uint64_t frame) { return submit(s, start_at::frame(frame)); }
    stroke_id submit(const score& s, start_at at = start_at::now())
    {
        feed.submit(next_id(), s, at);
        feed.pump(status().written, link.clock.load());
        return last();
    }

    engine::stream_status status() { return link.status.load(); }

    /// Does a wake-up of the audio thread: poll, step.
    void step()
    {
        io_kind ready = io_kind::again;
        if (loop.polls_sink()) {
            std::array<pollfd, 4> fds{};
            const std::size_t n = out->descriptors(fds);
            ::poll(fds.data(), n, 0);
            ready = out->ready(std::span(fds).first(n));
        }
        now += static_cast<std::int64_t>(1e9 * options.period / options.sample_rate) + options.slow_ns;
        loop.step(ready, now);
    }

    /// Does a wake-up of the control thread.
    void control()
    {
        engine::report r;
        while (link.reports.pop(r))
            feed.handle(r);
        for (const stroke_report& e : std::exchange(feed.reports(), {}))
            ended[e.id].push_back(e);
        feed.beginnings().clear();
        feed.pump(status().written, link.clock.load());
        if (also_control)
            also_control();
    }

    /// Plays so many frames, a period at a time; both threads do their work.
    void play(std::uint64_t frames)
    {
        for (std::uint64_t n = 0; n < frames && !loop.over(); n += options.period) {
            dac.advance_queued(options.period);
            step();
            control();
        }
    }

    /// Asks for the end of the stream, as stop() or the destructor of a player does.
    void stop(bool closing = false)
    {
        if (closing)
            feed.set_closing();
        link.requests.push({.what = engine::request::kind::stop, .closing = closing});
    }

    /// Lets the DAC run dry, and both threads notice.
    void xrun()
    {
        dac.advance(1000);
        step();
        control();
    }

    /// Steps both threads until the stream is over, or that often; the DAC stands still. Returns how long
    /// that took, ns.
    std::int64_t run_until_over(int steps)
    {
        const std::int64_t begun = now;
        for (int i = 0; i < steps && !loop.over(); ++i) {
            step();
            control();
        }
        return now - begun;
    }

    /// Plays until all strokes have ended; gives up after a while.
    void play_out()
    {
        for (int i = 0; i < 100'000 && ended.size() < last_id && !loop.over(); ++i)
            play(options.period);
    }
    /// Does the same and returns this stroke's only report; fails without one.
    stroke_report play_out(stroke_id id)
    {
        play_out();
        return end(id);
    }

    /// Returns the only report of a stroke, if there is exactly one.
    std::optional<stroke_report> report(stroke_id id) const
    {
        const auto found = ended.find(id);
        if (found == ended.end() || found->second.size() != 1)
            return std::nullopt;
        return found->second.front();
    }

    /// Returns the only report of a stroke; fails without one.
    stroke_report end(stroke_id id) const
    {
        const auto r = report(id);
        REQUIRE(r);
        return *r;
    }

    /// Returns frames captured from `from` on; zeros beyond the end.
    std::vector<std::byte> captured(std::uint64_t from, std::uint64_t frames) const
    {
        std::vector<std::byte> part = dac.captured(from);
        part.resize(frames * dac.frame_bytes());
        return part;
    }

    /// Returns the samples of a channel from a frame on, of format s32.
    std::vector<double> channel(unsigned c, std::uint64_t from = 0) const
    {
        const std::vector<std::byte> all = dac.captured(from);
        std::vector<double> samples;
        for (std::size_t f = 0; f < all.size() / dac.frame_bytes(); ++f) {
            std::int32_t v = 0;
            std::memcpy(&v, &all[f * dac.frame_bytes() + 4 * c], 4);
            samples.push_back(v / 2147483648.0);
        }
        return samples;
    }

    /// Returns the first captured frame that is not silent; none if all are.
    std::optional<std::uint64_t> first_sound(std::uint64_t from = 0) const
    {
        const std::vector<std::byte> all = dac.captured(from);
        const auto found =
            std::find_if(all.begin(), all.end(), [](std::byte b) { return b != std::byte{0}; });
        if (found == all.end())
            return std::nullopt;
        return from + static_cast<std::uint64_t>(found - all.begin()) / dac.frame_bytes();
    }

    sink& wrapped(const rig_options& o)
    {
        out =
            std::make_unique<position_sink>(std::move(out), [this](stream_position& p) { p.time_ns = now; });
        if (o.wrap)
            out = o.wrap(std::move(out));
        return *out;
    }

    std::int64_t now = 1'000'000'000'000;
    fake_dac dac;
    std::unique_ptr<sink> out;
    engine::link link;
    engine::feeder feed;
    std::vector<double> limits;
    engine::audio_loop loop;
    rig_options options;
    std::uint32_t last_id = 0;
    std::function<void()> also_control{}; ///< called at the end of control()
    std::map<stroke_id, std::vector<stroke_report>> ended;
};

inline double peak(const std::vector<double>& s, std::size_t from = 0, std::size_t to = SIZE_MAX)
{
    double most = 0.0;
    for (std::size_t i = from; i < std::min(to, s.size()); ++i)
        most = std::max(most, std::abs(s[i]));
    return most;
}

inline double largest_step(const std::vector<double>& s)
{
    double most = 0.0;
    for (std::size_t i = 1; i < s.size(); ++i)
        most = std::max(most, std::abs(s[i] - s[i - 1]));
    return most;
}

inline const double live_level = std::pow(10.0, -12.0 / 20.0);

/// A rig with one live stroke.
class live_rig : public rig {
public:
    explicit live_rig(const live_options& o = {}, const rig_options& r = {}) : rig(r) { live = add(o); }

    std::shared_ptr<live_stroke::impl> add(const live_options& o = {})
    {
        const array a = palm();
        auto s = begin_live(a, o);
        feed.pump(status().written, link.clock.load());
        return s;
    }

    /// Returns the rig's stroke and new ones, n in all.
    std::vector<std::shared_ptr<live_stroke::impl>> fill(std::size_t n, const live_options& o = {})
    {
        std::vector<std::shared_ptr<live_stroke::impl>> all{live};
        while (all.size() < n)
            all.push_back(add(o));
        return all;
    }

    /// Ends the rig's stroke, or another, and plays it out.
    stroke_report finish(engine::live_voice::action w = engine::live_voice::action::end)
    {
        return finish(*live, w);
    }
    stroke_report finish(live_stroke::impl& s, engine::live_voice::action w = engine::live_voice::action::end)
    {
        s.voice.request(w);
        play_out();
        return end(s.id);
    }

    std::shared_ptr<live_stroke::impl> live;
};

inline live_options bursts()
{
    live_options o;
    o.plan.algorithm = algorithm_kind::park2016;
    return o;
}

} // namespace tactor::test
