// SPDX-License-Identifier: MIT
// Wiring: the device channels that a PCM's channels reach, by its definition and by libasound.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <alsa/asoundlib.h>
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "folder.hpp"
#include "has.hpp"
#include "sink/alsa/configuration.hpp"
#include "sink/alsa/devices/route.hpp"
#include "sink/alsa/handle.hpp"
#include "sink/alsa/negotiate.hpp"

namespace wiring_test {

using namespace tactor;
using channels = std::vector<std::vector<unsigned>>;

namespace {

stream_wiring wired(const std::string& text, const std::string& name, unsigned n)
{
    return alsa::find_wiring(alsa::read_configuration(text).get(), name, n, n);
}

constexpr const char* definitions = R"(
pcm.hw { @args [ CARD DEV ] @args.CARD { type string default "0" } @args.DEV { type integer default 0 } type hw card $CARD device $DEV }
pcm.plug { @args [ SLAVE ] @args.SLAVE { type string } type plug slave.pcm $SLAVE }
pcm.null { type null }
pcm.swapped { type route slave { pcm "hw:0" channels 4 } ttable { 0.1 1 1.0 1 2.2 0.5 3.3 0 } }
pcm.above { type plug slave.pcm "swapped" }
pcm.again { type route slave.pcm "swapped" ttable { 0.1 1 1.0 1 2.3 1 3.2 1 } }
pcm.tabled { type plug slave.pcm "hw:0" ttable { 0.0 1 1.0 1 } }
pcm.mixed { type dmix ipc_key 1 slave { pcm "hw:Tactor" channels 8 } bindings { 0 7 1 8 } }
pcm.shared { type dshare ipc_key 1 slave "eight" bindings { 0 6 1 6 2 5 } }
pcm_slave.eight { pcm "hw:0" channels 8 }
pcm.unbound { type dmix ipc_key 1 slave "eight" }
pcm.two { type multi slaves { a { pcm "hw:0" channels 2 } b { pcm "hw:1" channels 2 } }
          bindings { 0 { slave a channel 1 } 1 { slave b channel 0 } 3 { slave b channel 1 } 4 { slave c channel 0 } } }
pcm.same { type multi slaves { a { pcm "mixed" channels 2 } b { pcm "mixed" channels 2 } }
           bindings { 0 { slave a channel 0 } 1 { slave b channel 0 } } }
pcm.both { type asym playback.pcm "swapped" capture.pcm "tabled" }
pcm.alias "swapped"
pcm.over { type softvol slave.pcm { type rate slave { pcm { type file file "/dev/null" slave.pcm "swapped" } rate 48000 } } }
pcm.front { type route slave.pcm "hw:0" ttable { 0.FL 1 1.FR 1 } }
pcm.odd { type ladspa slave.pcm "hw:0" }
pcm.desk { type plug slave.pcm { type pulse } }
pcm.round { type plug slave.pcm "round" }
pcm.wide { type multi slaves { a { pcm "wide" channels 1 } b { pcm "wide" channels 1 } c { pcm "wide" channels 1 } }
           bindings.0 { slave a channel 0 } }
pcm.typeless { slave.pcm "hw:0" }
pcm.nowhere { type plug slave.pcm "none" }
pcm.slaveless { type plug }
pcm.huge { type route slave { pcm "hw:0" channels 2000000000 } ttable { 0.1 1 999999999.0 1 1.99999 1 } }
)";

stream_wiring defined(const std::string& name, unsigned n)
{
    return wired(definitions, name, n);
}

} // namespace

TEST_CASE("a plugin that passes its channels on changes nothing")
{
    for (const char* name :
         {"null", "hw:0", "hw:CARD=Tactor,DEV=3", "plug:null", "plug:'hw:0,1'", "unbound"}) {
        CAPTURE(name);
        const stream_wiring w = defined(name, 8);
        CHECK(w.outputs.empty());
        CHECK(w.hidden_by == "");
    }
}

TEST_CASE("tables and bindings define the reached channels of the device, through any plugins between")
{
    const channels swapped{{1}, {0}, {2}, {}};
    for (const char* name : {"swapped", "above", "plug:swapped", "both", "alias", "over"}) {
        CAPTURE(name);
        CHECK(defined(name, 4).outputs == swapped);
        CHECK(defined(name, 4).hidden_by == "");
    }
    CHECK(defined("swapped", 6).outputs == channels{{1}, {0}, {2}, {}, {}, {}});
    CHECK(defined("swapped", 2).outputs == channels{{1}, {0}});
    CHECK(defined("again", 4).outputs.empty() == false);
    CHECK(defined("again", 4).outputs == channels{{0}, {1}, {}, {2}});
    CHECK(defined("tabled", 2).outputs == channels{{0}, {0}});
    CHECK(defined("mixed", 3).outputs == channels{{7}, {}, {}});
    CHECK(defined("shared", 3).outputs == channels{{6}, {6}, {5}});
    CHECK(defined("two", 5).outputs == channels{{1}, {1024}, {}, {1025}, {}});
    CHECK(defined("same", 2).outputs == channels{{7}, {7}}); // one device on two ways
}

