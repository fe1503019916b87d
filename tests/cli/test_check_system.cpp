// SPDX-License-Identifier: MIT
// Findings of `check` on machines made of files.
#include "cli/check/system_facts.hpp"

#include <algorithm>

#include <doctest/doctest.h>

#include "folder.hpp"
#include "has.hpp"

namespace check_system_test {

using namespace tactor;
using namespace tactor::cli;
namespace fs = std::filesystem;

namespace {

class fake_root {
public:
    const fake_root& write(const std::string& file, const std::string& text = "") const
    {
        files_.write(file, text);
        return *this;
    }
    system_facts read(const std::string& kernel = "#1 SMP") const
    {
        return read_system({.user = "ann", .kernel = kernel}, files_.path());
    }
    const fs::path& path() const { return files_.path(); }

private:
    folder files_;
};

// A user with all rights on a machine without faults.
system_facts good()
{
    system_facts f;
    f.own = {.user = "ann",
             .groups = {"ann", "audio", "gpio"},
             .rights = {.priority = 70, .lockable_bytes = 256U << 20},
             .memory_bytes = 100U << 20};
    f.sound = {{"/dev/snd/pcmC1D0p", "audio", true}};
    f.gpio = {{"/dev/gpiochip0", "gpio", true}};
    f.preempts = preemption::realtime;
    f.governors = {"performance"};
    f.releases_outputs = true;
    return f;
}

system_needs card_and_amplifier()
{
    return {
        .pcm = "hw:CARD=Tactor", .card = card_info{1, "Tactor", "DAC8x"}, .gpio = true, .amplifier = true};
}

finding judged(const system_facts& f, const system_needs& n, const std::string& check)
{
    const auto all = check_system(f, n);
    const auto x = std::find_if(all.begin(), all.end(), [&](const finding& y) { return y.check == check; });
    REQUIRE_MESSAGE(x != all.end(), check);
    return *x;
}

} // namespace

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
    const fake_root r;
    const system_facts f = r.read();
    CHECK(f.sound.empty());
    CHECK(f.gpio.empty());
    CHECK(f.governors.empty());
    CHECK(f.servers.empty());
    CHECK_FALSE(f.keeps_outputs.has_value());
    CHECK_FALSE(f.raspberry_pi);
    CHECK(f.preempts == preemption::none);
    CHECK(worst_status(check_system(f, {})) == 0);
}

TEST_CASE("groups and devices are read")
{
    const fake_root r;
    r.write("etc/group", "root:x:0:\naudio:x:29:bob,ann\ngpio:x:990:annabel\n");
    r.write("dev/snd/pcmC1D0p").write("dev/snd/pcmC1D0c").write("dev/snd/controlC1").write("dev/gpiochip0");
    const system_facts f = r.read();
    CHECK(f.joined == std::vector<std::string>{"audio"});
    REQUIRE(f.sound.size() == 1);
    CHECK(f.sound[0].path == (r.path() / "dev/snd/pcmC1D0p").string());
    CHECK(f.sound[0].may_open);
    CHECK_FALSE(f.sound[0].group.empty());
    CHECK(f.gpio.size() == 1);
}

TEST_CASE("a device that may not be opened names the group to join, or the missing login")
{
    system_facts f = good();
    f.own.groups = {"ann"};
    f.sound[0].may_open = false;
    const finding x = judged(f, card_and_amplifier(), "sound rights");
    CHECK(x.how == level::error);
    CHECK(x.kind == error_kind::not_available);
    CHECK(has(x.cure, "sudo usermod -aG audio $USER"));
    CHECK(judged(f, {.pcm = "null"}, "sound rights").how == level::warning);
    f.joined = {"audio"};
    CHECK(has(judged(f, card_and_amplifier(), "sound rights").cure, "log out and in again"));
    CHECK(judged(f, card_and_amplifier(), "sound rights").cure.find("usermod") == std::string::npos);

    f.gpio[0] = {"/dev/gpiochip0", "root", false};
    CHECK(judged(f, card_and_amplifier(), "GPIO rights").how == level::error);
    CHECK(has(judged(f, card_and_amplifier(), "GPIO rights").cure, "udev"));
    CHECK(judged(f, {.pcm = "null"}, "GPIO rights").how == level::warning);
}

