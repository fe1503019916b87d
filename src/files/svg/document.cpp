// SPDX-License-Identifier: MIT
#include "files/svg/document.hpp"

#include <functional>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {

svg_document::svg_document(std::string_view text, const std::string& name)
    : text_(without_mark(text)), name_(name), buffer_(text_)
{
    const pugi::xml_parse_result r = tree_.load_buffer_inplace(
        buffer_.data(), buffer_.size(), pugi::parse_default | pugi::parse_doctype | pugi::parse_pi);
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
        if (n.type() == pugi::node_doctype)
            sheet_.add_entities(n.value());
        if (n.type() == pugi::node_pi && std::string_view(n.name()) == "xml-stylesheet")
            sheet_.add_other_file(n);
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
    const auto at = offset(n);
    return at ? find_place(text_, *at, name_) : source_place{name_};
}

std::optional<std::size_t> svg_document::offset(pugi::xml_node n) const
{
    const auto at = n.offset_debug();
    return at < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(at));
}

std::string svg_document::called(pugi::xml_node n)
{
    const std::string_view id = n.attribute("id").value();
    const std::string tag = detail::quoted(n.name());
    return fmt::format("<{}>{}", std::string_view(tag).substr(1, tag.size() - 2),
                       id.empty() ? std::string() : fmt::format(" {}", detail::quoted(id)));
}

error svg_document::to_error(const left_out& f) const
{
    return {error_kind::bad_input, f.offset ? find_place(text_, *f.offset, name_) : source_place{name_},
            f.why, f.hint};
}

void svg_document::fail(pugi::xml_node n, std::string_view why, std::string_view hint) const
{
    throw error(error_kind::bad_input, where(n), why, hint);
}

void svg_document::leave_out(pugi::xml_node n, std::string why, std::string hint) const
{
    throw left_out{offset(n), std::move(why), std::move(hint)};
}

left_out svg_document::fault(pugi::xml_node n, pugi::xml_attribute a, const value_fault& f) const
{
    // Values are decoded in place, so their begin is where it was in the text. (Text in other encodings than
    // UTF-8 is converted elsewhere.)
    const char* value = a.value();
    const bool here =
        std::less_equal<>{}(buffer_.data(), value) && std::less<>{}(value, buffer_.data() + buffer_.size());
    return {here ? static_cast<std::size_t>(value - buffer_.data()) + f.offset : offset(n),
            fmt::format("{} of {}: {}", a.name(), called(n), f.why), f.hint};
}

std::string_view svg_document::property(pugi::xml_node n, std::string_view name) const
{
    try {
        return sheet_.value(n, name);
    } catch (const value_fault& f) {
        fail(n, f.why, f.hint);
    }
}

template <class F>
void svg_document::note(const std::string& key, const char* more, const char* end, F begin) const
{
    noted& n = notes_[key];
    if (n.elements++ == 0)
        n = {begin(), more, end, 1};
}

void svg_document::note_unfollowed(pugi::xml_node n, const std::string& what, std::string_view why) const
{
    note(what, ", nor of", ": what it hides or moves plays as if it were not there", [&] {
        return fmt::format("{}: {} of {} is not followed{}", where(n).text(), what, called(n), why);
    });
}

void svg_document::note_strength(pugi::xml_node n) const
{
    note("data-intensity-from", ", nor of", ": data-intensity says how strong a line is", [&] {
        return fmt::format("{}: data-intensity-from of {} is not followed", where(n).text(), called(n));
    });
}

void svg_document::note_unknown(pugi::xml_node n, const char* property, std::string_view value) const
{
    note(fmt::format("unknown {}", property), ", nor of", ": that is taken as hidden", [&] {
        return fmt::format("{}: {} of {} is not understood ({})", where(n).text(), property, called(n),
                           detail::quoted(value));
    });
}

void svg_document::note_no_shape(pugi::xml_node n) const
{
    note(n.name(), ", nor", ": only shapes do, and text made into paths",
         [&] { return fmt::format("{}: {} does not play", where(n).text(), called(n)); });
}

void svg_document::note_twice(pugi::xml_node n) const
{
    note("twice", ", as does", ": it plays again",
         [&] { return fmt::format("{}: {} has the shape of one before it", where(n).text(), called(n)); });
}

void svg_document::note_unpainted(pugi::xml_node n) const
{
    note("unpainted", ", nor has", ": it plays all the same", [&] {
        return fmt::format("{}: {} has neither fill nor stroke, or no opacity", where(n).text(), called(n));
    });
}

void svg_document::note_left_out(const left_out& f) const
{
    note(f.hint, ", and", "", [&] { return fmt::format("{}: left out", to_error(f).what()); });
}

std::vector<std::string> svg_document::warnings() const
{
    std::vector<std::string> all;
    for (const auto& [key, n] : notes_)
        all.push_back(n.elements == 1 ? n.begin + n.end
                                      : fmt::format("{}{} {} more{}", n.begin, n.more,
                                                    counted(n.elements - 1, "element"), n.end));
    for (const svg_style_sheet::skipped& s : sheet_.not_followed())
        all.push_back(fmt::format("{}: the style rule {} is not followed (those of a tag, class or id are)",
                                  where(s.style).text(), s.what));
    return all;
}

double svg_document::length(pugi::xml_node n, const char* attribute, const svg_viewport& v, svg_extent e,
                            double otherwise) const
{
    const pugi::xml_attribute a = n.attribute(attribute);
    try {
        return a ? parse_svg_length(a.value()).user_units(v, e) : otherwise;
    } catch (const value_fault& f) {
        throw fault(n, a, f);
    }
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