TEST_CASE("tables change levels, and below -60 dB nothing is reached")
{
    const auto through = [](const std::string& table) {
        return wired("pcm.n { type null } pcm.h { type route slave.pcm n ttable { 0.0 0.5 1.1 1 } }"
                     "pcm.t { type route slave.pcm h ttable { " +
                         table + " } }",
                     "t", 2);
    };
    using gains = std::vector<std::vector<double>>;
    CHECK(through("0.0 1 1.1 1").gains == gains{{0.5}, {1.0}});
    CHECK(through("0.0 2 1.1 1").outputs.empty()); // back to 1
    CHECK(through("0.0 -0.1 1.1 4").gains == gains{{-0.05}, {4.0}});
    CHECK(through("0.0 1 0.1 0.5 1.1 1").gains == gains{{0.5, 0.5}, {1.0}});
    CHECK(through("0.0 0.001 1.1 0.001").outputs == channels{{}, {1}});
    CHECK(through("0.0 0.001 1.1 0.001").gains == gains{{}, {0.001}});
    const stream_wiring soft =
        wired("pcm.n { type null } pcm.t { type softvol slave.pcm n control { name x card 0 } }", "t", 2);
    CHECK(soft.outputs.empty());
    CHECK(soft.level_by == "type softvol");
}

TEST_CASE("unknown definitions are reported, and give no channels")
{
    const auto hidden = [](const std::string& name) {
        const stream_wiring w = defined(name, 4);
        CHECK(w.outputs.empty());
        return w.hidden_by;
    };
    CHECK(hidden("odd") == "type ladspa");
    CHECK(hidden("desk") == "type pulse");
    CHECK(hidden("front") == "type route to a channel FL");
    CHECK(hidden("typeless") == "a definition without a type");
    CHECK(hidden("nowhere") == "none, which is not defined");
    CHECK(hidden("slaveless") == "a slave that is not defined");
}

TEST_CASE("definitions that lead to themselves, or to more than anyone has, end")
{
    CHECK(defined("round", 9).hidden_by == "more definitions than anyone has");
    CHECK(defined("wide", 9).hidden_by == "more definitions than anyone has");
    CHECK(defined("huge", 2).outputs == channels{{1}, {}});
    std::string all;
    for (unsigned c = 0; c < 1024; ++c)
        for (unsigned s = 0; s < 1024; ++s)
            all += fmt::format("ttable.{}.{} 1\n", c, s);
    CHECK(
        wired("pcm.n { type null } pcm.t { type route slave { pcm n channels 1024 } " + all + "}", "t", 1024)
            .hidden_by == "a larger table than anyone has");
}

namespace {

// Random chains of plugins over devices that write their input into files.
class chance {
public:
    chance(unsigned seed, const folder& here, unsigned n) : random_(seed), here_(here), channels_(n) {}

    std::string text()
    {
        const std::string top = plugin("t", 3);
        return "pcm.null { type null }\n" + top + devices_;
    }
    /// In the order in which they are met.
    const std::vector<std::string>& files() const { return files_; }

private:
    unsigned below(unsigned n) { return std::uniform_int_distribution<unsigned>(0, n - 1)(random_); }

    std::string device(const std::string& name)
    {
        files_.push_back((here_ / name).string());
        return fmt::format("pcm.{} {{ type file slave.pcm null file \"{}\" format raw }}\n", name,
                           files_.back());
    }

    std::string table()
    {
        std::string s = "ttable {";
        for (unsigned c = 0; c < channels_; ++c)
            for (unsigned k = 0; k < channels_; ++k)
                if (below(3) == 0 || (c == 0 && k == 0)) // an empty one is refused
                    s += fmt::format(" {}.{} {}", c, k, std::vector{"1", "0.5", "0"}[below(3)]);
        return s + " }";
    }

    std::string multi(const std::string& name, int depth)
    {
        std::string s = fmt::format(
            "pcm.{} {{ type multi slaves {{ a {{ pcm {}a channels {} }} b {{ pcm {}b channels {} }} }}", name,
            name, channels_, name, channels_);
        std::set<std::pair<unsigned, unsigned>> taken; // no two on one, which libasound refuses
        for (unsigned c = 0; c < channels_; ++c) {
            std::pair<unsigned, unsigned> to{below(2), below(channels_)};
            while (taken.contains(to))
                to = {below(2), below(channels_)};
            taken.insert(to);
            s += fmt::format(" bindings.{} {{ slave {} channel {} }}", c, to.first == 0 ? "a" : "b",
                             to.second);
        }
        s += " }\n";
        s += plugin(name + "a", depth - 1);
        return s + plugin(name + "b", depth - 1);
    }

