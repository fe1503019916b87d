// SPDX-License-Identifier: MIT
/// \file
/// Tactors that sound at one time, for the predicted percept.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// State of a plan that is followed through time. Computes only when a burst begins or ends.
class sounding {
public:
    /// Starts before the plan. Array and plan must live as long; `end_s` is the end of the movement. `gains`:
    /// of each tactor, or empty.
    sounding(const array& a, const plan& p, double end_s, std::vector<double> gains);

    /// Fills in felt, intensity and shared. Times must ascend.
    /// \throws error (bad_input) if the plan names a tactor that the array does not have.
    void at(double t_s, percept_sample& out);

private:
    /// Bursts on one tactor.
    struct part {
        unsigned bursts = 0;
        double energy = 0.0;
        double sum = 0.0;
        double largest = 0.0;
        double intensity = 0.0;
    };
    struct state {
        std::optional<point> felt = {};
        double intensity = 0.0;
        bool shared = false;
    };

    bool begin_bursts(double t_s);
    bool end_bursts(double t_s);
    void add(const burst& b);
    double amplitude(const part& x) const;
    void sum_up();

    const array& tactors_;
    const plan& plan_;
    double end_s_;
    std::vector<double> gains_;       // empty: 1
    std::size_t next_ = 0;            // the first burst that has not begun
    std::vector<std::size_t> active_; // bursts that sound
    double first_end_s_;              // end of the first of them
    std::vector<part> parts_;         // by tactor; zero except those in touched_
    std::vector<unsigned> touched_;
    burst sampled_; // `continuous`
    state now_;
};

} // namespace tactor::detail
