// SPDX-License-Identifier: MIT
// The list of formats of stroke files, and reading of files whose format follows from name or content.
#include "files/stroke_format.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "core/refused.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {

// Each format is defined in the file of its reader.
extern const stroke_format toml_strokes;
extern const stroke_format csv_strokes;
extern const stroke_format svg_strokes;
extern const stroke_format tact_strokes;
extern const stroke_format haptic_strokes;
extern const stroke_format ahap_strokes;

namespace {

constexpr const stroke_format* formats[] = {&toml_strokes, &csv_strokes,    &svg_strokes,
                                            &tact_strokes, &haptic_strokes, &ahap_strokes};

template <class Is>
const stroke_format* find_format(Is is)
{
    const auto* const found = std::find_if(std::begin(formats), std::end(formats),
                                           [&is](const stroke_format* f) { return is(*f); });
    return found == std::end(formats) ? nullptr : *found;
}

} // namespace

std::span<const stroke_format* const> stroke_formats() noexcept
{
    return formats;
}

const stroke_format* find_format_by_name(std::string_view name) noexcept
{
    return find_format([name](const stroke_format& f) { return f.name == name; });
}

const stroke_format* find_format_by_extension(const std::filesystem::path& file)
{
    const std::string extension = to_lower_case(file.extension().string());
    return find_format([&extension](const stroke_format& f) {
        return std::find(f.extensions.begin(), f.extensions.end(), extension) != f.extensions.end();
    });
}

const stroke_format* find_format_by_content(std::string_view text)
{
    return find_format([text](const stroke_format& f) { return f.begins(text); });
}

const stroke_format* find_stroke_format(std::string_view text, const std::filesystem::path& file)
{
    const stroke_format* found = find_format_by_extension(file);
    if (found == nullptr)
        found = find_format_by_content(text);
    return found == nullptr ? formats[0] : found;
}

std::vector<stroke> read_stroke_text(const stroke_format& f, const stroke_file_text& s)
{
    if (!s.position.empty() && !f.has_positions)
        throw bad_field("position", fmt::format("{} has no positions", s.name),
                        "leave out {position}, which chooses a part of a .tact file");
    check_size(s.text, s.name, f.most_bytes, f.shorten);
    return f.parse(s);
}

std::vector<stroke> load_stroke_file(const std::filesystem::path& file, double intensity_max,
                                     std::string_view position, const actuator_numbers* actuator)
{
    const stroke_format* const named = find_format_by_extension(file);
    const whole_text text = named == nullptr
                                ? read_text_file(file, max_stroke_bytes)
                                : read_text_file(file, named->most_bytes, owner_kind::user, named->shorten);
    const std::string name = file.string();
    const std::filesystem::path folder = file.parent_path();
    return read_stroke_text(*find_stroke_format(text, file),
                            {text, name, intensity_max, &folder, position, actuator});
}

std::string list_stroke_formats()
{
    std::string all;
    for (const stroke_format* f : formats)
        all += fmt::format("{}{}",
                           f == formats[0]              ? ""
                           : f == *std::rbegin(formats) ? " or "
                                                        : ", ",
                           f->title);
    return all;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

std::vector<stroke> parse_strokes(std::string_view text, const std::string& name, double intensity_max,
                                  std::string_view position)
{
    return detail::read_stroke_text(*detail::find_stroke_format(text, {}),
                                    {text, name, intensity_max, nullptr, position});
}

std::vector<stroke> load_strokes(const std::filesystem::path& file, double intensity_max,
                                 std::string_view position)
{
    return detail::load_stroke_file(file, intensity_max, position, nullptr);
}

std::vector<stroke> load_strokes(int descriptor, const std::string& name, double intensity_max,
                                 std::string_view position)
{
    detail::note_input(fmt::format("/dev/fd/{}", descriptor));
    return parse_strokes(detail::read_text(descriptor, name, detail::max_stroke_bytes), name, intensity_max,
                         position);
}

} // namespace v0
} // namespace tactor
