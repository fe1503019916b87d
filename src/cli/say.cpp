// SPDX-License-Identifier: MIT
#include "cli/say.hpp"

#include <cstdio>
#include <map>
#include <string_view>
#include <utility>

#include <unistd.h>

#include <fmt/format.h>

#include "cli/settings.hpp"
#include "session/piece.hpp"

namespace tactor::cli {

namespace {

// Returns a text without its numbers and quoted names.
std::string find_kind(std::string_view text)
{
    std::string kind;
    bool quoted = false;
    for (const char c : text) {
        quoted = quoted != (c == '"');
        if (!quoted && std::string_view("0123456789.").find(c) == std::string_view::npos)
            kind += c;
    }
    return kind;
}

} // namespace

void print_grouped_warnings(std::span<const std::string> warnings)
{
    std::map<std::string, std::size_t> counts;
    for (const std::string& w : warnings)
        ++counts[find_kind(w)];
    for (const std::string& w : warnings) {
        const std::size_t n = std::exchange(counts[find_kind(w)], 0);
        if (n != 0)
            say(stderr, "tactor: warning: {}{}\n", make_printable(w),
                n == 1 ? "" : fmt::format("; and {} more like it", n - 1));
    }
}

std::vector<std::string> collect_warnings(std::span<const placed_plan> plans)
{
    std::vector<std::string> all;
    for (const placed_plan& p : plans)
        all.insert(all.end(), p.plan.warnings.begin(), p.plan.warnings.end());
    return all;
}

void warn_of_weakening(const std::string& name, const weakening& w, std::size_t strokes)
{
    if (const std::string text = session::weakening_text(w, strokes); !text.empty())
        say(stderr, "tactor: warning: {}: {}\n", make_printable(name), spell_marks(text));
}

progress_line::~progress_line()
{
    if (shown_)
        std::fputs("\r\033[K", stderr);
}

void progress_line::update(std::uint64_t done, std::uint64_t all)
{
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(500))
        return;
    last_ = now;
    if (::isatty(STDERR_FILENO) == 0)
        return;
    shown_ = true;
    const double percent = 100.0 * static_cast<double>(done) / static_cast<double>(all);
    std::fputs(fmt::format("\r\033[K{}: {:.1f} %", make_printable(name_), percent).c_str(), stderr);
    std::fflush(stderr);
}

} // namespace tactor::cli
