// SPDX-License-Identifier: MIT
// [serve].
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/prefix_bits.hpp"
#include "files/setup_parts.hpp"

namespace tactor::detail {
namespace {

constexpr unsigned most = std::numeric_limits<int>::max();

std::vector<std::string> texts(const toml_table& t, std::string_view key)
{
    std::vector<std::string> all;
    if (!t.has(key))
        return all;
    for (const toml::node& entry : *t.list(key, "texts")) {
        const auto* text = entry.as_string();
        if (text == nullptr || text->get().empty())
            fail_at(t.where(entry), fmt::format("an entry of {} is {}", key, shown(entry)), "give a text");
        all.push_back(text->get());
    }
    return all;
}

// [HOST:]PORT; whether this machine has such a host is seen when it is listened at.
bool is_address(std::string_view text)
{
    const auto colon = text.rfind(':');
    if (colon != std::string_view::npos) {
        const std::string_view host = text.substr(0, colon);
        const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
        if (host.empty() || (!bracketed && host.find(':') != std::string_view::npos))
            return false;
        text.remove_prefix(colon + 1);
    }
    std::uint16_t port = 0;
    const auto r = std::from_chars(text.data(), text.data() + text.size(), port);
    return r.ec == std::errc() && r.ptr == text.data() + text.size();
}

// Which of them are near is seen when they send.
std::vector<std::string> prefixes(const toml_table& t, std::string_view key)
{
    std::vector<std::string> all = texts(t, key);
    for (std::size_t i = 0; i < all.size(); ++i)
        if (!prefix_bits(all[i]))
            fail_at(t.where((*t.list(key, "texts"))[i]),
                    fmt::format("\"{}\" is neither an address nor a prefix", all[i]),
                    "such as 192.168.1.7, 192.168.1.0/24 or fd00::/8");
    return all;
}

// "127.0.0.1:4001", or a bare 4001.
std::optional<std::string> address(const toml_table& t, std::string_view key)
{
    if (const toml::node* n = t.node(key); n != nullptr && n->is_integer())
        return std::to_string(*t.whole(key, 0, 65535));
    auto text = t.text(key);
    if (text && !is_address(*text))
        t.fail(key, fmt::format("\"{}\" is no address", *text),
               "[HOST:]PORT, such as 4001, \"0.0.0.0:4001\" or \"[::1]:4001\"; port 0 takes a free one");
    return text;
}

void read_serve_limits(const toml_table& t, serve_settings& s)
{
    s.max_clients = t.whole("max_clients", 1, 100'000);
    s.kept_clients = t.whole("kept_clients", 0, 100'000);
    s.max_strokes = t.whole("max_strokes", 1, 100'000);
    s.max_live_strokes = t.whole("max_live_strokes", 0, 100'000);
    s.max_points_per_s = t.whole("max_points_per_s", 1, 10'000'000);
    s.max_stroke_s = t.number("max_stroke_s", bounds_of::timeout_s);
    s.max_message_bytes = t.whole("max_message_bytes", 1024, most);
    s.max_nesting = t.whole("max_nesting", 4, 10'000);
    s.max_message_s = t.number("max_message_s", bounds_of::timeout_s);
    s.max_unread_bytes = t.whole("max_unread_bytes", 1024, most);
    s.max_all_unread_bytes = t.whole("max_all_unread_bytes", 1024, most);
    s.max_all_unfinished_bytes = t.whole("max_all_unfinished_bytes", 65536, most);
    if (s.kept_clients && *s.kept_clients >= s.max_clients.value_or(128))
        t.fail("kept_clients",
               fmt::format("{} places are kept of {}", *s.kept_clients, s.max_clients.value_or(128)),
               "keep fewer than max_clients");
}

} // namespace

void read_serve(const toml_table& root, located_setup& out)
{
    const auto t = root.table("serve", "[serve]", "[serve]");
    if (!t)
        return;
    t->only({"socket",
             "tcp",
             "osc",
             "http",
             "token_file",
             "allow_hosts",
             "osc_peers",
             "max_level_dbfs",
             "idle_stop_s",
             "max_clients",
             "kept_clients",
             "max_strokes",
             "max_live_strokes",
             "max_points_per_s",
             "max_stroke_s",
             "max_message_bytes",
             "max_nesting",
             "max_message_s",
             "max_unread_bytes",
             "max_all_unread_bytes",
             "max_all_unfinished_bytes"});
    serve_settings s;
    s.socket = t->text("socket");
    s.tcp = address(*t, "tcp");
    s.osc = address(*t, "osc");
    s.http = address(*t, "http");
    s.token_file = t->text("token_file");
    s.allow_hosts = texts(*t, "allow_hosts");
    s.osc_peers = prefixes(*t, "osc_peers");
    s.max_level_dbfs = t->number("max_level_dbfs", bounds_of::level_dbfs);
    s.idle_stop_s = t->number("idle_stop_s", bounds_of::timeout_s);
    read_serve_limits(*t, s);
    out.said.serve = s;
}

} // namespace tactor::detail
