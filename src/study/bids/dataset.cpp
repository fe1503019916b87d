// SPDX-License-Identifier: MIT
#include "study/bids/dataset.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/tasks/adaptive.hpp"
#include "study/tasks/task.hpp"
#include "study/tasks/values.hpp"

namespace tactor::study {
namespace {

constexpr std::size_t sha256_digits = 64;

namespace fs = std::filesystem;

constexpr std::string_view prefix = "sub-";

// Returns the code in "sub-CODE"; empty for other texts. Allows only letters and digits, because the code
// becomes part of paths.
std::string_view read_code(std::string_view id)
{
    if (!id.starts_with(prefix))
        return {};
    id.remove_prefix(prefix.size());
    return make_file_name(id) == id ? id : std::string_view{};
}

// Lists a folder in no particular order. Throws error (bad_input) if it cannot be read.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder)
{
    std::vector<std::filesystem::path> all;
    std::error_code failed;
    for (std::filesystem::directory_iterator i(folder, failed), end; !failed && i != end; i.increment(failed))
        all.push_back(i->path());
    if (failed)
        throw error(error_kind::bad_input, source_place{folder.string()}, failed.message(),
                    "make the folder and its files readable")
            .with_os_code(failed.value());
    return all;
}

// Throws error (bad_input) if a folder belongs to a participant who is not in the list: the analysis would
// silently skip it.
void refuse_unlisted_people(const fs::path& folder, const std::vector<std::string>& known)
{
    for (const fs::path& path : list_folder(folder)) {
        const std::string name = path.filename().string();
        if (!name.starts_with(prefix))
            continue;
        if (std::find(known.begin(), known.end(), name.substr(prefix.size())) == known.end())
            throw error(error_kind::bad_input, source_place{path.string()},
                        "participants.tsv does not list this participant",
                        "add a line there, or move this folder away");
    }
}

// Reads the participants' codes in a study's folder.
std::vector<std::string> read_codes(const fs::path& folder)
{
    std::error_code failed;
    if (!fs::is_directory(fs::status(folder, failed)))
        throw error(error_kind::bad_input, source_place{folder.string()},
                    failed ? failed.message() : "it is not a folder", "name the folder of a study")
            .with_os_code(failed ? failed.value() : ENOTDIR);
    std::vector<std::string> known = read_participants(text_table(folder / "participants.tsv"));
    if (known.empty())
        throw error(error_kind::bad_input, source_place{(folder / "participants.tsv").string()},
                    "it lists no participant", "add a line for each participant, as tactor experiment does");
    refuse_unlisted_people(folder, known);
    return known;
}

// Returns an error about an option that selects participants. Each front end spells the option in its own
// way.
error selection_error(std::string_view option, std::string_view why, std::string_view hint)
{
    return error(error_kind::bad_input, option, why, hint).with_field(option);
}

// Returns the code that an option names, without "sub-". Throws error (bad_input) if no participant has it.
std::string find_code(const std::vector<std::string>& known, const std::string& wanted,
                      std::string_view option)
{
    std::string code = wanted.starts_with(prefix) ? wanted.substr(prefix.size()) : wanted;
    if (std::find(known.begin(), known.end(), code) == known.end())
        throw selection_error(option, fmt::format("\"{}\" is not in participants.tsv", wanted),
                              fmt::format("use one of {}", fmt::join(known, ", ")));
    return code;
}

// Returns the selected codes, and adds all other codes to `excluded`.
std::vector<std::string> select(const std::vector<std::string>& known, const selection& who,
                                std::vector<excluded_person>& excluded)
{
    std::set<std::string> only;
    for (const std::string& wanted : who.only)
        only.insert(find_code(known, wanted, "participants"));
    std::map<std::string, std::string> without;
    for (const auto& [wanted, reason] : who.without)
        if (std::string& why = without[find_code(known, wanted, "exclude")]; !reason.empty())
            why = reason;
    std::vector<std::string> selected;
    for (const std::string& code : known)
        if (without.contains(code))
            excluded.push_back({code, without[code].empty() ? "no reason was given" : without[code]});
        else if (!only.empty() && !only.contains(code))
            excluded.push_back({code, "not among those selected"});
        else
            selected.push_back(code);
    if (selected.empty())
        throw selection_error("participants", "no participant remains", "select at least one participant");
    return selected;
}

trial read_trial(const text_table& t, std::size_t row, const run_outline& run)
{
    trial r;
    r.motion = find_place(t, row, "motion", run.motions);
    r.response_time_s = t.number(row, "response_time");
    if (r.response_time_s.value_or(0.0) < 0.0)
        t.refuse(row, fmt::format("response_time is {}", *r.response_time_s), "give 0 s or more");
    find_run_task(run).read_row(r, t, row, run);
    return r;
}

// Reads a run's table. Throws error (bad_input) if the last line is cut off. The error suggests --resume only
// if trials are missing, because only then can the session resume.
run_data read_whole_run(const fs::path& file, const run_outline& run)
{
    const text_table t(file, last_line::may_be_cut);
    run_data d = read_run(t, run);
    read_cells(t); // refuses what --resume would refuse, such as decimal commas
    if (t.cut_position())
        t.refuse_cut(d.trials.size() < run.trials
                         ? "run tactor experiment --resume, which moves it to another file"
                         : "complete it, or delete it");
    return d;
}

class reader {
public:
    // Adds a participant whose files are in `folder`.
    void add(const std::string& code, const fs::path& folder)
    {
        folder_ = folder;
        set_.participants.push_back(code);
        set_.data.emplace_back();
        set_.groups.emplace_back();
        const std::vector<session_number> sessions = list_sessions(folder_, code); // may be empty
        for (const session_number session : sessions)
            add_session(code, session);
        for (std::size_t i = 0; i < set_.data.back().size(); ++i)
            set_.data.back()[i].sessions =
                static_cast<unsigned>(std::ranges::count_if(sessions, [&](session_number n) {
                    return set_.experiment.runs[i].is_in_session(n.value_or(1));
                }));
        for (unsigned n = 1; n <= set_.experiment.sessions && set_.experiment.sessions > 1; ++n)
            if (!sessions.empty() && std::ranges::find(sessions, n) == sessions.end())
                set_.warnings.push_back(fmt::format("sub-{} has no session {}", code, n));
    }

