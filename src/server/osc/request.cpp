// SPDX-License-Identifier: MIT
#include "server/osc/request.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::json;
using net::osc_message;
using net::osc_value;

// Reader of the values of a message, in order.
class value_list {
public:
    explicit value_list(const osc_message& m) : all_(m.values) {}

    bool left() const { return next_ != all_.size(); }
    bool next_is_number() const { return left() && as_number(all_[next_]); }
    /// Returns true if the next value is 0 or false.
    bool released() const
    {
        if (!left())
            return false;
        const auto* other = std::get_if<net::osc_other>(&all_[next_]);
        return as_number(all_[next_]) == 0.0 || (other != nullptr && other->tag == 'F');
    }

    double number(const char* what)
    {
        const std::optional<double> x = as_number(take(what, "a number"));
        if (!x)
            bad_param(what, "it is no number", "i, h, f and d are taken");
        if (!std::isfinite(*x))
            bad_param(what, "it is not finite");
        return *x;
    }
    template <typename Whole>
    Whole whole(const char* what, Whole low)
    {
        const double x = number(what);
        constexpr Whole high = std::numeric_limits<Whole>::max();
        if (x != std::floor(x) || x < low || x > high)
            bad_param(what, fmt::format("{} is no whole number of {} to {}", x, low, high));
        return static_cast<Whole>(x);
    }
    const std::string& text(const char* what)
    {
        const auto* s = std::get_if<std::string>(&take(what, "a text"));
        if (s == nullptr)
            bad_param(what, "it is no text", "s is taken");
        return *s;
    }
    void ignore_rest() { next_ = all_.size(); }
    void end() const
    {
        if (left())
            bad_param("values", fmt::format("there are {}, of which {} are known", all_.size(), next_));
    }

private:
    static std::optional<double> as_number(const osc_value& v)
    {
        if (const auto* n = std::get_if<std::int64_t>(&v))
            return static_cast<double>(*n);
        if (const auto* x = std::get_if<double>(&v))
            return *x;
        return {};
    }
    const osc_value& take(const char* what, const char* kind)
    {
        if (!left())
            bad_param(what, "it is missing", kind);
        return all_[next_++];
    }

    const std::vector<osc_value>& all_;
    std::size_t next_ = 0;
};

constexpr auto lowest_number = std::numeric_limits<std::int32_t>::min();

// Adds "soa=0.07" as the value that it would be in JSON.
void read_option(const std::string& word, json& into)
{
    const auto equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
        bad_param("options", fmt::format("\"{}\" is no option", word), "such as soa=0.07");
    const std::string name = word.substr(0, equals);
    const std::string value = word.substr(equals + 1);
    if (into.contains(name))
        bad_param("options." + name, "it is there twice");
    double x = 0.0;
    const auto r = std::from_chars(value.data(), value.data() + value.size(), x);
    if (r.ec == std::errc() && r.ptr == value.data() + value.size() && std::isfinite(x))
        into[name] = x;
    else if (value == "true" || value == "false")
        into[name] = value == "true";
    else
        into[name] = value;
}

json read_options(value_list& v)
{
    json options = json::object();
    while (v.left())
        read_option(v.text("options"), options);
    return options;
}

std::int32_t stroke_number(value_list& v)
{
    const auto n = v.whole<std::int32_t>("number", lowest_number);
    if (n == 0)
        bad_param("number", "0 stands for none", "choose another, by which the stroke is called later");
    return n;
}

void read_play(value_list& v, osc_request& r)
{
    if (v.next_is_number())
        r.number = v.whole<std::int32_t>("number", lowest_number);
    const std::string& what = v.text("stroke");
    const auto& presets = stroke_presets();
    const bool preset = std::find(presets.begin(), presets.end(), what) != presets.end();
    const auto first = what.find_first_not_of(" \t\r\n");
    const bool path = !preset && first != std::string::npos && (what[first] == 'M' || what[first] == 'm');
    r.params[path ? "path" : "stroke"] = what;
    r.params["options"] = read_options(v);
}

void read_begin(value_list& v, osc_request& r)
{
    r.number = stroke_number(v);
    json options = read_options(v);
    for (const char* own : {"timeout_s", "smooth_s"})
        if (const auto t = options.find(own); t != options.end()) {
            r.params[own] = *t;
            options.erase(t);
        }
    r.params["options"] = std::move(options);
}

void read_to(value_list& v, osc_request& r)
{
    r.number = stroke_number(v);
    r.params["x_mm"] = v.number("x_mm");
    r.params["y_mm"] = v.number("y_mm");
    if (v.left())
        r.params["intensity"] = v.number("intensity");
}

void read_own_stroke(value_list& v, osc_request& r)
{
    r.number = stroke_number(v);
    v.ignore_rest();
}

// Stops for any value but 0 and false: controllers append the state of a button. Nothing that a controller
// may append is refused.
void read_stop(value_list& v, osc_request& r)
{
    if (v.released())
        r.method.clear();
    v.ignore_rest();
}

void read_drive(value_list& v, osc_request& r)
{
    r.params["tactor"] = v.number("tactor");
    r.params["intensity"] = v.number("intensity");
    if (v.left())
        r.params["duration_s"] = v.number("duration_s");
}

void read_subscribe(value_list& v, osc_request& r)
{
    if (v.next_is_number())
        r.port = v.whole<std::uint16_t>("port", 1);
    json events = json::array();
    while (v.left()) {
        const std::string& name = v.text("events");
        if (name != "levels" && name != "stream")
            bad_param("events", fmt::format("there are no \"{}\"", name),
                      "any of levels, stream; a sender is told of its own strokes without");
        events.push_back(name);
    }
    r.params["events"] = std::move(events);
}

constexpr std::string_view osc_root = "/tactor/";
constexpr std::pair<std::string_view, void (*)(value_list& v, osc_request& r)> readers[] = {
    {"play", read_play},         {"begin", read_begin}, {"to", read_to},       {"end", read_own_stroke},
    {"cancel", read_own_stroke}, {"stop", read_stop},   {"drive", read_drive}, {"subscribe", read_subscribe},
};

} // namespace

bool is_servers_own(std::string_view address)
{
    constexpr std::array own{"/tactor/stroke", "/tactor/error", "/tactor/levels", "/tactor/stream"};
    return std::find(own.begin(), own.end(), address) != own.end();
}

osc_request read_osc(const osc_message& m)
{
    const std::string_view address = m.address;
    const auto* found = std::find_if(std::begin(readers), std::end(readers), [&](const auto& reader) {
        return address.starts_with(osc_root) && address.substr(osc_root.size()) == reader.first;
    });
    if (found == std::end(readers))
        throw fault_error(
            {net::code_no_method, "bad-input", "address", "it is not known",
             "/tactor/ with play, begin, to, end, cancel, stop, drive or subscribe; no pattern"});
    osc_request r{.method = std::string(found->first)};
    value_list v(m);
    found->second(v, r);
    v.end();
    return r;
}

} // namespace tactor::server
