// SPDX-License-Identifier: MIT
#include "cli/check/finding.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"
#include "cli/say.hpp"
#include "core/words.hpp"

namespace tactor::cli {

namespace {

using json = nlohmann::ordered_json;

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

json to_json(const std::vector<finding>& all)
{
    json list = json::array();
    for (const finding& f : all)
        list.push_back({{"check", f.check},
                        {"level", std::string(to_string(f.how))},
                        {"found", f.found},
                        {"cure", f.cure.empty() ? json(nullptr) : json(f.cure)}});
    return list;
}

json to_json(const walk_outcome& w)
{
    const session::walk_answers& felt = w.felt;
    const session::walk_verdict& v = w.verdict;
    json answers = json::array();
    for (std::size_t i = 0; i < felt.size(); ++i)
        answers.push_back({{"tactor", i},
                           {"channel", w.tactors.tactors[i].channel},
                           {"felt", felt[i] ? json(*felt[i]) : json(nullptr)}});
    return {{"answers", answers},
            {"problems", v.problems},
            {"channels", v.channels.empty() ? json(nullptr) : json(v.channels)},
            {"changed", v.changed}};
}

} // namespace

std::string_view to_string(level l)
{
    return l == level::ok ? "ok" : l == level::warning ? "warning" : "error";
}

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

int worst_status(const std::vector<finding>& all)
{
    int status = status_ok;
    for (const finding& f : all) {
        if (f.how != level::error)
            continue;
        if (f.kind == error_kind::bad_input)
            return status_usage;
        if (f.kind == error_kind::not_available)
            status = status_device;
        else if (status == status_ok)
            status = status_failed;
    }
    return status;
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
    json told{{"schema", "tactor-check/1"},
              {"errors", count(all, level::error)},
              {"warnings", count(all, level::warning)},
              {"findings", to_json(all)}};
    if (walked)
        told["walk"] = to_json(*walked);
    return told.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

} // namespace tactor::cli
