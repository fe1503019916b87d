// SPDX-License-Identifier: MIT
#include "study/report/facts.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <tactor/alsa.hpp>
#include <tactor/error.hpp>

#include "core/sha256.hpp"
#include "study/data/text_table.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;

constexpr int most_channel = int{max_pcm_channels} - 1;

[[noreturn]] void refuse_changed(const std::string& what, const std::string& written, const std::string& is)
{
    throw error(error_kind::bad_input, what, fmt::format("its SHA-256 is {}, not {}", is, written),
                "it was changed after the session: put back what it was");
}

tactor_spec tactor_in(const json_value& t)
{
    tactor_spec one;
    one.position = {t["x_mm"].need_number(), t["y_mm"].need_number()};
    one.channel = static_cast<unsigned>(t["channel"].need_whole(0, most_channel));
    if (t["polarity"].there())
        one.polarity = t["polarity"].need_whole(-1, 1);
    one.gain_db = t["gain_db"].number().value_or(0.0);
    one.max_dbfs = t["max_dbfs"].number().value_or(0.0);
    one.actuator = t["actuator"].kind<actuator_kind>().value_or(one.actuator);
    one.displacement_um_at_0dbfs = t["displacement_um_at_0dbfs"].number();
    return one;
}

std::optional<array> array_in(const json_value& a)
{
    if (!a.there())
        return {};
    array all;
    all.name = a["name"].text().value_or("");
    for (const json_value& t : a["tactors"].list())
        all.tactors.push_back(tactor_in(t));
    try {
        validate(all);
    } catch (const error& e) {
        a.refuse(fmt::format("is none: {}: {}", e.subject(), e.why()), e.hint());
    }
    return all;
}

std::vector<planned_stimulus> read_stimuli(const session_facts& s, const fs::path& plans)
{
    std::vector<planned_stimulus> all;
    for (const json_value& one : s.facts()["stimuli"].list()) {
        planned_stimulus p{
            one["motion"].need_text(), one["method"].need_text(), one["sha256"].need_text(), {}, {}};
        const fs::path file = plans / (fs::path(p.hash).filename().string() + ".json");
        p.file = file.string();
        const std::string text = read_file(file);
        if (const std::string is = detail::sha256_text(text); is != p.hash)
            refuse_changed(p.file, p.hash, is);
        p.plan = files::read_object(text, p.file);
        all.push_back(std::move(p));
    }
    return all;
}

// Checks that a trial names the hash of its stimulus.
void check_plan(const text_table& t, std::size_t row, const session_facts& s, const char* method,
                const char* plan)
{
    if (!t.has(method) || !t.has(plan) || !t.cell(row, method) || !t.cell(row, plan))
        return;
    const auto same = [&](const planned_stimulus& p) {
        return p.motion == *t.cell(row, "motion") && p.method == *t.cell(row, method);
    };
    const auto at = std::find_if(s.stimuli.begin(), s.stimuli.end(), same);
    if (at == s.stimuli.end() || at->hash != *t.cell(row, plan))
        t.refuse(row, fmt::format("{} is no plan of its motion by its method in session.json", plan),
                 "it was changed");
}

// Adds the void trials and openings of the device in a run's table.
void add_table(const fs::path& folder, const fs::path& table, session_facts& s)
{
    void_count& c = s.voids.emplace_back();
    std::set<unsigned>& streams = s.streams.emplace_back();
    if (!is_there(folder, table))
        return;
    const text_table t(folder / table);
    std::map<std::string_view, std::size_t> waiting; // void attempts at a trial that did not come again yet
    for (std::size_t i = 0; i < t.rows(); ++i) {
        if (!s.stimuli.empty()) {
            check_plan(t, i, s, "method_1", "plan_1");
            check_plan(t, i, s, "method_2", "plan_2");
        }
        if (const auto came = waiting.extract(t.need(i, "trial")); !came.empty())
            c.again += came.mapped();
        if (!t.truth(i, "void")) {
            if (t.has("stream"))
                if (const auto stream = t.whole(i, "stream", 0, 1000000000))
                    streams.insert(*stream);
            continue;
        }
        ++c.voids;
        ++waiting[t.need(i, "trial")];
        const auto xruns = t.has("xruns") ? t.whole(i, "xruns", 0, 1000000000) : std::nullopt;
        if (!xruns)
            ++c.unknown;
        else if (*xruns > 0)
            ++c.with_xruns;
    }
}

session_facts read_session_facts(const fs::path& folder, const std::string& code,
                                 const experiment_outline& outline)
{
    const fs::path source = folder / source_path(code);
    const fs::path file = source / "session.json";
    session_facts s;
    s.code = code;
    s.file = file.string();
    s.document = files::read_object(read_file(file), s.file);
    const std::string text = s.facts()["experiment"]["text"].need_text();
    s.definition_hash = detail::sha256_text(text);
    if (const auto written = s.facts()["experiment"]["sha256"].text();
        written && *written != s.definition_hash)
        refuse_changed(s.file + ": experiment.text", *written, s.definition_hash);
    if (s.facts()["schema"].text() == own_schema)
        s.design = read_design(text, s.file + ": experiment.text");
    s.tactors = array_in(s.facts()["array"]);
    s.stimuli = read_stimuli(s, source / "plans");
    for (const run_outline& r : outline.runs)
        add_table(folder, table_path(code, r), s);
    return s;
}

std::vector<participant> read_people(const fs::path& folder, const std::vector<std::string>& codes)
{
    const text_table t(folder / "participants.tsv");
    const auto cell = [&](std::size_t row, const char* column) {
        const auto v = t.has(column) ? t.cell(row, column) : std::nullopt;
        return v ? std::optional<std::string>(*v) : std::nullopt;
    };
    std::vector<participant> all;
    for (std::size_t i = 0; i < t.rows(); ++i) {
        const std::string code(t.need(i, "participant_id").substr(4)); // after "sub-"
        if (std::find(codes.begin(), codes.end(), code) != codes.end())
            all.push_back({code, cell(i, "age"), cell(i, "sex"), cell(i, "handedness")});
    }
    return all;
}

} // namespace

study_facts read_facts(const fs::path& folder, const dataset& d)
{
    study_facts f;
    f.people = read_people(folder, d.participants);
    for (const std::string& code : d.participants)
        if (is_there(folder, source_path(code) / "session.json"))
            f.sessions.push_back(read_session_facts(folder, code, d.experiment));
    return f;
}

} // namespace tactor::study
