// SPDX-License-Identifier: MIT
#include "files/toml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/refused.hpp"
#include "core/split.hpp"
#include "core/suggest.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

// Greatest number of dots in a key. No key of tactor has as many. toml++ 3.3 limits the nesting of values but
// not of dotted keys, and frees nested tables recursively: a key of 100 000 dots would overflow the stack.
constexpr unsigned max_dots = 16;

bool bare(char c) noexcept
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == ' ' || c == '\t';
}

// Returns the offset after the string that begins at i, or the end of the text if the string is not closed.
std::size_t find_string_end(std::string_view t, std::size_t i)
{
    const char quote = t[i];
    const bool multiline = t.substr(i, 3) == std::string(3, quote);
    const std::string end(multiline ? 3 : 1, quote);
    for (i += end.size(); i < t.size(); ++i) {
        if (quote == '"' && t[i] == '\\')
            ++i;
        else if (t.compare(i, end.size(), end) == 0) {
            i += end.size();
            // A multi-line string may have one or two quotes just before its closing quotes.
            for (unsigned own = 0; multiline && own < 2 && i < t.size() && t[i] == quote; ++own)
                ++i;
            return i;
        } else if (t[i] == '\n' && !multiline)
            return i; // toml++ reports the error
    }
    return t.size();
}

/// A copy of a text in which strings and comments are masked. Offsets and lines are the same as in the text.
struct masked_text {
    std::string text = {};                       ///< '_' replaces strings, '#' replaces comments
    std::optional<std::size_t> open_string = {}; ///< offset of the first string that is not closed
};

masked_text mask_strings(std::string_view t)
{
    masked_text m{std::string(t)};
    for (std::size_t i = 0; i < t.size();) {
        const std::size_t from = i;
        if (t[i] == '#') {
            i = std::min(t.find('\n', i), t.size());
        } else if (t[i] == '"' || t[i] == '\'') {
            const std::string quotes(t.substr(i, 3) == std::string(3, t[i]) ? 3 : 1, t[i]);
            i = find_string_end(t, i);
            const std::string_view whole = t.substr(from, i - from);
            if (!m.open_string && (whole.size() < 2 * quotes.size() || !whole.ends_with(quotes)))
                m.open_string = from;
        } else {
            ++i;
            continue;
        }
        for (std::size_t k = from; k < i; ++k)
            if (t[k] != '\n')
                m.text[k] = t[from] == '#' ? '#' : '_';
    }
    return m;
}

void refuse_deep_keys(std::string_view t, const std::string& name)
{
    const std::string masked = mask_strings(t).text;
    unsigned dots = 0;
    for (std::size_t i = 0; i < masked.size(); ++i) {
        if (masked[i] == '.')
            ++dots;
        else if (!bare(masked[i]))
            dots = 0;
        if (dots > max_dots)
            fail_at(find_place(t, i, name), "a key has too many parts", "use at most three parts");
    }
}

bool is_unit_character(char c) noexcept
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' ||
           static_cast<unsigned char>(c) >= 0x80;
}

// Refuses a number with a unit or a decimal comma, which people often write. `masked` is the text with its
// strings masked.
void refuse_foreign_number(std::string_view masked, const source_place& line)
{
    for (unsigned i = 1; i < line.line && !masked.empty(); ++i)
        masked.remove_prefix(std::min(masked.find('\n'), masked.size() - 1) + 1);
    const std::string_view text = masked.substr(0, masked.find_first_of("\n#"));
    for (std::size_t i = 0; (i = text.find_first_of("=[,", i)) != std::string_view::npos;) {
        const bool value = text[i] == '=';
        skip_blanks(text, ++i);
        const std::size_t begin = i;
        if (!scan_number(text, i))
            continue;
        const source_place place{line.file, line.line, static_cast<unsigned>(begin + 1)};
        if (std::size_t digits = i + 1; value && text.substr(i, 1) == "," && scan_number(text, digits))
            fail_at(place, fmt::format("{} has a decimal comma", quoted(text.substr(begin, digits - begin))),
                    fmt::format("write {}.{}", text.substr(begin, i - begin),
                                text.substr(i + 1, digits - i - 1)));
        std::size_t end = i;
        skip_blanks(text, end);
        const std::size_t unit = end;
        while (end < text.size() && is_unit_character(text[end]))
            ++end;
        if (end > unit)
            fail_at(place, fmt::format("{} is a number with a unit", quoted(text.substr(begin, end - begin))),
                    "give the number alone: its unit is in the name of the key, or in the manual");
    }
}

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

