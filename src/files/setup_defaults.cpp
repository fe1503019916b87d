// SPDX-License-Identifier: MIT
// [defaults]. Its keys are named as the tool's options are; it is checked here, where its lines are known.
#include "files/setup_defaults.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <variant>

#include <fmt/format.h>

#include <tactor/envelope.hpp>

#include "core/kind_names.hpp"
#include "core/option_bounds.hpp"
#include "core/suggest.hpp"
#include "files/setup_parts.hpp"

namespace tactor::detail {
namespace {

template <class T>
using member = std::optional<T> default_settings::*;

// Values that are written in another way than their field holds them.
struct milliseconds {
    member<double> seconds;
};
struct yes_or_none { // a flag that has a name
    member<bool> flag;
    std::string_view yes;
};
struct envelope_name {}; // KIND or tukey:PART
struct waveform_name {   // a waveform's name or file
    member<std::string> text;
};

using field =
    std::variant<member<double>, member<unsigned>, member<std::uint64_t>, member<bool>,
                 member<algorithm_kind>, member<phantom_kind>, member<faces_kind>, member<timing_kind>,
                 member<outside_kind>, member<overlap_kind>, member<texture_kind>, member<scale_kind>,
                 member<phase_kind>, member<format_kind>, member<observer_kind>, member<modulation>,
                 milliseconds, yes_or_none, envelope_name, waveform_name>;

struct key {
    std::string_view name;
    field to;
    bounds allowed{};
};

// The SOA's bounds are what is possible at all: the planner knows the closer ones.
namespace of = option_bounds;
using d = default_settings;
constexpr std::array keys{
    key{"algorithm", &d::algorithm},
    key{"phantom", &d::phantom},
    key{"faces", &d::faces},
    key{"speed", &d::speed_mm_s, of::speed},
    key{"soa", &d::soa_s, {0.0, 10.0, true}},
    key{"burst", &d::burst_s, of::burst},
    key{"timing", &d::timing},
    key{"outside", &d::outside},
    key{"snap", &d::snap},
    key{"drop-points", &d::drop_points},
    key{"overlap", &d::overlap},
    key{"carrier", &d::carrier_hz, of::carrier},
    key{"waveform", waveform_name{&d::waveform}},
    key{"am", &d::am},
    key{"noise-seed", &d::noise_seed, of::noise_seed},
    key{"texture", &d::texture},
    key{"texture-mm", &d::texture_mm, of::texture_mm},
    key{"envelope", envelope_name{}},
    key{"attack", &d::attack_s, of::attack},
    key{"release", &d::release_s, of::release},
    key{"phase", &d::phase},
    key{"ramp", &d::ramp_s, of::ramp},
    key{"level-dbfs", &d::level_dbfs, of::level_dbfs},
    key{"sl", &d::sl_db, of::sl},
    key{"intensity-scale", &d::intensity_scale},
    key{"stevens-exponent", &d::stevens_exponent, of::stevens_exponent},
    key{"rate", &d::rate, of::rate},
    key{"sample-format", &d::sample_format},
    key{"latency-ms", milliseconds{&d::latency_s}, of::latency_ms},
    key{"slope", &d::slope, of::slope},
    key{"intercept", &d::intercept_s, of::intercept},
    key{"compensate", yes_or_none{&d::compensate, "low-speed"}},
    key{"observer", &d::observer},
    key{"sigma-mm", &d::sigma_mm, {0.001, 1000.0}},
    key{"sigma-v-mm-s", &d::sigma_v_mm_s, {0.001, 1e6}},
};

// Reads the value at n into its field.
class reader {
public:
    reader(const toml_table& table, const key& k, const toml::node& n, default_settings& out)
        : table_(table), key_(k), node_(n), out_(out)
    {
    }

