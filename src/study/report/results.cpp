// SPDX-License-Identifier: MIT
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"
#include "study/analysis/analysis.hpp"
#include "study/report/sections.hpp"

namespace tactor::study {
namespace {

// Lines of a run's results, each marked if the study is simulated.
class results {
public:
    explicit results(bool simulated) : mark_(simulated ? "(simulated) " : "") {}

    void line(const std::string& text)
    {
        text_ += fmt::format("{}- {}{}\n", after_table_ ? "\n" : "", mark_, text);
        after_table_ = false;
    }
    void effect_line(const std::string& name, const effect& e)
    {
        if (e.f)
            line(fmt::format("Effect of {}: {}.", name, effect_text(e)));
    }
    void table(const std::string& caption, const std::string& rows)
    {
        text_ += fmt::format("\n{}{}:\n\n{}", mark_, caption, rows);
        after_table_ = true;
    }
    std::string text() const { return text_; }

private:
    std::string mark_;
    std::string text_ = {};
    bool after_table_ = false;
};

std::string mean_text(const t_test& t, const char* unit, const std::string& ci)
{
    return fmt::format("{}{} (se {}, 95 % interval {})", value_text(t.mean), unit, value_text(t.se), ci);
}

std::string mean_text(const t_test& t, const char* unit, const interval& possible)
{
    return mean_text(t, unit, interval_text(t.ci, possible));
}

// Describes a test of a mean against a number, or says that there is none.
std::string test_text(const t_test& t, const char* d)
{
    std::string text = t.t ? t_text(t) : "no t test (too few participants, or no variance)";
    text += fmt::format(", exact sign-flip p {}", p_text(t.p_signflip));
    if (t.d)
        text += fmt::format(", {} = {:.2f} (95 % interval {})", d, *t.d, interval_text(t.d_ci));
    return text;
}

std::string tests_table(const by_motion& b, const std::vector<std::string>& motions)
{
    std::string rows =
        table_head({"motion", "mean", "se", "95 % interval", "test", "p (Holm)", "p (sign flips)", "d"});
    for (std::size_t m = 0; m < motions.size(); ++m) {
        const t_test& t = b.motion[m];
        rows += table_row({plain(motions[m]), value_text(t.mean), value_text(t.se),
                           interval_text(t.ci, per_cents), t.t ? t_text(t) : "-", p_text(b.p_holm[m]),
                           p_text(t.p_signflip), value_text(t.d)});
    }
    return rows;
}

void pairs(results& r, const std::vector<comparison>& all, const std::vector<std::string>& motions,
           const std::string& of)
{
    if (all.empty() || !all[0].q)
        return;
    std::string rows = table_head({"pair", "difference", "q", "p"});
    for (const comparison& c : all)
        rows += table_row({fmt::format("{} - {}", plain(motions[c.a]), plain(motions[c.b])),
                           value_text(c.difference), value_text(c.q), p_text(c.p)});
    r.table("Tukey's comparisons" + of, rows);
}

void choose(results& r, const run_analysis& a)
{
    const by_motion& b = a.cells[0];
    r.line(fmt::format("{} was chosen in {} of trials, against 50 %: {}.", plain(a.run.methods.back()),
                       mean_text(b.all, " %", per_cents), test_text(b.all, "d")));
    r.line(fmt::format("The first interval was chosen in {} of trials, against 50 %: {}.",
                       mean_text(a.first_interval, " %", per_cents), test_text(a.first_interval, "d")));
    r.effect_line("motion", a.effects.second);
    r.table("By motion, against 50 %", tests_table(b, a.run.motions));
    pairs(r, a.pairs[0], a.run.motions, " of motions");
}

void rate(results& r, const run_analysis& a)
{
    for (std::size_t m = 0; m < a.run.methods.size(); ++m)
        r.line(fmt::format("{}: mean rating {}.", plain(a.run.methods[m]),
                           mean_text(a.cells[m].all, "", possible_values(a.run))));
    if (a.run.methods.size() > 1)
        r.line(fmt::format("{} less {}, paired: {}, {}.", plain(a.run.methods.back()),
                           plain(a.run.methods.front()), mean_text(a.paired, "", interval_text(a.paired.ci)),
                           test_text(a.paired, "d_z")));
    r.effect_line("method", a.effects.first);
    r.effect_line("motion", a.effects.second);
    r.effect_line("method by motion", a.effects.interaction);
    std::string rows = table_head({"method", "motion", "mean", "se", "95 % interval"});
    for (std::size_t m = 0; m < a.run.methods.size(); ++m)
        for (std::size_t k = 0; k < a.run.motions.size(); ++k) {
            const t_test& t = a.cells[m].motion[k];
            rows += table_row({plain(a.run.methods[m]), plain(a.run.motions[k]), value_text(t.mean),
                               value_text(t.se), interval_text(t.ci, possible_values(a.run))});
        }
    r.table("Mean ratings", rows);
    for (std::size_t m = 0; m < a.run.methods.size(); ++m)
        pairs(r, a.pairs[m], a.run.motions, " of motions within " + plain(a.run.methods[m]));
}

void identify(results& r, const run_analysis& a)
{
    const std::string against = fmt::format("{:.2f} %", chance(a.run));
    for (std::size_t m = 0; m < a.run.methods.size(); ++m) {
        const by_motion& b = a.cells[m];
        r.line(fmt::format("{}: correct in {} of trials, against {}: {}.", plain(a.run.methods[m]),
                           mean_text(b.all, " %", per_cents), against, test_text(b.all, "d")));
        r.table(fmt::format("{}: by motion, against {}", plain(a.run.methods[m]), against),
                tests_table(b, a.run.motions));
        std::vector<std::string> head{"motion, then its answers"};
        for (const std::string& k : a.run.motions)
            head.push_back(plain(k));
        std::string rows = table_head(head);
        for (std::size_t i = 0; i < a.run.motions.size(); ++i) {
            std::vector<std::string> row{plain(a.run.motions[i])};
            for (const std::size_t count : a.confusion[m][i])
                row.push_back(fmt::format("{}", count));
            rows += table_row(row);
        }
        r.table(fmt::format("{}: answers", plain(a.run.methods[m])), rows);
    }
}

std::string run_results(const run_analysis& a, bool simulated)
{
    std::string text = fmt::format("\n### {}{}\n\n", plain(a.run.name), simulated ? " (SIMULATED)" : "");
    results r(simulated);
    r.line(fmt::format("{}, {} that count.", counted(a.n, "participant"), counted(a.trials, "trial")));
    for (const left_out& l : a.missing)
        r.line(fmt::format("sub-{} is left out: {}.", l.participant, l.why));
    if (a.n == 0)
        return text + r.text();
    if (a.run.task == task_kind::choose)
        choose(r, a);
    else if (a.run.task == task_kind::rate)
        rate(r, a);
    else
        identify(r, a);
    return text + r.text();
}

/// A paper, and the word in the text that refers to it.
struct reference {
    std::string_view mark;
    std::string_view text;
};

constexpr std::array<reference, 10> references{
    {{"Blackman", "- Blackman, D., Vigna, S. (2018): Scrambled linear pseudorandom number generators. arXiv "
                  "1805.01407.\n"},
     {"Greenhouse", "- Greenhouse, S. W., Geisser, S. (1959): On methods in the analysis of profile data. "
                    "Psychometrika 24.\n"},
     {"Holm", "- Holm, S. (1979): A simple sequentially rejective multiple test procedure. Scandinavian "
              "Journal of Statistics 6.\n"},
     {"Israr", "- Israr, A., Poupyrev, I. (2011): Tactile brush: drawing on skin with a tactile grid "
               "display. CHI 2011, 2019-2028.\n"},
     {"Lemire", "- Lemire, D. (2019): Fast random integer generation in an interval. ACM Transactions on "
                "Modeling and Computer\n  Simulation 29.\n"},
     {"Mauchly", "- Mauchly, J. W. (1940): Significance test for sphericity of a normal n-variate "
                 "distribution. Annals of\n  Mathematical Statistics 11.\n"},
     {"Olejnik", "- Olejnik, S., Algina, J. (2003): Generalized eta and omega squared statistics. "
                 "Psychological Methods 8.\n"},
     {"Park et al.", "- Park, J., Kim, J., Oh, Y., Tan, H. Z. (2016): Rendering moving tactile stroke on the "
                     "palm using a sparse 2D array.\n  EuroHaptics 2016.\n"},
     {"Williams", "- Williams, E. J. (1949): Experimental designs balanced for the estimation of residual "
                  "effects of treatments.\n  Australian Journal of Scientific Research A 2.\n"},
     {"Yun", "- Yun, G., Oh, S., Choi, S. (2019), World Haptics Conference: the Gaussian phantom model.\n"}}};

} // namespace

std::string results_section(const analysis& a)
{
    std::string text = fmt::format("\n## Results{}\n\n", a.simulated ? " (SIMULATED)" : "");
    text += "Each participant's trials become one value for each cell, void ones left out; all means are of "
            "participants. t tests\nare two-sided; d and d_z with intervals from the noncentral t "
            "distribution; sign-flip p are exact; p of motions also\nadjusted by Holm (1979). Analyses of "
            "variance are of repeated measures, each effect against its interaction with\nparticipants; "
            "sphericity by Mauchly (1940) and Greenhouse and Geisser (1959); eta squared partial and "
            "generalised\n(Olejnik and Algina 2003); pairs of motions by Tukey's studentized range.\n";
    for (const run_analysis& r : a.runs)
        text += run_results(r, a.simulated);
    if (!a.warnings.empty() || !a.no_figures.empty())
        text += "\n### Warnings of the analysis\n\n";
    for (const std::vector<std::string>* all : {&a.warnings, &a.no_figures})
        for (const std::string& w : *all)
            text += fmt::format("- {}\n", plain(w));
    return text;
}

std::string references_section(std::string_view named)
{
    std::string text = "\n## References\n\n";
    for (const reference& r : references)
        if (named.find(r.mark) != std::string_view::npos)
            text += r.text;
    return text;
}

} // namespace tactor::study
