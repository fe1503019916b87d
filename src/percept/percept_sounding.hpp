// SPDX-License-Identifier: MIT
/// \file
/// What sounds at one time, for the predicted percept.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <tactor/percept.hpp>

namespace tactor::detail {

/// Follows a plan through time. Between the times at which a burst begins or ends nothing is computed.
class sounding {
public:
    /// Both must live as long; `end_s` is where the movement ends. `gains`: of each tactor, or none.
    sounding(const array& a, const plan& p, double end_s, std::vector<double> gains);

    /// Fills in felt, intensity and shared. Times must ascend.
    /// \throws error (bad_input) where the plan names a tactor that the array does not have.
    void at(double t_s, percept_sample& out);

private:
    /// The bursts on one tactor.
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
    double first_end_s_;              // of those
    std::vector<part> parts_;         // by tactor; all zero but those touched
    std::vector<unsigned> touched_;
    burst sampled_; // `continuous`
    state now_;
};

} // namespace tactor::detail
