// SPDX-License-Identifier: MIT
#include "session/say.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>

#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "core/split.hpp"

namespace tactor::session {
namespace {

constexpr std::size_t usual_columns = 80;
constexpr std::size_t least_columns = 40;
constexpr std::size_t most_columns = 200;

// Counts columns. East Asian characters take two, as in fmt's padding.
std::size_t count_columns(std::string_view s)
{
    const std::size_t padded = 2 * s.size();
    return s.size() + padded - fmt::formatted_size("{:{}}", s, padded);
}

std::size_t count_blanks(std::string_view line, std::size_t at)
{
    return std::min(line.find_first_not_of(' ', at), line.size()) - at;
}

// Parts of a line, separated by two or more blanks.
struct line_parts {
    std::size_t hang = 0;   ///< column of the last part in the left half, else of the first word
    std::size_t beyond = 0; ///< index of the only part in the right half; 0 if there is none, or several
};

line_parts find_parts(std::string_view line, std::size_t width)
{
    line_parts p;
    unsigned count = 0; // parts in the right half
    for (std::size_t at = 0; at < line.size();) {
        const std::size_t word = at + count_blanks(line, at);
        if (word == line.size())
            break;
        if (at == 0 || word - at > 1) {
            const std::size_t column = count_columns(line.substr(0, word));
            if (column <= width / 2)
                p.hang = column;
            else
                p.beyond = ++count == 1 ? word : 0;
        }
        at = std::min(line.find(' ', word), line.size());
    }
    return p;
}

void append_line(std::string& all, std::string_view line, std::size_t hang, std::size_t width)
{
    std::size_t column = 0;
    for (std::size_t at = 0; at < line.size();) {
        const std::size_t blanks = count_blanks(line, at);
        const std::size_t end = std::min(line.find(' ', at + blanks), line.size());
        const std::string_view word = line.substr(at + blanks, end - at - blanks);
        const std::size_t columns = count_columns(word);
        if (column + blanks > hang && column + blanks + columns > width && !word.empty()) {
            all.append("\n").append(hang, ' ').append(word);
            column = hang + columns;
        } else {
            all.append(line.substr(at, end - at));
            column += blanks + columns;
        }
        at = end;
    }
}

// Breaks a line. If one part is in the right half, moves this part to a new line.
void append_parts(std::string& all, std::string_view line, std::size_t width)
{
    constexpr std::size_t deeper = 2;
    const line_parts p = find_parts(line, width);
    std::string_view left = line.substr(0, p.beyond);
    left.remove_suffix(left.size() - std::min(left.find_last_not_of(' ') + 1, left.size()));
    const std::size_t hang = p.beyond == 0 ? p.hang : (left.empty() ? deeper : p.hang) + deeper;
    if (!left.empty()) {
        append_line(all, left, p.hang, width);
        all += '\n';
    }
    append_line(all, p.beyond == 0 ? std::string(line) : std::string(hang, ' ').append(line.substr(p.beyond)),
                hang, width);
}

// Returns true for a C1 control character, which is C2 80 to C2 9F in UTF-8.
bool is_c1_control(std::string_view s, std::size_t at)
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
        else if (is_c1_control(text, i))
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

std::string add_journal_levels(const std::string& lines, log_kind k)
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

// Keeps the errno of the first failure; the stream itself only keeps that it failed.
void keep_error(std::FILE* to, bool arrived)
{
    int none = 0;
    if (!arrived && to == stdout)
        first_output_error.compare_exchange_strong(none, errno);
}

} // namespace

std::size_t line_width(std::FILE* to)
{
    winsize w{};
    const bool known = ::ioctl(::fileno(to), TIOCGWINSZ, &w) == 0 && w.ws_col != 0;
    return (known ? std::clamp<std::size_t>(w.ws_col, least_columns, most_columns) : usual_columns) - 1;
}

std::string wrap_text(std::string_view first, std::string_view text, std::size_t width)
{
    std::string all;
    append_line(all, fmt::format("{}{}", first, text), count_columns(first), width);
    return all + '\n';
}

std::string wrap_lines(std::string_view text, std::size_t width)
{
    std::string all;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string_view line = text.substr(at, end - at);
        if (count_columns(line) > width)
            append_parts(all, line, width);
        else
            all += line;
        if (end < text.size())
            all += '\n';
        at = end + 1;
    }
    return all;
}

std::string fit_lines(std::FILE* to, std::string text)
{
    return ::isatty(::fileno(to)) != 0 ? wrap_lines(text, line_width(to)) : text;
}

std::string make_printable(std::string_view name)
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
        line = add_journal_levels(line, text.starts_with("tactor: warning: ") ? log_kind::warning : kind);
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
        show(wrap_text("", std::string(line)));
}

} // namespace tactor::session
