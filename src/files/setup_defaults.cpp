// SPDX-License-Identifier: MIT
// [defaults]: options of the command line. They are checked here, where their line is known, and
// kept as text, which the tool takes as if it had been typed.
#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include <fmt/format.h>

#include <tactor/waveform.hpp>

#include "core/suggest.hpp"
#include "files/setup_parts.hpp"

namespace tactor::detail {
namespace {

enum class kind { word, text, number, whole, flag };

struct option {
    std::string_view name;
    kind is;
    bounds allowed{};
    std::array<std::string_view, 5> words{};
};

constexpr double max_hz = 384000.0; // half of the highest rate

// What is possible at all; the planner knows the closer bounds.
constexpr std::array options{
    option{"algorithm", kind::word, {}, {"park2016", "tactile-brush", "continuous"}},
    option{"phantom", kind::word, {}, {"inverse-distance", "barycentric", "linear", "log", "gaussian"}},
    option{"speed", kind::number, {0.0, max_mm, true}},
    option{"soa", kind::number, {0.0, 10.0, true}},
    option{"burst", kind::number, {0.0001, 10.0}},
    option{"timing", kind::word, {}, {"fixed", "fit"}},
    option{"outside", kind::word, {}, {"error", "clamp"}},
    option{"snap", kind::flag},
    option{"drop-points", kind::flag},
    option{"overlap", kind::word, {}, {"energy", "max", "sum"}},
    option{"carrier", kind::number, {1.0, max_hz}},
    option{"waveform", kind::text},
    option{"am", kind::text},
    option{"noise-seed", kind::whole, {0.0, 4294967295.0}},
    option{"texture", kind::word, {}, {"cycle", "time", "length"}},
    option{"texture-mm", kind::number, {0.0, max_mm}},
    option{"envelope", kind::text, {}, {"raised-cosine", "linear", "exponential", "tukey"}},
    option{"attack", kind::number, {0.0, 10.0}},
    option{"release", kind::number, {0.0, 10.0}},
    option{"phase", kind::word, {}, {"stroke", "burst"}},
    option{"ramp", kind::number, {0.0, 10.0}},
    option{"level-dbfs", kind::number, {min_db, 0.0}},
    option{"sl", kind::number, {min_db, -min_db}},
    option{"intensity-scale", kind::word, {}, {"linear", "sl", "stevens"}},
    option{"stevens-exponent", kind::number, {0.1, 3.0}},
    option{"rate", kind::whole, {8000.0, 768000.0}},
    option{"sample-format", kind::word, {}, {"float", "s16", "s24", "s24-4", "s32"}},
    option{"latency-ms", kind::number, {0.0, 10000.0}},
    option{"slope", kind::number, {0.0, 0.99}},
    option{"intercept", kind::number, {0.0, 10.0, true}},
    option{"compensate", kind::word, {}, {"none", "low-speed"}},
    option{"observer", kind::word, {}, {"centroid", "low-speed"}},
    option{"sigma-mm", kind::number, {0.001, 1000.0}},
    option{"sigma-v-mm-s", kind::number, {0.001, 1e6}},
};

// A value in quotes is taken as typed: "0.07" is 0.07.
double number_in(const toml_table& t, const option& o, const toml::node& n)
{
    const auto* s = n.as_string();
    if (!s)
        return t.number_of(n, o.name, o.allowed);
    double v = 0.0;
    const char* end = s->get().data() + s->get().size();
    const auto [stop, code] = std::from_chars(s->get().data(), end, v);
    if (code != std::errc() || stop != end)
        fail_at(t.where(n), fmt::format("{} is {}", o.name, shown(n)), "give a number");
    return t.within(n, o.name, v, o.allowed);
}

// What only the option's own reader knows, checked here as far as it goes without a file.
std::string text_in(const toml_table& t, const option& o, const toml::node& n)
{
    const bool number = o.name == "am" && (n.is_integer() || n.is_floating_point());
    std::string said = n.is_string() ? n.as_string()->get() : number ? shown(n) : std::string();
    if (said.empty())
        fail_at(t.where(n), fmt::format("{} is {}", o.name, shown(n)), "give a text");
    const std::string_view head = std::string_view(said).substr(0, said.find(':'));
    if (!o.words.front().empty() && std::find(o.words.begin(), o.words.end(), head) == o.words.end())
        fail_at(t.where(n), fmt::format("{} is {}", o.name, shown(n)),
                suggestion(said, std::span(o.words).first(4), "values"));
    try {
        if (o.name == "am")
            static_cast<void>(parse_modulation(said));
        // A file is looked for where the option is used.
        if (o.name == "waveform" && !waveform_names_file(said))
            static_cast<void>(parse_waveform(said));
    } catch (const error& e) {
        fail_at(t.where(n), fmt::format("{} is {}", o.name, shown(n)), e.hint());
    }
    return said;
}

std::string value_of(const toml_table& t, const option& o, const toml::node& n)
{
    if (o.is == kind::text)
        return text_in(t, o, n);
    if (o.is == kind::number)
        return fmt::format("{}", number_in(t, o, n));
    if (o.is == kind::whole) {
        const double v = number_in(t, o, n);
        if (v != static_cast<double>(static_cast<unsigned>(v)))
            fail_at(t.where(n), fmt::format("{} is {}", o.name, v), "give a whole number");
        return fmt::format("{}", static_cast<unsigned>(v));
    }
    if (o.is == kind::flag) {
        const auto* s = n.as_string();
        if (!n.is_boolean() && !(s && (s->get() == "true" || s->get() == "false")))
            fail_at(t.where(n), fmt::format("{} is {}", o.name, shown(n)), "give true or false");
        return s ? s->get() : shown(n);
    }
    std::vector<std::string_view> words;
    for (const std::string_view w : o.words)
        if (!w.empty())
            words.push_back(w);
    std::string said = n.is_string() ? n.as_string()->get() : std::string();
    for (const std::string_view w : words)
        if (w == said)
            return said;
    fail_at(t.where(n), fmt::format("{} is {}", o.name, shown(n)), suggestion(said, words, "values"));
}

} // namespace

void read_defaults(const toml_table& root, setup& out)
{
    const auto t = root.table("defaults", "[defaults]", "[defaults]");
    if (!t)
        return;
    t->only(std::vector<std::string_view>(setup_default_names().begin(), setup_default_names().end()));
    for (const option& o : options)
        if (const toml::node* n = t->node(o.name))
            out.defaults[std::string(o.name)] = value_of(*t, o, *n);
    if (t->has("sl") && t->has("level-dbfs"))
        t->one_of({"level-dbfs", "sl"});
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

const std::vector<std::string>& setup_default_names()
{
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all;
        for (const detail::option& o : detail::options)
            all.emplace_back(o.name);
        return all;
    }();
    return names;
}

} // namespace v0
} // namespace tactor
