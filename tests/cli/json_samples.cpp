// SPDX-License-Identifier: MIT
// Prints in a JSON array the tool's output on machines with cards, chips and trouble, for test_json.py.
#include <optional>

#include <fmt/format.h>

#include "cli/check/check.hpp"
#include "cli/play/play.hpp"
#include "session/device.hpp"
#include "studio.hpp"

namespace {

using namespace tactor;
using namespace tactor::cli;

session::device_list devices()
{
    session::device_list d = tactor::test::studio();
    d.wanted.format = format_kind::s16;
    return d;
}

play_report troubled_run()
{
    play_report r;
    r.device = {.name = "hw:CARD=Tactor", .channels = 9, .rate = 48000, .period_frames = 96};
    r.device.buffer_frames = 288;
    const stroke_report cut{.id = 1,
                            .state = state_kind::interrupted,
                            .frames = 480,
                            .reason = reason_kind::xrun,
                            .why = "an xrun",
                            .late_s = 0.001,
                            .started_ns = 123456789,
                            .delay = live_delay{3, 0.01, 0.011, 0.012}};
    r.strokes = {{"a.toml", 70560, cut}, {"b.toml", 70560, std::nullopt}};
    r.stats.xruns = 1;
    r.stats.xrun_s = {0.0125};
    r.reopened = 1;
    return r;
}

std::string walked()
{
    const array pair = make_grid("pair", 1, 2, 20.0, 20.0);
    const session::walk_answers felt{1U, std::nullopt};
    const session::walk_map verdict = session::map_channels(pair, felt);
    return check_json({warning("real time", "no priority", "join a group")},
                      walk_outcome{pair, felt, verdict});
}

} // namespace

int main()
{
    fmt::print("[{},\n{},\n", session::devices_json(devices()), walked());
    print_json(troubled_run());
    fmt::print("]\n");
}
