// SPDX-License-Identifier: MIT
// Calls that throw: a player, its live strokes, and the drive history for the next player.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <tactor/live.hpp>
#include <tactor/player.hpp>

#include "clock_runner.hpp"
#include "exhaustion_calls.hpp"
#include "player_support.hpp"
#include "sink/alsa/adopt.hpp"

namespace tactor::test {
namespace {

// Things made anew before each call.
struct fresh {
    std::unique_ptr<fake_dac> dac = {};
    std::unique_ptr<running_clock> clock = {};
    std::unique_ptr<sink> out = {};
    std::unique_ptr<clocked_player> open = {};

    void make_sink()
    {
        out.reset();
        clock.reset();
        dac = std::make_unique<fake_dac>();
        clock = std::make_unique<running_clock>(*dac);
        out = alsa::adopt(dac->pcm(), nine());
    }
    void make_player()
    {
        open.reset();
        open = std::make_unique<clocked_player>();
    }
};

live_options soon_over()
{
    return {.timeout_s = 0.001};
}

} // namespace

struct player_things {
    clocked_player open{};
    fresh anew = {};
    score s = tone(0.001);
    stroke_id id = {};
    std::optional<live_stroke> live = {};
};

std::shared_ptr<player_things> make_player_things()
{
    return std::make_shared<player_things>();
}

call_table player_calls(player_things& t)
{
    using enum call_kind;
    player& p = t.open;
    const auto submitted = [&t, &p] { t.id = p.submit(t.s); };
    const auto armed = [&t, &p] { t.id = p.submit(t.s, start_at::trigger()); };
    const auto begun = [&t, &p] {
        if (t.live)
            t.live->cancel();
        t.live.emplace(p.begin({.timeout_s = 86400.0}));
    };
    const auto stopped = [&t] {
        t.anew.make_player();
        t.anew.open->stop();
    };
    return {
        {"player::player", [&t] { const player made(std::move(t.anew.out), palm(), patient()); }, opens,
         [&t] { t.anew.make_sink(); }},
        {"player::submit", [&t, &p] { return p.submit(t.s); }},
        {"player::submit, from a frame on", [&t, &p] { return p.submit(t.s, start_at::frame(0)); }},
        {"player::submit, from a time on", [&t, &p] { return p.submit(t.s, start_at::time(0)); }},
        {"player::submit, when triggered", [&t, &p] { return p.submit(t.s, start_at::trigger()); }},
        {"player::submit, to a stream that has ended", [&t] { return t.anew.open->submit(t.s); }, plain,
         stopped},
        {"player::fire", [&p] { return p.fire(0); }, plain, armed},
        {"player::begin", [&p] { return p.begin(soon_over()); }},
        {"player::begin, of bursts",
         [&p] {
             live_options o = soon_over();
             o.plan.algorithm = algorithm_kind::park2016;
             return p.begin(o);
         }},
        {"player::cancel", [&t, &p] { return p.cancel(t.id); }, plain, armed},
        {"player::set_level", [&t, &p] { return p.set_level(t.id, -6.0); }, plain, armed},
        {"player::first_frame", [&t, &p] { return !p.first_frame(t.id); }, plain, armed},
        {"player::cancel_all", [&p] { return p.cancel_all(); }, plain, armed},
        {"player::wait", [&t, &p] { return p.wait(t.id); }, plain, submitted},
        {"player::on_begin", [&p] { p.on_begin([](stroke_id, std::optional<std::int64_t>) {}); }},
        {"player::on_report", [&p] { p.on_report([](const stroke_report&) {}); }},
        {"player::on_end", [&t, &p] { return p.on_end(t.id, [](const stroke_report&) {}); }, plain, armed},
        {"player::on_end, of nothing", [&t, &p] { return p.on_end(t.id, {}); }},
        {"player::stop", [&t] { t.anew.open->stop(); }, plain, [&t] { t.anew.make_player(); }},
        {"player::ended", [&t] { return t.anew.open->ended(); }, plain, stopped},
        {"player::stats", [&p] { return p.stats(); }},
        {"live_stroke::to", [&t] { return t.live->to(20.0, 20.0); }, plain, begun},
        {"live_stroke::to, nowhere", [&t] { return t.live->to(1.0 / 0.0, 20.0); }, plain, begun},
        {"lost_tactor",
         [] {
             return lost_tactor(palm(), {.outputs = {{0}, {0}}});
         }},
        {"wiring_warnings",
         [] {
             return wiring_warnings(palm(), {.outputs = {{0}}, .gains = {{0.1}}, .level_by = "type softvol"});
         }},
        {"drive_time_fault", [] { return drive_time_fault("null"); }},
    };
}

} // namespace tactor::test
