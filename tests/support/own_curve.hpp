// SPDX-License-Identifier: MIT
// A curve whose samples come from a function, each time that they are read.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "plan/curve_impl.hpp"

namespace tactor::test {

class own_curve final : public curve::impl {
public:
    using function = std::function<void(double t_s, burst& out)>;

    own_curve(double duration, function at) : impl(duration), at_(std::move(at)) {}

    void fill(std::uint64_t k, detail::same_tactors&, burst& out) const override
    {
        at_(detail::sample_time_s(k, duration_s), out);
    }

private:
    function at_;
};

inline curve make_curve(double duration_s, own_curve::function at)
{
    return curve_access::make(std::make_shared<own_curve>(duration_s, std::move(at)));
}

} // namespace tactor::test