TEST_CASE("limits below what play asks for are warnings, and errors where real time is required")
{
    system_facts f = good();
    f.own.rights = {.priority = 0, .lockable_bytes = 8U << 20};
    system_needs n = card_and_amplifier();
    CHECK(judged(f, n, "real time").how == level::warning);
    CHECK(has(judged(f, n, "real time").found, "RLIMIT_RTPRIO is 0"));
    CHECK(has(judged(f, n, "memory").found,
              "8 MiB may be locked (RLIMIT_MEMLOCK), 100 MiB must be, a reserve included"));
    CHECK_FALSE(judged(f, n, "memory").cure.empty());
    f.own.rights.priority = 40;
    CHECK(has(judged(f, n, "real time").found, "SCHED_FIFO up to 40 only, 65 is asked for"));
    n.require_realtime = true;
    CHECK(judged(f, n, "real time").how == level::error);
    CHECK(judged(f, n, "memory").kind == error_kind::not_available);
    f.own.rights = {.priority = 99, .lockable_bytes = {}};
    CHECK(judged(f, n, "real time").how == level::ok);
    CHECK(judged(f, n, "memory").how == level::ok);
}

TEST_CASE("the kernel's preemption is read from each possible place")
{
    const std::string dynamic = "#1 SMP PREEMPT_DYNAMIC Debian";
    CHECK(fake_root().read("#1 SMP PREEMPT_RT Debian").preempts == preemption::realtime);
    CHECK(fake_root().write("sys/kernel/realtime", "1\n").read().preempts == preemption::realtime);
    CHECK(fake_root().read(dynamic).preempts == preemption::unknown);
    CHECK(fake_root().read("#1 SMP PREEMPT Debian").preempts == preemption::full);
    CHECK(fake_root().read("#1 SMP Debian").preempts == preemption::none);
    const auto debug = [&](const std::string& text) {
        return fake_root().write("sys/kernel/debug/sched/preempt", text).read(dynamic).preempts;
    };
    CHECK(debug("none (voluntary) full\n") == preemption::voluntary);
    CHECK(debug("none voluntary (full)\n") == preemption::full);
    CHECK(debug("(none) voluntary full\n") == preemption::none);
    CHECK(debug("none voluntary full (lazy)\n") == preemption::full);
    CHECK(fake_root().write("proc/cmdline", "quiet preempt=full\n").read(dynamic).preempts ==
          preemption::full);

    system_facts f = good();
    for (const auto p : {preemption::none, preemption::voluntary}) {
        f.preempts = p;
        CHECK(judged(f, {}, "kernel").how == level::warning);
        CHECK(has(judged(f, {}, "kernel").cure, "preempt=full"));
    }
    f.preempts = preemption::unknown;
    CHECK(judged(f, {}, "kernel").how == level::ok);
}

