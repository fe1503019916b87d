// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/analyze/analyze_output.hpp"
#include "cli/say.hpp"
#include "study/analysis/analysis.hpp"

namespace tactor::cli {
namespace {

using study::task_kind;

// A text in quotes, as R reads it.
std::string in_quotes(std::string_view text)
{
    std::string q;
    for (const char c : text) {
        if (c == '"' || c == '\\')
            q += '\\';
        q += c;
    }
    return fmt::format("\"{}\"", q);
}

// The model of a run. People differ in what is asked about, too: without its slope for each of them, such a
// difference passes for an effect of all. Nothing of the stimuli is taken to be a sample.
std::string write_model(const study::run_outline& r)
{
    const char* motion = r.motions.size() > 1 ? "motion" : "1";
    const char* people = r.task != task_kind::choose && r.methods.size() > 1 ? "(1 + method | participant)"
                         : r.motions.size() > 1                              ? "(1 + motion | participant)"
                                                                             : "(1 | participant)";
    const std::string data = fmt::format("data = subset(d, run == {})", in_quotes(r.name));
    switch (r.task) {
    case task_kind::choose:
        return fmt::format("glmer(chosen ~ {} + order + {}, family = binomial, {})", motion, people, data);
    case task_kind::rate:
        return fmt::format("lmer(rating ~ {}{} + {}, {})", r.methods.size() > 1 ? "method * " : "", motion,
                           people, data);
    case task_kind::identify:
        break;
    }
    return fmt::format("glmer(correct ~ {}{} + {}, family = binomial, {})",
                       r.methods.size() > 1 ? "method * " : "", motion, people, data);
}

// The columns that depend on the task; "method" of choose is the one that may be chosen.
std::string answer(const study::trial& t, const study::run_outline& r)
{
    switch (r.task) {
    case task_kind::choose: {
        const bool chosen = study::last_chosen(t, r);
        const bool first = t.method_1 + 1 == r.methods.size();
        return fmt::format("{}\t{}\t{}\t{}\tn/a\tn/a", r.methods.back(), first ? "0.5" : "-0.5", t.response,
                           chosen ? 1 : 0);
    }
    case task_kind::rate:
        return fmt::format("{}\tn/a\t{}\tn/a\t{}\tn/a", r.methods[t.method_1], t.response, t.response);
    case task_kind::identify:
        break;
    }
    return fmt::format("{}\tn/a\t{}\tn/a\tn/a\t{}", r.methods[t.method_1], r.motions[t.response],
                       t.response == t.motion ? 1 : 0);
}

} // namespace

void print_trials(std::FILE* out, const study::dataset& d)
{
    std::string text;
    if (d.simulated)
        text += "# simulated: these are no people's answers\n";
    // Names may have "#" in them: the notes are counted, not told by their first letter.
    const std::size_t notes = 3 + (d.simulated ? 1 : 0) + d.experiment.runs.size();
    // With sum contrasts an effect is over all motions, not that at the first one.
    text += fmt::format("# library(lme4)\n"
                        "# options(contrasts = c(\"contr.sum\", \"contr.poly\"))\n"
                        "# d <- read.delim(\"trials.tsv\", skip = {}, na.strings = \"n/a\", quote = \"\", "
                        "colClasses = c(participant = \"character\"))\n",
                        notes);
    for (const study::run_outline& r : d.experiment.runs)
        text += fmt::format("# {}\n", write_model(r));
    text += "participant\trun\ttask\ttrial\tattempt\tmotion\tmethod\torder\tresponse\tchosen\trating\tcorrect"
            "\tresponse_time\tearly\n";
    for (std::size_t i = 0; i < d.participants.size(); ++i)
        for (std::size_t k = 0; k < d.experiment.runs.size(); ++k) {
            const study::run_outline& r = d.experiment.runs[k];
            for (const study::trial& t : d.data[i][k].trials)
                text += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\n", d.participants[i], r.name,
                                    to_string(r.task), t.place, t.attempt, r.motions[t.motion], answer(t, r),
                                    t.response_time_s ? fmt::format("{}", *t.response_time_s) : "n/a",
                                    t.early ? (*t.early ? "true" : "false") : "n/a");
        }
    fmt::print(out, "{}", text);
}

} // namespace tactor::cli