toml::table parse_toml(std::string_view text, const std::string& name, const toml_hints& hints)
{
    refuse_non_text(text, name, hints.kinds);
    refuse_deep_keys(text, name);
    try {
        return toml::parse(text, std::string_view(name));
    } catch (const toml::parse_error& e) {
        refuse_other_form(text, name, text_form::toml, hints.kinds);
        const auto& at = e.source().begin;
        const masked_text masked = mask_strings(text);
        if (const auto open = masked.open_string) {
            const source_place begin = find_place(text, *open, name);
            const std::string three(3, text[*open]);
            if (begin.line <= at.line)
                fail_at(begin, "this text has no closing quote",
                        text.substr(*open, 3) == three
                            ? "end it with " + three
                            : fmt::format("end it with {} on the same line", text[*open]));
        }
        if (e.description().find("utf-8") != std::string_view::npos)
            fail_at({name, at.line, at.column}, "this is not UTF-8",
                    "save it as UTF-8 in the editor, or convert it: iconv -f LATIN1 -t UTF-8 OLD > NEW");
        refuse_foreign_number(masked.text, {name, at.line, 0});
        const std::string manual = fmt::format("see {}", hints.manual);
        if (e.description().find("could not determine value type") != std::string_view::npos)
            fail_at({name, at.line, at.column}, "this is not a value",
                    "put texts in quotes, such as name = \"palm\", and give numbers without a unit; " +
                        manual);
        fail_at({name, at.line, at.column}, e.description(), manual);
    }
}

void fail_at(const source_place& at, std::string_view why, std::string_view hint, std::string_view field)
{
    throw_with_cause(error(error_kind::bad_input, at, why, hint).with_field(field));
}

