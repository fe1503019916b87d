// SPDX-License-Identifier: MIT
// Tables of a session that goes on: checks and repairs.
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "study/bids/disk.hpp"
#include "study/bids/session_store.hpp"
#include "study/data/columns.hpp"
#include "study/data/outline.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {

namespace fs = std::filesystem;

void session_store::check_tables(const std::vector<const run_definition*>& runs) const
{
    folder_.check_lists(code_);
    const run_definition* lost = nullptr;
    for (const run_definition* r : runs) {
        check_description(folder_.path() / description_path(r->outline), r->outline);
        if (!there(table(*r)))
            lost = lost == nullptr ? r : lost;
        else if (lost != nullptr)
            throw error(error_kind::bad_input, table(*lost).string(),
                        fmt::format("it is missing, and the run {} came after it", r->outline.name),
                        "put it back: its trials would be asked once more");
        rows(*r);
        practice_rows(*r);
    }
}

void session_store::refuse_cut_lines(const std::vector<const run_definition*>& runs) const
{
    for (const run_definition* r : runs)
        if (there(table(*r)))
            if (const text_table t = read_trials(table(*r)); t.cut_at())
                t.refuse_cut("complete it, or delete it: the session is finished");
}

std::vector<std::string> session_store::mend(const std::vector<const run_definition*>& runs)
{
    std::vector<std::string> done;
    const auto cut = [&](const fs::path& file) {
        const auto at = read_trials(file).cut_at();
        if (at)
            done.push_back(fmt::format("{}: its last line was cut off: what is left of it is in {}",
                                       file.string(), cut_file(file, *at).string()));
        return at.has_value();
    };
    const bool lost_people = !there(folder_.path() / "participants.tsv");
    const bool lost_scans = !there(folder_.scans(code_));
    bool added = false;
    bool entered = false;
    for (const run_definition* r : runs) {
        if (!there(table(*r)))
            continue;
        if (cut(table(*r)))
            folder_.ignore_cut_lines();
        added = folder_.add_participant(code_) || added;
        if (!acq_time(*r)) {
            folder_.add_scan(code_, scan_name(*r), "n/a");
            entered = true;
        }
    }
    const auto note_lost = [&](bool lost, const fs::path& file, const std::string& what) {
        done.push_back(file.string() +
                       (lost ? ": it is missing: a new one is begun (put the old one back from a copy)"
                             : fmt::format(": {} was missing, and is there again", what)));
    };
    if (added)
        note_lost(lost_people, folder_.path() / "participants.tsv", "sub-" + code_);
    if (entered)
        note_lost(lost_scans, folder_.scans(code_), "a run");
    if (const fs::path practice = source_ / "practice.tsv"; there(practice))
        cut(practice);
    return done;
}

} // namespace tactor::study
