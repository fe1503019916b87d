// SPDX-License-Identifier: MIT
#include "study/bids/session_store.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "study/data/dataset.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;
using ordered = nlohmann::ordered_json;

// What says when and with what a session was held, not what was held.
constexpr std::array<std::string_view, 7> may_differ{
    "date", "versions", "device", "streams", "sound_server", "masker_sound_server", "walk"};

// A card may have another name by now; that there was one, and noise from it, is how the session was held.
bool is_as_begun(const std::string& key, const ordered& began, const ordered& now)
{
    if (key == "masker")
        return began.is_null() == now.is_null();
    return began == now || std::find(may_differ.begin(), may_differ.end(), key) != may_differ.end();
}

// Enough for a trial's line and the tables that it may have to make.
constexpr std::size_t reserved_bytes = std::size_t{64} << 10;

// The first holds these, and each gives up a place for a file's name: a disk or a quota may be out of those,
// too. The first answer of all takes two folders and three tables.
constexpr std::array<const char*, 5> reserved{".reserve", ".reserve-2", ".reserve-3", ".reserve-4",
                                              ".reserve-5"};

std::string session_text(const ordered& j)
{
    return j.dump(2, ' ', false, ordered::error_handler_t::replace) + "\n";
}

// A value, where it is short enough to be shown.
std::string brief(const ordered& j, const std::string& key)
{
    const std::string text = j.contains(key) ? j[key].dump() : "nothing";
    constexpr std::size_t longest = 60;
    return text.size() > longest ? std::string("another") : text;
}

std::string new_table(const named_cells& cells)
{
    std::string header;
    for (const auto& [column, text] : cells)
        header += fmt::format("{}{}", header.empty() ? "" : "\t", column);
    return text_table("", header + "\n").with_line(cells);
}

// A table that somebody changed in the middle of a session, and that cannot be read any more, takes an answer
// nevertheless: in the order of a new one.
std::string text_behind(const fs::path& table, const named_cells& cells)
{
    try {
        const text_table t(table, last_line::may_be_cut);
        return t.missing_end() + t.line(cells);
    } catch (const error&) {
        const std::string text = new_table(cells);
        return text.substr(text.find('\n'));
    }
}

} // namespace

session_store::session_store(study_folder& folder, std::string code, const ordered& facts, bool resume)
    : folder_(folder),
      code_(std::move(code)),
      facts_(facts),
      source_(folder.path() / "sourcedata" / ("sub-" + code_))
{
    settle(resume);
}

session_store::~session_store()
{
    release();
}

void session_store::settle(bool resume)
{
    const fs::path file = source_ / "session.json";
    const fs::path data = folder_.path() / ("sub-" + code_) / "beh";
    for (const fs::path& p : {source_.parent_path(), source_, source_ / "plans", data.parent_path(), data})
        remove_leftovers(p);
    if (!there(file)) {
        if (there(data))
            throw error(error_kind::bad_input, file.string(),
                        fmt::format("it is missing, and sub-{} has data", code_),
                        "put it back, or choose another code");
        if (const std::string other = folder_.alike(code_); !other.empty())
            throw error(error_kind::bad_input, "--participant",
                        fmt::format("{} is here already, and sub-{} is the same name where a disk does not "
                                    "know capitals",
                                    other, code_),
                        "choose another code");
        return;
    }
    if (!resume)
        throw error(error_kind::bad_input, "--participant",
                    fmt::format("there is a session of {} already", code_),
                    "--resume goes on with it; somebody else needs another code");
    const ordered began = ordered::parse(read_file(file), nullptr, false);
    if (!began.is_object())
        throw error(error_kind::bad_input, file.string(), "it is no JSON", "it was changed");
    for (const auto& [key, value] : facts_.items())
        if (!is_as_begun(key, began.value(key, ordered("")), value))
            throw error(error_kind::bad_input, file.string(),
                        fmt::format("the session was begun with {} {}, and now it is {}", key,
                                    brief(began, key), brief(facts_, key)),
                        "a session goes on as it was begun");
    facts_ = began;
    resumed_ = true;
}

void session_store::try_to_write(const std::vector<run_definition>& runs) const
{
    folder_.try_to_write(code_);
    for (const run_definition& r : runs)
        study::try_to_write(table_of(r));
    study::try_to_write(source_ / "session.json");
}

