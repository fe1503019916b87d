// SPDX-License-Identifier: MIT
#include "study/bids/session_store.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "study/bids/dataset.hpp"
#include "study/bids/disk.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;
using ordered = nlohmann::ordered_json;

// Facts that may change when a session resumes. All other facts must stay the same.
constexpr std::array<std::string_view, 9> may_differ{"date",    "versions",     "device",
                                                     "streams", "sound_server", "masker_sound_server",
                                                     "walk",    "consent",      "answers"};

// Returns true if a resumed session may have the value `now` of a fact. The card for the masking noise may
// have another name, but a session that began with noise from a card must continue with such noise.
bool is_compatible_fact(const std::string& key, const ordered& began, const ordered& now)
{
    if (key == "masker")
        return began.is_null() == now.is_null();
    return began == now || std::find(may_differ.begin(), may_differ.end(), key) != may_differ.end();
}

// Room for the line of a trial and the tables that have to be created for it.
constexpr std::size_t reserved_bytes = std::size_t{64} << 10;

// Files that reserve room on the disk; the first has reserved_bytes. Each file also reserves an inode,
// because a disk or a quota may run out of inodes, too. The first answer needs six inodes: for three folders,
// if there are several sessions, and for three tables.
constexpr std::array<const char*, 6> reserved{".reserve",   ".reserve-2", ".reserve-3",
                                              ".reserve-4", ".reserve-5", ".reserve-6"};

// Describes how a fact changed. Shows the old and the new value if both are short.
std::string describe_change(const std::string& key, const ordered& began, const ordered& now)
{
    const std::string before = began.contains(key) ? began[key].dump() : "none";
    const std::string after = now.contains(key) ? now[key].dump() : "none";
    constexpr std::size_t longest = 60;
    if (std::max(before.size(), after.size()) > longest)
        return fmt::format("\"{}\" has changed since the session began", key);
    return fmt::format("the session began with {} {}, but now it is {}", key, before, after);
}

std::pair<std::uintmax_t, fs::file_time_type> read_file_state(const fs::path& file)
{
    std::error_code ignored;
    return {fs::file_size(file, ignored), fs::last_write_time(file, ignored)};
}

// Returns the name of a questionnaire in session.json.
std::string questionnaire_key(const questionnaire& q, const std::string& after)
{
    return after.empty() ? q.name : fmt::format("{} after {}", q.name, after);
}

// Reads the columns of an existing table. Returns text_table::missing_end(), or nothing if the table cannot
// be read.
std::optional<std::string> read_columns(text_table& t)
{
    try {
        t = text_table(t.file(), last_line::may_be_cut);
        return t.missing_end();
    } catch (const error&) {
        return {};
    }
}

} // namespace

session_store::session_store(study_folder& folder, runs_in_order runs, const ordered& facts, start_kind start)
    : folder_(folder),
      runs_(std::move(runs)),
      facts_(facts),
      source_(folder.path() / source_path(folder.code(), folder.session()))
{
    const fs::path file = source_ / "session.json";
    const fs::path data = folder_.path() / session_path(folder_.code(), folder_.session()) / "beh";
    for (const fs::path& p : {source_.parent_path(), source_, source_ / "plans", data.parent_path(), data})
        remove_leftovers(p);
    if (!is_on_disk(file)) {
        if (is_on_disk(data))
            throw error(error_kind::bad_input, file.string(),
                        fmt::format("it is missing, and {} has data",
                                    session_name(folder_.code(), folder_.session())),
                        "restore the file, or choose another code");
        if (start == start_kind::resume)
            throw error(error_kind::bad_input, "--resume",
                        fmt::format("there is no {} in {}", session_name(folder_.code(), folder_.session()),
                                    folder_.path().string()),
                        "correct --participant, or add --new to begin a new session");
        return;
    }
    if (start == start_kind::begin)
        throw error(
            error_kind::bad_input, "--participant",
            fmt::format("there is already {} of {}",
                        folder_.session() ? fmt::format("session {}", *folder_.session()) : "a session",
                        folder_.code()),
            "use --resume to continue it, or another code for another person");
    const ordered began = ordered::parse(read_file(file), nullptr, false);
    if (!began.is_object())
        throw error(error_kind::bad_input, file.string(), "it is not JSON", "restore the original file");
    ordered both = facts_; // has the keys of `facts_` and `began`
    both.update(began);
    for (const auto& [key, value] : both.items())
        if (!is_compatible_fact(key, began.value(key, ordered("")), facts_.value(key, ordered(""))))
            throw error(error_kind::bad_input, file.string(), describe_change(key, began, facts_),
                        "continue with the same definition, array and options");
    facts_ = began;
    resumed_ = true;
}

