// SPDX-License-Identifier: MIT
// Findings of `check` on machines made of files.
#include "cli/check/check.hpp"

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
    system_facts read() const { return read_system(files_.path(), "ann"); }
    const fs::path& path() const { return files_.path(); }

private:
    folder files_;
};

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
    CHECK(f.servers.empty());
    CHECK(f.keeps_outputs.empty());
    CHECK_FALSE(f.raspberry_pi);
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
    f.groups = {"ann"};
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
    f.rights = {.priority = 0, .lockable_bytes = 8U << 20};
    system_needs n = card_and_amplifier();
    CHECK(judged(f, n, "real time").how == level::warning);
    CHECK(has(judged(f, n, "real time").found, "RLIMIT_RTPRIO is 0"));
    CHECK(has(judged(f, n, "memory").found,
              "8 MiB may be locked (RLIMIT_MEMLOCK), 100 MiB must be, a reserve included"));
    CHECK_FALSE(judged(f, n, "memory").cure.empty());
    f.rights.priority = 40;
    CHECK(has(judged(f, n, "real time").found, "SCHED_FIFO up to 40 only, 65 is asked for"));
    n.require_realtime = true;
    CHECK(judged(f, n, "real time").how == level::error);
    CHECK(judged(f, n, "memory").kind == error_kind::not_available);
    f.rights = {.priority = 99, .lockable_bytes = {}};
    CHECK(judged(f, n, "real time").how == level::ok);
    CHECK(judged(f, n, "memory").how == level::ok);
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
    CHECK_FALSE(f.keeps_outputs.empty());
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

} // namespace check_system_test
