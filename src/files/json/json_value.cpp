// SPDX-License-Identifier: MIT
#include "files/json/json_value.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"

namespace tactor::files {

using nlohmann::ordered_json;

namespace {

// Returns a description of a range: "from 0 to 1", "above 0", "at most 0".
std::string range_text(const detail::bounds& range)
{
    const std::string low =
        std::isfinite(range.low) ? fmt::format("{} {}", range.above_low ? "above" : "from", range.low) : "";
    if (!std::isfinite(range.high))
        return range.above_low ? low : fmt::format("{} or more", range.low);
    if (low.empty() || range.above_low)
        return fmt::format("{}{}at most {}", low, low.empty() ? "" : " and ", range.high);
    return fmt::format("{} to {}", low, range.high);
}

// Returns the end of the comment that begins at `at`, or `at` if there is no comment.
std::size_t find_comment_end(std::string_view text, std::size_t at)
{
    const std::string_view mark = text.substr(at, 2);
    if (mark != "//" && mark != "/*")
        return at;
    const std::size_t end = text.find(mark == "//" ? "\n" : "*/", at + 2);
    return end == std::string_view::npos ? text.size() : end + (mark == "//" ? 0 : 2);
}

// Returns the end of the longest run of digits and characters of `in` that begins at `at`.
std::size_t find_run_end(std::string_view text, std::size_t at, std::string_view in)
{
    while (at < text.size() && ((text[at] >= '0' && text[at] <= '9') || in.find(text[at]) != in.npos))
        ++at;
    return at;
}

// Removes comments, and commas before a closing bracket. The lines stay the same. With `json5`, also puts
// double quotes around names without quotes and texts in single quotes, and completes numbers such as +.5.
// Refuses more than `deepest` nested values, because their tree would take far more memory than the text.
std::string make_strict_json(std::string_view text, const std::string& file, bool json5)
{
    constexpr std::size_t deepest = 64;
    constexpr std::string_view name = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_$";
    std::string out;
    out.reserve(text.size());
    std::size_t depth = 0;
    std::size_t comma = std::string::npos; // place in `out` of a comma that no value follows yet
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        if (const std::size_t end = find_comment_end(text, i); end != i) {
            out.append(
                static_cast<std::size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                                                    text.begin() + static_cast<std::ptrdiff_t>(end), '\n')),
                '\n');
            i = end;
            continue;
        }
        if (detail::blank(c)) {
            out += text[i++];
            continue;
        }
        if ((c == '}' || c == ']') && comma != std::string::npos)
            out[comma] = ' ';
        comma = c == ',' ? out.size() : std::string::npos;
        depth += c == '{' || c == '[' ? 1 : 0;
        depth -= (c == '}' || c == ']') && depth > 0 ? 1 : 0;
        if (depth > deepest)
            throw error(error_kind::bad_input, source_place{file},
                        fmt::format("its values are nested more than {} deep", deepest), "name another file");
        std::size_t end = i + 1;
        if (c == '"' || (json5 && c == '\'')) {
            out += '"';
            for (; end < text.size() && text[end] != c; ++end) {
                const bool escaped = text[end] == '\\' && end + 1 < text.size();
                if (escaped ? text[end + 1] != '\'' : text[end] == '"') // JSON needs \" and does not have \'
                    out += '\\';
                end += escaped ? 1 : 0;
                out += text[end];
            }
            if (end < text.size())
                out += '"';
            ++end;
        } else if (const std::size_t to = find_run_end(text, i, name);
                   json5 && to > i && name.find(c) != name.npos) {
            const std::string_view word = text.substr(i, to - i);
            const bool value = word == "true" || word == "false" || word == "null";
            out += value ? std::string(word) : fmt::format("\"{}\"", word);
            end = to;
        } else if (const std::size_t number = find_run_end(text, i, "+-.eE"); number > i) {
            std::string_view digits = text.substr(i, number - i);
            if (json5 && digits.starts_with('+'))
                digits.remove_prefix(1);
            const std::size_t sign = digits.starts_with('-') ? 1 : 0;
            out.append(digits.substr(0, sign));
            if (json5 && digits.substr(sign).starts_with('.'))
                out += '0';
            out.append(digits.substr(sign));
            if (json5 && digits.ends_with('.'))
                out += '0';
            end = number;
        } else {
            out += c;
        }
        i = end;
    }
    return out;
}

} // namespace

ordered_json read_foreign_object(std::string_view text, const std::string& file, bool json5)
{
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    if (text.starts_with(mark))
        text.remove_prefix(mark.size());
    return read_object(make_strict_json(text, file, json5), file);
}