session_store::~session_store()
{
    release();
}

void session_store::check_writable(const std::vector<stimulus>& stimuli) const
{
    const detail::owned_fd alone = folder_.lock(); // all sessions use the same temporary file names
    std::vector<fs::path> files = folder_.list_files();
    std::erase_if(files, [](const fs::path& p) { return is_on_disk(p) && p.extension() != ".tsv"; });
    for (const run_definition* r : runs_)
        files.push_back(facts_.contains("codes") ? event_table(*r) : table(*r)); // the longer of both names
    for (const fs::path& file : files)
        study::check_writable(file);
    std::size_t room = 2 * reserved_bytes; // half for reserve(), half for tables, lists and descriptions
    for (const stimulus& s : stimuli)
        room += s.text.size();
    study::check_writable(source_ / "session.json", resumed_ ? 0 : room);
}

void session_store::begin(const std::vector<stimulus>& stimuli, const ordered& events)
{
    const detail::owned_fd alone = folder_.lock();
    if (!resumed_)
        folder_.check_other_sessions(); // other sessions may have begun since this session was prepared
    begun_ = true;
    try {
        make_folders(folder_.path(), source_path(folder_.code(), folder_.session()) / "plans");
        reserve();
        for (const stimulus& s : stimuli) {
            const fs::path file = source_ / "plans" / (s.hash + ".json");
            if (!is_on_disk(file))
                write_whole_file(file, s.text);
        }
        if (!resumed_)
            write_facts();
    } catch (const error& e) {
        if (resumed_)
            throw;
        begun_ = false;
        undo_begin(stimuli);
        throw error(e.kind(), e.subject(), e.why(),
                    "free some space, or name a folder on another disk; the session has not begun");
    }
    folder_.write_descriptions();
    for (const run_definition* r : runs_) {
        const fs::path file = folder_.path() / events_description_path(*r);
        if (!events.is_null() && !is_on_disk(file))
            write_whole_file(file, json_text(events));
    }
}

fs::path session_store::table(const run_definition& r) const
{
    return folder_.path() / table_path(folder_.code(), folder_.session(), r.outline);
}

fs::path session_store::event_table(const run_definition& r) const
{
    const fs::path file = table(r);
    const std::string name = file.filename().string();
    return file.parent_path() / (name.substr(0, name.rfind('_')) + "_events.tsv");
}

std::string session_store::scan_name(const run_definition& r) const
{
    return "beh/" + table(r).filename().string();
}

std::vector<trial_row> session_store::rows(const run_definition& r) const
{
    if (!is_on_disk(table(r)))
        return {};
    const text_table t = read_trials(table(r));
    read_run(t, r.outline); // throws the errors that the analysis would throw
    return read_rows(t, r.outline);
}

std::vector<trial_row> session_store::practice_rows(const run_definition& r) const
{
    std::vector<trial_row> own;
    const fs::path practice = source_ / "practice.tsv";
    if (!is_on_disk(practice))
        return own;
    const text_table t = read_trials(practice);
    std::vector<trial_row> all = read_rows(t, r.outline);
    for (std::size_t i = 0; i < t.rows(); ++i)
        if (t.need(i, "run") == r.outline.name)
            own.push_back(std::move(all[i]));
    return own;
}

