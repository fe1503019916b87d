// SPDX-License-Identifier: MIT
#include "cli/usage.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace tactor::cli {
namespace {

std::size_t edit_distance(const std::string& a, const std::string& b)
{
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0]++;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t change = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, change});
        }
    }
    return row.back();
}

// The name most like `given`, if one is like it at all.
std::string nearest(const std::string& given, const std::vector<std::string>& names)
{
    std::string best;
    std::size_t best_distance = std::max<std::size_t>(2, given.size() / 3) + 1;
    for (const std::string& n : names) {
        const std::size_t d = edit_distance(given, n);
        if (d < best_distance) {
            best_distance = d;
            best = n;
        }
    }
    return best;
}

const CLI::App& used_command(const CLI::App& app)
{
    const auto used = app.get_subcommands();
    return used.empty() ? app : *used.front();
}

std::vector<std::string> option_names(const CLI::App& command)
{
    std::vector<std::string> names;
    for (const CLI::Option* o : command.get_options())
        for (const std::string& l : o->get_lnames())
            names.push_back("--" + l);
    return names;
}

error unknown(const CLI::App& app, const CLI::App& command)
{
    const auto left = app.remaining(true);
    const std::string given = left.empty() ? "" : left.front();
    const std::string help =
        "tactor " + (&command == &app ? "" : command.get_name() + " ") + "--help lists them";
    if (given.rfind("-", 0) == 0) {
        const std::string name = given.substr(0, given.find('='));
        const std::string like = nearest(name, option_names(command));
        return {errc::bad_input, name, "no such option",
                like.empty() ? help : fmt::format("did you mean {}? {}", like, help)};
    }
    if (&command == &app) {
        std::vector<std::string> names;
        for (const CLI::App* c : app.get_subcommands({}))
            names.push_back(c->get_name());
        const std::string like = nearest(given, names);
        return {errc::bad_input, given, "no such command",
                like.empty() ? help : fmt::format("did you mean {}? {}", like, help)};
    }
    return {errc::bad_input, given, "one argument too many", help};
}

} // namespace

error usage_error(const CLI::App& app, const CLI::ParseError& e)
{
    const CLI::App& command = used_command(app);
    if (dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr)
        return unknown(app, command);
    if (app.get_subcommands().empty() && !app.remaining().empty())
        return unknown(app, app);
    return {errc::bad_input, "command line", e.what(),
            fmt::format("tactor {}--help", &command == &app ? "" : command.get_name() + " ")};
}

} // namespace tactor::cli