    dataset finish()
    {
        if (first_.empty())
            throw error(error_kind::bad_input, source_place{(folder_ / "sourcedata").string()},
                        "no participant has a session.json", "name a folder that tactor experiment wrote");
        for (std::vector<run_data>& runs : set_.data)
            runs.resize(set_.experiment.runs.size());
        return std::move(set_);
    }

private:
    // Adds a session of the last participant.
    void add_session(const std::string& code, session_number session)
    {
        const session_data s = read_session(folder_ / source_path(code, session) / "session.json");
        take_session(session_name(code, session), s);
        const unsigned planned = set_.experiment.sessions;
        if (session.value_or(1) > planned || session.has_value() != (planned > 1))
            throw error(error_kind::bad_input, session_name(code, session),
                        fmt::format("these files are of {}, but the experiment has {}",
                                    session ? fmt::format("session {}", *session) : "no session",
                                    planned == 1 ? "no numbered sessions"
                                                 : fmt::format("sessions 1 {} {}",
                                                               planned == 2 ? "and" : "to", planned)),
                        "move its files away, or leave out the participant with {exclude}");
        std::string& group = set_.groups.back();
        if (std::vector<run_data>& runs = set_.data.back(); runs.empty()) {
            group = s.group;
            runs.resize(set_.experiment.runs.size(), {.predictions = s.predictions});
        }
        if (group != s.group)
            throw error(error_kind::bad_input, session_name(code, session),
                        fmt::format("it is in group \"{}\", but an earlier session is in group \"{}\"",
                                    s.group, group),
                        "correct session.json, or leave out the participant with {exclude}");
        for (std::size_t i = 0; i < set_.experiment.runs.size(); ++i) {
            const run_outline& run = find_run(set_, set_.participants.size() - 1, i);
            const fs::path table = table_path(code, session, run);
            if (!exists_in_study(folder_, table))
                continue;
            run_data own = read_whole_run(folder_ / table, run);
            run_data& all = set_.data.back()[i];
            all.voids += own.voids;
            for (played_track& t : replay_tracks(run, own.trials)) {
                t.session = session;
                all.tracks.push_back(t);
            }
            for (trial& t : own.trials) {
                t.session = session;
                all.trials.push_back(t);
            }
        }
        if (const fs::path beh = session_path(code, session) / "beh"; exists_in_study(folder_, beh))
            refuse_unknown_tables(folder_ / beh, code, session);
    }

    // Keeps the experiment of the first session. Throws error (bad_input) if a later session has a different
    // experiment. `name`: name of the session in messages.
    void take_session(const std::string& name, const session_data& s)
    {
        if (first_.empty()) {
            first_ = name;
            text_ = s.text;
            set_.experiment = s.experiment;
            set_.simulated = s.simulated;
            return;
        }
        constexpr const char* choose = "choose people with {participants} or {exclude}";
        const auto differs = [&](std::string_view why, std::string_view hint) {
            throw error(error_kind::bad_input, fmt::format("{} and {}", first_, name), why, hint);
        };
        if (s.simulated != set_.simulated)
            differs("one is simulated and one is not", choose);
        if (const experiment_difference d = find_difference(set_.experiment, s.experiment))
            differs("their experiments differ: " + d.place +
                        (d.before.empty() ? fmt::format("they do not have the same {}", d.what)
                                          : fmt::format("{} has the {} {}, but {} has {}", first_, d.what,
                                                        d.before, name, d.now)),
                    choose);
        if (s.text != text_)
            set_.warnings.push_back(fmt::format(
                "{} and {}: the texts of their experiments differ, but not in parts that the analysis reads",
                first_, name));
    }

