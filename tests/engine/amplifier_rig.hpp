// SPDX-License-Identifier: MIT
/// \file
/// The engine without its threads, with an amplifier: logs in order what happens to the PCM and to the line.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <tactor/lines.hpp>

#include "engine/control/line_threads.hpp"
#include "rig.hpp"

namespace tactor::test {

using event_log = std::vector<std::string>;

/// Logs prepare, start and drop.
class logging_sink final : public forwarding_sink {
public:
    logging_sink(std::unique_ptr<sink> s, event_log& log) : forwarding_sink(std::move(s)), log_(log) {}

    io_kind prepare() noexcept override { return note("prepare", forwarding_sink::prepare()); }
    io_kind start() noexcept override { return note("start", forwarding_sink::start()); }
    void drop() noexcept override
    {
        log_.emplace_back("drop");
        forwarding_sink::drop();
    }

private:
    io_kind note(const char* what, io_kind s) noexcept
    {
        log_.emplace_back(s == io_kind::ok ? what : std::string(what) + " fails");
        return s;
    }
    event_log& log_;
};

/// Logs on and off. Can fail, and can go off by itself.
class logging_line final : public enable_line {
public:
    explicit logging_line(event_log& log) : log_(log) {}

    bool set(bool on) noexcept override
    {
        log_.emplace_back(on ? "on" : "off");
        if (!on && refusals > 0) {
            --refusals;
            return false;
        }
        is_on = on && works;
        return works || !on;
    }
    bool beat() noexcept override
    {
        ++beats;
        return is_on;
    }
    bool must_be_off() const noexcept override { return withheld; }

    bool works = true;     ///< on
    unsigned refusals = 0; ///< number of times that it stays on
    bool is_on = false;
    bool withheld = false;
    unsigned beats = 0;

private:
    event_log& log_;
};

inline constexpr std::int64_t ms = 1'000'000;

struct amplifier_rig : rig {
    explicit amplifier_rig(const rig_options& o = {}) : amplifier_rig(o, std::make_shared<event_log>()) {}

    /// Plays until strokes may sound.
    void warm_up()
    {
        for (int i = 0; i < 1000 && !link.amplifier.ready; ++i)
            play(options.period);
    }
    /// Lets time pass for the amplifier's thread only.
    void wait(std::int64_t ns)
    {
        for (const std::int64_t end = now + ns; now < end;) {
            now += 10 * ms;
            driver.update();
        }
    }
    /// Returns the log since the last call.
    event_log news() { return std::exchange(*log, {}); }

    std::shared_ptr<event_log> log;
    logging_line line{*log};
    engine::amplifier_driver driver;

private:
    amplifier_rig(rig_options o, const std::shared_ptr<event_log>& l)
        : rig(prepared(std::move(o), l)),
          log(l),
          driver(link, line, {.amplifier = {.proof_frames = 2 * options.period}}, [this] { return now; })
    {
        also_control = [this] { driver.update(); };
    }
    static rig_options prepared(rig_options o, const std::shared_ptr<event_log>& l)
    {
        o.loop.amplifier = true;
        o.wrap = [l](std::unique_ptr<sink> s) { return std::make_unique<logging_sink>(std::move(s), *l); };
        return o;
    }
};

/// A stroke that sounds, with the amplifier on.
struct playing : amplifier_rig {
    explicit playing(rig_options o = {}) : amplifier_rig(std::move(o))
    {
        warm_up();
        id = submit(tone(2.0));
        play(4800);
        CHECK(news() == event_log{"prepare", "start", "on"});
    }
    stroke_id id = {};
};

} // namespace tactor::test