    void operator()(member<double> m) const { out_.*m = number(); }
    template <class Whole>
    requires std::is_unsigned_v<Whole>
    void operator()(member<Whole> m) const
    {
        const double v = number();
        if (v != std::floor(v))
            fail("give a whole number");
        out_.*m = static_cast<Whole>(v);
    }
    void operator()(member<bool> m) const
    {
        const auto* s = node_.as_string();
        if (!node_.is_boolean() && !(s && (s->get() == "true" || s->get() == "false")))
            fail("give true or false");
        out_.*m = s ? s->get() == "true" : node_.as_boolean()->get();
    }
    template <class Kind>
    requires std::is_enum_v<Kind>
    void operator()(member<Kind> m) const { out_.*m = from_string<Kind>(one_of(names_of<Kind>(), typed())); }
    void operator()(milliseconds m) const { out_.*m.seconds = number() / 1e3; }
    void operator()(yes_or_none m) const { out_.*m.flag = one_of({"none", m.yes}, typed()) == m.yes; }
    void operator()(member<modulation> m) const
    {
        out_.*m = checked([&] {
            return parse_modulation(node_.is_integer() || node_.is_floating_point() ? shown(node_) : text());
        });
    }
    void operator()(envelope_name) const
    {
        const std::string said = text();
        one_of(names_of<envelope_kind>(), said.substr(0, said.find(':')));
        const burst_envelope e = checked([&] { return parse_envelope(said); });
        out_.envelope = e.kind;
        out_.tukey_part = said.find(':') == std::string::npos ? std::nullopt : std::optional(e.tukey_part);
    }
    void operator()(waveform_name m) const
    {
        const std::string said = text();
        // A file is looked for where the option is used.
        if (!waveform_names_file(said))
            checked([&] { return parse_waveform(said); });
        out_.*m.text = said;
    }

private:
    [[noreturn]] void fail(std::string_view hint) const
    {
        fail_at(table_.where(node_), fmt::format("{} is {}", key_.name, shown(node_)), hint);
    }
    // Empty for what is no text.
    std::string typed() const { return node_.is_string() ? node_.as_string()->get() : std::string(); }
    std::string text() const
    {
        std::string said = typed();
        if (said.empty())
            fail("give a text");
        return said;
    }
    std::string_view one_of(const std::vector<std::string_view>& names, std::string_view said) const
    {
        const auto found = std::find(names.begin(), names.end(), said);
        if (found == names.end())
            fail(suggestion(said, names, "values"));
        return *found;
    }
    // A value in quotes is taken as typed: "0.07" is 0.07.
    double number() const
    {
        if (!node_.is_string())
            return table_.number_of(node_, key_.name, key_.allowed);
        const std::string said = typed();
        double v = 0.0;
        const char* end = said.data() + said.size();
        const auto [stop, code] = std::from_chars(said.data(), end, v);
        if (code != std::errc() || stop != end)
            fail("give a number");
        return table_.within(node_, key_.name, v, key_.allowed);
    }
    // What parse() says is wrong stands at this value.
    template <class Parse>
    std::invoke_result_t<Parse> checked(Parse parse) const
    {
        try {
            return parse();
        } catch (const error& e) {
            fail(e.hint());
        }
    }

    const toml_table& table_;
    const key& key_;
    const toml::node& node_;
    default_settings& out_;
};

// Writes a field as text; none is not said.
struct writer {
    const default_settings& from;

    template <class T>
    std::optional<std::string> operator()(member<T> m) const
    {
        return from.*m ? std::optional(written(*(from.*m))) : std::nullopt;
    }
    std::optional<std::string> operator()(milliseconds m) const
    {
        // 15 digits: the number that was divided.
        return from.*m.seconds ? std::optional(fmt::format("{:.15g}", *(from.*m.seconds) * 1e3))
                               : std::nullopt;
    }
    std::optional<std::string> operator()(yes_or_none m) const
    {
        return from.*m.flag ? std::optional(std::string(*(from.*m.flag) ? m.yes : "none")) : std::nullopt;
    }
    std::optional<std::string> operator()(envelope_name) const
    {
        if (!from.envelope)
            return {};
        if (from.envelope == envelope_kind::tukey && from.tukey_part)
            return envelope_text({.kind = envelope_kind::tukey, .tukey_part = *from.tukey_part});
        return std::string(to_string(*from.envelope));
    }
    std::optional<std::string> operator()(waveform_name m) const { return from.*m.text; }

private:
    template <class T>
    requires std::is_arithmetic_v<T>
    static std::string written(T v) { return fmt::format("{}", v); }
    template <class Kind>
    requires std::is_enum_v<Kind>
    static std::string written(Kind k) { return std::string(to_string(k)); }
    static std::string written(const modulation& m)
    {
        return m.depth == modulation().depth ? fmt::format("{}", m.hz) : fmt::format("{}:{}", m.hz, m.depth);
    }
};

} // namespace

void read_defaults(const toml_table& root, setup& out)
{
    const auto t = root.table("defaults", "[defaults]", "[defaults]");
    if (!t)
        return;
    const auto names = default_names();
    t->only({names.begin(), names.end()});
    for (const key& k : keys)
        if (const toml::node* n = t->node(k.name)) {
            std::visit(reader(*t, k, *n, out.defaults), k.to);
            out.defaults_at.insert_or_assign(std::string(k.name), t->where(*n));
        }
    if (t->has("sl") && t->has("level-dbfs"))
        t->one_of({"level-dbfs", "sl"});
    // What an included file says of the other.
    if (t->has("sl"))
        out.defaults.level_dbfs.reset();
    if (t->has("level-dbfs"))
        out.defaults.sl_db.reset();
}

std::span<const std::string_view> default_names()
{
    static constexpr auto names = [] {
        std::array<std::string_view, keys.size()> all;
        std::transform(keys.begin(), keys.end(), all.begin(), [](const key& k) { return k.name; });
        return all;
    }();
    return names;
}

std::map<std::string, std::string> default_texts(const default_settings& s)
{
    std::map<std::string, std::string> texts;
    for (const key& k : keys)
        if (auto text = std::visit(writer{s}, k.to))
            texts.emplace(k.name, *std::move(text));
    return texts;
}

} // namespace tactor::detail
