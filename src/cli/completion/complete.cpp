// SPDX-License-Identifier: MIT
#include "cli/usage.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string_view>

#include <CLI/CLI.hpp>

#include <tactor/array.hpp>
#include <tactor/stroke.hpp>

#include "cli/settings.hpp"
#include "core/split.hpp"
#include "study/experiment/definition.hpp"

namespace tactor::cli {
namespace {

using lines = std::vector<std::string>;

constexpr const char* any_file = ":files";

void offer(lines& out, const std::string& typed, const std::string& word, const std::string& description)
{
    if (word.starts_with(typed))
        out.push_back(description.empty() ? word : word + "\t" + description);
}

// Cards by the names that survive a reboot. Nothing is opened: whoever presses Tab does not want that.
std::vector<std::string> pcm_names()
{
    std::vector<std::string> names{"null"};
    std::ifstream cards("/proc/asound/cards");
    for (std::string line; std::getline(cards, line);) {
        const std::size_t open = line.find('[');
        const std::size_t close = line.find_first_of(" ]", open);
        if (close != std::string::npos)
            names.push_back("hw:CARD=" + line.substr(open + 1, close - open - 1));
    }
    return names;
}

// The type of an option, or the name of an argument, says its values: "a|b|c", "a,b,c" for a list, or what
// they stand for in capitals.
void offer_values(lines& out, const std::string& type, const std::string& typed, const std::string& before)
{
    const auto offer_all = [&](const auto& values) {
        for (const std::string_view v : values)
            if (!v.empty() && v != "..." &&
                std::none_of(v.begin(), v.end(), [](unsigned char c) { return std::isupper(c) != 0; }))
                offer(out, before + typed, before + std::string(v), "");
    };
    const auto means = [&](const char* word) { return type.find(word) != std::string::npos; };
    if (type == "NAME|FILE")
        offer_all(array_presets());
    else if (type == "PCM")
        offer_all(pcm_names());
    else if (type == "STROKE")
        offer_all(stroke_presets());
    else if (type == "EXPERIMENT")
        offer_all(lines{study::shipped_experiment});
    else if (!type.starts_with("FILE"))
        offer_all(detail::split(type, type.find('|') == std::string::npos ? ',' : '|'));
    if (means("FILE") || means("DIR") || means("PATH") || means("STROKE") || means("EXPERIMENT"))
        out.emplace_back(any_file);
}

void offer_options(lines& out, const CLI::App& command, const std::string& typed)
{
    for (const CLI::Option* o : command.get_options()) {
        const std::string help = spelled(o->get_description());
        for (const std::string& name : o->get_lnames())
            offer(out, typed, "--" + name, help);
        for (const std::string& name : o->get_snames())
            offer(out, typed, "-" + name, help);
    }
}

// Returns the option with that name where it takes a value, else null.
const CLI::Option* find_option(const CLI::App& command, const std::string& name)
{
    const CLI::Option* o = name.starts_with('-') ? command.get_option_no_throw(name) : nullptr;
    return o != nullptr && o->get_type_size() != 0 ? o : nullptr;
}

void complete_command_line(lines& out, const CLI::App& command, const std::vector<std::string>& words)
{
    const std::string& typed = words.back();
    const std::string head = typed.starts_with("--") ? typed.substr(0, typed.find('=') + 1) : "";
    if (const CLI::Option* o = words.size() > 1 ? find_option(command, words[words.size() - 2]) : nullptr)
        offer_values(out, o->get_type_name(), typed, "");
    else if (!head.empty()) {
        if (const CLI::Option* named = find_option(command, head.substr(0, head.size() - 1)))
            offer_values(out, named->get_type_name(), typed.substr(head.size()), head);
    } else if (typed.starts_with('-'))
        offer_options(out, command, typed);
    else
        for (const CLI::Option* argument :
             command.get_options([](const CLI::Option* x) { return x->get_positional(); }))
            offer_values(out, argument->get_single_name(), typed, "");
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
    if (words.size() == 1 && words[0].starts_with('-'))
        offer_options(out, app, words[0]);
    return out;
}

} // namespace tactor::cli
