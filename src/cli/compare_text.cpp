// SPDX-License-Identifier: MIT
#include <set>
#include <string_view>

#include <fmt/format.h>

#include <tactor/words.hpp>

#include "cli/compare_rows.hpp"
#include "cli/say.hpp"

namespace tactor::cli {
namespace {

// A figure of the table, or a dash where there is none.
std::string figure(std::optional<double> v)
{
    return v ? fmt::format("{:.3f}", *v) : "-";
}

std::string names(const comparison_row& r)
{
    return fmt::format("{:<13} {:<16}", to_string(r.method), to_string(r.phantom));
}

void print_row(std::FILE* out, const comparison_row& r)
{
    if (r.refused) {
        say(out, "{} refused: {}\n", names(r), r.refused->what());
        return;
    }
    const std::string bursts = r.schedule->at ? "-" : fmt::format("{}", r.schedule->bursts.size());
    fmt::print(out, "{} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6.1f} {:>6.1f}\n", names(r), bursts,
               figure(r.felt.rms_error_mm), figure(r.felt.largest_error_mm), figure(r.felt.speed_cv),
               figure(r.felt.intensity_cv), 100.0 * r.felt.silent_share, 100.0 * r.felt.shared_share);
}

// What a plan warns of is mostly the same for all phantom models.
void print_warnings(std::FILE* out, std::string_view before, const comparison& c)
{
    std::set<std::string> said;
    for (const comparison_row& r : c.rows)
        if (r.schedule)
            for (const std::string& w : r.schedule->warnings) {
                const std::string text = fmt::format("{}warning: {}: {}\n", before, to_string(r.method), w);
                if (said.insert(text).second)
                    say_text(out, text);
            }
}

void print_one(std::FILE* out, const comparison& c, const array& a)
{
    const trajectory& m = c.target.motion;
    say(out, "{} on {}: {} mm in {}\n", c.target.name, a.name, plain_number(m.length_mm()),
        seconds_text(m.duration_s()));
    if (!c.target.note.empty())
        say(out, "note: {}\n", c.target.note);
    fmt::print(out, "\n{:<13} {:<16} {:>6} {:>13} {:>14} {:>13}\n", "", "", "", "error mm   ", "CV      ",
               "% of time ");
    fmt::print(out, "{:<13} {:<16} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6} {:>6}\n", "algorithm", "phantom",
               "bursts", "RMS", "max", "speed", "intens.", "silent", "shared");
    for (const comparison_row& r : c.rows)
        print_row(out, r);
    print_warnings(out, "", c);
}

// A field of CSV: quoted where it must be (RFC 4180).
std::string field(const std::string& text)
{
    if (text.find_first_of(",\"\r\n") == std::string::npos)
        return text;
    std::string quoted = "\"";
    for (const char c : text)
        quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

std::string field(std::optional<double> v)
{
    return v ? fmt::format("{}", *v) : "";
}

} // namespace

void print_text(std::FILE* out, const std::vector<comparison>& all, const array& a)
{
    for (const comparison& c : all) {
        print_one(out, c, a);
        fmt::print(out, "\n");
    }
    fmt::print(out,
               "CV: standard deviation / mean; shared: a tactor serves two bursts.\n"
               "This is {}.\n",
               prediction_note);
}

void print_csv(std::FILE* out, const std::vector<comparison>& all, const array&)
{
    fmt::print(out,
               "stroke,name,algorithm,phantom,bursts,rms_error_mm,largest_error_mm,speed_cv,intensity_cv,"
               "silent_share,shared_share,refused\n");
    for (std::size_t i = 0; i < all.size(); ++i)
        for (const comparison_row& r : all[i].rows) {
            fmt::print(out, "{},{},{},{},", i, field(all[i].target.name), to_string(r.method),
                       to_string(r.phantom));
            if (r.refused)
                fmt::print(out, ",,,,,,,{}\n", field(std::string(r.refused->what())));
            else
                fmt::print(out, "{},{},{},{},{},{},{},\n",
                           r.schedule->at ? "" : fmt::format("{}", r.schedule->bursts.size()),
                           field(r.felt.rms_error_mm), field(r.felt.largest_error_mm), field(r.felt.speed_cv),
                           field(r.felt.intensity_cv), r.felt.silent_share, r.felt.shared_share);
        }
    for (const comparison& c : all)
        print_warnings(stderr, "tactor: ", c); // there is no place for them in a table
}

} // namespace tactor::cli
