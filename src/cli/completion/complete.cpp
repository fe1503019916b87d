// SPDX-License-Identifier: MIT
#include "cli/usage.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string_view>

#include <CLI/CLI.hpp>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "core/split.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::cli {
namespace {

using lines = std::vector<std::string>;

constexpr const char* array_files = ":files .toml";
constexpr const char* folders = ":folders";
constexpr const char* stroke_files = ":files .toml .csv .svg";

bool starts_with(std::string_view text, std::string_view head)
{
    return text.substr(0, head.size()) == head;
}

void offer(lines& out, const std::string& typed, const std::string& word, const std::string& description)
{
    if (starts_with(word, typed))
        out.push_back(description.empty() ? word : word + "\t" + description);
}

// Cards by the names that survive a reboot. Nothing is opened: whoever presses Tab does not want that.
std::vector<std::string> pcm_names()
{
    std::vector<std::string> names{"null"};
    std::ifstream cards("/proc/asound/cards");
    for (std::string line; std::getline(cards, line);) {
        const std::size_t open = line.find('[');
        const std::size_t close = line.find(']');
        if (open == std::string::npos || close == std::string::npos || close < open)
            continue;
        std::string id = line.substr(open + 1, close - open - 1);
        id.erase(id.find_last_not_of(' ') + 1);
        names.push_back("hw:CARD=" + id);
    }
    return names;
}

bool is_word(std::string_view s)
{
    return !s.empty() && std::none_of(s.begin(), s.end(), [](unsigned char c) { return std::isupper(c); });
}

// ":files" for "FILE", "FILE.wav" and "FILE.svg|.png|.pdf".
std::string file_kinds(const std::string& type)
{
    std::string all = ":files";
    for (const std::string_view part : detail::split(type, '|'))
        if (const std::size_t dot = part.find('.'); dot != part.npos)
            all.append(" ").append(part.substr(dot));
    return all;
}

// The type of an option says its values: "a|b|c", "a,b,c" for a list, or what they stand for in capitals.
void offer_values(lines& out, const CLI::Option& o, const std::string& typed, const std::string& before)
{
    const std::string type = o.get_type_name();
    const auto offer_all = [&](const auto& values, const std::string& head) {
        for (const std::string_view v : values)
            if (is_word(v))
                offer(out, before + typed, (before + head).append(v), "");
    };
    if (type == "NAME|FILE") {
        offer_all(array_presets(), "");
        out.push_back(array_files);
    } else if (type == "PCM") {
        for (const std::string& name : pcm_names())
            offer(out, before + typed, before + name, "");
    } else if (type == "DIR") {
        out.push_back(folders);
    } else if (type == "PATH") {
        out.push_back(":files");
    } else if (type == "FILE") {
        out.push_back(array_files);
    } else if (starts_with(type, "FILE")) {
        out.push_back(file_kinds(type));
    } else if (type.find(',') != std::string::npos) {
        std::vector<std::string_view> values = detail::split(type, ',');
        std::vector<std::string_view> given = detail::split(typed, ',');
        given.pop_back();
        values.erase(std::remove_if(values.begin(), values.end(),
                                    [&](std::string_view v) {
                                        return std::find(given.begin(), given.end(), v) != given.end();
                                    }),
                     values.end());
        offer_all(values, typed.substr(0, typed.rfind(',') + 1));
    } else {
        offer_all(detail::split(type, '|'), "");
    }
}

bool takes_value(const CLI::Option& o)
{
    return !o.get_positional() && o.get_type_size() != 0;
}

const CLI::Option* option_called(const CLI::App& command, const std::string& name)
{
    return starts_with(name, "-") ? command.get_option_no_throw(name) : nullptr;
}

void offer_options(lines& out, const CLI::App& command, const std::string& typed)
{
    for (const CLI::Option* o : command.get_options()) {
        for (const std::string& name : o->get_lnames())
            offer(out, typed, "--" + name, o->get_description());
        for (const std::string& name : o->get_snames())
            offer(out, typed, "-" + name, o->get_description());
    }
}

void offer_strokes(lines& out, const CLI::App& command, const std::string& typed)
{
    for (const CLI::Option* o : command.get_options())
        if (o->get_positional() && o->get_single_name() == "STROKE") {
            for (const std::string& name : stroke_presets())
                offer(out, typed, name, "");
            out.push_back(stroke_files);
        } else if (o->get_positional() && o->get_single_name() == "DIR") {
            out.push_back(folders);
        } else if (o->get_positional() && o->get_single_name() == "EXPERIMENT") {
            for (const std::string& name : study::shipped_experiments())
                offer(out, typed, name, "");
            out.push_back(array_files); // definitions are TOML, too
        }
}

void complete_command_line(lines& out, const CLI::App& command, const std::vector<std::string>& words)
{
    const std::string& typed = words.back();
    const CLI::Option* before = words.size() > 1 ? option_called(command, words[words.size() - 2]) : nullptr;
    const std::size_t equals = starts_with(typed, "--") ? typed.find('=') : std::string::npos;
    if (before != nullptr && takes_value(*before))
        offer_values(out, *before, typed, "");
    else if (equals != std::string::npos) {
        const CLI::Option* o = option_called(command, typed.substr(0, equals));
        if (o != nullptr && takes_value(*o))
            offer_values(out, *o, typed.substr(equals + 1), typed.substr(0, equals + 1));
    } else if (starts_with(typed, "-"))
        offer_options(out, command, typed);
    else
        offer_strokes(out, command, typed);
}

} // namespace

std::vector<std::string> complete(const CLI::App& app, const std::vector<std::string>& words)
{
    lines out;
    if (words.empty())
        return out;
    for (const CLI::App* command : app.get_subcommands({}))
        if (words.size() == 1)
            offer(out, words[0], command->get_name(), command->get_description());
        else if (command->get_name() == words[0])
            complete_command_line(out, *command, {words.begin() + 1, words.end()});
    if (words.size() == 1 && starts_with(words[0], "-"))
        offer_options(out, app, words[0]);
    return out;
}

} // namespace tactor::cli
