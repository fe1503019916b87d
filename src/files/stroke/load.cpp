// SPDX-License-Identifier: MIT
#include <tactor/stroke.hpp>

#include <fmt/format.h>

#include "core/words.hpp"
#include "files/stroke/toml.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {

std::string_view find_stroke_format(std::string_view text, const std::filesystem::path& file)
{
    const std::string extension = in_small_letters(file.extension().string());
    for (const std::string_view format : {"svg", "csv", "toml"})
        if (extension == fmt::format(".{}", format))
            return format;
    const std::string_view form = find_text_form(text);
    return form == "json" ? "toml" : form; // the reader of TOML explains what it is
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

std::vector<stroke> parse_strokes(std::string_view text, const std::string& name, double intensity_max)
{
    const std::string_view format = detail::find_stroke_format(text, {});
    return format == "svg"   ? parse_strokes_svg(text, name)
           : format == "csv" ? parse_strokes_csv(text, name, intensity_max)
                             : parse_strokes_toml(text, name, intensity_max);
}

std::vector<stroke> load_strokes(const std::filesystem::path& file, double intensity_max)
{
    const detail::whole_text text = detail::read_text_file(file, detail::max_stroke_bytes);
    const std::string name = file.string();
    const std::string_view format = detail::find_stroke_format(text, file);
    return format == "svg"   ? parse_strokes_svg(text, name)
           : format == "csv" ? parse_strokes_csv(text, name, intensity_max)
                             : detail::read_strokes_file(text, name, intensity_max);
}

std::vector<stroke> load_strokes(int descriptor, const std::string& name, double intensity_max)
{
    detail::note_input(fmt::format("/dev/fd/{}", descriptor));
    return parse_strokes(detail::read_text(descriptor, name, detail::max_stroke_bytes), name, intensity_max);
}

} // namespace v0
} // namespace tactor
