// SPDX-License-Identifier: MIT
#include "cli/check/finding.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "cli/commands.hpp"
#include "cli/say.hpp"

namespace tactor::cli {

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

int status_of(const std::vector<finding>& all)
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

} // namespace tactor::cli
