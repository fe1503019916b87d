// SPDX-License-Identifier: MIT
#include "study/bids/study_folder.hpp"

#include <algorithm>
#include <ctime>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <tactor/error.hpp>
#include <tactor/version.hpp>

#include "core/split.hpp"
#include "core/words.hpp"
#include "study/bids/dataset.hpp"
#include "study/data/text_table.hpp"
#include "study/tasks/task.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_code = 240; // a file name has at most 255 bytes, and other parts

// Returns true if a folder contains other files. Ignores hidden files, which a file manager or a crash may
// leave, and sourcedata, which may remain of a session that failed to begin.
bool has_other_files(const fs::path& folder)
{
    std::error_code failed;
    for (const fs::directory_entry& e : fs::directory_iterator(folder, failed)) {
        const std::string name = e.path().filename().string();
        if (!name.starts_with('.') && name != "sourcedata")
            return true;
    }
    return false;
}

// Makes the folder. Returns its name, or nothing if the folder exists already.
fs::path make_study_folder(const fs::path& folder)
{
    if (folder.empty())
        throw error(error_kind::bad_input, "-o", "the folder's name is empty", "name a folder");
    std::error_code ignored;
    const fs::path parent = folder.parent_path();
    if (!parent.empty() && !fs::is_directory(parent, ignored))
        throw error(error_kind::bad_input, folder.string(),
                    fmt::format("the folder \"{}\" does not exist", parent.string()), "create it first");
    if (is_on_disk(folder) && !fs::is_directory(folder, ignored))
        throw error(error_kind::bad_input, folder.string(), "it is not a folder",
                    "name a folder for the study");
    const bool is_new = !is_on_disk(folder);
    make_folder(folder);
    return is_new ? folder : fs::path();
}

// Returns the header of a new participants.tsv.
const char* participants_header(const experiment_definition& d)
{
    return d.group.empty() ? "participant_id\tage\tsex\thandedness\n"
                           : "participant_id\tage\tsex\thandedness\tgroup\n";
}

constexpr const char* new_scans = "filename\tacq_time\n";

text_table read_or_make_table(const fs::path& file, const char* header)
{
    return is_on_disk(file) ? text_table(file) : text_table(file, std::string(header));
}

// Returns the index of the row with these cells, if any.
std::optional<std::size_t> find_row(const text_table& t, const named_cells& cells)
{
    for (std::size_t row = 0; row < t.rows(); ++row)
        if (std::ranges::all_of(cells, [&](const auto& c) { return t.cell(row, c.first) == c.second; }))
            return row;
    return {};
}

using ordered = nlohmann::ordered_json;

constexpr const char* simulated_note = "SIMULATED: no person answered. The answers come from a model; they "
                                       "test the software and say nothing about people.";

// Texts in dataset_description.json that name the program that wrote the data set.
constexpr std::string_view held_by = "tactor experiment";
constexpr std::string_view simulated_by = "tactor experiment --simulate";

ordered column_json(std::string_view description, std::string_view units = {})
{
    ordered j{{"Description", description}};
    if (!units.empty())
        j["Units"] = units;
    return j;
}

std::string readme_text(const experiment_definition& d, bool simulated)
{
    return fmt::format(
        "{}\n"
        "\n"
        "{}This folder was written by tactor experiment (definition: {}). Vibrations moved over the skin, "
        "and after\n"
        "each trial the participant answered a question. Each run is one task, and sub-CODE/{}beh has a line "
        "for each\n"
        "trial. task-NAME_beh.json explains the columns. The definition, the array, the levels and each\n"
        "stimulus, named by the SHA-256 of its plan, are in sourcedata. Trials whose column void is true "
        "did\n"
        "not play, or were not answered, as planned; they do not count, and come again.\n"
        "tactor analyze prints the statistics.\n",
        d.title, simulated ? std::string(simulated_note) + "\n\n" : std::string(), d.outline.name,
        d.session ? "ses-N/" : "");
}

