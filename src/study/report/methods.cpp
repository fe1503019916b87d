// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>
#include <tactor/version.hpp>

#include "files/output_file.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

constexpr std::string_view mark = "Written by tactor ";

// Facts for a paper that no file of the folder has.
constexpr const char* by_hand =
    "\n## To be added by hand\n\n"
    "The files do not say: who approved the study and how consent was given; how participants were "
    "recruited and\n"
    "paid; where on the body the array lay, how it was held and how hard the skin pressed on it; the "
    "actuators' maker\n"
    "and type, the amplifier, the headphones; what was sampled a priori and why so many participants took "
    "part.\n";

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

// Makes a line for each participant: trials that count, void ones, those with gaps in the sound.
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

std::string version_text(const session_facts& s)
{
    const std::string tactor = s.facts()["versions"]["tactor"].words();
    const std::string build = s.facts()["versions"]["build"].words();
    return build.empty() ? plain(tactor) : fmt::format("{} ({})", plain(tactor), plain(build));
}

// Removes blanks that lined a table up.
std::string without_runs_of_blanks(const std::string& text)
{
    std::string out;
    for (const char c : text)
        if (c != ' ' || out.empty() || out.back() != ' ')
            out += c;
    return out;
}

// Counts the answers that are marked early, by run.
std::string early_text(const study_facts& f, const dataset& d)
{
    std::vector<std::string> runs;
    for (std::size_t i = 0; i < d.experiment.runs.size(); ++i) {
        std::size_t n = 0;
        for (const std::vector<run_data>& own : d.data)
            n += count_early(own[i]);
        if (n == 0)
            continue;
        const std::string least = join_texts(f, [&](const session_facts& s) {
            return s.design ? digits(s.design->runs.at(i).min_response_s) + " s" : std::string();
        });
        runs.push_back(fmt::format("{} in {} (sooner than {} after the stimulus)", n,
                                   plain(d.experiment.runs[i].name), least));
    }
    return runs.empty() ? "No answer is marked early. "
                        : fmt::format("Answers marked early, which count: {}. ", fmt::join(runs, ", "));
}

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
    text += early_text(f, d);
    text += "Trials that count / void / void\nwith gaps in the sound:\n\n";
    text += trials_table(f, d);
    text += "\n### Versions and hashes\n\n";
    text += fmt::format("- tactor: {}\n", without_runs_of_blanks(join_texts(f, version_text)));
    text += fmt::format("- SHA-256 of the definition: {}\n",
                        join_texts(f, [](const session_facts& s) { return "`" + s.definition_hash + "`"; }));
    if (std::any_of(f.sessions.begin(), f.sessions.end(),
                    [](const session_facts& s) { return !s.stimuli.empty(); }))
        text += "- Each stimulus is identified by the SHA-256 of its plan, in the table above; the plans "
                "were found "
                "to have these\n  hashes still, and each trial to name those of its motion and methods.\n";
    return text;
}

} // namespace

std::string methods_text(const study_facts& f, const dataset& d, const analysis& a)
{
    std::string text = fmt::format("# Methods: {}\n\n", join_texts(f, [&](const session_facts& s) {
                                       return plain(s.design ? s.design->title : d.experiment.name);
                                   }));
    if (a.simulated)
        text += fmt::format("> **SIMULATED: nobody was asked.** The answers come from a model ({}). They "
                            "test the software and say nothing\n> about people.\n\n",
                            join_texts(f, [](const session_facts& s) {
                                return plain(s.facts()["simulation"].text().value_or(""));
                            }));
    text += fmt::format(
        "{}{} from the files of the study; what they do not say is \"{}\". Lengths are in mm with x to "
        "the\nright and y down, levels in dB below full scale (dBFS) unless said otherwise.\n",
        mark, version(), not_recorded);
    text += participants_section(f, a);
    text += apparatus_section(f);
    text += stimuli_section(f);
    text += procedure_section(f, d);
    text += data_section(f, d);
    text += results_section(a);
    text += by_hand;
    text += references_section(text);
    return text;
}

void check_report_name(const std::filesystem::path& file)
{
    if (file.extension() != ".md")
        throw error(error_kind::bad_input, file.string(), "the report is Markdown", "end the name in .md");
}

void write_report(const std::filesystem::path& file, const std::string& text, bool force)
{
    check_report_name(file);
    detail::check_replaced(file, force, [](std::string_view begin, std::string_view) {
        return begin.starts_with("# Methods: ") && begin.find(mark) != begin.npos;
    });
    detail::output_file out(file);
    out.write(text.data(), static_cast<std::int64_t>(text.size()));
    out.commit();
}

std::string plain(std::string_view text)
{
    constexpr std::string_view own = "\\`*_{}[]<>#|$~";
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '\n' || c == '\t' || c == '\r')
            out += ' ';
        else if (byte < 0x20 || byte == 0x7f)
            out += fmt::format("\\\\x{:02x}", byte);
        else {
            if (own.find(c) != std::string_view::npos)
                out += '\\';
            out += c;
        }
    }
    return out;
}

std::string plain_list(const std::vector<std::string>& names)
{
    std::string all;
    for (const std::string& n : names)
        all += (all.empty() ? "" : ", ") + plain(n);
    return all;
}

std::string digits(double v)
{
    return fmt::format("{:.6g}", v);
}

std::string subjects(std::span<const std::string> codes)
{
    std::string all;
    for (const std::string& c : codes)
        all += (all.empty() ? "sub-" : ", sub-") + c;
    return all;
}

std::string table_row(const std::vector<std::string>& cells)
{
    std::string line = "|";
    for (const std::string& c : cells)
        line += fmt::format(" {} |", c);
    return line + "\n";
}

std::string table_head(const std::vector<std::string>& cells)
{
    return table_row(cells) + table_row(std::vector<std::string>(cells.size(), "---"));
}

void add_text(shared_texts& all, std::string text, const std::string& who)
{
    auto at = std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.first == text; });
    if (at == all.end())
        at = all.emplace(at, std::move(text), std::vector<std::string>());
    at->second.push_back(who);
}

std::string join_texts(const study_facts& f, const std::function<std::string(const session_facts&)>& say)
{
    shared_texts texts;
    for (const session_facts& s : f.sessions) {
        std::string text = say(s);
        add_text(texts, text.empty() ? not_recorded : std::move(text), s.code);
    }
    if (texts.size() == 1)
        return texts.front().first;
    std::string all;
    for (const auto& [text, codes] : texts)
        all += fmt::format("{}{} ({})", all.empty() ? "" : "; ", text, subjects(codes));
    return all;
}

std::string range_text(const std::vector<double>& values)
{
    if (values.empty())
        return not_recorded;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const std::string from = digits(*low);
    const std::string to = digits(*high);
    return from == to ? from : fmt::format("{} to {}", from, to);
}

} // namespace tactor::study