std::string shown(const toml::node& n)
{
    if (const auto* s = n.as_string())
        return detail::quoted(s->get());
    if (const auto* i = n.as_integer())
        return fmt::format("{}", i->get());
    if (const auto* f = n.as_floating_point()) {
        std::string text = fmt::format("{}", f->get());
        // Writes 2.0 with its decimal point: it is not an integer, and messages must show the difference.
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

void toml_table::refuse_other_keys(const std::vector<std::string_view>& known) const
{
    for (const key_value& e : entries())
        if (std::find(known.begin(), known.end(), e.key) == known.end())
            throw unknown_key(e.key_at, e.key, title_, known);
}

std::vector<toml_table::key_value> toml_table::entries() const
{
    std::vector<key_value> all;
    for (auto&& [key, value] : *table_) {
        const auto& begin = key.source().begin;
        all.push_back({key.str(), &value, {*file_, begin.line, begin.column}});
    }
    std::sort(all.begin(), all.end(), [](const key_value& a, const key_value& b) {
        return std::pair(a.key_at.line, a.key_at.column) < std::pair(b.key_at.line, b.key_at.column);
    });
    return all;
}

source_place toml_table::where(const toml::node& n) const
{
    return {*file_, n.source().begin.line, n.source().begin.column};
}

source_place toml_table::where(std::string_view key) const
{
    const toml::node* n = node(key);
    return n ? where(*n) : where();
}

std::vector<std::string> toml_table::texts(std::string_view key, std::size_t most) const
{
    std::vector<std::string> all;
    const toml::array* texts = list(key, "texts in quotes");
    if (texts == nullptr)
        return all;
    for (const toml::node& n : *texts) {
        if (!n.is_string())
            fail_at(where(n), fmt::format("{} has {}", key, shown(n)),
                    "texts in quotes, with commas between");
        all.push_back(n.as_string()->get());
    }
    if (all.size() > most)
        fail(key, fmt::format("{} has {} texts", key, all.size()), fmt::format("use at most {}", most));
    return all;
}

void toml_table::fail(std::string_view why, std::string_view hint) const
{
    fail_at(where(), why, hint);
}

void toml_table::fail(std::string_view key, std::string_view why, std::string_view hint) const
{
    fail_at(where(key), why, hint, key);
}

void toml_table::refuse_missing_key(std::string_view key) const
{
    fail_at(where(), fmt::format("{} has no {}", title_, key), fmt::format("add {} = ...", key), key);
}

void toml_table::refuse_type(std::string_view called, const toml::node& n, std::string_view want) const
{
    const bool scalar = n.is_string() || n.is_number() || n.is_boolean();
    fail_at(where(n), fmt::format("{} is {}", called, scalar ? shown(n) : type_name(n)),
            fmt::format("give {}", want), called);
}

std::variant<std::monostate, bool, double, std::string> toml_table::read_scalar(const toml::node& n,
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
        refuse_type(called, n, "a number");
    const double v = *n.value<double>();
    if (!std::isfinite(v) || !b.holds(v))
        fail_at(where(n), fmt::format("{} is {}", called, v), fmt::format("use {}", bounds_text(b)), called);
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
        refuse_type(key, *n, "a whole number");
    if (i->get() < low || i->get() > high)
        fail_at(where(*n), fmt::format("{} is {}", key, i->get()), fmt::format("use {} to {}", low, high),
                key);
    return static_cast<unsigned>(i->get());
}

std::optional<bool> toml_table::boolean(std::string_view key) const
{
    const toml::node* n = node(key);
    if (!n)
        return std::nullopt;
    if (!n->is_boolean())
        refuse_type(key, *n, "true or false");
    return n->as_boolean()->get();
}

std::optional<std::string> toml_table::text(std::string_view key) const
{
    const toml::node* n = node(key);
    if (!n)
        return std::nullopt;
    if (!n->is_string())
        refuse_type(key, *n, "a string in quotes");
    const std::string& s = n->as_string()->get();
    if (s.empty() || s.find('\0') != std::string::npos)
        fail_at(where(*n), fmt::format("{} is {}", key, s.empty() ? "empty" : "not a text"), {}, key);
    return s;
}

std::optional<std::string> toml_table::choice(std::string_view key,
                                              const std::vector<std::string_view>& of) const
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
                                            std::string_view example) const
{
    const toml::node* n = node(key);
    if (!n)
        return std::nullopt;
    if (!n->is_table())
        refuse_type(key, *n, fmt::format("a table, {}", example));
    return toml_table(*n->as_table(), std::move(title), *file_);
}

std::vector<toml_table> toml_table::tables(std::string_view key) const
{
    std::vector<toml_table> all;
    const toml::node* n = node(key);
    if (!n)
        return all;
    if (!n->is_array())
        refuse_type(key, *n, fmt::format("[[{}]] entries", key));
    all.reserve(n->as_array()->size());
    for (const toml::node& entry : *n->as_array()) {
        if (!entry.is_table())
            refuse_type(key, entry, fmt::format("[[{}]] entries", key));
        all.emplace_back(*entry.as_table(), fmt::format("[[{}]]", key), *file_);
    }
    return all;
}

const toml::array* toml_table::list(std::string_view key, std::string_view of_what) const
{
    const toml::node* n = node(key);
    if (n && !n->is_array())
        refuse_type(key, *n, fmt::format("a list of {}", of_what));
    return n ? n->as_array() : nullptr;
}

affine toml_table::turn(double scale) const
{
    const affine turned = rotation(number("rotate_deg", turn_deg).value_or(0.0));
    const std::string mirror = choice("mirror", {"x", "y"}).value_or("");
    return turned *
           affine{mirror == "x" ? -scale : scale, 0.0, 0.0, mirror == "y" ? -scale : scale, 0.0, 0.0};
}

std::optional<point> toml_table::place(std::string_view key) const
{
    const toml::node* n = node(key);
    return n ? std::optional(to_point(*n, key)) : std::nullopt;
}

const toml::array& toml_table::pair(const toml::node& entry, std::string_view called) const
{
    const toml::array* a = entry.as_array();
    if (!a)
        refuse_type(called, entry, "a list of 2 numbers");
    if (a->size() != 2)
        fail_at(where(entry), fmt::format("{} has {}", called, counted(a->size(), "value")), "give 2 numbers",
                called);
    return *a;
}

point toml_table::to_point(const toml::node& xy, std::string_view called) const
{
    constexpr bounds any_mm{-max_mm, max_mm};
    const toml::array& a = pair(xy, called);
    return {to_number(a[0], called, any_mm), to_number(a[1], called, any_mm)};
}

std::string_view toml_table::one_of(const std::vector<std::string_view>& keys) const
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
        fail(fmt::format("{} is incomplete", title_), fmt::format("add one of: {}", fmt::join(keys, ", ")));
    return found;
}

} // namespace tactor::detail
