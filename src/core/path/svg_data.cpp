// SPDX-License-Identifier: MIT
// Grammar of path data. svg_pen.cpp draws its commands.

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/limits.hpp"
#include "core/path/impl.hpp"
#include "core/path/number.hpp"
#include "core/path/svg_pen.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::subpaths;
using detail::value_fault;

constexpr const char* starts = "it starts with M x y";

// Returns the arguments of a command: n is a number, f a flag.
std::string_view argument_kinds(char command) noexcept
{
    switch (detail::upper(command)) {
    case 'M':
    case 'L':
    case 'T':
        return "nn";
    case 'H':
    case 'V':
        return "n";
    case 'S':
    case 'Q':
        return "nnnn";
    case 'C':
        return "nnnnnn";
    case 'A':
        return "nnnffnn";
    default:
        return {};
    }
}

class path_reader {
public:
    path_reader(std::string_view data, double limit, subpaths wanted)
        : data_(data), limit_(limit), one_(wanted == subpaths::one)
    {
    }

    std::vector<detail::outline> run()
    {
        detail::skip_blanks(data_, at_);
        if (at_ == data_.size())
            fail("is empty", starts);
        if (detail::upper(data_[at_]) != 'M')
            fail(fmt::format("{} where a path starts", found()), starts);
        while (at_ < data_.size()) {
            command();
            detail::skip_blanks(data_, at_);
        }
        std::vector<detail::outline> drawn = pen_.take();
        if (one_ && drawn.empty()) // a move alone is a single place
            drawn.push_back({{pen_.start()}, {}});
        return drawn;
    }

private:
    void command()
    {
        const char c = data_[at_];
        const char kind = detail::upper(c);
        const std::string_view wanted = argument_kinds(c);
        if (wanted.empty() && kind != 'Z')
            fail(fmt::format("{} is not a path command", found()),
                 "the commands are M L H V C S Q T A Z and the same in lower case");
        if (one_ && begun_ && (kind == 'M' || (closed_ && kind != 'Z')))
            fail("a second subpath begins", "give one stroke for each");
        begun_ = true;
        closed_ = kind == 'Z';
        ++at_;
        if (closed_)
            return pen_.close();
        detail::skip_blanks(data_, at_);
        groups(c, wanted);
    }

    // Reads groups of arguments. Groups after a move's first one are lines.
    void groups(char c, std::string_view wanted)
    {
        for (char drawn = c;; drawn = c == 'M' ? 'L' : c == 'm' ? 'l' : c) {
            pen_.draw(drawn, group(c, wanted));
            const bool comma = separator();
            if (at_ == data_.size() || !begins_number(data_[at_])) {
                if (comma)
                    fail(fmt::format("{} where a number is wanted", found()), "a number follows each comma");
                return;
            }
        }
    }

    detail::path_arguments group(char c, std::string_view wanted)
    {
        detail::path_arguments values{};
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            if (i > 0)
                separator();
            values[i] = wanted[i] == 'f' ? flag(c) : number(c, wanted.size());
        }
        return values;
    }

    double flag(char c)
    {
        if (at_ == data_.size() || (data_[at_] != '0' && data_[at_] != '1'))
            fail(fmt::format("{} where {} wants a flag", found(), c), "flags are 0 or 1");
        return data_[at_++] == '1' ? 1.0 : 0.0;
    }

    double number(char c, std::size_t count)
    {
        const std::size_t begin = at_;
        const auto value = detail::scan_number(data_, at_);
        if (!value)
            fail(fmt::format("{} where {} wants a number", found(), c),
                 fmt::format("{} takes {}", c, counted(count, "number")));
        if (!(std::abs(*value) <= limit_)) {
            at_ = begin;
            fail(fmt::format("{:g} is beyond {:g}", *value, limit_), "is it the right unit?");
        }
        return *value;
    }

    bool separator()
    {
        detail::skip_blanks(data_, at_);
        if (at_ == data_.size() || data_[at_] != ',')
            return false;
        ++at_;
        detail::skip_blanks(data_, at_);
        return true;
    }

    static bool begins_number(char c) noexcept
    {
        return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-';
    }

    std::string found() const
    {
        return at_ == data_.size() ? "the end" : detail::quoted(data_.substr(at_, 1));
    }

    [[noreturn]] void fail(std::string why, std::string hint = {}) const
    {
        throw value_fault{at_, std::move(why), std::move(hint)};
    }

    std::string_view data_;
    double limit_;
    bool one_;
    std::size_t at_ = 0;
    bool begun_ = false;
    bool closed_ = false;
    detail::path_pen pen_;
};

} // namespace

} // namespace v0
} // namespace tactor

namespace tactor::detail {

std::vector<outline> parse_path_data(std::string_view data, double limit, subpaths wanted)
{
    return path_reader(data, limit, wanted).run();
}

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

path path::from_svg(std::string_view data)
{
    constexpr const char* what = "path data";
    try {
        std::vector<detail::outline> found = detail::parse_path_data(data, detail::max_mm, subpaths::one);
        return detail::make_path(std::move(found.front()), [] { return what; });
    } catch (const value_fault& f) {
        throw error(error_kind::bad_input, what, fmt::format("column {}: {}", f.offset + 1, f.why), f.hint);
    }
}

} // namespace v0
} // namespace tactor
