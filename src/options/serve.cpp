// SPDX-License-Identifier: MIT
#include "options/serve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <variant>

#include <arpa/inet.h>
#include <netinet/in.h>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/bounds.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "options/option.hpp"

namespace tactor::options {
namespace {

[[noreturn]] void fail(const written_value& d, const std::string& why, std::string_view hint)
{
    throw error(error_kind::bad_input, d.at, why, hint).with_field(d.name);
}

std::string read_text_value(const written_value& d)
{
    const auto* text = std::get_if<std::string>(&d.value);
    if (text == nullptr)
        fail(d, fmt::format("{} is {}", d.name, value_text(d.value)), "give a string in quotes");
    if (text->empty() || text->find('\0') != std::string::npos)
        fail(d, fmt::format("{} is {}", d.name, text->empty() ? "empty" : "not a text"), {});
    return *text;
}

double read_number(const written_value& d, detail::bounds b, bool whole)
{
    const auto* v = std::get_if<double>(&d.value);
    if (v == nullptr || (whole && *v != std::floor(*v)))
        fail(d, fmt::format("{} is {}", d.name, value_text(d.value)),
             fmt::format("give a {}number{}", whole ? "whole " : "",
                         std::holds_alternative<std::string>(d.value) ? " without quotes" : ""));
    if (!b.holds(*v))
        fail(d, fmt::format("{} is {}", d.name, value_text(d.value)),
             fmt::format("use {} to {}", plain_number(b.low), plain_number(b.high)));
    return *v;
}

// Returns true for a name, an IPv4 address, or an IPv6 address in brackets, each without a port.
bool is_host(std::string_view text)
{
    std::string_view others = "._-";
    if (text.size() > 2 && text.front() == '[' && text.back() == ']' && text.find(':') != text.npos) {
        text = text.substr(1, text.size() - 2);
        others = "._-:%";
    }
    return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               others.find(c) != others.npos;
    });
}

bool is_port(std::string_view text)
{
    return detail::parse_number_text<std::uint16_t>(text).has_value();
}

// Returns true for the form [HOST:]PORT. Does not check whether this machine has the host; listening does
// this.
bool is_address(std::string_view text)
{
    const auto colon = text.rfind(':');
    if (colon == std::string_view::npos)
        return is_port(text);
    return is_host(text.substr(0, colon)) && is_port(text.substr(colon + 1));
}

// Reads a host with or without a port. It is later compared with the Host headers of browsers.
std::string read_host(const written_value& d)
{
    std::string text = read_text_value(d);
    const std::string_view all(text);
    const auto colon = all.rfind(':');
    // A leading zero is refused, because browsers write ports without leading zeros.
    const bool has_port = colon != all.npos && is_port(all.substr(colon + 1)) && all[colon + 1] != '0';
    if (!is_host(all) && !(has_port && is_host(all.substr(0, colon))))
        fail(d, fmt::format("\"{}\" is not a host", text),
             "give HOST[:PORT] without a scheme and a path, such as pi.lan, pi.lan:8080 or \"[fd00::7]\"");
    return text;
}

// Reads an address such as "127.0.0.1:4001", or a port such as 4001.
std::string read_address(const written_value& d)
{
    if (std::holds_alternative<double>(d.value))
        return plain_number(read_number(d, {0.0, 65535.0}, true));
    std::string text = read_text_value(d);
    if (!is_address(text))
        fail(d, fmt::format("\"{}\" is not an address", text),
             "give [HOST:]PORT, such as 4001, \"0.0.0.0:4001\" or \"[::1]:4001\"; ports are 0 to 65535, 0 "
             "selects "
             "a free one");
    return text;
}

// Returns true for "192.168.1.0/24", "fd00::/8", or an address alone, such as fe80::1%eth0.
bool is_prefix(std::string_view text)
{
    const auto slash = text.find('/');
    const std::string address(text.substr(0, slash));
    in6_addr bytes{}; // large enough for IPv4 and IPv6
    const bool v4 = ::inet_pton(AF_INET, address.c_str(), &bytes) == 1;
    if (!v4 && ::inet_pton(AF_INET6, address.substr(0, address.find('%')).c_str(), &bytes) != 1)
        return false;
    if (slash == text.npos)
        return true;
    const auto bits = detail::parse_number_text<unsigned>(text.substr(slash + 1));
    return bits && *bits <= (v4 ? 32U : 128U);
}

// Reads an address prefix. Senders are compared with it later.
std::string read_prefix(const written_value& d)
{
    std::string text = read_text_value(d);
    if (!is_prefix(text))
        fail(d, fmt::format("\"{}\" is neither an address nor a prefix", text),
             "use an address or a prefix, such as 192.168.1.7, 192.168.1.0/24 or fd00::/8");
    return text;
}

