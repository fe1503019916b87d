// SPDX-License-Identifier: MIT
/// \file
/// Remarks on the points of a live stroke.
#pragma once

#include <string>
#include <vector>

#include <tactor/path.hpp>
#include <tactor/player.hpp>

namespace tactor::session {

/// Returns a remark that an intensity above intensity_max plays as intensity_max.
std::string intensity_limit_text(double intensity, double intensity_max);

/// Remarks on points of a live stroke that were changed before they sounded. Each kind is reported once, at
/// its first point; the stroke's report counts all.
class live_remarks {
public:
    /// \param intensity_max value by which the producer's intensities were divided
    explicit live_remarks(double intensity_max = 1.0) : intensity_max_(intensity_max) {}

    /// Returns the remarks on the newest point of the stroke: `p` at `intensity`, which the stroke has
    /// accepted.
    std::vector<std::string> take(const live_stroke& stroke, point p, double intensity);

private:
    double intensity_max_;
    bool held_ = false;
    bool outside_ = false;
};

} // namespace tactor::session
