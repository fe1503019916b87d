// SPDX-License-Identifier: MIT
/// \file
/// The rows of a plan's JSON. By hand: there are half a million in ten hours, and building a document of each
/// takes most of the time of a plan.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactor/array.hpp>
#include <tactor/plan.hpp>

namespace tactor::files {

/// A member of an object, with what stands before it; kept, for many say the same in each row.
class number_member {
public:
    explicit number_member(std::string_view before) : text_(before), before_(before.size()) {}
    void append(std::string& out, double v);

private:
    std::string text_;
    std::size_t before_;
    std::optional<std::uint64_t> bits_; ///< of the number in text_
};

/// The array must outlive it.
class row_json {
public:
    explicit row_json(const array& a) : array_(a), tactors_(a.tactors.size()) {}

    /// Appends a burst.
    void append(std::string& out, const burst& b, double ramp_s);
    /// Appends a point of a continuous stroke.
    void append_sample(std::string& out, const burst& b);

private:
    void append_rest(std::string& out, const burst& b);

    const array& array_;
    std::vector<std::string> tactors_; ///< what stands before a drive's amplitude, once it was needed
    number_member time_{"{\"t_s\":"}, onset_{"{\"onset_s\":"}, duration_{",\"duration_s\":"},
        ramp_{",\"ramp_s\":"}, tau_{",\"tau_s\":"}, x_{",\"x_mm\":"}, y_{",\"y_mm\":"},
        intensity_{",\"intensity\":"};
};

/// Calls row(burst) for each burst; for `continuous`, for each point at which the phantom is
/// evaluated (each lasts until the next).
template <class Row>
void for_each_row(const plan& p, Row&& row)
{
    for (const burst& b : p.bursts)
        row(b);
    burst b;
    for (std::uint64_t k = 0; p.curve && k < p.curve->size(); ++k) {
        p.curve->sample(k, b);
        b.duration_s = std::min(continuous_step_s, p.stroke_duration_s - b.onset_s);
        row(b);
    }
}

} // namespace tactor::files
