// SPDX-License-Identifier: MIT
#include <tactor/stroke.hpp>

#include <algorithm>

#include <fmt/format.h>

#include "core/path/number.hpp"
#include "core/words.hpp"
#include "files/input_files.hpp"
#include "files/stroke/parts.hpp"
#include "files/text_file.hpp"

namespace tactor {
inline namespace v0 {
namespace {

// Returns the first line with something on it that is not a comment.
std::string_view first_line(std::string_view text)
{
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        std::size_t at = 0;
        detail::skip_blanks(line, at);
        line.remove_prefix(at);
        if (!line.empty() && line.front() != '#')
            return line;
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return {};
}

// Returns true for a header, also one that forgets t_s: TOML has no line with a comma and without '=' at its
// top.
bool looks_like_csv(std::string_view line)
{
    return line.find_first_of("=[{") == std::string_view::npos &&
           (line.find("t_s") != std::string_view::npos || line.find(',') != std::string_view::npos);
}

// Returns the format that the extension of a file's name says; empty for others.
std::string_view format_in_name(const std::filesystem::path& file)
{
    const std::string extension = in_small_letters(file.extension().string());
    for (const std::string_view format : {"svg", "csv", "toml"})
        if (extension == fmt::format(".{}", format))
            return format;
    return {};
}

std::string_view guess_format(std::string_view text)
{
    const std::string_view line = first_line(detail::without_mark(text));
    if (!line.empty() && line.front() == '<')
        return "svg";
    return looks_like_csv(line) ? "csv" : "toml";
}

std::vector<stroke> parse_as(std::string_view format, std::string_view text, const std::string& name,
                             double intensity_max)
{
    return format == "svg"   ? parse_strokes_svg(text, name)
           : format == "csv" ? parse_strokes_csv(text, name, intensity_max)
                             : parse_strokes_toml(text, name, intensity_max);
}

} // namespace

std::vector<stroke> parse_strokes(std::string_view text, const std::string& name, double intensity_max)
{
    return parse_as(guess_format(text), text, name, intensity_max);
}

std::vector<stroke> load_strokes(const std::filesystem::path& file, double intensity_max)
{
    const detail::whole_text text = detail::read_text_file(file, detail::max_stroke_bytes);
    const std::string name = file.string();
    const std::string_view format = format_in_name(file);
    if (format == "toml")
        return detail::strokes_of_toml_file(text, name, intensity_max);
    return format.empty() ? parse_strokes(text, name, intensity_max)
                          : parse_as(format, text, name, intensity_max);
}

std::vector<stroke> load_strokes(int descriptor, const std::string& name, double intensity_max)
{
    detail::note_input(fmt::format("/dev/fd/{}", descriptor));
    return parse_strokes(detail::read_text(descriptor, name, detail::max_stroke_bytes), name, intensity_max);
}

} // namespace v0

namespace detail {

std::string_view find_stroke_format(std::string_view text, const std::filesystem::path& file)
{
    const std::string_view format = format_in_name(file);
    return format.empty() ? guess_format(text) : format;
}

} // namespace detail
} // namespace tactor
