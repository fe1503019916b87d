// SPDX-License-Identifier: MIT
// Prints in a JSON array the tool's output on machines with cards, chips and trouble, for test_json.py.
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/check/check.hpp"
#include "cli/play/play.hpp"
#include "files/json/json_value.hpp"
#include "session/device.hpp"
#include "studio.hpp"
#include "study/session/session_record.hpp"

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

// A session with everything that session.json can have.
study::session_record full_session()
{
    study::session_record r;
    r.participant = "07";
    r.seed = 7;
    r.group = "palm";
    r.session = 2;
    r.order_row = 3;
    r.order = {"which", "even"};
    r.level.sl_db = 12.0;
    r.hand = "left";
    r.rests_s.emplace().all.emplace_back("which", std::vector{1.0, 1.25});
    r.tactors = make_grid("pair", 1, 2, 20.0, 20.0);
    r.tactors.tactors[0].threshold_dbfs = -40.0;
    r.tactors.tactors[0].rise_s = 0.01;
    r.tactors.tactors[0].displacement_um_at_0dbfs = 35.0;
    const calibrated_tactor measured{0, -40.0, 1.5, 0.8, 30};
    r.calibration = {{.participant = "07",
                      .carrier_hz = 250.0,
                      .method = "quest",
                      .rule = "1up2down",
                      .interval_s = 0.5,
                      .feedback = true,
                      .masker = "pink",
                      .date = "2026-11-20T09:00:00.000000Z",
                      .seed = 1,
                      .tactors = {measured}},
                     {"another device"}};
    r.codes = {9, 2.0, std::vector{1U, 2U}, study::listed_serial{115200}, true};
    r.codes->numbers.emplace().all.emplace_back("1", "stimulus");
    r.rate = 48000;
    r.channels = 9;
    r.masking = {"pink", -20.0, 0.1, "run"};
    r.masker = "hw:1";
    r.stimuli = {{"0f", "across", "park", -1.0, 4.0, {{{}, -20.0}}}};
    r.predictions = std::vector{study::listed_prediction{"centroid", "across", "park", "0,0,0"}};
    r.experiment = {"felt", "0f", "[experiment]"};
    r.versions = {"0.1", "gcc"};
    r.device = "hw:0";
    r.sound_server = "PipeWire";
    r.masker_sound_server = "PulseAudio";
    r.streams = {{1, "2026-11-20T09:00:01.000000Z", "hw:0", "hw:1", r.masking, "page", "s32", 96, 288, true,
                  true, study::listed_pulses{4, 1, 1e-4, 2e-4}}};
    r.date = r.consent = r.streams.front().opened;
    r.walk = std::vector{study::listed_step{0, r.streams.front().opened}};
    r.answers.emplace().all.emplace_back("form", std::vector<std::string>{"41"});
    return r;
}

} // namespace

int main()
{
    fmt::print("[{},\n{},\n{},\n", session::devices_json(devices()), walked(),
               files::make_document(full_session()).dump());
    print_json(troubled_run());
    fmt::print("]\n");
}
