// SPDX-License-Identifier: MIT
#include <cstdint>

#include <fmt/format.h>
#include <kainjow/mustache.hpp>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "files/output_file.hpp"
#include "study/report/methods.hpp"

namespace tactor::study {
namespace {

namespace mustache = kainjow::mustache;

constexpr std::string_view mark = "Written by tactor ";

// Returns a value for the template. An object has its members once more, as `list`: each with its name, and
// a plain one with its value. Two numbers are an interval. Null is false: no section, and no text.
mustache::data make_data(const nlohmann::ordered_json& v)
{
    if (v.is_null())
        return mustache::data(false);
    if (v.is_boolean())
        return mustache::data(v.get<bool>());
    if (v.is_number_float())
        return mustache::data(plain_number(v.get<double>(), 4));
    if (v.is_number())
        return mustache::data(v.dump());
    if (v.is_string())
        return mustache::data(v.get<std::string>());
    mustache::data all(mustache::data::type::list);
    if (v.is_array() && v.size() == 2 && v[0].is_number() && v[1].is_number())
        return mustache::data(fmt::format("{} to {}", plain_number(v[0], 4), plain_number(v[1], 4)));
    if (v.is_array()) {
        for (const nlohmann::ordered_json& one : v)
            all.push_back(make_data(one));
        return all;
    }
    mustache::data members(mustache::data::type::object);
    for (const auto& [name, value] : v.items()) {
        const mustache::data one = make_data(value);
        members.set(name, one);
        mustache::data item = value.is_object() ? one : mustache::data("value", one);
        item.set("name", name);
        if (!value.is_null())
            all.push_back(item);
    }
    members.set("list", all);
    return members;
}

// Keeps one empty line of several in a row, which sections without a fact leave.
std::string without_gaps(const std::string& text)
{
    std::string out;
    for (const char c : text)
        if (c != '\n' || !out.ends_with("\n\n"))
            out += c;
    return out;
}

} // namespace

std::string methods_text(const study_facts& f, const dataset& d, const nlohmann::ordered_json& analysis)
{
    mustache::mustache text{std::string(methods_template())};
    text.set_custom_escape([](const std::string& t) { return escape_markdown(t); });
    return without_gaps(text.render(make_data(collect_facts(f, d, analysis))));
}

void check_report_name(const std::filesystem::path& file)
{
    if (file.extension() != ".md")
        throw error(error_kind::bad_input, file.string(), "the report is Markdown", "end the name in .md");
}

void write_report(const std::filesystem::path& file, const std::string& text, bool force)
{
    check_report_name(file);
    detail::check_replaced(file, force, [](std::string_view begin, std::string_view) {
        return begin.starts_with("# Methods: ") && begin.find(mark) != begin.npos;
    });
    detail::output_file out(file);
    out.write(text.data(), static_cast<std::int64_t>(text.size()));
    out.commit();
}

std::string escape_markdown(std::string_view text)
{
    constexpr std::string_view own = "\\`*_{}[]<>#|$~";
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool blank = c == ' ' || c == '\n' || c == '\t' || c == '\r';
        if (blank && !out.ends_with(' '))
            out += ' ';
        else if (!blank && (byte < 0x20 || byte == 0x7f))
            out += fmt::format("\\\\x{:02x}", byte);
        else if (!blank)
            out += own.find(c) == own.npos ? std::string(1, c) : std::string{'\\', c};
    }
    return out;
}

} // namespace tactor::study
