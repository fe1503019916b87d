// SPDX-License-Identifier: MIT
// Findings of `check`: arrays, levels and actuators; GPIO lines; machines made of files; and how they are
// printed.
#include "cli/check/check.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <doctest/doctest.h>

#include "folder.hpp"
#include "has.hpp"

namespace check_test {

using namespace tactor;
using namespace tactor::cli;

namespace {

const finding& named(const std::vector<finding>& all, const std::string& check)
{
    const auto f = std::find_if(all.begin(), all.end(), [&](const finding& x) { return x.check == check; });
    REQUIRE_MESSAGE(f != all.end(), check);
    return *f;
}

finding array_finding(const array& a, const std::string& check, const settings& s = {})
{
    environment e;
    e.tactors = a;
    return named(check_array(s, e), check);
}

finding limits_finding(const limit_settings& l, array a = preset_array("palm-3x3"))
{
    environment e;
    e.tactors = std::move(a);
    e.config.limits = l;
    return named(check_array({}, e), "limits");
}

array with_actuator(actuator_kind kind)
{
    array a = preset_array("palm-3x3");
    for (tactor_spec& t : a.tactors)
        t.actuator = kind;
    return a;
}

finding bursts(actuator_kind kind, const std::string& check, double carrier_hz = 250.0,
               algorithm_kind method = algorithm_kind::park2016)
{
    plan_options p;
    p.carrier_hz = carrier_hz;
    p.algorithm = method;
    return named(check_bursts(p, with_actuator(kind), 48000), check);
}

setup wired(bool active_low = false)
{
    setup s;
    s.amplifier = amplifier_settings{.line = {.name = "AMP"}, .active_low = active_low};
    s.sync.emplace();
    s.sync->out = gpio_line_name{.name = "OUT"};
    s.sync->in = gpio_line_name{.name = "GONE"};
    return s;
}

gpio_line_place find(const gpio_line_name& l)
{
    if (l.name == "GONE")
        throw error(error_kind::not_available, "GPIO line \"GONE\"", "no line has this name",
                    "use one of: AMP, OUT");
    const bool amplifier = l.name == "AMP";
    return {"/dev/gpiochip0",
            "pinctrl-rp1",
            {.offset = amplifier ? 17U : 27U, .name = l.name, .consumer = amplifier ? "" : "led"}};
}

system_facts read(const folder& root)
{
    return read_system(root.path(), "ann");
}

// A user with all rights on a machine without faults.
system_facts good()
{
    system_facts f;
    f.user = "ann";
    f.groups = {"ann", "audio", "gpio"};
    f.rights = {.priority = 70, .lockable_bytes = 256U << 20};
    f.memory_bytes = 100U << 20;
    f.sound = {{"/dev/snd/pcmC1D0p", "audio", true}};
    f.gpio = {{"/dev/gpiochip0", "gpio", true}};
    f.releases_outputs = true;
    return f;
}

system_needs card_and_amplifier()
{
    return {
        .pcm = "hw:CARD=Tactor", .card = card_info{1, "Tactor", "DAC8x"}, .gpio = true, .amplifier = true};
}

finding judged(const system_facts& f, const std::string& check, const system_needs& n = card_and_amplifier())
{
    return named(check_system(f, n), check);
}

} // namespace

TEST_CASE("for an array as large as a trunk check cites the knowledge about trunks")
{
    const finding vest = array_finding(make_grid("vest", 4, 5, 50.0, 50.0), "array");
    CHECK(vest.how == level::ok);
    CHECK(vest.cure.find("twice as well across the body as along") != std::string::npos);
    CHECK(vest.cure.find("--phantom linear") != std::string::npos);
    CHECK(array_finding(make_grid("sleeve", 2, 5, 50.0, 50.0), "array").cure.empty());
}

TEST_CASE("check lists places: number, grid, size, distances")
{
    const finding palm = array_finding(preset_array("palm-3x3"), "array");
    CHECK(palm.how == level::ok);
    CHECK(palm.found == "palm-3x3: 9 tactors, 3 x 3, 40 x 40 mm, neighbours 20 mm apart");
    array ragged = preset_array("palm-2x4");
    ragged.tactors[7].position.x_mm += 5.0;
    CHECK(array_finding(ragged, "array").found ==
          "palm-2x4: 8 tactors, no grid, 65 x 20 mm, neighbours 20 to 20.62 mm apart");
    array many = make_grid("many", 25, 40, 10.0, 7.0);
    std::reverse(many.tactors.begin() + 100, many.tactors.end()); // neighbours are far apart in the file
    CHECK(has(array_finding(many, "array").found, "neighbours 7 mm apart"));
}

TEST_CASE("an array that is not in millimetres, or has one tactor, is a warning")
{
    CHECK(array_finding(make_grid("m", 3, 3, 0.02, 0.02), "array").how == level::warning);
    CHECK(array_finding(make_grid("um", 2, 2, 20000.0, 20000.0), "array").how == level::warning);
    CHECK(array_finding(make_grid("one", 1, 1, 20.0, 20.0), "array").how == level::warning);
    CHECK(array_finding(make_grid("arm", 1, 4, 60.0, 60.0), "array").how == level::ok);
}

TEST_CASE("check lists channels and the marker")
{
    environment e;
    e.tactors = preset_array("palm-3x3");
    CHECK(named(check_array({}, e), "channels").found == "9 of 9 channels drive tactors: 0 to 8");
    e.tactors.tactors[8].channel = 12;
    e.config.output.channels = 16;
    e.config.sync.emplace();
    e.config.sync->channel = 15;
    CHECK(named(check_array({}, e), "channels").found ==
          "9 of 16 channels drive tactors: 0, 1, 2, 3, 4, 5, 6, 7, 12; 15 marks strokes");
}

TEST_CASE("levels that play would refuse are errors in the same words")
{
    array a = preset_array("palm-3x3");
    CHECK(array_finding(a, "levels").found == "peaks of -12 dBFS");
    a.tactors[3].gain_db = -6.0;
    CHECK(array_finding(a, "levels").found == "peaks of -18 to -12 dBFS");
    a.tactors[3].gain_db = 13.0;
    const finding over = array_finding(a, "levels");
    CHECK(over.how == level::error);
    CHECK(over.kind == error_kind::bad_input);
    CHECK(has(over.found, "tactor 3"));
    CHECK_FALSE(over.cure.empty());
}

TEST_CASE("missing thresholds, and levels that are not above them, are findings")
{
    array a = preset_array("palm-3x3");
    settings sl;
    sl.render.sl_db = 7.0;
    CHECK(array_finding(a, "levels", sl).how == level::error);
    for (tactor_spec& t : a.tactors)
        t.threshold_dbfs = -40.0;
    CHECK(array_finding(a, "levels", sl).found == "peaks of -33 dBFS, 7 dB SL");
    CHECK(array_finding(a, "levels").how == level::ok);
    a.tactors[2].threshold_dbfs = -10.0;
    const finding unfelt = array_finding(a, "levels");
    CHECK(unfelt.how == level::warning);
    CHECK(has(unfelt.found, "not above the threshold of tactors 2"));
    a.tactors[2].threshold_dbfs.reset();
    CHECK(has(array_finding(a, "levels").found, "tactors 2 have no threshold"));
}

TEST_CASE("check lists the limits that hold")
{
    const finding usual = array_finding(preset_array("palm-3x3"), "limits");
    CHECK(usual.how == level::ok);
    CHECK(usual.found == "all together at most +4.77 dB above one at full scale; each at most 5 s in 10 s");
    CHECK(limits_finding({.power_dbfs = 0.0, .max_drive_s = 2.0, .window_s = 4.0}).how == level::ok);
}

TEST_CASE("a limit that is weaker than by default is a warning that gives the default")
{
    const finding untimed = limits_finding({.power_dbfs = 0.0, .max_drive_s = 20.0});
    CHECK(untimed.how == level::warning);
    CHECK(untimed.found ==
          "all together at most +0 dB above one at full scale; no limit on time: more than by default");
    CHECK(has(untimed.cure, "max_drive_s = 5, window_s = 10"));
    CHECK(untimed.cure.find("power_dbfs") == std::string::npos);
    for (const limit_settings& l :
         {limit_settings{.window_s = 5.0}, limit_settings{.window_s = 9.0}, limit_settings{.window_s = 1.0},
          limit_settings{.max_drive_s = 3600.0}, limit_settings{.max_drive_s = 60.0, .window_s = 3600.0}})
        CHECK(limits_finding(l).how == level::warning);
    const finding loud = limits_finding({.power_dbfs = 60.0});
    CHECK(loud.how == level::warning);
    CHECK(has(loud.cure, "power_dbfs = 4.77"));
    CHECK(loud.cure.find("window_s") == std::string::npos);
    CHECK(limits_finding({.power_dbfs = 60.0, .max_drive_s = 60.0}).how == level::warning);
    // The default lets three tactors through: for them it is no limit either.
    CHECK(limits_finding({.power_dbfs = 60.0}, make_grid("three", 1, 3, 20.0, 20.0)).how == level::ok);
}

TEST_CASE("actuators that cannot make the bursts are a warning with the reason")
{
    CHECK(bursts(actuator_kind::piezo, "actuators").how == level::ok);
    CHECK(bursts(actuator_kind::voice_coil, "actuators").found == "voice-coil");
    const finding erm = bursts(actuator_kind::erm, "actuators");
    CHECK(erm.how == level::warning);
    CHECK(has(erm.found, "116 ms"));
    CHECK(has(erm.found, "bursts of 70 ms"));
    const finding lra = bursts(actuator_kind::lra, "actuators", 175.0);
    CHECK(lra.how == level::warning);
    CHECK(has(lra.found, "the carrier is 175 Hz"));
    CHECK(has(lra.cure, "--carrier"));
    CHECK(has(bursts(actuator_kind::lra, "actuators", 250.0, algorithm_kind::continuous).found,
              "a moving phantom"));
    const finding unknown = bursts(actuator_kind::unknown, "actuators");
    CHECK(unknown.how == level::ok);
    CHECK(has(unknown.cure, "actuator = "));
}

TEST_CASE("the unsuitable ones of mixed actuators are named")
{
    array a = with_actuator(actuator_kind::piezo);
    a.tactors[4].actuator = actuator_kind::erm;
    a.tactors[7].actuator = actuator_kind::lra;
    const auto all = check_bursts({}, a, 48000);
    CHECK(all.size() == 3);
    CHECK(has(all[0].found, "tactor 4: an ERM"));
    CHECK(has(all[1].found, "tactor 7: an LRA"));
    a.tactors[7].actuator = a.tactors[4].actuator = actuator_kind::voice_coil;
    CHECK(named(check_bursts({}, a, 48000), "actuators").found == "7 piezo, 2 voice-coil");
}

TEST_CASE("carriers are checked against skin, burst and rate")
{
    CHECK(bursts(actuator_kind::piezo, "bursts").found == "70 ms at 250 Hz, 17.5 cycles");
    CHECK(bursts(actuator_kind::piezo, "bursts", 60.0).how == level::warning);
    CHECK(has(bursts(actuator_kind::piezo, "bursts", 60.0).found, "too few"));
    CHECK(bursts(actuator_kind::piezo, "bursts", 60.0, algorithm_kind::continuous).how == level::ok);
    CHECK(bursts(actuator_kind::piezo, "bursts", 20.0).how == level::warning);
    CHECK(bursts(actuator_kind::piezo, "bursts", 1500.0).how == level::warning);
    const finding alias = bursts(actuator_kind::piezo, "bursts", 24000.0);
    CHECK(alias.how == level::error);
    CHECK(alias.kind == error_kind::bad_input);
}

TEST_CASE("an impossible SOA or algorithm is an error")
{
    plan_options p;
    p.soa_s = 0.2;
    CHECK(named(check_bursts(p, with_actuator(actuator_kind::piezo), 48000), "bursts").how == level::error);
    p = {};
    p.algorithm = algorithm_kind::tactile_brush;
    array a = with_actuator(actuator_kind::piezo);
    CHECK(named(check_bursts(p, a, 48000), "bursts").how == level::ok);
    a.tactors[0].position.x_mm -= 3.0;
    CHECK(has(named(check_bursts(p, a, 48000), "bursts").found, "grid"));
}

TEST_CASE("lines are free, held or not there")
{
    const auto all = check_lines(wired(), true, find);
    REQUIRE(all.size() == 3);
    CHECK(all[0].check == "amplifier");
    CHECK(all[0].how == level::ok);
    CHECK(all[0].found == "line 17 \"AMP\" of pinctrl-rp1 (/dev/gpiochip0), free");
    CHECK(all[1].how == level::error);
    CHECK(all[1].kind == error_kind::not_available);
    CHECK(all[1].found == "line 27 \"OUT\" of pinctrl-rp1 (/dev/gpiochip0): held by \"led\"");
    CHECK(all[2].found == "GPIO line \"GONE\": no line has this name");
    CHECK(all[2].cure == "use one of: AMP, OUT");
    CHECK(worst_status(all) == 3);
}

TEST_CASE("an amplifier that is on when low is a warning, and so is none where a person feels it")
{
    CHECK(check_lines(wired(true), true, find)[0].how == level::warning);
    for (const bool felt : {true, false}) {
        const auto none = check_lines({}, felt, find);
        REQUIRE(none.size() == 1);
        CHECK(none[0].how == (felt ? level::warning : level::ok));
        CHECK(none[0].cure.find("tactor-raspberry-pi(7)") != std::string::npos);
    }
}

TEST_CASE("bad input wins over a missing device in the exit status, warnings do not count")
{
    const finding device = failure("device", error(error_kind::not_available, "a", "b"));
    const finding input = failure("levels", error(error_kind::bad_input, "a", "b"));
    const finding other = failure("x", error(error_kind::runtime, "a", "b"));
    CHECK(worst_status({}) == 0);
    CHECK(worst_status({warning("a", "b", "c"), passed("a", "b")}) == 0);
    CHECK(worst_status({device, input}) == 2);
    CHECK(worst_status({other, device}) == 3);
    CHECK(worst_status({other}) == 1);
}

TEST_CASE("findings have this form")
{
    const std::vector<finding> all{
        passed("array", "palm-3x3: 9 tactors"),
        warning("sound servers", "pipewire (process 812): may use card Tactor at any time",
                "call the card Tactor"),
        failure("device", error(error_kind::not_available, "PCM \"x\"", "there is no such PCM", "try y"))};
    CHECK(check_text(all, false) ==
          "ok       array          palm-3x3: 9 tactors\n"
          "warning  sound servers  pipewire (process 812): may use card Tactor at any time\n"
          "                        -> call the card Tactor\n"
          "error    device         PCM \"x\": there is no such PCM\n"
          "                        -> try y\n"
          "\n1 error, 1 warning, 1 ok\n");
    CHECK(check_text(all, true).find("palm-3x3") == std::string::npos);
    CHECK(check_text({passed("a", "b")}, true) == "0 errors, 0 warnings, 1 ok\n");
}

TEST_CASE("a machine without faults needs no hint")
{
    for (const finding& f : check_system(good(), card_and_amplifier())) {
        INFO(f.check, ": ", f.found);
        CHECK(f.how == level::ok);
        CHECK(f.cure.empty());
    }
}

TEST_CASE("an empty machine is read without complaint")
{
    const folder r;
    const system_facts f = read(r);
    CHECK(f.sound.empty());
    CHECK(f.gpio.empty());
    CHECK(f.servers.empty());
    CHECK(f.keeps_outputs.empty());
    CHECK_FALSE(f.raspberry_pi);
    CHECK(worst_status(check_system(f, {})) == 0);
}

TEST_CASE("groups and devices are read")
{
    const folder r;
    r.write("etc/group", "root:x:0:\naudio:x:29:bob,ann\ngpio:x:990:annabel\n");
    for (const char* device : {"dev/snd/pcmC1D0p", "dev/snd/pcmC1D0c", "dev/snd/controlC1", "dev/gpiochip0"})
        r.write(device);
    const system_facts f = read(r);
    CHECK(f.joined == std::vector<std::string>{"audio"});
    REQUIRE(f.sound.size() == 1);
    CHECK(f.sound[0].path == (r.path() / "dev/snd/pcmC1D0p").string());
    CHECK(f.sound[0].may_open);
    r.write("dev/gpiochip1/x"); // access(2) allows to read and write it, and no open() does
    REQUIRE(read(r).gpio.size() == 2);
    CHECK_FALSE(read(r).gpio[1].may_open);
    CHECK_FALSE(f.sound[0].group.empty());
    CHECK(f.gpio.size() == 1);
}

TEST_CASE("a device that may not be opened names the group to join, or the missing login")
{
    system_facts f = good();
    f.groups = {"ann"};
    f.sound[0].may_open = false;
    const finding x = judged(f, "sound rights");
    CHECK(x.how == level::error);
    CHECK(x.kind == error_kind::not_available);
    CHECK(has(x.cure, "sudo usermod -aG audio $USER"));
    CHECK(judged(f, "sound rights", {.pcm = "null"}).how == level::warning);
    f.joined = {"audio"};
    CHECK(has(judged(f, "sound rights").cure, "log out and in again"));
    CHECK(judged(f, "sound rights").cure.find("usermod") == std::string::npos);

    f.groups = {"ann", "audio"}; // a container keeps the device away
    CHECK(has(judged(f, "sound rights").cure, "DeviceAllow="));

    f.gpio[0] = {"/dev/gpiochip0", "root", false};
    CHECK(judged(f, "GPIO rights").how == level::error);
    CHECK(has(judged(f, "GPIO rights").cure, "udev"));
    CHECK(judged(f, "GPIO rights", {.pcm = "null"}).how == level::warning);
}

TEST_CASE("limits below what play asks for are warnings, and errors where real time is required")
{
    system_facts f = good();
    f.rights = {.priority = 0, .lockable_bytes = 8U << 20};
    system_needs n = card_and_amplifier();
    CHECK(judged(f, "real time", n).how == level::warning);
    CHECK(has(judged(f, "real time", n).found, "RLIMIT_RTPRIO is 0"));
    CHECK(has(judged(f, "memory", n).found,
              "8 MiB of locked memory (RLIMIT_MEMLOCK), 100 MiB needed, including a reserve"));
    CHECK_FALSE(judged(f, "memory", n).cure.empty());
    f.priority = 20; // granted all the same
    n.require_realtime = true;
    CHECK(judged(f, "real time", n).how == level::ok);
    CHECK(judged(f, "real time", n).found == "RealtimeKit grants SCHED_FIFO at 20, 65 requested");
    n.require_realtime = false;
    f.rights.priority = f.priority = 40;
    CHECK(has(judged(f, "real time", n).found, "SCHED_FIFO only up to 40, 65 requested"));
    n.require_realtime = true;
    CHECK(judged(f, "real time", n).how == level::error);
    CHECK(judged(f, "memory", n).kind == error_kind::not_available);
    f.rights = {.priority = 99, .lockable_bytes = {}};
    f.priority_error = EPERM; // in a container, whatever the limits say
    CHECK(judged(f, "real time", n).how == level::error);
    CHECK(has(judged(f, "real time", n).found,
              "no real-time priority, though the limits allow it: Operation not permitted"));
    f.priority_error = 0;
    CHECK(judged(f, "real time", n).how == level::ok);
    CHECK(judged(f, "memory", n).how == level::ok);
}

TEST_CASE("running sound servers are found, and udev's word for a card")
{
    const folder r;
    r.write("proc/812/comm", "pipewire\n");
    r.write("proc/99/comm", "jackd\n");
    r.write("proc/7/comm", "bash\n");
    const auto servers = read(r).servers;
    REQUIRE(servers.size() == 2);
    CHECK(servers[0].program == "jackd");
    CHECK(servers[1].pid == 812);

    CHECK_FALSE(is_ignored_by_servers(1, r.path()));
    r.write("run/udev/data/+sound:card1", "E:ACP_IGNORE=1\nE:PULSE_IGNORE=1\n");
    CHECK(is_ignored_by_servers(1, r.path()));
    CHECK_FALSE(is_ignored_by_servers(2, r.path()));
}

TEST_CASE("a server that may take the card, or has it, is a warning")
{
    system_facts f = good();
    system_needs n = card_and_amplifier();
    f.servers = {{99, "jackd"}};
    CHECK(judged(f, "sound servers", n).how == level::ok);
    f.servers.push_back({812, "pipewire"});
    CHECK(judged(f, "sound servers", n).how == level::warning);
    CHECK(has(judged(f, "sound servers", n).found, "pipewire (process 812): may use card Tactor"));
    CHECK(has(judged(f, "sound servers", n).cure, "70-tactor.rules"));
    n.ignored = true;
    CHECK(judged(f, "sound servers", n).how == level::ok);
    n.holders = {{99, "jackd"}};
    CHECK(has(judged(f, "sound servers", n).found, "jackd (process 99) plays on card Tactor"));
    n.holders = {{100, "mpd"}};
    CHECK(judged(f, "sound servers", n).how == level::warning);
    CHECK(judged(f, "sound servers", n).cure == "stop that program, such as by kill 100");
    CHECK(judged(f, "sound servers", {.pcm = "null"}).how == level::ok);
}

TEST_CASE("lines that keep their level are a warning where an amplifier hangs on one")
{
    const folder r;
    r.write("sys/module/pinctrl_rp1/parameters/persist_gpio_outputs", "Y\n");
    r.write("proc/device-tree/model", std::string("Raspberry Pi 5 Model B\0", 23));
    system_facts f = read(r);
    CHECK(f.raspberry_pi);
    CHECK_FALSE(f.keeps_outputs.empty());
    const finding x = judged(f, "GPIO release");
    CHECK(x.how == level::warning);
    CHECK(has(x.found, "if player and holder are both killed, the amplifier stays on"));
    CHECK(has(x.cure, "strict_gpiod"));
    CHECK(has(x.cure, "ExecStopPost=tactor off"));
    const auto without = check_system(f, {.pcm = "null"});
    CHECK(std::none_of(without.begin(), without.end(),
                       [](const finding& y) { return y.check == "GPIO release"; }));

    r.write("sys/module/pinctrl_rp1/parameters/persist_gpio_outputs", "N\n");
    CHECK(judged(read(r), "GPIO release").how == level::ok);
    const folder silent;
    silent.write("proc/device-tree/model", "Raspberry Pi 4");
    CHECK(judged(read(silent), "GPIO release").how == level::warning);
    const folder other;
    const finding unknown = judged(read(other), "GPIO release");
    CHECK(unknown.how == level::ok);
    CHECK(has(unknown.cure, "tactor off"));
}

} // namespace check_test