std::string participants_text(const experiment_definition& d, bool simulated)
{
    ordered j;
    j["participant_id"] =
        column_json(simulated ? simulated_note : "Code, which does not identify the person");
    j["age"] = column_json("Age", "years");
    j["sex"] = column_json("Sex, as the participant stated it");
    j["sex"]["Levels"] = {{"F", "female"}, {"M", "male"}, {"O", "other"}};
    j["handedness"] = column_json("Hand that the participant prefers");
    j["handedness"]["Levels"] = {{"R", "right"}, {"L", "left"}, {"A", "both"}};
    for (const group_outline& g : d.outline.groups) {
        j["group"]["Description"] = "Group, with its runs, and their motions and methods";
        j["group"]["Levels"][g.name] = describe_group(g);
    }
    return json_text(j);
}

std::string task_text(const run_definition& r, const experiment_definition& d, bool simulated)
{
    ordered j{{"TaskName", r.outline.name}};
    const task::facts& task = find_run_task(r.outline).properties();
    j["TaskDescription"] = (simulated ? std::string(simulated_note) + " " : "") + std::string(task.trial);
    j["Instructions"] = r.outline.question;
    if (!r.outline.labels.empty())
        j["Labels"] = r.outline.labels;
    const named_cells columns = make_cells({.group = d.group, .session = d.session}, {&r.outline});
    for (const trial_column& c : trial_columns)
        if (std::ranges::count(columns, c.name, &named_cells::value_type::first) != 0)
            j[std::string(c.name)] = column_json(c.meaning, c.unit);
    j["response"] = column_json(fmt::format(fmt::runtime(task.response), rating_range(r.outline)));
    if (!r.choices.empty())
        j["response"]["Levels"] = {{"1", r.choices[0]}, {"2", r.choices[1]}};
    j["early"]["Levels"] = {{"true", fmt::format("sooner than {} s", r.min_response_s)}, {"false", "later"}};
    if (d.session)
        j["plan_1"]["Description"] = "SHA-256 of the first stimulus' plan: sourcedata/sub-CODE/ses-N/plans";
    j["void"]["Levels"] = {{"true", "does not count"}, {"false", "counts"}};
    return json_text(j);
}

// Returns the cells that identify a line of a questionnaire: participant, session and preceding run.
named_cells find_key(const questionnaire& q, const std::string& code, session_number session,
                     const std::string& after)
{
    named_cells key{{"participant_id", "sub-" + code}};
    if (session)
        key.emplace_back("session", fmt::format("{}", *session));
    if (q.when == questionnaire_time::between)
        key.emplace_back("after", after);
    return key;
}

// Returns a text for one cell: replaces each line end by a backslash and the letter n.
std::string on_one_line(const std::string& answer)
{
    std::string line;
    for (const char c : answer)
        line += c == '\n' ? std::string("\\n") : std::string(1, c);
    return line.empty() ? "n/a" : line;
}

// Returns the cells of a line. If there are no answers, the cells are only for the header of a new table.
named_cells make_cells(const questionnaire& q, const std::string& code, session_number session,
                       const std::string& after, const std::vector<std::string>& answers)
{
    named_cells cells = find_key(q, code, session, after);
    for (std::size_t i = 0; i < q.items.size(); ++i)
        cells.emplace_back(q.items[i].name, answers.empty() ? "" : on_one_line(answers[i]));
    return cells;
}

text_table read_answers(const fs::path& folder, const questionnaire& q, session_number session)
{
    return read_or_make_table(folder / answers_path(q),
                              header_line(make_cells(q, {}, session, {}, {})).c_str());
}

std::string questionnaire_text(const questionnaire& q, session_number session, bool simulated)
{
    ordered j;
    j["MeasurementToolMetadata"]["Description"] = fmt::format(
        "{}{}, asked {}{}{}", simulated ? std::string(simulated_note) + " " : "",
        q.title.empty() ? q.name : q.title, describe_time(q.when), q.text.empty() ? "" : ". ", q.text);
    j["participant_id"] = column_json("As in participants.tsv");
    if (session)
        j["session"] = column_json("Session of the participant, from 1");
    if (q.when == questionnaire_time::between)
        j["after"] = column_json("Run before it");
    for (const questionnaire_item& item : q.items) {
        j[item.name] = column_json(item.question);
        const std::vector<std::string> labels = list_answer_labels(item);
        for (std::size_t i = 0; i < labels.size(); ++i)
            if (!labels[i].empty())
                j[item.name]["Levels"][fmt::format("{}", i + item.lowest)] = labels[i];
    }
    return json_text(j);
}

