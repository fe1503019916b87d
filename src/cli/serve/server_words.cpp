// SPDX-License-Identifier: MIT
#include "cli/serve/server_words.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <variant>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include <tactor/stroke.hpp>

#include "cli/input.hpp"
#include "cli/option_words.hpp"
#include "files/plan/plan_file.hpp"
#include "files/text_file.hpp"
#include "net/listen.hpp"
#include "session/pipes.hpp"

namespace tactor::cli {

namespace {

// Replaces "options.level_dbfs" with "--level-dbfs".
std::string in_options(std::string_view text)
{
    constexpr std::string_view prefix = "options.";
    std::string out;
    for (std::size_t at = 0; (at = text.find(prefix)) != text.npos;) {
        out.append(text.substr(0, at));
        text.remove_prefix(at + prefix.size());
        const std::string_view name = text.substr(0, text.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"));
        const options::option* o = options::find(name);
        out += o == nullptr ? fmt::format("{}{}", prefix, name) : option_name(*o);
        text.remove_prefix(name.size());
    }
    return out.append(text);
}

constexpr std::size_t most_bytes = 48U << 20;

std::string read_all(int fd, const std::string& name)
{
    std::string all;
    for (;;) {
        char bytes[65536];
        const ssize_t n = ::read(fd, bytes, sizeof bytes);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            throw error(error_kind::bad_input, name, std::strerror(errno));
        if (n == 0)
            return all;
        all.append(bytes, static_cast<std::size_t>(n));
        if (all.size() > most_bytes)
            throw error(error_kind::bad_input, name, "it is too large for a server",
                        "play it without --socket");
    }
}

[[noreturn]] void refuse_plan(const std::string& name)
{
    throw error(error_kind::bad_input, name, "it is a plan, which a server does not take", "give the stroke");
}

net::json make_params(const std::string& argument)
{
    const auto& presets = stroke_presets();
    std::error_code ignored;
    const bool is_preset = std::find(presets.begin(), presets.end(), argument) != presets.end();
    if (argument == "-") {
        const std::string text = read_all(STDIN_FILENO, "standard input");
        if (files::holds_plans(text))
            refuse_plan("standard input");
        return {{std::string(detail::find_stroke_format(text, {})), text}};
    }
    if (is_preset ||
        (!std::filesystem::exists(argument, ignored) && argument.find_first_of("./") == std::string::npos))
        return {{"stroke", preset_stroke(argument).name}}; // its error lists the presets
    if (files::is_plan_file(argument))
        refuse_plan(argument);
    session::check_readable(argument);
    const net::owned_fd fd(::open(argument.c_str(), O_RDONLY | O_CLOEXEC));
    if (!fd)
        throw error(error_kind::bad_input, argument, std::strerror(errno));
    const std::string text = read_all(fd.get(), argument);
    return {{std::string(detail::find_stroke_format(text, argument)), text}};
}

} // namespace

error in_words_of_the_tool(const error& e, const std::string& argument)
{
    std::string what(e.subject());
    if (what == "stroke" || what == "path" || what == "toml" || what == "csv" || what == "svg") {
        const source_place at{argument, e.place().line, e.place().column};
        if (at.line != 0)
            return e.reworded(at.text(), e.why(), e.hint()).with_place(at);
        what = argument;
    } else {
        what = in_options(what);
    }
    return e.reworded(what, in_options(e.why()), in_options(e.hint()));
}

std::vector<std::pair<std::string, net::json>> stroke_params(const settings& s)
{
    const std::vector<std::string> arguments = stroke_arguments(s);
    if (s.path_data)
        return {{arguments.front(), {{"path", *s.path_data}}}};
    if (s.shape)
        return {{arguments.front(), {{"stroke", *s.shape}}}};
    std::vector<std::pair<std::string, net::json>> all;
    for (const std::string& argument : arguments)
        all.emplace_back(argument, make_params(argument));
    return all;
}

net::json client_options(const settings& s)
{
    net::json given = net::json::object();
    for (const options::option& o : options::all()) {
        if ((o.where & options::by_client) == 0 || !s.gives(o))
            continue;
        std::visit(
            [&]<class T>(const T& v) {
                if constexpr (!std::is_same_v<T, std::monostate>)
                    given[std::string(o.name)] = v;
            },
            o.to.get(s));
    }
    return given;
}

} // namespace tactor::cli
