// SPDX-License-Identifier: MIT
#include "study/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <kainjow/mustache.hpp>

#include <tactor/error.hpp>

#include "core/sha256.hpp"
#include "core/words.hpp"
#include "files/output_file.hpp"
#include "study/bids/study_folder.hpp"
#include "study/data/text_table.hpp"
#include "study/experiment/read_definition.hpp"
#include "study/report/facts.hpp"

namespace tactor::study {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_wrong_hash(const std::string& what)
{
    throw error(error_kind::bad_input, what, "it has changed since the session", changed_file);
}

std::vector<planned_stimulus> read_stimuli(const session_facts& s, const fs::path& plans)
{
    std::vector<planned_stimulus> all;
    for (const json_value& one : s.facts()["stimuli"].list()) {
        planned_stimulus p{
            one["motion"].need_text(), one["method"].need_text(), one["sha256"].need_text(), {}, {},
            one["value"].number()};
        const fs::path file = plans / (fs::path(p.hash).filename().string() + ".json");
        p.file = file.string();
        const std::string text = read_file(file);
        if (detail::sha256_text(text) != p.hash)
            refuse_wrong_hash(p.file);
        p.document = files::read_object(text, p.file);
        all.push_back(std::move(p));
    }
    return all;
}

// Throws error (bad_input) if session.json does not list the plan of a trial for the motion and the method.
void check_plan(const text_table& t, std::size_t row, const session_facts& s, const char* method,
                const char* plan)
{
    if (!t.has(method) || !t.has(plan) || !t.cell(row, method) || !t.cell(row, plan))
        return;
    const auto same = [&](const planned_stimulus& p) {
        return p.motion == *t.cell(row, "motion") && p.method == *t.cell(row, method) &&
               p.hash == *t.cell(row, plan);
    };
    if (std::none_of(s.stimuli.begin(), s.stimuli.end(), same))
        t.refuse(row,
                 fmt::format("{} is not one of the plans in session.json for this motion and method", plan),
                 changed_file);
}

// Checks the plans in a run's table, and counts the run's trials.
trial_counts check_trials(const fs::path& folder, const fs::path& table, const session_facts& s)
{
    trial_counts count;
    if (!exists_in_study(folder, table))
        return count;
    const text_table t(folder / table);
    for (std::size_t i = 0; i < t.rows(); ++i) {
        if (!s.stimuli.empty())
            for (const auto& [method, plan] :
                 {std::pair("method_1", "plan_1"), {"method_2", "plan_2"}, {"method_3", "plan_3"}})
                check_plan(t, i, s, method, plan);
        ++(t.truth(i, "void") ? count.voids : count.valid);
        if (!t.truth(i, "void"))
            continue;
        const auto xruns = t.has("xruns") ? t.whole(i, "xruns", 0, 1000000000) : std::nullopt;
        if (!xruns)
            count.xruns.reset();
        else if (*xruns > 0 && count.xruns)
            ++*count.xruns;
    }
    return count;
}

// Counts a session's lines in the table of a questionnaire.
std::size_t count_answers(const fs::path& folder, const questionnaire& q, const std::string& code,
                          session_number session)
{
    const fs::path table = answers_path(q);
    if (!exists_in_study(folder, table))
        return 0;
    const text_table t(folder / table);
    std::size_t count = 0;
    for (std::size_t i = 0; i < t.rows(); ++i)
        if (t.need(i, "participant_id") == "sub-" + code &&
            (!session || t.whole(i, "session", 1, 99) == session)) {
            ++count;
            for (const questionnaire_item& item : q.items)
                if (item.kind != item_kind::text && t.has(item.name))
                    t.whole(i, item.name, item.lowest, item.greatest); // throws for an impossible answer
        }
    return count;
}

session_facts read_session_facts(const fs::path& folder, const std::string& code, session_number session,
                                 const experiment_outline& outline)
{
    const fs::path source = folder / source_path(code, session);
    const fs::path file = source / "session.json";
    session_facts s;
    s.participant = code;
    s.code = session_name(code, session).substr(4); // after "sub-"
    s.file = file.string();
    s.document = files::read_object(read_file(file), s.file);
    const std::string text = s.facts()["experiment"]["text"].need_text();
    s.definition_hash = detail::sha256_text(text);
    if (const auto written = s.facts()["experiment"]["sha256"].text();
        written && *written != s.definition_hash)
        refuse_wrong_hash(s.file + ": experiment.text");
    if (s.facts()["schema"].text() == own_schema)
        s.design = read_design(text, s.file + ": experiment.text");
    if (s.design)
        for (const questionnaire& q : s.design->outline.questionnaires)
            s.answered.push_back(count_answers(folder, q, code, session));
    s.stimuli = read_stimuli(s, source / "plans");
    for (const run_outline& r : outline.runs)
        s.counts.push_back(check_trials(folder, table_path(code, session, r), s));
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

namespace mustache = kainjow::mustache;

std::string render_text(const std::string& text, const mustache::data& facts)
{
    mustache::mustache section("{{=[[ ]]=}}" + text);
    section.set_custom_escape(escape_markdown);
    return section.render(facts);
}

// Data for the template, made from the facts of a study. It cannot be copied, because the functions of
// sections refer to this object.
class template_data {
public:
    explicit template_data(const nlohmann::ordered_json& facts)
    {
        for (const nlohmann::ordered_json& s : facts.at("sessions"))
            codes_.push_back(s.at("code"));
        for (const auto& [name, value] : facts.items())
            all_.set(name, make_member(name, value, name == "results" ? 4 : 6));
    }
    template_data(const template_data&) = delete;
    template_data& operator=(const template_data&) = delete;

    std::string fill_in(const std::string& text) const { return render_text(text, all_); }

private:
    // Converts a value. An object also gets a `list` of the object's members; an element of this list has the
    // member's name, and the value if it is no object. Two numbers with fractions become an interval. Null
    // becomes false, for which the template shows no section and no text.
    mustache::data make(const nlohmann::ordered_json& v, int digits) const
    {
        if (v.is_null())
            return mustache::data(false);
        if (v.is_boolean())
            return mustache::data(v.get<bool>());
        if (v.is_number_float())
            return mustache::data(plain_number(v.get<double>(), digits));
        if (v.is_number())
            return mustache::data(v.dump());
        if (v.is_string())
            return mustache::data(v.get<std::string>());
        mustache::data all(mustache::data::type::list);
        if (v.is_array() && v.size() == 2 && v[0].is_number_float() && v[1].is_number_float())
            return mustache::data(
                fmt::format("{} to {}", plain_number(v[0], digits), plain_number(v[1], digits)));
        if (v.is_array()) {
            for (const nlohmann::ordered_json& one : v)
                all.push_back(make(one, digits));
            return all;
        }
        mustache::data members(mustache::data::type::object);
        for (const auto& [name, value] : v.items()) {
            const mustache::data one = make_member(name, value, digits);
            members.set(name, one);
            mustache::data item = value.is_object() ? one : mustache::data("value", one);
            item.set("name", name);
            if (!value.is_null())
                all.push_back(item);
        }
        members.set("list", all);
        return members;
    }

    mustache::data make_member(const std::string& name, const nlohmann::ordered_json& v, int digits) const
    {
        if (name != "each" && name != "alike")
            return make(v, digits);
        std::vector<mustache::data> facts;
        for (const nlohmann::ordered_json& one : v)
            facts.push_back(one.empty() ? mustache::data(false) : make(one, digits));
        return mustache::data(
            mustache::lambda2([this, facts, below = name == "alike"](const std::string& text, const auto&) {
                return below ? render_distinct_texts(text, facts) : join_each(text, facts);
            }));
    }

    // Renders a section for each session. Returns the different texts in order of appearance, each with the
    // sessions that share the text.
    static std::vector<std::pair<std::string, std::vector<std::size_t>>>
    group(const std::string& text, const std::vector<mustache::data>& facts)
    {
        std::vector<std::pair<std::string, std::vector<std::size_t>>> texts;
        for (std::size_t i = 0; i < facts.size(); ++i) {
            std::string own = facts[i].is_false() ? "" : render_text(text, facts[i]);
            const auto at = std::ranges::find(texts, own, [](const auto& t) { return t.first; });
            (at == texts.end() ? texts.emplace_back(std::move(own), std::vector<std::size_t>()) : *at)
                .second.push_back(i);
        }
        return texts;
    }

    std::string format_session_names(const std::vector<std::size_t>& which) const
    {
        std::vector<std::string> own;
        for (const std::size_t i : which)
            own.push_back(codes_[i]);
        return which.size() == codes_.size() ? "all" : format_subjects(own);
    }

    std::string join_each(const std::string& text, const std::vector<mustache::data>& facts) const
    {
        std::vector<std::string> parts;
        for (const auto& [rendered, which] : group(text, facts)) {
            std::string own = rendered.substr(0, rendered.find_last_not_of(" ,;") + 1);
            own.erase(0, own.find_first_not_of(" ,;"));
            parts.push_back(own.empty() ? not_recorded : own);
            if (which.size() < facts.size())
                parts.back() += fmt::format(" ({})", escape_markdown(format_session_names(which)));
        }
        return parts.empty() ? not_recorded : join(parts, "; ");
    }

    std::string render_distinct_texts(const std::string& text, const std::vector<mustache::data>& facts) const
    {
        std::string all;
        for (const auto& [rendered, which] : group(text, facts)) {
            mustache::data one = facts[which.front()];
            one.set("who", format_session_names(which));
            all += render_text(text.substr(text.starts_with('\n') ? 1 : 0), one);
        }
        return all;
    }

    std::vector<std::string> codes_;
    mustache::data all_{mustache::data::type::object};
};

// Replaces several empty lines in a row by one. Sections without facts leave such lines.
std::string collapse_empty_lines(const std::string& text)
{
    std::string out;
    for (const char c : text)
        if (c != '\n' || !out.ends_with("\n\n"))
            out += c;
    return out;
}

} // namespace

study_facts read_facts(const fs::path& folder, const dataset& d)
{
    study_facts f;
    f.people = read_people(folder, d.participants);
    for (const std::string& code : d.participants)
        for (const session_number session : list_sessions(folder, code))
            f.sessions.push_back(read_session_facts(folder, code, session, d.experiment));
    return f;
}

std::string methods_text(const study_facts& f, const dataset& d, const analysis& a)
{
    return collapse_empty_lines(fill_in(std::string(methods_template()), collect_facts(f, d, a)));
}

std::string fill_in(const std::string& text, const nlohmann::ordered_json& facts)
{
    return template_data(facts).fill_in(text);
}

std::string session_gap_text(const study_facts& f)
{
    constexpr double day_ns = 86400e9;
    std::vector<double> days;
    for (std::size_t i = 1; i < f.sessions.size(); ++i) {
        const auto before = parse_acq_time(f.sessions[i - 1].facts()["date"].words());
        const auto after = parse_acq_time(f.sessions[i].facts()["date"].words());
        if (before && after && f.sessions[i].participant == f.sessions[i - 1].participant)
            days.push_back(std::round(10.0 * static_cast<double>(*after - *before) / day_ns) / 10.0);
    }
    return days.empty() ? not_recorded : range_text(days) + " days";
}

void write_report(const fs::path& file, const std::string& text, bool force)
{
    detail::write_text(file, text, {"<!-- ", " -->"}, force);
}

std::string escape_markdown(std::string_view text)
{
    constexpr std::string_view own = "\\`*_{}[]<>#|$~";
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const bool blank = c == ' ' || c == '\n' || c == '\t' || c == '\r';
        if (blank && !out.ends_with(' '))
            out += ' ';
        else if (!blank && (byte < 0x20 || byte == 0x7f))
            out += fmt::format("\\\\x{:02x}", byte);
        else if (!blank)
            out += own.find(c) == own.npos ? std::string(1, c) : std::string{'\\', c};
    }
    return out;
}

} // namespace tactor::study