constexpr std::int64_t second_ns = 1000000000;
constexpr std::int64_t microsecond_ns = 1000;
constexpr std::size_t fraction_from = 20; // start of the fraction in 2026-11-21T14:03:00.000000Z
constexpr std::size_t fraction_digits = 6;

} // namespace

void check_code(const std::string& code)
{
    if (code.empty() || make_file_name(code) != code)
        throw error(error_kind::bad_input, "--participant", fmt::format("\"{}\" is not a code", code),
                    "use only letters and digits, such as P07");
    if (code.size() > longest_code)
        throw error(error_kind::bad_input, "--participant",
                    fmt::format("a code of {} characters is too long", code.size()),
                    "use a shorter participant code");
}

study_folder::study_folder(fs::path folder, const experiment_definition& d, std::string code, bool simulated)
    : folder_(folder.has_filename() ? std::move(folder) : folder.parent_path()),
      made_{make_study_folder(folder_)},
      definition_(d),
      code_(std::move(code)),
      simulated_(simulated)
{
    const detail::owned_fd alone = lock();
    remove_leftovers(folder_);
    if (!is_on_disk(folder_ / "dataset_description.json") && has_other_files(folder_))
        throw error(error_kind::bad_input, folder_.string(), "it contains other files",
                    "give the study its own folder");
    own_.emplace(folder_ / fmt::format(".sub-{}.lock", to_lower_case(code_)),
                 error(error_kind::bad_input, folder_.string(),
                       fmt::format("another session of {} is running in this folder", code_),
                       "end that session first, or use another code"));
}

made_folder::~made_folder()
{
    std::error_code not_empty;
    if (!path.empty())
        fs::remove(path, not_empty);
}

std::vector<std::string> study_folder::check_other_sessions() const
{
    std::vector<std::string> warnings;
    const auto kind = [](bool simulated) { return simulated ? "simulated" : "real"; };
    constexpr const char* one_kind = "keep simulated and real sessions in different folders";
    std::vector<std::string> otherwise;
    std::vector<std::pair<std::string, session_number>> all; // codes and sessions
    std::error_code failed;
    for (const fs::directory_entry& e : fs::directory_iterator(folder_ / "sourcedata", failed))
        if (const std::string name = e.path().filename().string(); name.starts_with("sub-"))
            for (const session_number n : list_sessions(folder_, name.substr(4)))
                all.emplace_back(name.substr(4), n);
    for (const auto& [code, session] : all) {
        const fs::path file = folder_ / source_path(code, session) / "session.json";
        if (!is_on_disk(file))
            continue;
        if (code != code_ && to_lower_case(code) == to_lower_case(code_))
            throw error(
                error_kind::bad_input, "--participant",
                fmt::format("sub-{} exists, and sub-{} is the same name on a disk that ignores capitals",
                            code, code_),
                "choose another code");
        const std::string who = session_name(code, session);
        const session_data s = read_session(file);
        if (s.simulated != simulated_)
            throw error(
                error_kind::bad_input, folder_.string(),
                fmt::format("{} is {}, but this session is {}", who, kind(s.simulated), kind(simulated_)),
                one_kind);
        if (const experiment_difference d = find_difference(s.experiment, definition_.outline))
            throw error(error_kind::bad_input, folder_.string(),
                        fmt::format("{} was run with a different experiment: {}the {} changed{}", who,
                                    d.place, d.what,
                                    d.before.empty() ? "" : fmt::format(" from {} to {}", d.before, d.now)),
                        "give each experiment its own folder");
        if (code == code_ && session != definition_.session && s.group != definition_.group)
            throw error(error_kind::bad_input, "--group",
                        fmt::format("{} was in group \"{}\", but this session is in group \"{}\"", who,
                                    s.group, definition_.group),
                        "keep a participant in one group");
        if (s.text != definition_.text)
            otherwise.push_back(who);
    }
    std::set<std::string> alike;
    for (const auto& [code, session] : all)
        if (code != code_ && are_similar_codes(code, code_) && alike.insert(code).second)
            warnings.push_back(fmt::format("sub-{} and sub-{}: {}", code, code_, alike_codes));
    for (unsigned n = 1; n < definition_.session.value_or(1); ++n)
        if (std::ranges::count(all, std::pair(code_, session_number(n))) == 0)
            warnings.push_back(fmt::format("the folder has no {}", session_name(code_, n)));
    if (!otherwise.empty()) {
        std::sort(otherwise.begin(), otherwise.end());
        warnings.push_back(fmt::format("{} used a different text of this definition: levels, gaps, methods "
                                       "and motions may differ (session.json has them)",
                                       fmt::join(otherwise, ", ")));
    }
    const fs::path description = folder_ / "dataset_description.json";
    if (is_on_disk(description) && parse_simulated_flag(read_file(description)) == !simulated_)
        throw error(error_kind::bad_input, description.string(),
                    fmt::format("the study has {} sessions, but this session is {}", kind(!simulated_),
                                kind(simulated_)),
                    one_kind);
    return warnings;
}

