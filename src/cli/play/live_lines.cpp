// SPDX-License-Identifier: MIT
#include "cli/play/live_lines.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <tactor/error.hpp>

#include "cli/say.hpp"
#include "core/split.hpp"
#include "core/words.hpp"
#include "files/text_file.hpp"
#include "session/pipes.hpp"

namespace tactor::cli {
namespace {

constexpr std::size_t longest_line = 4096;
constexpr double farthest_mm = 1e6;

// Splits at blanks. A comma is a separator only before a blank: elsewhere it may be a decimal one.
std::vector<std::string_view> split(std::string_view line)
{
    std::vector<std::string_view> words;
    constexpr const char* blanks = " \t\r";
    for (std::size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = line.find_first_not_of(blanks, end);
        if (at != std::string_view::npos && words.back().size() > 1 && words.back().back() == ',')
            words.back().remove_suffix(1);
    }
    return words;
}

// Reads a number, also nan, and with a plus sign.
std::optional<double> read_number(std::string_view word)
{
    if (word.starts_with('+') && !word.starts_with("+-"))
        word.remove_prefix(1);
    return detail::number_in<double>(word);
}

source_place line_place(std::size_t line)
{
    return {.file = "standard input", .line = static_cast<unsigned>(line)};
}

} // namespace

// Reads available bytes. Returns false if there are none.
bool live_lines::fill()
{
    pollfd p{fd_, POLLIN, 0};
    if (end_ || ::poll(&p, 1, 0) <= 0)
        return false;
    char bytes[4096];
    const ssize_t n = ::read(fd_, bytes, sizeof bytes);
    if (n < 0 && (errno == EINTR || errno == EAGAIN))
        return false;
    if (n < 0)
        session::refuse_standard_input(errno);
    if (n == 0) {
        end_ = true;
        if (!buffer_.empty() && buffer_.back() != '\n')
            buffer_ += '\n'; // the last line counts without its end, too
        return !buffer_.empty();
    }
    buffer_.append(bytes, static_cast<std::size_t>(n));
    return true;
}

std::optional<timed_point> live_lines::next()
{
    do {
        for (std::size_t end = buffer_.find('\n'); end != std::string::npos; end = buffer_.find('\n')) {
            const std::string line = buffer_.substr(0, end);
            buffer_.erase(0, end + 1);
            ++line_;
            if (const auto point = parse(line_ == 1 ? detail::without_mark(line) : line))
                return point;
        }
        if (buffer_.size() > longest_line)
            throw error(error_kind::bad_input, line_place(line_ + 1),
                        fmt::format("a line of more than {} bytes", longest_line),
                        "give x y [intensity], in mm");
    } while (fill());
    return std::nullopt;
}

std::optional<timed_point> live_lines::parse(std::string_view line)
{
    const auto words = split(line);
    if (words.empty() || words.front().front() == '#')
        return std::nullopt;
    const auto refuse = [&](const std::string& why) {
        throw error(error_kind::bad_input, line_place(line_), why,
                    "give x y [intensity]: two places in mm and a factor from 0 to 1, such as 20 12.5 0.8");
    };
    double v[3] = {};
    bool lost = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i].find(',') != std::string_view::npos)
            refuse(fmt::format("\"{}\" has a comma that could be a decimal one", words[i]));
        if (i == std::size(v))
            refuse(counted(words.size(), "word"));
        const auto number = read_number(words[i]);
        if (!number || std::isinf(*number))
            refuse(fmt::format("\"{}\" is not a number", words[i]));
        v[i] = *number;
        lost = lost || std::isnan(v[i]);
        if (std::abs(v[i]) > farthest_mm || (i == 2 && v[i] < 0.0))
            refuse(fmt::format("{} is out of range", words[i]));
    }
    if (lost && last_)
        return timed_point{.position = *last_, .intensity = 0.0};
    if (lost)
        return std::nullopt;
    if (words.size() < 2)
        refuse(counted(words.size(), "word"));
    last_ = point{v[0], v[1]};
    return timed_point{.position = *last_, .intensity = words.size() == 3 ? v[2] / intensity_max_ : 1.0};
}

void live_lines::warn(const std::string& remark) const
{
    say(stderr,
        "tactor: warning: standard input:{}: {} (x y [intensity] is the order; further points of this kind "
        "are counted)\n",
        line_, remark);
}

} // namespace tactor::cli