TEST_CASE("governors of all CPUs are read; any but performance is a warning")
{
    const fake_root r;
    r.write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "schedutil\n")
        .write("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "schedutil\n")
        .write("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "performance\n");
    CHECK(r.read().governors == std::vector<std::string>{"performance", "schedutil"});
    system_facts f = good();
    f.governors = {"ondemand"};
    CHECK(judged(f, {}, "CPU clock").how == level::warning);
    CHECK(has(judged(f, {}, "CPU clock").cure, "scaling_governor"));
    f.governors.clear();
    CHECK(judged(f, {}, "CPU clock").how == level::ok);
}

TEST_CASE("running sound servers are found, and udev's word for a card")
{
    const fake_root r;
    r.write("proc/812/comm", "pipewire\n").write("proc/99/comm", "jackd\n").write("proc/7/comm", "bash\n");
    const auto servers = r.read().servers;
    REQUIRE(servers.size() == 2);
    CHECK(servers[0].program == "jackd");
    CHECK(servers[1].pid == 812);

    CHECK_FALSE(servers_ignore(1, r.path()));
    r.write("run/udev/data/+sound:card1", "E:ACP_IGNORE=1\nE:PULSE_IGNORE=1\n");
    CHECK(servers_ignore(1, r.path()));
    CHECK_FALSE(servers_ignore(2, r.path()));
}

TEST_CASE("a server that may take the card, or has it, is a warning")
{
    system_facts f = good();
    system_needs n = card_and_amplifier();
    f.servers = {{99, "jackd"}};
    CHECK(judged(f, n, "sound servers").how == level::ok);
    f.servers.push_back({812, "pipewire"});
    CHECK(judged(f, n, "sound servers").how == level::warning);
    CHECK(has(judged(f, n, "sound servers").found, "pipewire (process 812): may take card Tactor"));
    CHECK(has(judged(f, n, "sound servers").cure, "70-tactor.rules"));
    n.ignored = true;
    CHECK(judged(f, n, "sound servers").how == level::ok);
    n.holders = {{99, "jackd"}};
    CHECK(has(judged(f, n, "sound servers").found, "jackd (process 99) plays on card Tactor"));
    n.holders = {{100, "mpd"}};
    CHECK(judged(f, n, "sound servers").how == level::warning);
    CHECK(judged(f, n, "sound servers").cure == "stop it: kill 100");
    CHECK(judged(f, {.pcm = "null"}, "sound servers").how == level::ok);
}

TEST_CASE("lines that keep their level are a warning where an amplifier hangs on one")
{
    const fake_root r;
    r.write("sys/module/pinctrl_rp1/parameters/persist_gpio_outputs", "Y\n")
        .write("proc/device-tree/model", std::string("Raspberry Pi 5 Model B\0", 23));
    system_facts f = r.read();
    CHECK(f.raspberry_pi);
    REQUIRE(f.keeps_outputs.has_value());
    const finding x = judged(f, card_and_amplifier(), "GPIO release");
    CHECK(x.how == level::warning);
    CHECK(has(x.found, "nothing switches the amplifier off when player and holder are killed together"));
    CHECK(has(x.cure, "strict_gpiod"));
    CHECK(has(x.cure, "ExecStopPost=tactor off"));
    const auto without = check_system(f, {.pcm = "null"});
    CHECK(std::none_of(without.begin(), without.end(),
                       [](const finding& y) { return y.check == "GPIO release"; }));

    r.write("sys/module/pinctrl_rp1/parameters/persist_gpio_outputs", "N\n");
    CHECK(judged(r.read(), card_and_amplifier(), "GPIO release").how == level::ok);
    const fake_root silent;
    silent.write("proc/device-tree/model", "Raspberry Pi 4");
    CHECK(judged(silent.read(), card_and_amplifier(), "GPIO release").how == level::warning);
    const fake_root other;
    const finding unknown = judged(other.read(), card_and_amplifier(), "GPIO release");
    CHECK(unknown.how == level::ok);
    CHECK(has(unknown.cure, "tactor off"));
}

TEST_CASE("a service that switches off after its end is found, and its gaps are named")
{
    const fake_root r;
    r.write("sys/module/pinctrl_rp1/parameters/persist_gpio_outputs", "Y\n");
    r.write("etc/systemd/system/other.service",
            "[Service]\nExecStart=/usr/bin/tactor off\n#ExecStopPost=tactor off\n");
    CHECK(r.read().off_units.empty());
    CHECK(judged(r.read(), card_and_amplifier(), "GPIO release").how == level::warning);
    r.write("etc/systemd/system/tactor-play@.service", "[Service]\nExecStopPost=/usr/local/bin/tactor off\n");
    r.write("run/systemd/system/touch.service.d/off.conf",
            "[Service]\nExecStopPost=-/usr/bin/tactor off --config a.toml\n");
    CHECK(r.read().off_units == std::vector<std::string>{"tactor-play@.service", "touch.service"});
    const finding x = judged(r.read(), card_and_amplifier(), "GPIO release");
    CHECK(x.how == level::ok);
    CHECK(has(x.found, "tactor-play@.service, touch.service switches the amplifier off"));
    CHECK(has(x.found, "killed together outside of it"));
}

TEST_CASE("addresses of the kernel's tables are read")
{
    struct {
        const char* said;
        const char* means;
        bool beyond;
    } const cases[] = {
        {"0100007F:0FA1", "127.0.0.1:4001", false},
        {"00000000:0FA1", "0.0.0.0:4001", true},
        {"2A01A8C0:0050", "192.168.1.42:80", true},
        {"00000000000000000000000001000000:0FA1", "[::1]:4001", false},
        {"00000000000000000000000000000000:0FA1", "[::]:4001", true},
        {"0000000000000000FFFF00000100007F:0001", "[::ffff:127.0.0.1]:1", false},
        {"local_address", "", false},
        {"0100007F", "", false},
        {"0100007F:", "", false},
        {"0100007F:10000", "", false},
        {"0100007G:0FA1", "", false},
        {"", "", false},
    };
    for (const auto& c : cases) {
        INFO(c.said);
        const endpoint e = parse_endpoint(c.said);
        CHECK(e.at == c.means);
        CHECK(e.beyond_loopback == c.beyond);
    }
}

TEST_CASE("listening sockets of services are found and judged")
{
    const fake_root r;
    const auto process = [&](int pid, const std::string& arguments, const std::vector<int>& inodes) {
        const std::string folder = "proc/" + std::to_string(pid);
        r.write(folder + "/comm", "tactor\n").write(folder + "/cmdline", arguments).write(folder + "/fd/0");
        for (std::size_t i = 0; i < inodes.size(); ++i)
            fs::create_symlink("socket:[" + std::to_string(inodes[i]) + "]",
                               r.path() / folder / "fd" / std::to_string(3 + i));
    };
    process(12, std::string("tactor\0serve\0--tcp\0004001\0", 24), {501, 502, 505, 777});
    process(7, std::string("tactor\0play\0x.toml\0", 19), {503});
    r.write("proc/9/comm", "tactorish\n").write("proc/self/comm", "tactor\n");
    const std::string head =
        "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode\n";
    r.write(
        "proc/net/tcp",
        head +
            "   0: 0100007F:0FA1 00000000:0000 0A 00000000:00000000 00:00000000 00000000  1000  0 501 1\n"
            "   1: 00000000:1F90 00000000:0000 0A 00000000:00000000 00:00000000 00000000  1000  0 503 1\n"
            "   2: 00000000:1F91 0200000A:9999 01 00000000:00000000 00:00000000 00000000  1000  0 777 1\n");
    r.write("proc/net/udp", head + " 9: 0100007F:0FA3 00000000:0000 07 0:0 0:0 0 1000 0 505 2\n");
    r.write("proc/net/unix", "Num       RefCount Protocol Flags    Type St Inode Path\n"
                             "0000000000000000: 00000002 00000000 00010000 0001 01 502 /run/tactor.sock\n"
                             "0000000000000000: 00000003 00000000 00000000 0001 03 504 /run/tactor.sock\n");
    system_facts f = r.read();
    REQUIRE(f.services.size() == 1);
    CHECK(f.services[0].who.pid == 12);
    CHECK(judged(f, {}, "service").how == level::ok);
    CHECK(judged(f, {}, "service").found ==
          "tactor (process 12) listens at 127.0.0.1:4001, /run/tactor.sock, osc 127.0.0.1:4003");

    r.write("proc/net/tcp6",
            head + "   0: 00000000000000000000000000000000:0FA2 0:0 0A 0:0 0:0 0 1000 0 777 1\n");
    f = r.read();
    CHECK(judged(f, {}, "service").how == level::warning);
    CHECK(has(judged(f, {}, "service").found, "[::]:4002: other machines can connect"));

    f.services[0].may_look = false;
    CHECK(has(judged(f, {}, "service").cure, "sudo tactor check"));
    f.services.clear();
    CHECK(judged(f, {}, "service").found == "none runs");
}

} // namespace check_system_test