void session_store::begin(const std::vector<const stimulus*>& stimuli)
{
    begun_ = true;
    make_folder(folder_.path() / "sourcedata");
    make_folder(source_);
    make_folder(source_ / "plans");
    reserve();
    for (const stimulus* s : stimuli) {
        const fs::path file = source_ / "plans" / (s->hash + ".json");
        if (!there(file))
            write_whole(file, s->text);
    }
    if (!resumed_)
        write_whole(source_ / "session.json", session_text(facts_));
    folder_.describe();
}

std::vector<fs::path> session_store::missing(const std::vector<const stimulus*>& stimuli) const
{
    std::vector<fs::path> all = folder_.files_of(code_);
    for (const stimulus* s : stimuli)
        all.push_back(source_ / "plans" / (s->hash + ".json"));
    std::erase_if(all, [](const fs::path& p) { return there(p); });
    return all;
}

fs::path session_store::table_of(const run_definition& r) const
{
    return folder_.path() / ("sub-" + code_) / "beh" /
           fmt::format("sub-{}_task-{}_beh.tsv", code_, r.outline.file_name);
}

std::string session_store::scan_name(const run_definition& r) const
{
    return "beh/" + table_of(r).filename().string();
}

std::vector<trial_row> session_store::rows(const run_definition& r) const
{
    const fs::path table = table_of(r);
    if (!there(table))
        return {};
    const text_table t = read_trials(table);
    read_run(t, r.outline); // refuses what the analysis would refuse
    return read_rows(t);
}

std::vector<trial_row> session_store::practice_rows(const run_definition& r) const
{
    const fs::path table = source_ / "practice.tsv";
    if (!there(table))
        return {};
    const text_table t = read_trials(table);
    std::vector<trial_row> all = read_rows(t);
    std::vector<trial_row> own;
    for (std::size_t i = 0; i < t.rows(); ++i)
        if (t.need(i, "run") == r.outline.name)
            own.push_back(std::move(all[i]));
    return own;
}

void session_store::append(const run_definition& r, const trial_row& row, const std::string& acq_time)
{
    const fs::path table = table_of(r);
    keeping([&] {
        if (there(table)) {
            append_text(table, text_behind(table, cells_of(row)));
            return;
        }
        const fs::path own = folder_.path() / ("sub-" + code_);
        make_folder(own);
        make_folder(own / "beh");
        folder_.add_participant(code_);
        folder_.add_scan(code_, scan_name(r), acq_time);
        write_whole(table, new_table(cells_of(row)));
    });
}

void session_store::append_practice(const run_definition& r, const trial_row& row)
{
    const fs::path table = source_ / "practice.tsv";
    named_cells cells = cells_of(row);
    cells.insert(cells.begin(), {"run", r.outline.name});
    keeping([&] {
        if (there(table))
            append_text(table, text_behind(table, cells));
        else
            write_whole(table, new_table(cells));
    });
}

void session_store::make_last_void(const run_definition& r)
{
    const text_table t(table_of(r));
    keeping([&] { write_whole(table_of(r), t.with_cells(t.rows() - 1, {{"void", "true"}})); });
}

std::optional<std::string> session_store::acq_time(const run_definition& r) const
{
    return folder_.scan_time(code_, scan_name(r));
}

void session_store::note(const std::string& key, const ordered& value)
{
    facts_[key] = value;
    write_whole(source_ / "session.json", session_text(facts_));
}

// Room on the disk that is given up for an answer which would be lost otherwise.
void session_store::reserve()
{
    for (const char* name : reserved)
        if (const fs::path file = source_ / name; !there(file))
            write_whole(file, std::string(name == reserved.front() ? reserved_bytes : 0, '\n'));
}

void session_store::release() noexcept
{
    std::error_code ignored;
    for (const char* name : reserved)
        fs::remove(source_ / name, ignored);
}

void session_store::keeping(const std::function<void()>& write)
{
    try {
        write();
    } catch (const error& e) {
        if (!there(source_ / reserved.front()))
            throw;
        release();
        write();
        throw error(error_kind::runtime, e.subject(), e.why(),
                    "the last answer is kept; free some space, and --resume goes on");
    }
}

} // namespace tactor::study
