// SPDX-License-Identifier: MIT
#include "cli/analyze/study_options.hpp"

#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include <tactor/error.hpp>

#include "cli/settings.hpp"
#include "core/split.hpp"

namespace tactor::cli {
namespace {

// "A,B,...": none empty.
std::vector<std::string> parse_codes(const char* option, std::string_view text)
{
    std::vector<std::string> codes;
    for (const std::string_view code : detail::split(text, ',')) {
        if (code.empty())
            throw error(error_kind::bad_input, option, "a code is empty",
                        "codes with commas between, as 01,02");
        codes.emplace_back(code);
    }
    return codes;
}

// "CODE:REASON,...": the reasons are optional, and have no comma.
void parse_excluded(std::string_view text, study::selection& who)
{
    for (const std::string& one : parse_codes("--exclude", text)) {
        const std::size_t colon = one.find(':');
        const std::string code = one.substr(0, colon);
        who.without.push_back(code);
        if (colon != std::string::npos && colon + 1 < one.size())
            who.reasons[code.starts_with("sub-") ? code.substr(4) : code] = one.substr(colon + 1);
    }
}

} // namespace

void add_study_options(CLI::App& command, std::string& folder, study::selection& who)
{
    command.add_option("DIR", folder, "folder of the study, as tactor experiment wrote it")->required();
    add_text(command, "--participants", "CODES", "participants to include (default all)",
             [&who](const std::string& t) { who.only = parse_codes("--participants", t); });
    add_text(command, "--exclude", "CODE[:REASON],...",
             "participants to leave out; the report names them with their reasons",
             [&who](const std::string& t) { parse_excluded(t, who); });
}

void make_derivatives(const std::filesystem::path& folder, const std::filesystem::path& file)
{
    const std::filesystem::path ours = folder / "derivatives" / "tactor";
    std::error_code ignored;
    // However both are written.
    if (std::filesystem::weakly_canonical(std::filesystem::absolute(file, ignored).parent_path(), ignored) ==
        std::filesystem::weakly_canonical(std::filesystem::absolute(ours, ignored), ignored))
        std::filesystem::create_directories(ours, ignored);
}

} // namespace tactor::cli