// Calls `write`. If `write` fails, frees the reserved room and calls `write` once more. Then throws error
// (runtime) nevertheless, so that the session ends.
template <class Write>
void session_store::keep(const Write& write)
{
    try {
        write();
    } catch (const error& e) {
        if (!is_on_disk(source_ / reserved.front()))
            throw;
        release();
        write();
        throw error(error_kind::runtime, e.subject(), e.why(),
                    "earlier answers are kept; free some space, and continue with --resume");
    }
}

void session_store::append(const run_definition& r, const trial_row& row, const std::string& acq_time)
{
    const fs::path file = table(r);
    keep([&] {
        if (!is_on_disk(file)) {
            make_folders(folder_.path(), session_path(folder_.code(), folder_.session()) / "beh");
            folder_.add_participant();
            folder_.add_scan(scan_name(r), acq_time);
        }
        write_line(file, make_cells(row, {&r.outline}));
    });
}

void session_store::append_practice(const run_definition& r, const trial_row& row)
{
    std::vector<const run_outline*> all; // all runs share the table of practice trials
    for (const run_definition* one : runs_)
        all.push_back(&one->outline);
    named_cells cells = make_cells(row, all);
    cells.insert(cells.begin(), {"run", r.outline.name});
    keep([&] { write_line(source_ / "practice.tsv", cells); });
}

void session_store::append_event(const run_definition& r, const named_cells& cells)
{
    keep([&] { write_line(event_table(r), cells); });
}

// Returns the answers so far to a questionnaire that is not complete.
std::vector<std::string> session_store::partial_answers(const std::string& form) const
{
    std::vector<std::string> all;
    if (facts_.contains("answers") && facts_["answers"].is_object() && facts_["answers"].contains(form))
        for (const ordered& one : facts_["answers"][form])
            if (one.is_string())
                all.push_back(one.get<std::string>());
    return all;
}

std::size_t session_store::count_answers(const questionnaire& q, const std::string& after) const
{
    if (folder_.has_answers(q, after))
        return q.items.size();
    return std::min(partial_answers(questionnaire_key(q, after)).size(), q.items.size() - 1);
}

void session_store::keep_answer(const questionnaire& q, const std::string& after, std::size_t item,
                                const std::string& answer)
{
    const std::string form = questionnaire_key(q, after);
    keep([&] {
        if (folder_.has_answers(q, after))
            return folder_.change_answer(q, after, item, answer);
        std::vector<std::string> all = partial_answers(form);
        all.resize(item);
        all.push_back(answer);
        if (all.size() == q.items.size()) {
            folder_.add_answers(q, after, all);
            facts_.erase("answers"); // one questionnaire is asked at a time
        } else {
            facts_["answers"] = {{form, all}};
        }
        write_facts();
    });
}

// Appends a line to a table, or creates the table with this line. First reads an existing table, unless this
// process was the last to write to it.
void session_store::write_line(const fs::path& file, const named_cells& cells)
{
    const auto was = written_.find(file);
    const bool known = was != written_.end() && was->second.state == read_file_state(file);
    if (!known)
        written_.insert_or_assign(file, written_table{text_table(file, header_line(cells)), {}});
    written_table& own = written_.at(file);
    std::optional<std::string> end = "";
    if (is_on_disk(file)) {
        if (!known)
            end = read_columns(own.columns);
        // If the table cannot be read, appends the answer nevertheless, with the columns of a new table.
        append_text(file, end.value_or("\n") + own.columns.line(cells));
    } else {
        write_whole_file(file, own.columns.text_with_line(cells));
    }
    if (end)
        own.state = read_file_state(file);
    else
        written_.erase(file);
}

void session_store::void_last_trial(const run_definition& r)
{
    const text_table t(table(r));
    keep([&] { write_whole_file(table(r), t.text_with_cells(t.rows() - 1, {{"void", "true"}})); });
}

std::optional<std::string> session_store::acq_time(const run_definition& r) const
{
    return folder_.scan_time(scan_name(r));
}

