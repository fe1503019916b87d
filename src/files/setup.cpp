// SPDX-License-Identifier: MIT
#include <tactor/setup.hpp>

#include <fmt/format.h>

#include "core/words.hpp"
#include "files/setup_parts.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

std::string place_note(const source_place& at)
{
    return at.line != 0 ? fmt::format(" ({})", at.text()) : std::string();
}

// Refuses a channel count in which the map, or the marker, does not fit.
void check_channels(const located_setup& s)
{
    const auto& count = s.said.output.channels;
    if (!count)
        return;
    if (s.said.array) {
        const unsigned needed = s.said.array->channels();
        for (std::size_t i = 0; needed > *count && i < s.said.array->tactors.size(); ++i) {
            const tactor_spec& t = s.said.array->tactors[i];
            if (t.channel + 1 == needed)
                fail_at(s.channels_at,
                        fmt::format("channels is {}, but tactor {}{} is on channel {}", *count, i,
                                    place_note(t.where), t.channel),
                        fmt::format("the array needs {}; they count from 0", counted(needed, "channel")));
        }
    }
    if (s.said.sync && s.said.sync->channel && *s.said.sync->channel >= *count)
        fail_at(s.sync_channel_at,
                fmt::format("the marker's channel is {}, but there {} {}{}", *s.said.sync->channel,
                            *count == 1 ? "is" : "are", counted(*count, "channel"),
                            place_note(s.channels_at)),
                "channels count from 0");
}

void check_marker(const located_setup& s)
{
    if (!s.said.array || !s.said.sync || !s.said.sync->channel)
        return;
    for (std::size_t i = 0; i < s.said.array->tactors.size(); ++i) {
        const tactor_spec& t = s.said.array->tactors[i];
        if (t.channel == *s.said.sync->channel)
            fail_at(s.sync_channel_at,
                    fmt::format("the marker's channel {} is that of tactor {}{}", t.channel, i,
                                place_note(t.where)),
                    "give the marker a channel without a tactor");
    }
}

bool same_line(const gpio_line_name& a, const gpio_line_name& b)
{
    return a.chip == b.chip && a.offset == b.offset && a.name == b.name;
}

// Refuses a GPIO line that serves two purposes.
void check_lines(const setup& s)
{
    std::vector<const gpio_line_name*> lines;
    if (s.amplifier)
        lines.push_back(&s.amplifier->line);
    if (s.sync && s.sync->out)
        lines.push_back(&*s.sync->out);
    if (s.sync && s.sync->in)
        lines.push_back(&*s.sync->in);
    for (std::size_t i = 0; i < lines.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (same_line(*lines[i], *lines[j]))
                fail_at(lines[i]->where, fmt::format("the line is in use at {}", lines[j]->where.text()),
                        "give each purpose a GPIO line of its own");
}

} // namespace

located_setup read_setup(std::string_view text, const setup_source& source)
{
    const toml::table document =
        parse_toml(text, source.name,
                   {.kinds = "arrays and configurations are TOML; points, drawings and plans are strokes"});
    const toml_table root(document, "the file", source.name);
    if (root.has("stroke"))
        root.fail("stroke", "this is a stroke file, not an array or configuration", "name it as the STROKE");
    root.only(
        {"array", "tactor", "output", "amplifier", "sync", "limits", "serve", "defaults", "calibration"});

    located_setup out;
    read_array(root, source, out);
    read_calibration(root, out);
    read_output(root, out);
    read_amplifier(root, out);
    read_sync(root, out);
    read_limits(root, out);
    read_serve(root, out.said);
    read_defaults(root, out.said);

    if (out.said.array)
        validate(*out.said.array);
    check_channels(out);
    check_marker(out);
    check_lines(out.said);
    return out;
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

setup load_setup(const std::filesystem::path& file)
{
    const detail::whole_text text = detail::read_text_file(file, detail::max_setup_bytes);
    std::error_code ignored;
    return detail::read_setup(
               text, {file.string(), file.parent_path(), {std::filesystem::weakly_canonical(file, ignored)}})
        .said;
}

setup parse_setup(std::string_view toml, const std::string& name)
{
    return detail::read_setup(toml, {name, {}, {}}).said;
}

} // namespace v0
} // namespace tactor
