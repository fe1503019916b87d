// SPDX-License-Identifier: MIT
#include "core/words.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace tactor {

namespace {

constexpr double no_time_s = 0.5e-9;  // sums of rounded numbers leave less than this
constexpr double small_time_s = 1e-4; // below it, too many zeros to read
constexpr int most_decimals = 12;

} // namespace

std::string counted(std::uint64_t n, std::string_view noun, std::string_view plural)
{
    if (n == 1)
        return fmt::format("1 {}", noun);
    return plural.empty() ? fmt::format("{} {}s", n, noun) : fmt::format("{} {}", n, plural);
}

std::string plain_number(double v, int digits)
{
    if (!std::isfinite(v) || v == 0.0)
        return fmt::format("{}", v == 0.0 ? 0.0 : v);
    // Number of digits before the point. Rounding may carry into one more digit; the surplus is then a zero.
    const auto magnitude = static_cast<int>(std::floor(std::log10(std::abs(v))));
    std::string s = fmt::format("{:.{}f}", v, std::clamp(digits - 1 - magnitude, 0, most_decimals));
    if (s.find('.') != std::string::npos) {
        s.erase(s.find_last_not_of('0') + 1);
        if (s.back() == '.')
            s.pop_back();
    }
    return s == "-0" ? "0" : s;
}

std::string seconds_text(double s, int digits)
{
    const double size = std::abs(s);
    if (size < no_time_s)
        return "0 s";
    if (size < 1e-6)
        return plain_number(s * 1e9, std::min(digits, 3)) + " ns";
    if (size < small_time_s)
        return plain_number(s * 1e6, std::min(digits, 3)) + " us";
    return plain_number(s, digits) + " s";
}

std::string in_small_letters(std::string text)
{
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
}

} // namespace tactor
