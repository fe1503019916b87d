// SPDX-License-Identifier: MIT
#include "study/bids/study_folder.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "study/bids/describe.hpp"
#include "study/data/session.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;

// What is hidden does not count: a file manager's, or what a crash left; nor does sourcedata, which is all
// that there is of a session whose begin was broken off.
bool has_other_things(const fs::path& folder)
{
    std::error_code failed;
    for (const fs::directory_entry& e : fs::directory_iterator(folder, failed)) {
        const std::string name = e.path().filename().string();
        if (!name.starts_with('.') && name != "sourcedata")
            return true;
    }
    return false;
}

// Whether it was not there before.
bool made(const fs::path& folder)
{
    if (folder.empty())
        throw error(error_kind::bad_input, "-o", "the folder's name is empty", "name a folder");
    std::error_code ignored;
    const fs::path parent = folder.parent_path();
    if (!parent.empty() && !fs::is_directory(parent, ignored))
        throw error(error_kind::bad_input, folder.string(),
                    fmt::format("the folder \"{}\" does not exist", parent.string()), "make it first");
    if (there(folder) && !fs::is_directory(folder, ignored))
        throw error(error_kind::bad_input, folder.string(), "it is no folder", "name a folder for the study");
    const bool is_new = !there(folder);
    make_folder(folder);
    return is_new;
}

// The lines of a table, without their ends; CR LF is as good.
std::vector<std::string> lines_of(const fs::path& file)
{
    std::vector<std::string> lines;
    const std::string text = read_file(file);
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        lines.push_back(text.substr(at, end - at));
        if (lines.back().ends_with('\r'))
            lines.back().pop_back();
        at = end + 1;
    }
    return lines;
}

std::string joined(const std::vector<std::string>& lines)
{
    std::string text;
    for (const std::string& l : lines)
        text += l + "\n";
    return text;
}

bool is_first_cell(const std::string& line, const std::string& cell)
{
    return line == cell || line.starts_with(cell + "\t");
}

// The table with a line added, or put in the place of the one that begins alike.
std::vector<std::string> with_line(std::vector<std::string> lines, const std::string& first,
                                   const std::string& line)
{
    const auto old = std::find_if(lines.begin(), lines.end(),
                                  [&](const std::string& l) { return is_first_cell(l, first); });
    if (old != lines.end())
        *old = line;
    else
        lines.push_back(line);
    return lines;
}

} // namespace

void check_code(const std::string& code)
{
    if (code.empty() || file_name_of(code) != code)
        throw error(error_kind::bad_input, "--participant", fmt::format("\"{}\" is no code", code),
                    "letters and digits only, as P07");
}

study_folder::study_folder(fs::path folder, const experiment_definition& d, bool simulated)
    : folder_(folder.has_filename() ? std::move(folder) : folder.parent_path()),
      is_new_(made(folder_)),
      lock_(folder_),
      definition_(d),
      simulated_(simulated)
{
    remove_leftovers(folder_);
    if (!there(folder_ / "dataset_description.json") && has_other_things(folder_))
        throw error(error_kind::bad_input, folder_.string(), "there are other things in it",
                    "a study needs a folder of its own");
    refuse_others(d, simulated);
}

study_folder::~study_folder()
{
    std::error_code not_empty;
    if (is_new_)
        fs::remove(folder_, not_empty);
}

void study_folder::refuse_others(const experiment_definition& d, bool simulated)
{
    std::vector<std::string> otherwise;
    std::error_code failed;
    for (const fs::directory_entry& e : fs::directory_iterator(folder_ / "sourcedata", failed)) {
        const fs::path file = e.path() / "session.json";
        if (!there(file))
            continue;
        const session s = read_session(file);
        const std::string who = e.path().filename().string();
        if (s.simulated != simulated)
            throw error(error_kind::bad_input, folder_.string(),
                        fmt::format("{} is {}, and this session is {}", who,
                                    s.simulated ? "simulated" : "real", simulated ? "simulated" : "real"),
                        "simulated and real sessions need a folder each");
        if (s.experiment != d.outline)
            throw error(error_kind::bad_input, folder_.string(),
                        fmt::format("{} had another experiment: \"{}\" with other runs, motions or methods",
                                    who, s.experiment.name),
                        "each experiment needs a folder of its own");
        if (s.text != d.text)
            otherwise.push_back(who);
    }
    if (!otherwise.empty()) {
        std::sort(otherwise.begin(), otherwise.end());
        warnings_.push_back(fmt::format("{} had another text of this definition: levels, gaps, methods and "
                                        "motions may have been others (session.json has them)",
                                        fmt::join(otherwise, ", ")));
    }
    const fs::path description = folder_ / "dataset_description.json";
    if (there(description) && says_simulated(read_file(description)).value_or(simulated) != simulated)
        throw error(error_kind::bad_input, description.string(),
                    fmt::format("it is of {} sessions, and this one is {}", simulated ? "real" : "simulated",
                                simulated ? "simulated" : "real"),
                    "simulated and real sessions need a folder each");
}