std::vector<fs::path> study_folder::list_files() const
{
    std::vector<fs::path> all;
    for (const run_definition& r : definition_.runs)
        all.push_back(folder_ / description_path(r.outline));
    for (const questionnaire& q : definition_.outline.questionnaires)
        for (const char* extension : {".json", ".tsv"})
            all.push_back(folder_ / answers_path(q, extension));
    for (const char* name : {"dataset_description.json", "README", "participants.json", "participants.tsv"})
        all.push_back(folder_ / name);
    all.push_back(scans_path());
    return all;
}

void study_folder::write_descriptions() const
{
    const auto put = [](const fs::path& file, const std::string& text) {
        if (!is_on_disk(file))
            write_whole_file(file, text);
    };
    // Written first, because this file marks the folder as the folder of a study.
    put(folder_ / "dataset_description.json", dataset_text(definition_, simulated_));
    put(folder_ / "README", readme_text(definition_, simulated_));
    put(folder_ / "participants.json", participants_text(definition_, simulated_));
    for (const run_definition& r : definition_.runs)
        put(folder_ / description_path(r.outline), task_text(r, definition_, simulated_));
    if (!definition_.outline.questionnaires.empty()) {
        make_folder(folder_ / "phenotype");
        // bids-validator 1 expects exactly one line for each participant. But a questionnaire between runs
        // has several lines, and a session that was broken off may have none.
        ignore("phenotype/*.tsv");
    }
    for (const questionnaire& q : definition_.outline.questionnaires)
        put(folder_ / answers_path(q, ".json"), questionnaire_text(q, session(), simulated_));
}

std::string events_description_path(const run_definition& r)
{
    return fmt::format("task-{}_events.json", r.outline.file_name);
}

bool study_folder::has_codes() const
{
    return std::ranges::any_of(definition_.runs, [this](const run_definition& r) {
        return is_on_disk(folder_ / events_description_path(r));
    });
}

fs::path study_folder::scans_path() const
{
    return folder_ / session_path(code_, session()) / (session_name(code_, session()) + "_scans.tsv");
}

void study_folder::check_lists() const
{
    const text_table people =
        read_or_make_table(folder_ / "participants.tsv", participants_header(definition_));
    read_participants(people);
    const std::string& group = definition_.group;
    if (const auto row = find_row(people, {{"participant_id", "sub-" + code_}});
        row && !group.empty() && people.has("group"))
        if (const auto listed = people.cell(*row, "group"); listed && *listed != group)
            people.refuse(*row,
                          fmt::format("sub-{} is listed in group \"{}\", but this session is in group \"{}\"",
                                      code_, *listed, group),
                          "use --group with the group in the list, or correct the list");
    const text_table t = read_or_make_table(scans_path(), new_scans);
    t.need_column("filename");
    t.need_column("acq_time");
    for (const questionnaire& q : definition_.outline.questionnaires) {
        const text_table answers = read_answers(folder_, q, session());
        for (const auto& [column, text] : make_cells(q, code_, session(), {}, {}))
            if (!answers.has(column))
                throw error(error_kind::bad_input, source_place{answers.file(), 1},
                            fmt::format("the column {} of the questionnaire is missing", column),
                            "give a changed questionnaire another name");
    }
}

bool study_folder::has_answers(const questionnaire& q, const std::string& after) const
{
    return find_row(read_answers(folder_, q, session()), find_key(q, code_, session(), after)).has_value();
}

void study_folder::change_answer(const questionnaire& q, const std::string& after, std::size_t item,
                                 const std::string& answer) const
{
    const detail::owned_fd alone = lock();
    const text_table t = read_answers(folder_, q, session());
    if (const auto row = find_row(t, find_key(q, code_, session(), after)))
        write_whole_file(folder_ / answers_path(q),
                         t.text_with_cells(*row, {{q.items[item].name, on_one_line(answer)}}));
}

