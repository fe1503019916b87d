// SPDX-License-Identifier: MIT
#include "study/data/outline.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/split.hpp"
#include "study/data/trial.hpp"

namespace tactor::study {

std::string describe_group(const group_outline& g)
{
    std::vector<std::string> parts;
    for (const run_outline& r : g.runs)
        if (!r.motions.empty())
            parts.push_back(fmt::format("{}: motions {}, methods {}", r.name, fmt::join(r.motions, ", "),
                                        fmt::join(r.methods, ", ")));
    return fmt::format("{}", fmt::join(parts, "; "));
}

std::string make_file_name(std::string_view run)
{
    std::string name;
    for (const char c : run)
        if ((c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))
            name += c;
    return name;
}

std::string session_name(std::string_view code, session_number session)
{
    return session ? fmt::format("sub-{}_ses-{}", code, *session) : fmt::format("sub-{}", code);
}

std::filesystem::path session_path(std::string_view code, session_number session)
{
    return session ? fmt::format("sub-{}/ses-{}", code, *session) : fmt::format("sub-{}", code);
}

std::filesystem::path source_path(std::string_view code, session_number session)
{
    return "sourcedata" / session_path(code, session);
}

std::filesystem::path table_path(std::string_view code, session_number session, const run_outline& run)
{
    return session_path(code, session) / "beh" /
           fmt::format("{}_task-{}_beh.tsv", session_name(code, session), run.file_name);
}

std::filesystem::path description_path(const run_outline& run)
{
    return fmt::format("task-{}_beh.json", run.file_name);
}

std::optional<double> read_estimate(std::string_view text) noexcept
{
    if (text.size() > most_estimate_characters || text.find_first_not_of("0123456789.") != text.npos)
        return {};
    const auto number = detail::parse_number_text<double>(text);
    return number >= least_estimate && number <= most_estimate ? number : std::nullopt;
}

} // namespace tactor::study