void study_folder::try_to_write(const std::string& code) const
{
    for (const run_definition& r : definition_.runs)
        if (const fs::path file = description_of(r); !there(file))
            study::try_to_write(file);
    study::try_to_write(folder_ / "participants.tsv");
    study::try_to_write(scans_of(code));
}

std::string study_folder::alike(const std::string& code) const
{
    const std::string own = "sub-" + code;
    std::error_code failed;
    for (const fs::path& place : {folder_, folder_ / "sourcedata"})
        for (const fs::directory_entry& e : fs::directory_iterator(place, failed))
            if (std::string name = e.path().filename().string();
                name != own && in_small_letters(name) == in_small_letters(own))
                return name;
    return {};
}

std::vector<fs::path> study_folder::files_of(const std::string& code) const
{
    std::vector<fs::path> all;
    for (const char* name : {"dataset_description.json", "README", "participants.json", "participants.tsv"})
        all.push_back(folder_ / name);
    for (const run_definition& r : definition_.runs)
        all.push_back(description_of(r));
    all.push_back(scans_of(code));
    return all;
}

void study_folder::describe() const
{
    const auto put = [](const fs::path& file, const std::string& text) {
        if (!there(file))
            write_whole(file, text);
    };
    // First: by it the folder is known.
    put(folder_ / "dataset_description.json", dataset_text(definition_, simulated_));
    put(folder_ / "README", readme_text(definition_, simulated_));
    put(folder_ / "participants.json", participants_text(simulated_));
    for (const run_definition& r : definition_.runs)
        put(description_of(r), task_text(r, simulated_));
}

fs::path study_folder::description_of(const run_definition& r) const
{
    return folder_ / fmt::format("task-{}_beh.json", r.outline.file_name);
}

fs::path study_folder::scans_of(const std::string& code) const
{
    return folder_ / ("sub-" + code) / fmt::format("sub-{}_scans.tsv", code);
}

void study_folder::add_participant(const std::string& code)
{
    const fs::path file = folder_ / "participants.tsv";
    std::vector<std::string> lines{"participant_id\tage\tsex\thandedness"};
    if (there(file))
        lines = lines_of(file);
    const std::string id = "sub-" + code;
    if (std::any_of(lines.begin(), lines.end(), [&](const std::string& l) { return is_first_cell(l, id); }))
        return;
    // Whoever added a column finds n/a in it.
    std::string line = id;
    for (auto tabs = std::count(lines.front().begin(), lines.front().end(), '\t'); tabs > 0; --tabs)
        line += "\tn/a";
    lines.push_back(line);
    write_whole(file, joined(lines));
}

std::optional<std::string> study_folder::scan_time(const std::string& code,
                                                   const std::string& file_name) const
{
    const fs::path file = scans_of(code);
    if (!there(file))
        return {};
    for (const std::string& l : lines_of(file))
        if (is_first_cell(l, file_name) && l != file_name)
            return l.substr(file_name.size() + 1, l.find('\t', file_name.size() + 1) - file_name.size() - 1);
    return {};
}

void study_folder::add_scan(const std::string& code, const std::string& file_name,
                            const std::string& acq_time)
{
    const fs::path file = scans_of(code);
    std::vector<std::string> lines{"filename\tacq_time"};
    if (there(file))
        lines = lines_of(file);
    write_whole(file, joined(with_line(std::move(lines), file_name, file_name + "\t" + acq_time)));
}

} // namespace tactor::study
