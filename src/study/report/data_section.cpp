// SPDX-License-Identifier: MIT
#include <algorithm>

#include <fmt/format.h>

#include "study/report/markdown.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

std::string gaps_text(const void_count& c)
{
    return c.unknown == 0         ? fmt::format("{}", c.with_xruns)
           : c.unknown == c.voids ? std::string(not_recorded)
                                  : fmt::format("{} (of {}: {})", c.with_xruns, c.unknown, not_recorded);
}

std::string again_text(const void_count& c)
{
    if (c.again == c.voids)
        return c.voids == 1 ? "It came again" : "All of them came again";
    return fmt::format("{} of them came again, {} did not", c.again, c.voids - c.again);
}

// A line for each participant: trials that count, void ones, those with gaps in the sound.
std::string trials_table(const study_facts& f, const dataset& d)
{
    std::vector<std::string> head{"participant"};
    for (const run_outline& r : d.experiment.runs)
        head.push_back(plain(r.name));
    std::string text = table_head(head);
    for (const session_facts& s : f.sessions) {
        std::vector<std::string> row{"sub-" + s.code};
        for (std::size_t i = 0; i < d.experiment.runs.size(); ++i)
            for (std::size_t k = 0; k < d.participants.size(); ++k)
                if (d.participants[k] == s.code)
                    row.push_back(fmt::format("{} / {} / {}", d.data[k][i].trials.size(), s.voids[i].voids,
                                              gaps_text(s.voids[i])));
        text += table_row(row);
    }
    return text;
}

std::string version_of(const session_facts& s)
{
    const std::string tactor = s.facts()["versions"]["tactor"].words();
    const std::string build = s.facts()["versions"]["build"].words();
    return build.empty() ? plain(tactor) : fmt::format("{} ({})", plain(tactor), plain(build));
}

// Blanks that lined a table up.
std::string without_runs_of_blanks(const std::string& text)
{
    std::string out;
    for (const char c : text)
        if (c != ' ' || out.empty() || out.back() != ' ')
            out += c;
    return out;
}

} // namespace

std::string data_section(const study_facts& f, const dataset& d)
{
    std::string text = "\n## Data\n\n";
    void_count all;
    for (const session_facts& s : f.sessions)
        for (const void_count& c : s.voids)
            all = {all.voids + c.voids, all.again + c.again, all.with_xruns + c.with_xruns,
                   all.unknown + c.unknown};
    if (all.voids == 0)
        text += "No trial was void. ";
    else
        text += fmt::format("Void trials: {}, of which had gaps in the sound: {}; they do not count. {}. ",
                            all.voids, gaps_text(all), again_text(all));
    text += "Trials that count / void / void\nwith gaps in the sound:\n\n";
    text += trials_table(f, d);
    text += "\n### Versions and hashes\n\n";
    text += fmt::format("- tactor: {}\n", without_runs_of_blanks(told(f, version_of)));
    text += fmt::format("- SHA-256 of the definition: {}\n",
                        told(f, [](const session_facts& s) { return "`" + s.definition_hash + "`"; }));
    if (std::any_of(f.sessions.begin(), f.sessions.end(),
                    [](const session_facts& s) { return !s.stimuli.empty(); }))
        text += "- Each stimulus is identified by the SHA-256 of its plan, in the table above; the plans "
                "were found "
                "to have these\n  hashes still, and each trial to name those of its motion and methods.\n";
    return text;
}

} // namespace tactor::study
