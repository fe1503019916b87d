// SPDX-License-Identifier: MIT
#include "percept/person.hpp"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/refused.hpp"
#include "core/words.hpp"

namespace tactor::detail {
namespace {

void check_count(const array& a, const char* what, std::size_t n)
{
    if (n != 0 && n != a.tactors.size())
        throw detail::bad_field(what,
                                fmt::format("there are {} for {}", n, counted(a.tactors.size(), "tactor")),
                                "one for each, or none");
}

} // namespace

array felt_array(const array& a, const person& who)
{
    check_count(a, "shift", who.shift.size());
    array felt = a;
    for (std::size_t i = 0; i < who.shift.size(); ++i) {
        point& p = felt.tactors[i].position;
        p = {p.x_mm + who.shift[i].x_mm, p.y_mm + who.shift[i].y_mm};
        if (!std::isfinite(p.x_mm) || !std::isfinite(p.y_mm))
            throw detail::bad_field("shift", fmt::format("that of tactor {} is not finite", i));
    }
    return felt;
}

std::vector<double> person_gains(const array& a, const person& who)
{
    check_count(a, "sensitivity_db", who.sensitivity_db.size());
    std::vector<double> gains;
    for (const double db : who.sensitivity_db) {
        gains.push_back(std::pow(10.0, db / 20.0));
        if (!(gains.back() > 0.0 && std::isfinite(gains.back())))
            throw detail::bad_field("sensitivity_db", fmt::format("{} dB is not one", db));
    }
    return gains;
}

} // namespace tactor::detail