using text_place = std::optional<std::string> serve_settings::*;
using list_place = std::vector<std::string> serve_settings::*;
using number_place = std::optional<double> serve_settings::*;
using limit_place = double serve_limits::*;
using count_place = std::size_t serve_limits::*;

struct key {
    std::string_view name;
    std::variant<text_place, list_place, number_place, limit_place, count_place> to;
    detail::bounds allowed = {};
    std::string (*read_text)(const written_value&) = read_text_value;
};

constexpr double most = std::numeric_limits<int>::max();

const std::array keys{
    key{"socket", &serve_settings::socket},
    key{"tcp", &serve_settings::tcp, {}, read_address},
    key{"osc", &serve_settings::osc, {}, read_address},
    key{"http", &serve_settings::http, {}, read_address},
    key{"bhaptics", &serve_settings::bhaptics, {}, read_address},
    key{"token_file", &serve_settings::token_file},
    key{"allow_hosts", &serve_settings::allow_hosts, {}, read_host},
    key{"osc_peers", &serve_settings::osc_peers, {}, read_prefix},
    key{"max_level_dbfs", &serve_settings::max_level_dbfs, detail::bounds_of::level_dbfs},
    key{"idle_stop_s", &serve_settings::idle_stop_s, detail::bounds_of::timeout_s},
    key{"max_clients", &serve_limits::max_clients, {1, 100'000}},
    key{"kept_clients", &serve_limits::kept_clients, {0, 100'000}},
    key{"max_strokes", &serve_limits::max_strokes, {1, 100'000}},
    key{"max_live_strokes", &serve_limits::max_live_strokes, {0, 100'000}},
    key{"max_points_per_s", &serve_limits::max_points_per_s, {1, 10'000'000}},
    key{"max_stroke_s", &serve_limits::max_stroke_s, detail::bounds_of::timeout_s},
    key{"max_message_bytes", &serve_limits::max_message_bytes, {1024, most}},
    key{"max_nesting", &serve_limits::max_nesting, {4, 10'000}},
    key{"max_message_s", &serve_limits::max_message_s, detail::bounds_of::timeout_s},
    key{"max_unread_bytes", &serve_limits::max_unread_bytes, {1024, most}},
};

const key& find_key(const written_value& d)
{
    const auto found =
        std::find_if(keys.begin(), keys.end(), [&d](const key& k) { return k.name == d.name; });
    if (found != keys.end())
        return *found;
    std::vector<std::string_view> known;
    for (const key& k : keys)
        known.push_back(k.name);
    throw detail::unknown_key(d.name_at, d.name, "[serve]", known);
}

void take(serve_settings& s, const key& k, const written_value& d)
{
    const auto* list = std::get_if<list_place>(&k.to);
    if ((list != nullptr) != d.in_list)
        fail(d, fmt::format("{} is {}", d.name, d.in_list ? "a list" : value_text(d.value)),
             d.in_list ? "give one value" : "give a list of texts");
    if (list != nullptr)
        (s.*(*list)).push_back(k.read_text(d));
    else if (const auto* text = std::get_if<text_place>(&k.to))
        s.*(*text) = k.read_text(d);
    else if (const auto* number = std::get_if<number_place>(&k.to))
        s.*(*number) = read_number(d, k.allowed, false);
    else if (const auto* limit = std::get_if<limit_place>(&k.to))
        s.limits.*(*limit) = read_number(d, k.allowed, false);
    else
        s.limits.*std::get<count_place>(k.to) = static_cast<std::size_t>(read_number(d, k.allowed, true));
}

} // namespace

serve_settings read_serve(const std::vector<written_value>& entries)
{
    serve_settings s;
    const written_value* kept = nullptr;
    for (const written_value& d : entries) {
        const key& k = find_key(d);
        take(s, k, d);
        if (k.name == "kept_clients")
            kept = &d;
        if (k.name == "max_level_dbfs")
            s.max_level_at = d.at;
    }
    serve_limits& l = s.limits;
    if (kept == nullptr)
        l.kept_clients = std::min(l.kept_clients, l.max_clients / 2);
    else if (l.kept_clients >= l.max_clients)
        fail(*kept, fmt::format("kept_clients is {}, but max_clients is {}", l.kept_clients, l.max_clients),
             "set kept_clients below max_clients");
    return s;
}

std::vector<std::pair<std::string_view, double>> list_limits(const serve_limits& l)
{
    std::vector<std::pair<std::string_view, double>> all;
    for (const key& k : keys)
        if (const auto* limit = std::get_if<limit_place>(&k.to))
            all.emplace_back(k.name, l.*(*limit));
        else if (const auto* count = std::get_if<count_place>(&k.to))
            all.emplace_back(k.name, static_cast<double>(l.*(*count)));
    return all;
}

} // namespace tactor::options