void session_store::set_fact(const std::string& key, const ordered& value)
{
    facts_[key] = value;
    write_facts();
}

// Removes the files and empty folders of a session that could not begin.
void session_store::undo_begin(const std::vector<stimulus>& stimuli) noexcept
{
    release();
    std::error_code ignored;
    for (const stimulus& s : stimuli)
        fs::remove(source_ / "plans" / (s.hash + ".json"), ignored);
    fs::remove(source_ / "plans", ignored);
    fs::path folder = source_;
    for ([[maybe_unused]] const fs::path& part : source_path(folder_.code(), folder_.session())) {
        fs::remove(folder, ignored);
        folder = folder.parent_path();
    }
}

void session_store::write_facts() const
{
    write_whole_file(source_ / "session.json", json_text(facts_));
}

// Reserves room on the disk. keep() frees this room if an answer would otherwise be lost.
void session_store::reserve()
{
    for (const char* name : reserved)
        if (const fs::path file = source_ / name; !is_on_disk(file))
            write_whole_file(file, std::string(name == reserved.front() ? reserved_bytes : 0, '\n'));
}

void session_store::release() noexcept
{
    std::error_code ignored;
    for (const char* name : reserved)
        fs::remove(source_ / name, ignored);
}

void session_store::check_tables() const
{
    folder_.check_lists();
    const run_definition* lost = nullptr;
    for (const run_definition* r : runs_) {
        if (!is_on_disk(table(*r)))
            lost = lost == nullptr ? r : lost;
        else if (lost != nullptr)
            throw error(error_kind::bad_input, table(*lost).string(),
                        fmt::format("it is missing, but the later run \"{}\" has data", r->outline.name),
                        "restore the file: otherwise its trials come again");
        rows(*r);
        practice_rows(*r);
    }
}

void session_store::refuse_cut_lines() const
{
    for (const run_definition* r : runs_)
        if (is_on_disk(table(*r)))
            if (const text_table t = read_trials(table(*r)); t.cut_position())
                t.refuse_cut("complete it, or delete it: the session is finished");
}

std::vector<std::string> session_store::repair_tables()
{
    std::vector<std::string> done;
    const auto cut = [&](const fs::path& file, const text_table& t) {
        const auto at = t.cut_position();
        if (at)
            done.push_back(fmt::format("{}: its last line was incomplete and was moved to {}", file.string(),
                                       split_file(file, *at).string()));
        return at.has_value();
    };
    const bool lost_people = !is_on_disk(folder_.path() / "participants.tsv");
    const bool lost_scans = !is_on_disk(folder_.scans_path());
    bool added = false;
    bool entered = false;
    for (const run_definition* r : runs_) {
        if (!is_on_disk(table(*r)))
            continue;
        if (cut(table(*r), read_trials(table(*r))))
            folder_.ignore_cut_lines();
        if (const fs::path file = event_table(*r); is_on_disk(file)) {
            text_table t(file, last_line::may_be_cut);
            if (t.is_open())
                t.drop_last_row();
            if (cut(file, t))
                folder_.ignore_cut_lines();
        }
        added = folder_.add_participant() || added;
        if (!acq_time(*r)) {
            folder_.add_scan(scan_name(*r), "n/a");
            entered = true;
        }
    }
    const auto note_lost = [&](bool lost, const fs::path& file, const std::string& what) {
        done.push_back(file.string() +
                       (lost ? ": it is missing, so a new one begins (restore the old one from a copy)"
                             : fmt::format(": {} was missing and was added again", what)));
    };
    if (added)
        note_lost(lost_people, folder_.path() / "participants.tsv", "sub-" + folder_.code());
    if (entered)
        note_lost(lost_scans, folder_.scans_path(), "a run");
    if (const fs::path practice = source_ / "practice.tsv"; is_on_disk(practice))
        cut(practice, read_trials(practice));
    return done;
}

} // namespace tactor::study
