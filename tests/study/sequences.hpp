// SPDX-License-Identifier: MIT
// Definitions with one run, a test of counts, and an array, for tests of orders and their stimuli.
#pragma once

#include <string>
#include <vector>

#include <boost/math/distributions/chi_squared.hpp>
#include <fmt/format.h>

#include <tactor/array.hpp>

#include "study/experiment/read_definition.hpp"

namespace tactor::study {

inline experiment_definition with_run(const std::string& run, unsigned motions = 4, unsigned methods = 2)
{
    std::string text = "[experiment]\nname = \"e\"\n";
    for (unsigned i = 1; i <= motions; ++i)
        text += fmt::format("[[motion]]\nname = \"m{}\"\npath = \"M0 0H{}\"\n", i, 10 * i);
    text += "[[method]]\nname = \"a\"\nalgorithm = \"tactile-brush\"\n[[method]]\nname = \"b\"\n";
    for (unsigned i = 3; i <= methods; ++i)
        text += fmt::format("[[method]]\nname = \"{}\"\n", i);
    return read_definition(text + "[[run]]\nname = \"r\"\n" + run, "e.toml", {});
}

// Returns the probability of counts so far from equal, if all are equally likely.
inline double p_of_equal(const std::vector<double>& counts)
{
    double sum = 0.0;
    for (const double c : counts)
        sum += c;
    const double expected = sum / static_cast<double>(counts.size());
    double chi2 = 0.0;
    for (const double c : counts)
        chi2 += (c - expected) * (c - expected) / expected;
    const boost::math::chi_squared d(static_cast<double>(counts.size() - 1));
    return boost::math::cdf(boost::math::complement(d, chi2));
}

// Returns an array whose tactors are all felt from one level on.
inline array felt_array()
{
    array a = preset_array("palm-3x3");
    for (tactor_spec& t : a.tactors)
        t.threshold_dbfs = -40.0;
    return a;
}

} // namespace tactor::study
