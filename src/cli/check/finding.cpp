// SPDX-License-Identifier: MIT
#include "cli/check/finding.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/say.hpp"
#include "cli/settings.hpp"
#include "core/members.hpp"
#include "core/words.hpp"
#include "files/json/json_value.hpp"
#include "files/json/schema.hpp"

namespace tactor::cli {

namespace {

using detail::about;

std::size_t count(const std::vector<finding>& all, level l)
{
    return static_cast<std::size_t>(
        std::count_if(all.begin(), all.end(), [l](const auto& f) { return f.how == l; }));
}

std::string summary(const std::vector<finding>& all)
{
    return fmt::format("{}, {}, {} ok", counted(count(all, level::error), "error"),
                       counted(count(all, level::warning), "warning"), count(all, level::ok));
}

template <class Io>
void walk_members(Io& io, const walk_outcome& w)
{
    const session::walk_verdict& v = w.verdict;
    io.list("answers", w.felt, {"of each tactor, in order"},
            [&w](auto& inner, const std::optional<unsigned>& felt, std::size_t number) {
                constexpr about driven{"its number, and the channel that was driven"};
                inner("tactor", number, driven);
                inner.fact(
                    "channel", [&] { return w.tactors.tactors[number].channel; }, driven);
                inner.or_null("felt", felt, {"the tactor that was felt; null: none"});
            });
    io("problems", v.problems, {"why there is no map; none where there is"});
    io.or_null("channels", v.channels.empty() ? std::nullopt : std::optional(v.channels),
               {"of each tactor, as it should be; null where there is no map"});
    io("changed", v.changed, {"whether that differs from the array's"});
}

template <class Io>
void check_members(Io& io, const std::vector<finding>& all, const std::optional<walk_outcome>& walk)
{
    constexpr about many{"how many"};
    io.constant("schema", "tactor-check/1");
    io("errors", count(all, level::error), many);
    io("warnings", count(all, level::warning), many);
    io.list("findings", all, {"what was looked at"}, [](auto& inner, const finding& f, std::size_t) {
        inner("check", f.check, {"what, as in tactor-check(1)"});
        inner.one_of("level", to_string(f.how), {"ok", "warning", "error"}, {"ok, warning or error"});
        inner("found", f.found, {"what was found"});
        inner.or_null("cure", detail::omit_empty(f.cure), {"what to do about it; else null"});
    });
    io.part("walk", walk.has_value(), {"only after --walk with answers"},
            [&walk](auto& inner) { walk_members(inner, *walk); });
}

// Returns a line or two for each finding, at most 80 columns wide.
std::string findings_text(const std::vector<finding>& all)
{
    std::string s;
    for (auto f = all.begin(); f != all.end(); ++f) {
        s += wrapped(fmt::format("{:<8} {:<14} ", to_string(f->how), f->check), f->found);
        const auto first =
            std::find_if(all.begin(), f, [&](const finding& earlier) { return earlier.cure == f->cure; });
        if (!f->cure.empty())
            s += wrapped(fmt::format("{:<24}-> ", ""), first == f ? f->cure : "as for " + first->check);
    }
    return s;
}

} // namespace

std::string_view to_string(level l)
{
    return l == level::ok ? "ok" : l == level::warning ? "warning" : "error";
}

int worst_status(const std::vector<finding>& all)
{
    for (const error_kind k : {error_kind::bad_input, error_kind::not_available, error_kind::runtime})
        if (std::any_of(all.begin(), all.end(),
                        [k](const finding& f) { return f.how == level::error && f.kind == k; }))
            return exit_status_for(k);
    return status_ok;
}

std::string check_text(const std::vector<finding>& all, bool brief)
{
    std::vector<finding> shown;
    std::copy_if(all.begin(), all.end(), std::back_inserter(shown),
                 [&](const finding& f) { return !brief || f.how != level::ok; });
    return fmt::format("{}{}{}\n", findings_text(shown), shown.empty() ? "" : "\n", summary(all));
}

std::string check_json(const std::vector<finding>& all, const std::optional<walk_outcome>& walked)
{
    return files::make_object([&](auto& io) { check_members(io, all, walked); }).dump(2) + "\n";
}

nlohmann::ordered_json check_schema()
{
    const array none;
    const session::walk_answers felt;
    const session::walk_verdict verdict;
    return files::json_schema::describe_object([&](auto& io) {
        check_members(io, {}, walk_outcome{none, felt, verdict});
    });
}

} // namespace tactor::cli