    std::string plugin(const std::string& name, int depth)
    {
        const std::string inner = name + "x";
        if (depth == 0 || below(5) == 0)
            return device(name);
        switch (below(4)) {
        case 0:
            return fmt::format("pcm.{} {{ type route slave.pcm {} {} }}\n", name, inner, table()) +
                   plugin(inner, depth - 1);
        case 1:
            return fmt::format("pcm.{} {{ type plug slave.pcm {} {} }}\n", name, inner,
                               below(2) == 0 ? table() : "") +
                   plugin(inner, depth - 1);
        case 2:
            return multi(name, depth);
        default:
            return fmt::format("pcm.{} {{ type copy slave.pcm {} }}\n", name, inner) +
                   plugin(inner, depth - 1);
        }
    }

    std::mt19937 random_;
    const folder& here_;
    unsigned channels_;
    std::string devices_ = {};
    std::vector<std::string> files_ = {};
};

// Plays a frame for each channel with a sample in that channel only; returns the samples of the devices that
// it reached.
channels heard(const alsa_options& o, const folder& here, const std::vector<std::string>& files)
{
    {
        const alsa::library_messages silent;
        const alsa::configuration top = alsa::read_configuration(o.config_text);
        const alsa::handle h = alsa::open(o, top.get());
        static_cast<void>(alsa::negotiate(h.get(), o));
        REQUIRE(snd_pcm_prepare(h.get()) >= 0);
        std::vector<std::int16_t> frames(std::size_t{o.channels} * o.channels);
        for (unsigned c = 0; c < o.channels; ++c)
            frames[c * (o.channels + 1)] = 8000;
        REQUIRE(snd_pcm_writei(h.get(), frames.data(), o.channels) == static_cast<long>(o.channels));
    }
    channels all(o.channels);
    for (std::size_t f = 0; f < files.size(); ++f) {
        const std::string bytes = here.bytes(files[f]);
        const std::size_t width = bytes.size() / o.channels / o.channels;
        for (unsigned c = 0; c < o.channels && width > 0; ++c)
            for (unsigned k = 0; k < o.channels; ++k) {
                const std::string sample = bytes.substr((c * o.channels + k) * width, width);
                if (sample != std::string(width, '\0'))
                    all[c].push_back(static_cast<unsigned>(f) * 1024 + k);
            }
    }
    return all;
}

} // namespace

TEST_CASE("the largest factor after a table counts, not only the one at the device")
{
    const std::string half =
        "pcm.n { type null }\npcm.half { type route slave.pcm n ttable { 0.0 0.5 1.1 0.5 } }\n";
    const auto most = [&](const std::string& table) {
        return wired(half + "pcm.t { type route slave.pcm half ttable { " + table + " } }", "t", 2).most_gain;
    };
    CHECK(most("0.0 2 1.1 1") == 2.0);
    CHECK(most("0.0 1 1.1 -4") == 4.0);
    CHECK(most("0.0 1 1.1 0.5") == 1.0);
    CHECK(most("0.0 0.5 1.1 0.5 2.2 4") == 1.0); // of a channel that the stream does not have
    // Two ways to one channel add up.
    CHECK(wired(half + "pcm.two { type route slave.pcm half ttable { 0.0 0.9 1.0 0.9 } }\n"
                       "pcm.t { type route slave { pcm two channels 2 } ttable { 0.0 1 0.1 1 } }",
                "t", 1)
              .most_gain == doctest::Approx(1.8));
    CHECK(wired(half + "pcm.t { type plug slave.pcm half ttable { 0.0 2 1.1 2 } }", "t", 2).outputs.empty());
}

TEST_CASE("for random chains of plugins the wiring is that of libasound")
{
    constexpr unsigned n = 4;
    unsigned crossed = 0;
    for (unsigned seed = 0; seed < 200; ++seed) {
        const folder here;
        chance made(seed, here, n);
        const alsa_options o{
            .pcm = "t", .channels = n, .format = format_kind::s16, .config_text = made.text()};
        INFO(o.config_text);
        const stream_wiring w = wired(o.config_text, o.pcm, n);
        CHECK(w.hidden_by == "");
        channels expected = w.outputs;
        for (unsigned c = 0; expected.size() < n; ++c)
            expected.push_back({c});
        CHECK(heard(o, here, made.files()) == expected);
        crossed += w.outputs.empty() ? 0 : 1;
    }
    CHECK(crossed > 50);
}

} // namespace wiring_test
