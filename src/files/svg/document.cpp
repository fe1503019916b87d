// SPDX-License-Identifier: MIT
#include "files/svg/document.hpp"

#include <functional>
#include <new>

#include <fmt/format.h>

#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {

svg_document::svg_document(std::string_view text, const std::string& name)
    : text_(without_mark(text)), name_(name), buffer_(text_)
{
    const pugi::xml_parse_result r = tree_.load_buffer_inplace(buffer_.data(), buffer_.size());
    if (r.status == pugi::status_out_of_memory)
        throw std::bad_alloc();
    if (!r) {
        refuse_other_form(text_, name_, "svg");
        const auto offset = static_cast<std::size_t>(r.offset > 0 ? r.offset : 0);
        throw error(error_kind::bad_input, find_place(text_, offset, name_), r.description(),
                    "the file is not well-formed XML");
    }
    if (svg_tag(root()) != "svg")
        fail(root(), fmt::format("{} is not <svg>", called(root())), "is it an SVG file?");
    // A search that finds nothing visits all, and not by recursion. Of two with one id the first counts.
    tree_.find_node([this](pugi::xml_node n) {
        if (const std::string_view id = n.attribute("id").value(); !id.empty())
            ids_.try_emplace(id, n);
        if (svg_tag(n) == "style")
            sheet_.add(n);
        return false;
    });
}

std::string_view svg_tag(pugi::xml_node n)
{
    std::string_view tag = n.name();
    if (tag.substr(0, 4) == "svg:")
        tag.remove_prefix(4);
    return tag;
}

pugi::xml_node svg_document::by_id(std::string_view id) const
{
    const auto found = ids_.find(id);
    return found == ids_.end() ? pugi::xml_node() : found->second;
}

source_place svg_document::where(pugi::xml_node n) const
{
    const auto offset = n.offset_debug();
    if (offset < 0)
        return {name_, 0, 0};
    return find_place(text_, static_cast<std::size_t>(offset), name_);
}

std::string svg_document::called(pugi::xml_node n)
{
    const std::string_view id = n.attribute("id").value();
    const std::string tag = quoted(n.name());
    return fmt::format("<{}>{}", std::string_view(tag).substr(1, tag.size() - 2),
                       id.empty() ? std::string() : fmt::format(" {}", quoted(id)));
}

void svg_document::fail(pugi::xml_node n, std::string_view why, std::string_view hint) const
{
    throw error(error_kind::bad_input, where(n), why, hint);
}

void svg_document::fail(pugi::xml_node n, pugi::xml_attribute a, const value_fault& f) const
{
    // Values are decoded in place, so their begin is where it was in the text. (Text in other encodings than
    // UTF-8 is converted elsewhere.)
    const char* value = a.value();
    const bool here =
        std::less_equal<>{}(buffer_.data(), value) && std::less<>{}(value, buffer_.data() + buffer_.size());
    const source_place at =
        here ? find_place(text_, static_cast<std::size_t>(value - buffer_.data()) + f.offset, name_)
             : where(n);
    throw error(error_kind::bad_input, at, fmt::format("{} of {}: {}", a.name(), called(n), f.why), f.hint)
        .with_field(a.name());
}

void svg_document::fail(pugi::xml_node n, const char* property, std::string_view text, value_fault f) const
{
    const pugi::xml_attribute a = n.attribute(property);
    const char* begin = a.value();
    const char* end = begin + std::string_view(begin).size();
    if (a && std::less_equal<>{}(begin, text.data()) && std::less_equal<>{}(text.data(), end)) {
        f.offset += static_cast<std::size_t>(text.data() - begin);
        fail(n, a, f);
    }
    fail(n, fmt::format("{} of {}: {}", property, called(n), f.why), f.hint);
}

std::string_view svg_document::property(pugi::xml_node n, std::string_view name) const
{
    try {
        return sheet_.value(n, name);
    } catch (const value_fault& f) {
        fail(n, f.why, f.hint);
    }
}

void svg_document::note(pugi::xml_node n, const std::string& what) const
{
    note_count& c = notes_[what];
    if (c.elements++ == 0)
        c.first = n;
}

std::vector<std::string> svg_document::warnings() const
{
    std::vector<std::string> all;
    for (const auto& [what, c] : notes_)
        all.push_back(fmt::format(
            "{}: {} of {} is not followed{}: what it hides or moves plays as drawn", where(c.first).text(),
            what, called(c.first),
            c.elements == 1 ? "" : fmt::format(", nor of {} more", counted(c.elements - 1, "element"))));
    for (const svg_style_sheet::skipped& s : sheet_.not_followed())
        all.push_back(fmt::format("{}: the style rule {} is not followed (those of a tag, class or id are)",
                                  where(s.style).text(), s.what));
    return all;
}

double svg_document::length(pugi::xml_node n, const char* attribute, const svg_viewport& v, svg_extent e,
                            double otherwise) const
{
    const auto l = read(n, attribute, parse_svg_length);
    return l ? l->user_units(v, e) : otherwise;
}

std::optional<double> svg_document::number(pugi::xml_node n, const char* attribute, double low,
                                           double high) const
{
    return read(n, attribute, [low, high](std::string_view text) {
        const double v = svg_number(text);
        if (!(v >= low && v <= high))
            throw value_fault{0, fmt::format("{:g}", v),
                              fmt::format("it is between {:g} and {:g}", low, high)};
        return v;
    });
}

} // namespace tactor::detail
