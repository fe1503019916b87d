// SPDX-License-Identifier: MIT
// lib2geom's parser does not say where path data is wrong, so its grammar is walked here first.
#include "model/path_svg_data.hpp"

#include <cmath>

#include <fmt/format.h>

#include "model/suggest.hpp"

namespace tactor::detail {
namespace {

// What each command wants: n a number, f a flag.
std::string_view arguments_of(char command) noexcept
{
    switch (command) {
    case 'M':
    case 'm':
    case 'L':
    case 'l':
    case 'T':
    case 't':
        return "nn";
    case 'H':
    case 'h':
    case 'V':
    case 'v':
        return "n";
    case 'S':
    case 's':
    case 'Q':
    case 'q':
        return "nnnn";
    case 'C':
    case 'c':
        return "nnnnnn";
    case 'A':
    case 'a':
        return "nnnffnn";
    default:
        return {};
    }
}

bool closes(char c) noexcept
{
    return c == 'Z' || c == 'z';
}

bool moves(char c) noexcept
{
    return c == 'M' || c == 'm';
}

class checker {
public:
    checker(std::string_view data, double limit) : data_(data), limit_(limit) {}

    path_data_check run()
    {
        skip_blanks(data_, at_);
        if (at_ == data_.size())
            fail("is empty");
        else if (!moves(data_[at_]))
            fail(fmt::format("{} where a path starts", found()), "it starts with M x y");
        while (!result_.fault && at_ < data_.size()) {
            command();
            skip_blanks(data_, at_);
        }
        return std::move(result_);
    }

private:
    void command()
    {
        const char c = data_[at_];
        const std::string_view wanted = arguments_of(c);
        if (wanted.empty() && !closes(c))
            return fail(fmt::format("{} is not a path command", found()),
                        "the commands are M L H V C S Q T A Z and the same in lower case");
        if (begun_ && !result_.second_subpath && (moves(c) || (closed_ && !closes(c))))
            result_.second_subpath = at_;
        begun_ = true;
        closed_ = closes(c);
        ++at_;
        if (closed_)
            return;
        skip_blanks(data_, at_);
        while (group(c, wanted)) {
            const bool comma = separator();
            if (at_ == data_.size() || !begins_number(data_[at_])) {
                if (comma)
                    fail(fmt::format("{} where a number is wanted", found()));
                return;
            }
        }
    }

    // One set of arguments; false after a fault.
    bool group(char c, std::string_view wanted)
    {
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            if (i > 0)
                separator();
            const std::size_t begin = at_;
            if (wanted[i] == 'f') {
                if (at_ == data_.size() || (data_[at_] != '0' && data_[at_] != '1'))
                    return fail(fmt::format("{} where {} wants a flag", found(), c), "flags are 0 or 1"),
                           false;
                ++at_;
                continue;
            }
            const auto value = scan_number(data_, at_);
            if (!value)
                return fail(fmt::format("{} where {} wants a number", found(), c),
                            fmt::format("{} takes {} numbers", c, wanted.size())),
                       false;
            if (!(std::abs(*value) <= limit_)) {
                at_ = begin;
                return fail(fmt::format("{:g} is beyond {:g}", *value, limit_), "is it the right unit?"),
                       false;
            }
        }
        return true;
    }

    bool separator()
    {
        skip_blanks(data_, at_);
        if (at_ == data_.size() || data_[at_] != ',')
            return false;
        ++at_;
        skip_blanks(data_, at_);
        return true;
    }

    static bool begins_number(char c) noexcept
    {
        return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-';
    }

    std::string found() const { return at_ == data_.size() ? "the end" : quoted(data_.substr(at_, 1)); }

    void fail(std::string why, std::string hint = {})
    {
        result_.fault = value_fault{at_, std::move(why), std::move(hint)};
    }

    std::string_view data_;
    double limit_;
    std::size_t at_ = 0;
    bool begun_ = false;
    bool closed_ = false;
    path_data_check result_;
};

} // namespace

path_data_check check_path_data(std::string_view data, double limit)
{
    return checker(data, limit).run();
}

} // namespace tactor::detail
