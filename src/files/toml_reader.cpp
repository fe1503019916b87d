// SPDX-License-Identifier: MIT
#include "files/toml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/refused.hpp"
#include "core/suggest.hpp"

namespace tactor::detail {
namespace {

std::string type_name(const toml::node& n)
{
    if (n.is_table())
        return "a table";
    if (n.is_array())
        return "a list";
    if (n.is_date() || n.is_time() || n.is_date_time())
        return "a date or time";
    return n.is_boolean() ? "a boolean" : n.is_string() ? "a string" : "a number";
}

std::string bounds_text(bounds b)
{
    return b.above_low ? fmt::format("more than {}, at most {}", b.low, b.high)
                       : fmt::format("{} to {}", b.low, b.high);
}

} // namespace

void fail_at(const source_place& at, std::string_view why, std::string_view hint, std::string_view field)
{
    throw_caused(error(error_kind::bad_input, at, why, hint).with_field(field));
}

std::string shown(const toml::node& n)
{
    if (const auto* s = n.as_string())
        return detail::quoted(s->get());
    if (const auto* i = n.as_integer())
        return fmt::format("{}", i->get());
    if (const auto* f = n.as_floating_point()) {
        std::string text = fmt::format("{}", f->get());
        // 2.0 is no whole number: a message about one must show that.
        return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
    }
    if (const auto* b = n.as_boolean())
        return b->get() ? "true" : "false";
    return type_name(n);
}

toml_table::toml_table(const toml::table& t, std::string title, const std::string& file)
    : table_(&t), title_(std::move(title)), file_(&file)
{
}

void toml_table::only(std::span<const std::string_view> known) const
{
    for (const said_key& e : entries())
        if (std::find(known.begin(), known.end(), e.key) == known.end())
            throw unknown_key(e.key_at, e.key, title_, known);
}

std::vector<toml_table::said_key> toml_table::entries() const
{
    std::vector<said_key> all;
    for (auto&& [key, value] : *table_) {
        const auto& begin = key.source().begin;
        all.push_back({key.str(), &value, {*file_, begin.line, begin.column}});
    }
    std::sort(all.begin(), all.end(), [](const said_key& a, const said_key& b) {
        return std::pair(a.key_at.line, a.key_at.column) < std::pair(b.key_at.line, b.key_at.column);
    });
    return all;
}

bool toml_table::has(std::string_view key) const
{
    return table_->contains(key);
}

const toml::node* toml_table::node(std::string_view key) const
{
    return table_->get(key);
}

source_place toml_table::where(const toml::node& n) const
{
    return {*file_, n.source().begin.line, n.source().begin.column};
}

source_place toml_table::where() const
{
    // The root begins nowhere in particular.
    return where(*table_);
}

source_place toml_table::where(std::string_view key) const
{
    const toml::node* n = node(key);
    return n ? where(*n) : where();
}

void toml_table::fail(std::string_view why, std::string_view hint) const
{
    fail_at(where(), why, hint);
}

void toml_table::fail(std::string_view key, std::string_view why, std::string_view hint) const
{
    fail_at(where(key), why, hint, key);
}

void toml_table::missing(std::string_view key) const
{
    fail_at(where(), fmt::format("{} has no {}", title_, key), fmt::format("add {} = ...", key), key);
}

void toml_table::wrong_type(std::string_view called, const toml::node& n, std::string_view want) const
{
    const bool scalar = n.is_string() || n.is_number() || n.is_boolean();
    fail_at(where(n), fmt::format("{} is {}", called, scalar ? shown(n) : type_name(n)),
            fmt::format("give {}", want), called);
}

std::variant<std::monostate, bool, double, std::string> toml_table::plain(const toml::node& n,
                                                                          std::string_view called) const
{
    if (const auto* b = n.as_boolean())
        return b->get();
    if (const auto* s = n.as_string())
        return s->get();
    constexpr auto most = std::int64_t{1} << 53;
    const auto* i = n.as_integer();
    if (!n.is_number() || (i != nullptr && (i->get() > most || i->get() < -most)))
        fail_at(where(n), fmt::format("{} is {}", called, shown(n)), "give a number, a text, true or false",
                called);
    return *n.value<double>();
}

double toml_table::to_number(const toml::node& n, std::string_view called, bounds b) const
{
    if (!n.is_number())
        wrong_type(called, n, "a number");
    return within(n, called, *n.value<double>(), b);
}

double toml_table::within(const toml::node& n, std::string_view called, double v, bounds b) const
{
    const bool inside = v <= b.high && (b.above_low ? v > b.low : v >= b.low);
    if (!std::isfinite(v) || !inside)
        fail_at(where(n), fmt::format("{} is {}", called, v), fmt::format("allowed: {}", bounds_text(b)),
                called);
    return v;
}

std::optional<double> toml_table::number(std::string_view key, bounds b) const
{
    const toml::node* n = node(key);
    return n ? std::optional(to_number(*n, key, b)) : std::nullopt;
}

std::optional<unsigned> toml_table::whole(std::string_view key, unsigned low, unsigned high) const
{
    const toml::node* n = node(key);
    if (!n)
        return std::nullopt;
    const auto* i = n->as_integer();
    if (!i)
        wrong_type(key, *n, "a whole number");
    if (i->get() < low || i->get() > high)
        fail_at(where(*n), fmt::format("{} is {}", key, i->get()),
                fmt::format("allowed: {} to {}", low, high), key);
    return static_cast<unsigned>(i->get());
}

std::optional<bool> toml_table::boolean(std::string_view key) const
{
    const toml::node* n = node(key);
    if (!n)
        return std::nullopt;
    if (!n->is_boolean())
        wrong_type(key, *n, "true or false");
    return n->as_boolean()->get();
}

std::optional<std::string> toml_table::text(std::string_view key) const
{
    const toml::node* n = node(key);
    if (!n)
        return std::nullopt;
    if (!n->is_string())
        wrong_type(key, *n, "a string in quotes");
    const std::string& s = n->as_string()->get();
    if (s.empty() || s.find('\0') != std::string::npos)
        fail_at(where(*n), fmt::format("{} is {}", key, s.empty() ? "empty" : "not text"), {}, key);
    return s;
}

std::optional<std::string> toml_table::choice(std::string_view key,
                                              std::span<const std::string_view> of) const
{
    std::optional<std::string> s = text(key);
    if (!s)
        return std::nullopt;
    for (const std::string_view c : of)
        if (c == *s)
            return s;
    fail(key, fmt::format("{} is {}", key, detail::quoted(*s)), suggestion(*s, of, "values"));
}

std::optional<toml_table> toml_table::table(std::string_view key, std::string title,
                                            std::string_view shape) const
{
    const toml::node* n = node(key);
    if (!n)
        return std::nullopt;
    if (!n->is_table())
        wrong_type(key, *n, fmt::format("a table, {}", shape));
    return toml_table(*n->as_table(), std::move(title), *file_);
}

std::vector<toml_table> toml_table::tables(std::string_view key) const
{
    std::vector<toml_table> all;
    const toml::node* n = node(key);
    if (!n)
        return all;
    if (!n->is_array())
        wrong_type(key, *n, fmt::format("[[{}]] entries", key));
    all.reserve(n->as_array()->size());
    for (const toml::node& entry : *n->as_array()) {
        if (!entry.is_table())
            wrong_type(key, entry, fmt::format("[[{}]] entries", key));
        all.emplace_back(*entry.as_table(), fmt::format("[[{}]]", key), *file_);
    }
    return all;
}

const toml::array* toml_table::list(std::string_view key, std::string_view of_what) const
{
    const toml::node* n = node(key);
    if (n && !n->is_array())
        wrong_type(key, *n, fmt::format("a list of {}", of_what));
    return n ? n->as_array() : nullptr;
}

std::optional<point> toml_table::place(std::string_view key) const
{
    const toml::node* n = node(key);
    if (!n)
        return std::nullopt;
    std::vector<double> xy;
    numbers(*n, key, 2, 2, xy);
    return point{xy[0], xy[1]};
}

void toml_table::numbers(const toml::node& entry, std::string_view called, std::size_t least,
                         std::size_t most, std::vector<double>& out) const
{
    const toml::array* a = entry.as_array();
    if (!a || a->size() < least || a->size() > most)
        wrong_type(called, entry,
                   least == most ? fmt::format("a list of {} numbers", least)
                                 : fmt::format("a list of {} to {} numbers", least, most));
    out.clear();
    for (const toml::node& n : *a)
        out.push_back(to_number(n, called, {-max_mm, max_mm}));
}

std::string_view toml_table::one_of(std::span<const std::string_view> keys) const
{
    std::string_view found;
    for (const std::string_view k : keys) {
        if (!has(k))
            continue;
        if (!found.empty())
            fail(k, fmt::format("{} has both {} and {}", title_, found, k), "keep one of them");
        found = k;
    }
    if (found.empty())
        fail(fmt::format("{} says nothing of what it is", title_),
             fmt::format("add one of: {}", fmt::join(keys, ", ")));
    return found;
}

} // namespace tactor::detail