ordered_json read_object(const std::string& text, const std::string& file)
{
    std::size_t byte = 0;
    const char* why = "it is not JSON";
    try {
        ordered_json j = ordered_json::parse(text);
        if (j.is_object())
            return j;
        why = "it is not an object";
    } catch (const ordered_json::parse_error& e) {
        byte = std::min(e.byte, text.size());
    } catch (const ordered_json::exception&) { // a number that is too large for a double
    }
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(byte);
    const auto line = static_cast<unsigned>(1 + std::count(text.begin(), end, '\n'));
    throw error(error_kind::bad_input, source_place{file, line}, why, "restore the original file");
}

void json_value::refuse(std::string_view why, std::string_view hint) const
{
    throw error(error_kind::bad_input, *file_,
                place_.empty() ? std::string(why) : fmt::format("{}: {}", place_, why),
                hint.empty() ? hint_ : hint)
        .with_field(place_)
        .with_place({*file_});
}

json_value json_value::operator[](const std::string& key) const
{
    std::string place = place_.empty() ? key : place_ + "." + key;
    if (!exists())
        return {nullptr, *file_, hint_, std::move(place)};
    if (!value_->is_object())
        refuse("it is not an object");
    const auto at = value_->find(key);
    return {at == value_->end() ? nullptr : &*at, *file_, hint_, std::move(place)};
}

const json_value& json_value::need_member() const
{
    if (value_ == nullptr)
        refuse("it is missing");
    return *this;
}

std::vector<json_value> json_value::list() const
{
    std::vector<json_value> all;
    if (!exists())
        return all;
    if (!value_->is_array())
        refuse("it is not a list");
    for (const ordered_json& one : *value_)
        all.push_back({&one, *file_, hint_, fmt::format("{}[{}]", place_, all.size())});
    return all;
}

template <class T>
std::optional<T> json_value::get(bool (ordered_json::*is_one)() const noexcept, std::string_view why) const
{
    if (!exists())
        return {};
    if (!(value_->*is_one)())
        refuse(why);
    return value_->get<T>();
}

std::optional<double> json_value::number() const
{
    return get<double>(&ordered_json::is_number, "it is not a number");
}

std::optional<std::string> json_value::text() const
{
    return get<std::string>(&ordered_json::is_string, "it is not a text");
}

std::optional<bool> json_value::truth() const
{
    return get<bool>(&ordered_json::is_boolean, "it is neither true nor false");
}

std::vector<json_value> json_value::need_list() const
{
    if (!need_member().exists())
        refuse("it is null");
    return list();
}

std::vector<std::string> json_value::keys() const
{
    std::vector<std::string> all;
    if (exists() && value_->is_object())
        for (const auto& [key, value] : value_->items())
            all.push_back(key);
    return all;
}

double json_value::need_number(const detail::bounds& range, bool texts) const
{
    const std::optional<double> v = texts && exists() && value_->is_string()
                                        ? detail::parse_number_text<double>(detail::without_blanks(*text()))
                                        : need_number();
    if (!v)
        refuse("it is not a number");
    if (!range.holds(*v))
        refuse(fmt::format("{} is out of range: it must be {}", *v, range_text(range)));
    return *v;
}

void json_value::need_members() const
{
    if (!need_member().exists())
        refuse("it is null");
    if (!value_->is_object())
        refuse("it is not an object");
}

std::vector<double> json_value::need_numbers() const
{
    std::vector<double> all;
    for (const json_value& one : need_list())
        all.push_back(one.need_number());
    return all;
}

std::string json_value::words() const
{
    if (!exists())
        return {};
    if (value_->is_string())
        return value_->get<std::string>();
    if (value_->is_number_float())
        return plain_number(value_->get<double>());
    if (!value_->is_structured())
        return value_->dump();
    std::string all;
    for (const auto& [key, value] : value_->items()) {
        const std::string one = json_value(&value, *file_, hint_, place_).words();
        if (one.empty())
            continue;
        all += all.empty() ? "" : ", ";
        all += value_->is_object() ? fmt::format("{}: {}", key, one) : one;
    }
    return all;
}

void json_reader::finish() const
{
    for (const std::string& key : object_.keys())
        if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
            const std::string_view near = detail::nearest_name(key, known_);
            object_[key].refuse("it is an unknown field",
                                near.empty() ? "" : detail::similar_name_hint(key, near));
        }
}

double json_reader::whole(const json_value& from, const detail::bounds& range, bool is_unsigned, bool is_long)
{
    const double most = is_long ? 0x1p53 : 1e6;
    const double low = std::max(range.low, is_unsigned ? 0.0 : -most);
    const double high = std::min(range.high, most);
    const double v = from.need_number();
    if (!(v >= low && v <= high) || v != std::floor(v))
        from.refuse(fmt::format("it is not a whole number from {} to {}", low, high));
    return v;
}

} // namespace tactor::files
