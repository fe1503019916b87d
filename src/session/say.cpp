// SPDX-License-Identifier: MIT
#include "session/say.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>

#include <sys/stat.h>

#include "core/split.hpp"
#include "session/wrapped.hpp"

namespace tactor::session {
namespace {

// Finds C1 controls, which are C2 80 to C2 9F in UTF-8.
bool starts_c1(std::string_view s, std::size_t at)
{
    return s[at] == '\xC2' && at + 1 < s.size() && (static_cast<unsigned char>(s[at + 1]) & 0xE0U) == 0x80U;
}

std::string escaped(std::string_view text, bool lines)
{
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        if (c == '\n')
            out += lines ? "\n" : "\\n";
        else if (c < 0x20U || c == 0x7FU)
            out += fmt::format("\\x{:02x}", c);
        else if (starts_c1(text, i))
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[++i]));
        else
            out += text[i];
    }
    return out;
}

// Returns the prefix of a line for the journal: sd-daemon(3).
std::string_view journal_level(log_kind k)
{
    switch (k) {
    case log_kind::debug:
        return "<7>";
    case log_kind::warning:
        return "<4>";
    case log_kind::error:
        return "<3>";
    default:
        return "<6>";
    }
}

std::string with_levels(const std::string& lines, log_kind k)
{
    std::string out;
    for (std::size_t at = 0; at < lines.size();) {
        const std::size_t end = std::min(lines.find('\n', at), lines.size() - 1) + 1;
        out += journal_level(k);
        out += lines.substr(at, end - at);
        at = end;
    }
    return out;
}

std::atomic<int> first_output_error = 0;

// The stream itself remembers that it failed, not why.
void keep_error(std::FILE* to, bool arrived)
{
    int none = 0;
    if (!arrived && to == stdout)
        first_output_error.compare_exchange_strong(none, errno);
}

} // namespace

std::string shown(std::string_view name)
{
    return escaped(name, false);
}

bool goes_to_journal(std::FILE* to)
{
    const char* journal = std::getenv("JOURNAL_STREAM");
    struct stat is {};
    return journal != nullptr && ::fstat(::fileno(to), &is) == 0 &&
           fmt::format("{}:{}", is.st_dev, is.st_ino) == journal;
}

int output_error()
{
    return first_output_error;
}

void say_text(std::FILE* to, std::string_view text, log_kind kind)
{
    std::string line = fit_lines(to, escaped(text, true));
    if (goes_to_journal(to))
        line = with_levels(line, text.starts_with("tactor: warning: ") ? log_kind::warning : kind);
    keep_error(to, std::fwrite(line.data(), 1, line.size(), to) == line.size());
}

void flush_output()
{
    keep_error(stdout, std::fflush(stdout) == 0);
}

void show(std::string_view text)
{
    say_text(stdout, text);
    flush_output();
}

void show_lines(std::string_view text)
{
    for (const std::string_view line : detail::split(text, '\n'))
        show(wrapped("", std::string(line)));
}

} // namespace tactor::session
