// SPDX-License-Identifier: MIT
#include <tactor/stroke.hpp>

#include <fmt/format.h>

#include "core/words.hpp"
#include "files/input_files.hpp"
#include "files/stroke/toml.hpp"
#include "files/text_file.hpp"

namespace tactor {
inline namespace v0 {
namespace {

// Returns the format that the extension of a file's name says; empty for others.
std::string_view format_in_name(const std::filesystem::path& file)
{
    const std::string extension = in_small_letters(file.extension().string());
    for (const std::string_view format : {"svg", "csv", "toml"})
        if (extension == fmt::format(".{}", format))
            return format;
    return {};
}

// Takes JSON for TOML, whose reader explains what it is.
std::string_view guess_format(std::string_view text)
{
    const std::string_view form = detail::find_text_form(text);
    return form == "json" ? "toml" : form;
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
        return detail::read_strokes_file(text, name, intensity_max);
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
