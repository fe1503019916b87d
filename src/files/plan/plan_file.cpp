// SPDX-License-Identifier: MIT
#include "files/plan/plan_file.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/words.hpp"
#include "files/input_files.hpp"
#include "files/plan/plan_values.hpp"
#include "files/text_file.hpp"

namespace tactor::files {
namespace {

using nlohmann::ordered_json;

constexpr const char* hint = "see tactor-json(5)";
constexpr const char* how_to_make = "{command:plan} makes one";

/// Follows the parser: bursts and samples are taken as they end, and dropped from the document.
class reader {
public:
    reader(std::string file, recordings_kind recordings) : file_(std::move(file)), recordings_(recordings) {}

    bool event(int depth, ordered_json::parse_event_t what, ordered_json& parsed)
    {
        const auto d = static_cast<std::size_t>(depth);
        if (what == ordered_json::parse_event_t::key) {
            keys_.resize(d + 1);
            keys_[d] = parsed.get<std::string>();
        }
        if (what != ordered_json::parse_event_t::object_end || keys_.size() < 2)
            return true;
        const std::size_t top = keys_[1] == "plans" ? 2 : 0; // depth of a plan
        if (d == top)
            return end_plan(parsed, top == 0);
        return !(d > top && d - top <= 3 && take(d - top, top, parsed));
    }

    plan_file result() &&
    {
        if (read_.made.plans.empty())
            throw error(error_kind::bad_input, file_, "there is no plan in it", how_to_make);
        return std::move(read_);
    }

private:
    std::string key(std::size_t depth) const { return depth < keys_.size() ? keys_[depth] : ""; }

    // Takes a burst or a sample, so deep in a plan.
    bool take(std::size_t deep, std::size_t top, const ordered_json& j)
    {
        const bool is_burst = deep == 2 && key(top + 1) == "bursts";
        const bool is_sample = deep == 3 && key(top + 1) == "continuous" && key(top + 2) == "points";
        if (is_burst)
            bursts_.push_back(read_burst({j, file_, hint, fmt::format("bursts[{}]", bursts_.size())}));
        if (is_sample)
            samples_.add(read_sample({j, file_, hint, fmt::format("points[{}]", samples_.ends.size())}));
        return is_burst || is_sample;
    }

    // Returns false for a plan that is taken.
    bool end_plan(const ordered_json& j, bool whole)
    {
        const json_value all(j, file_, hint);
        const std::string schema = all["schema"].text().value_or("none");
        if (whole && schema == "tactor-plans/1")
            return true;
        if (schema != "tactor-plan/1")
            throw error(error_kind::bad_input, file_,
                        fmt::format("its schema is {}, not tactor-plan/1", schema), how_to_make);
        array tactors = read_array(all);
        if (read_.made.plans.empty()) {
            read_.tactors = std::move(tactors);
            read_.render = read_render(all);
            read_.made.fit = read_fitting(all);
        } else {
            check_same_array(file_, tactors, read_.tactors);
        }
        read_.made.plans.push_back(read_plan(all, read_.tactors, std::exchange(bursts_, {}),
                                             std::exchange(samples_, {}), recordings_));
        std::optional<compensated_plan> moved = read_compensation(all);
        read_.made.strokes.push_back(read_stroke(all, read_.made.plans.back().plan, moved));
        if (moved)
            read_.made.moved.push_back(*std::move(moved));
        if (!read_.made.moved.empty() && read_.made.moved.size() != read_.made.plans.size())
            all["compensation"].refuse("is said of some plans and not of all");
        return false;
    }

    std::string file_;
    recordings_kind recordings_;
    std::vector<std::string> keys_; ///< by depth
    std::vector<burst> bursts_;
    curve_samples samples_;
    plan_file read_;
};

// Returns "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error ..." without the
// library's part.
std::string said(const std::string& what)
{
    const std::size_t at = what.find("line ");
    return at == std::string::npos ? what.substr(std::min(what.find("] ") + 2, what.size()))
                                   : what.substr(at);
}

// Reads a stream or a text. `begin` returns its first bytes, to explain a failure.
template <class Input, class Begin>
plan_file read_from(Input&& in, const std::string& name, recordings_kind recordings, const Begin& begin)
{
    reader r(name, recordings);
    try {
        const ordered_json all =
            ordered_json::parse(in, [&r](int depth, ordered_json::parse_event_t what, ordered_json& parsed) {
                return r.event(depth, what, parsed);
            });
    } catch (const ordered_json::exception& e) {
        detail::refuse_other_form(begin(), name, "json", how_to_make);
        throw error(error_kind::bad_input, name, said(e.what()), how_to_make);
    }
    return std::move(r).result();
}

} // namespace

bool is_plan_file(const std::string& argument)
{
    return std::filesystem::path(argument).extension() == ".json";
}

plan_file load_plans(const std::string& file)
{
    std::ifstream in(file, std::ios::binary);
    in.peek(); // a folder opens, and cannot be read
    const int code = errno;
    if (in.bad() || !in.is_open())
        throw error(error_kind::bad_input, source_place{file}, std::generic_category().message(code),
                    "check the name and its rights")
            .with_os_code(code);
    detail::note_input(file);
    return read_from(in, file, recordings_kind::read, [&file] {
        std::error_code ignored;
        std::string bytes(std::filesystem::is_regular_file(file, ignored) ? 4096 : 0, '\0');
        std::ifstream again(file, std::ios::binary);
        again.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        bytes.resize(static_cast<std::size_t>(again.gcount()));
        return bytes;
    });
}

plan_file read_plans(std::string_view text, const std::string& name, recordings_kind recordings)
{
    return read_from(text, name, recordings, [text] { return text; });
}

bool holds_plans(std::string_view text) noexcept
{
    const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    return first != std::string_view::npos && text[first] == '{';
}

void check_same_array(const std::string& file, const array& made_for, const array& in_use)
{
    const auto refuse = [&](const std::string& why) {
        throw error(error_kind::bad_input, file,
                    fmt::format("it was planned for the array \"{}\", not for \"{}\": {}", made_for.name,
                                in_use.name, why),
                    "plan the stroke for this array, or {array=none}: the plan has its own");
    };
    if (made_for.tactors.size() != in_use.tactors.size())
        refuse(fmt::format("{} there, {} here", counted(made_for.tactors.size(), "tactor"),
                           in_use.tactors.size()));
    for (std::size_t i = 0; i < in_use.tactors.size(); ++i) {
        const tactor_spec& a = made_for.tactors[i];
        const tactor_spec& b = in_use.tactors[i];
        if (distance_mm(a.position, b.position) > same_place_mm)
            refuse(fmt::format("tactor {} is at ({:.6g}, {:.6g}) mm there, at ({:.6g}, {:.6g}) mm here", i,
                               a.position.x_mm, a.position.y_mm, b.position.x_mm, b.position.y_mm));
        if (a.channel != b.channel)
            refuse(fmt::format("tactor {} is on channel {} there, on {} here", i, a.channel, b.channel));
        if (a.polarity != b.polarity)
            refuse(fmt::format("tactor {} has polarity {} there, {} here", i, a.polarity, b.polarity));
    }
}

} // namespace tactor::files