    // Throws error (bad_input) for a table that belongs to no run: the analysis would silently skip it.
    void refuse_unknown_tables(const fs::path& beh, const std::string& code, session_number session) const
    {
        for (const fs::path& path : list_folder(beh)) {
            const std::string name = path.filename().string();
            const auto is_its_table = [&](const run_outline& r) {
                return r.is_in_session(session.value_or(1)) &&
                       path.filename() == table_path(code, session, r).filename();
            };
            if (!name.starts_with('.') && name.ends_with("_beh.tsv") &&
                std::none_of(set_.experiment.runs.begin(), set_.experiment.runs.end(), is_its_table))
                throw error(
                    error_kind::bad_input, source_place{path.string()},
                    fmt::format("the experiment has no such run{}", session ? " in this session" : ""),
                    "move the file away");
        }
    }

    fs::path folder_;
    std::string first_; ///< name of the first session
    std::string text_;
    dataset set_;
};

} // namespace

session_data read_session(const std::filesystem::path& file)
{
    const std::string name = file.string();
    const nlohmann::ordered_json j = files::read_object(read_file(file), name);
    const files::json_value all(j, name, "correct the file as described in tactor-analyze(1)");
    session_data s;
    s.simulated = all["simulated"].need_truth();
    s.text = all["experiment"]["text"].need_text();
    s.experiment = read_outline(s.text, name + ": experiment.text");
    const std::vector<group_outline>& groups = s.experiment.groups;
    if (!groups.empty()) {
        s.group = all["group"].need_text();
        if (std::ranges::find(groups, s.group, &group_outline::name) == groups.end())
            all["group"].refuse("it is not a group of the experiment");
    }
    for (const files::json_value& one : all["predictions"].list()) {
        std::optional<drawing> felt = read_drawing(one["felt"].need_text());
        if (!felt)
            one["felt"].refuse("it is not a drawing");
        s.predictions.push_back({one["observer"].need_text(), one["motion"].need_text(),
                                 one["method"].need_text(), *std::move(felt)});
    }
    return s;
}

std::vector<session_number> list_sessions(const fs::path& folder, std::string_view code)
{
    std::set<session_number> all{session_number{}};
    for (const fs::path& parent : {source_path(code, {}), session_path(code, {})})
        if (exists_in_study(folder, parent))
            for (const fs::path& path : list_folder(folder / parent))
                if (const std::string name = path.filename().string(); name.starts_with("ses-")) {
                    const auto n = detail::parse_number_text<unsigned>(name.substr(4));
                    if (!n || fmt::format("ses-{}", *n) != name)
                        throw error(error_kind::bad_input, source_place{path.string()}, "it is not a session",
                                    "call it ses-1, ses-2 and so on, or move it away");
                    all.insert(n);
                }
    std::erase_if(all, [&](session_number s) {
        return !exists_in_study(folder, source_path(code, s) / "session.json") &&
               !exists_in_study(folder, session_path(code, s) / "beh");
    });
    return {all.begin(), all.end()};
}

bool are_similar_codes(std::string_view a, std::string_view b)
{
    // Removes the number at the end of a code, and returns it without leading zeros.
    const auto take_number = [](std::string_view& code) {
        const std::size_t at = code.find_last_not_of("0123456789") + 1; // npos + 1 is 0
        std::string_view number = code.substr(at);
        code = code.substr(0, at);
        number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
        return number;
    };
    const std::string_view number = take_number(a);
    if (number != take_number(b))
        return false;
    const bool one_is_bare = !number.empty() && (a.empty() || b.empty());
    return one_is_bare || to_lower_case(std::string(a)) == to_lower_case(std::string(b));
}

bool has_cut_plan_hash(const text_table& t)
{
    if (!t.is_open())
        return false;
    const std::string& column = t.columns().back();
    const std::size_t row = t.rows() - 1;
    const std::size_t length = t.cell(row, column).value_or("").size();
    if (column == "plan_1")
        return length != sha256_digits;
    const bool is_plan = column == "plan_2" || column == "plan_3";
    return is_plan && length != (t.cell(row, "method_" + column.substr(5)) ? sha256_digits : 0);
}

text_table read_trials(const std::filesystem::path& table)
{
    text_table t(table, last_line::may_be_cut);
    if (has_cut_plan_hash(t))
        t.drop_last_row();
    return t;
}

std::vector<std::string> read_participants(const text_table& t)
{
    t.need_column("participant_id");
    std::vector<std::string> all;
    for (std::size_t i = 0; i < t.rows(); ++i) {
        const std::string_view code = read_code(t.need(i, "participant_id"));
        if (code.empty())
            t.refuse(i, "this is not a participant_id", "use sub- with letters and digits");
        if (std::find(all.begin(), all.end(), code) != all.end())
            t.refuse(i, fmt::format("sub-{} occurs twice", code), "give each participant one line");
        all.emplace_back(code);
    }
    return all;
}

run_data read_run(const text_table& t, const run_outline& run)
{
    for (const trial_column& c : trial_columns)
        if (c.use == column_use::analysis)
            t.need_column(c.name);
    run_data d;
    std::set<unsigned> seen;
    for (std::size_t i = 0; i < t.rows(); ++i) {
        const auto place = t.whole(i, "trial", 1, run.trials > 0 ? run.trials : 1000000);
        if (!place)
            t.refuse(i, "the trial is missing", "give its place in the sequence, from 1");
        const unsigned attempt = t.whole(i, "attempt", 1, 1000000).value_or(1);
        if (t.truth(i, "void")) {
            ++d.voids;
            continue;
        }
        if (!seen.insert(*place).second)
            t.refuse(i, fmt::format("trial {} counts twice", *place),
                     "keep one of its attempts, and make the others void");
        trial r = read_trial(t, i, run);
        if (t.has("early") && t.cell(i, "early"))
            r.early = t.truth(i, "early");
        if (run.is_adaptive() && t.has("track"))
            r.track = t.whole(i, "track", 1, count_tracks(run)).value_or(0);
        r.place = *place;
        r.attempt = attempt;
        d.trials.push_back(r);
    }
    return d;
}

namespace {

// Removes the trials that the selection excludes.
void drop_trials(dataset& d, const selection& who)
{
    if (who.drop_early)
        d.drop_rule = "answers marked early";
    if (who.response_time_s)
        d.drop_rule += fmt::format("{}response times outside {} to {} s", d.drop_rule.empty() ? "" : "; ",
                                   who.response_time_s->first, who.response_time_s->second);
    const auto is_dropped = [&who](const trial& t) {
        return (who.drop_early && t.early == true) ||
               (who.response_time_s &&
                !(t.response_time_s && *t.response_time_s >= who.response_time_s->first &&
                  *t.response_time_s <= who.response_time_s->second));
    };
    for (std::vector<run_data>& runs : d.data)
        for (run_data& run : runs)
            run.dropped = std::erase_if(run.trials, is_dropped);
}

} // namespace

dataset read_dataset(const std::vector<fs::path>& folders, const selection& who)
{
    std::vector<std::string> known;
    std::map<std::string, fs::path> homes;
    for (const fs::path& folder : folders)
        for (const std::string& code : read_codes(folder)) {
            const auto [home, is_new] = homes.emplace(code, folder);
            if (!is_new)
                throw error(
                    error_kind::bad_input, source_place{(folder / "participants.tsv").string()},
                    fmt::format("sub-{} is also in {}", code, (home->second / "participants.tsv").string()),
                    "name each folder once, and give two people different codes");
            known.push_back(code);
        }
    reader r;
    std::vector<excluded_person> excluded;
    for (const std::string& code : select(known, who, excluded))
        r.add(code, homes.at(code));
    dataset d = r.finish();
    d.excluded = std::move(excluded);
    drop_trials(d, who);
    for (std::size_t i = 0; i < d.participants.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (are_similar_codes(d.participants[k], d.participants[i]))
                d.warnings.push_back(
                    fmt::format("sub-{} and sub-{}: {}", d.participants[k], d.participants[i], alike_codes));
    return d;
}

const run_outline& find_run(const dataset& d, std::size_t participant, std::size_t run)
{
    for (const group_outline& g : d.experiment.groups)
        if (g.name == d.groups[participant])
            return g.runs[run];
    return d.experiment.runs[run];
}

dataset select_group(const dataset& d, const group_outline& g)
{
    dataset own{{d.experiment.name, g.runs}, d.simulated};
    for (std::size_t i = 0; i < d.participants.size(); ++i)
        if (d.groups[i] == g.name) {
            own.participants.push_back(d.participants[i]);
            own.data.push_back(d.data[i]);
        }
    return own;
}

} // namespace tactor::study