void study_folder::add_answers(const questionnaire& q, const std::string& after,
                               const std::vector<std::string>& answers) const
{
    const detail::owned_fd alone = lock();
    write_whole_file(
        folder_ / answers_path(q),
        read_answers(folder_, q, session()).text_with_line(make_cells(q, code_, session(), after, answers)));
}

bool study_folder::add_participant()
{
    const detail::owned_fd alone = lock();
    const fs::path file = folder_ / "participants.tsv";
    const text_table t = read_or_make_table(file, participants_header(definition_));
    const std::string id = "sub-" + code_;
    if (find_row(t, {{"participant_id", id}}))
        return false;
    const std::string& group = definition_.group;
    write_whole_file(file,
                     t.text_with_line({{"participant_id", id}, {"group", group.empty() ? "n/a" : group}}));
    return true;
}

std::optional<std::string> study_folder::scan_time(const std::string& file_name) const
{
    const text_table t = read_or_make_table(scans_path(), new_scans);
    const auto row = find_row(t, {{"filename", file_name}});
    if (!row)
        return {};
    return std::string(t.cell(*row, "acq_time").value_or("n/a"));
}

void study_folder::add_scan(const std::string& file_name, const std::string& acq_time)
{
    const fs::path file = scans_path();
    const text_table t = read_or_make_table(file, new_scans);
    const named_cells cells{{"filename", file_name}, {"acq_time", acq_time}};
    const auto row = find_row(t, {{"filename", file_name}});
    write_whole_file(file, row ? t.text_with_cells(*row, cells) : t.text_with_line(cells));
}

void study_folder::ignore_cut_lines() const
{
    const detail::owned_fd alone = lock();
    ignore("*.cut-*");
}

// Adds a line to .bidsignore.
void study_folder::ignore(const std::string& pattern) const
{
    const fs::path file = folder_ / ".bidsignore";
    std::string text = is_on_disk(file) ? read_file(file) : std::string();
    if (("\n" + text).find("\n" + pattern) != text.npos)
        return;
    text += text.empty() || text.ends_with('\n') ? "" : "\n";
    write_whole_file(file, text + pattern + "\n");
}

std::string dataset_text(const experiment_definition& d, bool simulated)
{
    ordered j{{"Name", d.title + (simulated ? " (simulated)" : "")},
              {"BIDSVersion", "1.8.0"},
              {"DatasetType", "raw"}};
    j["Authors"] = d.authors;
    j["GeneratedBy"] = {{{"Name", "tactor"},
                         {"Version", std::string(version())},
                         {"Description", simulated ? fmt::format("{}. {}", simulated_by, simulated_note)
                                                   : std::string(held_by)}}};
    return json_text(j);
}

std::optional<bool> parse_simulated_flag(const std::string& dataset_description)
{
    const ordered j = ordered::parse(dataset_description, nullptr, false);
    if (!j.is_object() || !j.contains("GeneratedBy") || !j["GeneratedBy"].is_array())
        return {};
    for (const ordered& by : j["GeneratedBy"]) {
        const std::string text = by.is_object() && by.contains("Description") && by["Description"].is_string()
                                     ? by["Description"].get<std::string>()
                                     : std::string();
        if (text.starts_with(simulated_by))
            return true;
        if (text.starts_with(held_by))
            return false;
    }
    return {};
}

std::string acq_time_text(std::int64_t utc_ns)
{
    return fmt::format("{:%FT%T}.{:06}Z", fmt::gmtime(utc_ns / second_ns),
                       utc_ns % second_ns / microsecond_ns);
}

std::optional<std::int64_t> parse_acq_time(const std::string& text)
{
    std::tm utc{};
    if (::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S.", &utc) != text.c_str() + fraction_from)
        return {};
    const std::string_view fraction = std::string_view(text).substr(fraction_from);
    const auto microseconds = detail::parse_number_text<std::uint32_t>(fraction.substr(0, fraction_digits));
    if (!microseconds || fraction.size() != fraction_digits + (text.ends_with('Z') ? 1 : 0))
        return {};
    return ::timegm(&utc) * second_ns + *microseconds * microsecond_ns;
}

} // namespace tactor::study
