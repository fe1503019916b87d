// SPDX-License-Identifier: MIT
#include "study/report/report.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/words.hpp"

namespace tactor::study {

nlohmann::ordered_json list_questionnaires(const study_facts& f)
{
    std::vector<std::string> names;
    for (const session_facts& s : f.sessions)
        if (s.design)
            for (const questionnaire& q : s.design->questionnaires)
                if (std::ranges::count(names, q.name) == 0)
                    names.push_back(q.name);
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const std::string& name : names) {
        std::set<std::string> people;
        std::size_t answers = 0;
        const std::string what = join_texts(f, [&](const session_facts& s) -> std::string {
            if (!s.design)
                return {};
            const std::vector<questionnaire>& own = s.design->questionnaires;
            const auto q = std::ranges::find(own, name, &questionnaire::name);
            if (q == own.end())
                return "not asked";
            const std::size_t lines = s.answered[static_cast<std::size_t>(q - own.begin())];
            if (lines > 0)
                people.insert(s.participant);
            answers += lines;
            return fmt::format("{}{}{}, {}", q->title, q->title.empty() ? "" : ", ", describe_time(q->when),
                               counted(q->items.size(), "item"));
        });
        all.push_back(
            {{"name", name},
             {"what", what},
             {"answered", fmt::format("{} of {}, {} in all", people.size(),
                                      counted(f.people.size(), "participant"), counted(answers, "time"))}});
    }
    return all;
}

} // namespace tactor::study
