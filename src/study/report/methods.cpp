// SPDX-License-Identifier: MIT

#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include <tactor/error.hpp>
#include <tactor/version.hpp>

#include "files/output_file.hpp"
#include "study/report/markdown.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

std::string title_of(const study_facts& f, const dataset& d)
{
    return told(f, [&](const session_facts& s) {
        return s.design ? plain(s.design->title) : plain(d.experiment.name);
    });
}

constexpr std::string_view mark = "Written by tactor ";

// What no file of the folder knows, and a paper must say.
constexpr const char* by_hand =
    "\n## To be added by hand\n\n"
    "The files do not say: who approved the study and how consent was given; how participants were "
    "recruited and\n"
    "paid; where on the body the array lay, how it was held and how hard the skin pressed on it; the "
    "actuators' maker\n"
    "and type, the amplifier, the headphones; what was sampled a priori and why so many participants took "
    "part.\n";

} // namespace

std::string methods_text(const study_facts& f, const dataset& d, const analysis& a)
{
    std::string text = fmt::format("# Methods: {}\n\n", title_of(f, d));
    if (a.simulated)
        text += fmt::format("> **SIMULATED: nobody was asked.** The answers come from a model ({}). They "
                            "test the software and say nothing\n> about people.\n\n",
                            told(f, [](const session_facts& s) {
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

} // namespace tactor::study
