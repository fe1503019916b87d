// SPDX-License-Identifier: MIT
// No library of Debian 12 and 13 fits: libcroco is gone, libcss and katana are in neither, lexbor is in 13
// only, and litehtml and librsvg lay out and draw documents of their own.
#include "files/svg/style.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/path/number.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/svg/document.hpp"
#include "files/svg/values.hpp"

namespace tactor::detail {
namespace {

constexpr std::size_t most_skipped = 100;
/// A million elements with 50 rules each; more is hostile.
constexpr std::size_t most_tried = 50'000'000;

std::string without_comments(std::string_view css)
{
    std::string s;
    for (std::size_t at = 0; at < css.size();) {
        const std::size_t open = std::min(css.find("/*", at), css.size());
        s += css.substr(at, open - at);
        const std::size_t close = css.find("*/", std::min(open + 2, css.size()));
        s += ' ';
        at = close == std::string_view::npos ? css.size() : close + 2;
    }
    return s;
}

/// Returns the first of `ends` outside quotes and round brackets, from `at` on, or the text's end.
std::size_t find_outside(std::string_view s, std::string_view ends, std::size_t at)
{
    char quote = '\0';
    unsigned depth = 0;
    for (; at < s.size(); ++at) {
        const char c = s[at];
        if (quote != '\0') {
            at += c == '\\' ? 1 : 0;
            quote = c == quote ? '\0' : quote;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (depth == 0 && ends.find(c) != std::string_view::npos) {
            return at;
        } else if (c == '(') {
            ++depth;
        } else if (c == ')' && depth > 0) {
            --depth;
        }
    }
    return s.size();
}

/// Returns the offset behind the block that opens at `open`, with the blocks in it.
std::size_t behind_block(std::string_view css, std::size_t open)
{
    unsigned depth = 0;
    for (std::size_t at = open; at < css.size(); ++at) {
        at = find_outside(css, "{}", at);
        if (at == css.size())
            break;
        depth = css[at] == '{' ? depth + 1 : depth - 1;
        if (depth == 0)
            return at + 1;
    }
    return css.size();
}

bool names_property(std::string_view body)
{
    const std::string css = in_small_letters(std::string(body));
    return std::any_of(svg_properties.begin() + svg_paints, svg_properties.end(), [&css](std::string_view p) {
        for (std::size_t at = css.find(p); at != std::string_view::npos; at = css.find(p, at + 1)) {
            const std::size_t end = css.find_first_not_of(" \t\r\n", at + p.size());
            const bool begins = at == 0 || blank(css[at - 1]) || css[at - 1] == '{' || css[at - 1] == ';';
            if (begins && end != std::string_view::npos && css[end] == ':')
                return true;
        }
        return false;
    });
}

bool in_name(char c)
{
    return c == '-' || c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
           (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

template <class F>
void for_each_class(pugi::xml_node n, F f)
{
    std::string_view all = n.attribute("class").value();
    for (all = without_blanks(all); !all.empty(); all = without_blanks(all)) {
        const std::size_t end = std::min(all.find_first_of(" \t\r\n"), all.size());
        f(all.substr(0, end));
        all.remove_prefix(end);
    }
}

std::string tidy(std::string_view text)
{
    return in_small_letters(std::string(without_blanks(text)));
}

template <std::size_t count>
bool holds(const std::array<std::string_view, count>& words, std::string_view word)
{
    return std::find(words.begin(), words.end(), word) != words.end();
}

constexpr std::array<std::string_view, 5> css_wide{"inherit", "initial", "unset", "revert", "revert-layer"};

// Returns false for a value that no browser takes. A function or an entity may stand for anything.
bool may_be_valid(std::string_view property, const std::string& value)
{
    if (value.find_first_of("(&") != std::string::npos || holds(css_wide, value))
        return true;
    if (property == "display" || property == "visibility")
        return is_svg_keyword(property, value);
    if (property == "transform")
        return value == "none";
    const bool side = property == "width" || property == "height";
    if (!side && property != "opacity")
        return true;
    try {
        return parse_svg_length(value).in != svg_length::unit::none || !side;
    } catch (const value_fault&) {
        return false;
    }
}

} // namespace

bool is_svg_keyword(std::string_view property, std::string_view value)
{
    constexpr std::array<std::string_view, 3> visibilities{"visible", "hidden", "collapse"};
    constexpr std::array<std::string_view, 14> displays{
        "none",  "inline",       "block",     "inline-block", "flow-root", "list-item",   "run-in",
        "table", "inline-table", "table-row", "table-cell",   "flex",      "inline-flex", "grid"};
    return holds(css_wide, value) ||
           (property == "display" ? holds(displays, value) : holds(visibilities, value));
}

void svg_style_sheet::add_entities(std::string_view doctype)
{
    constexpr std::string_view opening = "<!ENTITY";
    for (std::size_t at = doctype.find(opening); at != std::string_view::npos;
         at = doctype.find(opening, at)) {
        at += opening.size();
        skip_blanks(doctype, at);
        const std::size_t begin = at;
        at = std::min(doctype.find_first_of(" \t\r\n", at), doctype.size());
        const std::string_view name = doctype.substr(begin, at - begin);
        skip_blanks(doctype, at);
        if (at == doctype.size() || (doctype[at] != '"' && doctype[at] != '\''))
            continue;
        const std::size_t end = std::min(doctype.find(doctype[at], at + 1), doctype.size());
        entities_.try_emplace(name, doctype.substr(at + 1, end - at - 1));
        at = end;
    }
}

// Returns a style with the text of its entities. One that is not known, or too long, stays as it stands.
std::string svg_style_sheet::expand(std::string_view style) const
{
    constexpr std::size_t longest = std::size_t{1} << 16;
    std::string s;
    for (std::size_t at = 0; at < style.size();) {
        const std::size_t mark = std::min(style.find('&', at), style.size());
        s += style.substr(at, mark - at);
        const std::size_t end = std::min(style.find(';', mark), style.size());
        const auto found = entities_.find(mark < end ? style.substr(mark + 1, end - mark - 1) : style);
        const bool known = found != entities_.end() && s.size() + found->second.size() <= longest;
        s += known ? found->second : style.substr(mark, 1);
        at = known ? end + 1 : mark + 1;
    }
    return s;
}

void svg_style_sheet::add(pugi::xml_node style)
{
    const std::string media = tidy(style.attribute("media").value());
    const std::string type = tidy(style.attribute("type").value());
    std::string css;
    for (const pugi::xml_node c : style.children())
        css += c.value();
    css = without_comments(css);
    if ((!media.empty() && media != "all" && media != "screen") || (!type.empty() && type != "text/css")) {
        if (names_property(css))
            skip(style, fmt::format("@media {}", media.empty() ? type : media));
        return;
    }
    texts_.push_back(std::move(css));
    add_rules(style, texts_.back());
}

void svg_style_sheet::skip(pugi::xml_node style, std::string_view what)
{
    if (skipped_.size() < most_skipped)
        skipped_.push_back({style, detail::quoted(what)});
}

void svg_style_sheet::add_rules(pugi::xml_node style, std::string_view css)
{
    for (std::size_t at = css.find_first_not_of(" \t\r\n;}", 0); at < css.size();
         at = css.find_first_not_of(" \t\r\n;}", at)) {
        const std::size_t end = find_outside(css, css[at] == '@' ? "{;" : "{", at);
        const std::string_view before = without_blanks(css.substr(at, end - at));
        if (end == css.size())
            return;
        const std::size_t behind = css[end] == '{' ? behind_block(css, end) : end + 1;
        const std::string_view body = css.substr(end + 1, behind - end - 1);
        if (before.front() != '@')
            add_rule(style, before, body.substr(0, body.size() - (body.ends_with('}') ? 1 : 0)));
        else if (in_small_letters(std::string(before)).starts_with("@import") || names_property(body))
            skip(style, before);
        at = behind;
    }
}

void svg_style_sheet::add_rule(pugi::xml_node style, std::string_view selectors, std::string_view body)
{
    const std::vector<declaration> all = parse_declarations(body);
    if (all.empty())
        return;
    const std::size_t first = declarations_.size();
    declarations_.insert(declarations_.end(), all.begin(), all.end());
    for (std::size_t at = 0; at <= selectors.size();) {
        const std::size_t end = find_outside(selectors, ",", at);
        const std::string_view text = without_blanks(selectors.substr(at, end - at));
        at = end + 1;
        selector s;
        s.first = first;
        s.count = all.size();
        if (!parse_selector(text, s)) {
            if (std::any_of(all.begin(), all.end(),
                            [](const declaration& d) { return d.property >= svg_paints; }))
                skip(style, text);
            continue;
        }
        const std::string key = !s.ids.empty()       ? fmt::format("#{}", s.ids.front())
                                : !s.classes.empty() ? fmt::format(".{}", s.classes.front())
                                                     : std::string(s.tag);
        by_key_[key].push_back(selectors_.size());
        selectors_.push_back(std::move(s));
    }
}

bool svg_style_sheet::parse_selector(std::string_view text, selector& into)
{
    std::size_t at = 0;
    const auto name = [&] {
        const std::size_t begin = at;
        while (at < text.size() && in_name(text[at]))
            ++at;
        return text.substr(begin, at - begin);
    };
    if (text.starts_with('*'))
        ++at;
    else
        into.tag = name();
    while (at < text.size() && (text[at] == '#' || text[at] == '.')) {
        const bool id = text[at++] == '#';
        const std::string_view named = name();
        if (named.empty())
            return false;
        (id ? into.ids : into.classes).push_back(named);
    }
    constexpr std::size_t above = 1000;
    into.rank = above * above * into.ids.size() + above * into.classes.size() + (into.tag.empty() ? 0 : 1);
    return !text.empty() && at == text.size();
}

std::vector<svg_style_sheet::declaration> svg_style_sheet::parse_declarations(std::string_view body)
{
    std::vector<declaration> all;
    for (std::size_t at = 0; at < body.size();) {
        const std::size_t end = find_outside(body, ";", at);
        const std::string_view item = body.substr(at, end - at);
        at = end + 1;
        const std::size_t colon = item.find(':');
        if (colon == std::string_view::npos) {
            if (const std::string_view entity = without_blanks(item); entity.starts_with('&'))
                all.push_back({svg_paints, entity, false}); // it may hide: an unknown display
            continue;
        }
        std::string name = tidy(item.substr(0, colon));
        constexpr std::string_view alias = "-webkit-"; // in all browsers
        if (name.starts_with(alias))
            name.erase(0, alias.size());
        const auto known = std::find(svg_properties.begin(), svg_properties.end(), name);
        if (known == svg_properties.end())
            continue;
        std::string_view value = without_blanks(item.substr(colon + 1));
        const std::size_t mark = value.rfind('!');
        const bool important = mark != std::string_view::npos && tidy(value.substr(mark + 1)) == "important";
        if (mark != std::string_view::npos)
            value = without_blanks(value.substr(0, mark));
        if (!value.empty())
            all.push_back({static_cast<std::size_t>(known - svg_properties.begin()), value, important});
    }
    return all;
}

bool svg_style_sheet::fits(const selector& s, pugi::xml_node n)
{
    if (!s.tag.empty() && s.tag != svg_tag(n))
        return false;
    const std::string_view id = n.attribute("id").value();
    if (!std::all_of(s.ids.begin(), s.ids.end(), [id](std::string_view i) { return i == id; }))
        return false;
    return std::all_of(s.classes.begin(), s.classes.end(), [n](std::string_view c) {
        bool has = false;
        for_each_class(n, [&](std::string_view own) { has = has || own == c; });
        return has;
    });
}

const std::string& svg_style_sheet::value(pugi::xml_node n, std::string_view property) const
{
    if (n != valued_) {
        valued_ = {};
        find_values(n);
        valued_ = n;
    }
    const auto* at = std::find(svg_properties.begin(), svg_properties.end(), property);
    return values_[static_cast<std::size_t>(at - svg_properties.begin())];
}

void svg_style_sheet::find_values(pugi::xml_node n) const
{
    // The greatest counts, of equals the last: valid, important, own style, specificity.
    using weight = std::tuple<bool, bool, bool, std::size_t, std::size_t>;
    std::array<weight, svg_properties.size()> heaviest{};
    const auto take = [&](const declaration& d, bool own, std::size_t rank, std::size_t order) {
        std::string value = tidy(d.value);
        const weight w{may_be_valid(svg_properties[d.property], value), d.important, own, rank, order};
        if (w < heaviest[d.property])
            return;
        heaviest[d.property] = w;
        values_[d.property] = std::move(value);
    };
    const auto try_all = [&](const std::string& key) {
        const auto found = by_key_.find(key);
        if (found == by_key_.end())
            return;
        for (const std::size_t i : found->second) {
            if (++tried_ > most_tried)
                throw value_fault{0, "its style sheet takes too long", "simplify the drawing"};
            if (const selector& s = selectors_[i]; fits(s, n))
                for (std::size_t d = s.first; d < s.first + s.count; ++d)
                    take(declarations_[d], false, s.rank + 1, i);
        }
    };
    values_ = {};
    for (std::size_t i = 0; i < svg_attributes; ++i)
        if (const std::string text = without_comments(n.attribute(svg_properties[i].data()).value());
            !without_blanks(text).empty())
            take({i, text}, false, 0, 0);
    if (!selectors_.empty()) {
        try_all("");
        try_all(std::string(svg_tag(n)));
        if (const std::string_view id = n.attribute("id").value(); !id.empty())
            try_all(fmt::format("#{}", id));
        for_each_class(n, [&](std::string_view c) { try_all(fmt::format(".{}", c)); });
    }
    const std::string style = without_comments(expand(n.attribute("style").value()));
    for (const declaration& d : parse_declarations(style))
        take(d, true, 0, 0);
}

} // namespace tactor::detail
