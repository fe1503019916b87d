// SPDX-License-Identifier: MIT
/// \file
/// Lists of rounded numbers in the answer to a view. By hand: a document of so many values takes longer than
/// the plan.
#pragma once

#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include <tactor/path.hpp>

namespace tactor::server {

/// Parts of a second, of a millimetre, and of the level asked for, to which numbers are rounded.
inline constexpr double time_parts = 1e5;
inline constexpr double mm_parts = 1e3;
inline constexpr double amplitude_parts = 1e4;

inline double rounded(double v, double parts)
{
    return std::round(v * parts) / parts + 0.0; // which turns -0 into 0
}

/// A member that is a list of numbers, or of rows of numbers, as text with a comma before it.
class number_list {
public:
    explicit number_list(std::string_view name) : text_(fmt::format(",\"{}\":[", name)) {}

    void add(double v, double parts)
    {
        if (const double r = rounded(v, parts); r == 0.0)
            text_ += "0,"; // as most amplitudes are
        else
            fmt::format_to(std::back_inserter(text_), "{},", r);
    }
    void add_row(double t_s, point at, double intensity)
    {
        text_ += '[';
        add(t_s, time_parts);
        add(at.x_mm, mm_parts);
        add(at.y_mm, mm_parts);
        add(intensity, amplitude_parts);
        text_.back() = ']';
        text_ += ',';
        ++rows_;
    }
    std::size_t rows() const noexcept { return rows_; }
    /// Ends the list and returns it.
    const std::string& end()
    {
        if (text_.back() == ',')
            text_.pop_back();
        return text_ += ']';
    }

private:
    std::string text_;
    std::size_t rows_ = 0;
};

} // namespace tactor::server
