// SPDX-License-Identifier: MIT
// A phantom model of your own, compared with two that are built in.
//   own_phantom [POWER]            default 2: energies fall with the square of the distance
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numeric>

#include <tactor/tactor.hpp>

namespace {

// The three nearest tactors, with energies in inverse proportion to a power of the distance.
class inverse_power final : public tactor::phantom_model {
public:
    inverse_power(const tactor::layout& l, double power) : places_(l.places()), power_(power) {}

    std::string_view name() const noexcept override { return "inverse-power"; }

    void weights(tactor::point p, double a_v, std::vector<tactor::drive>& out) const override
    {
        std::vector<unsigned> order(places_.size());
        std::iota(order.begin(), order.end(), 0U);
        const auto distance = [&](unsigned i) { return distance_mm(places_[i], p); };
        const auto near = order.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(3, order.size()));
        // Takes the first of two at equal distance: ties must not depend on the sorting.
        std::partial_sort(order.begin(), near, order.end(), [&](unsigned i, unsigned j) {
            return std::pair(distance(i), i) < std::pair(distance(j), j);
        });
        order.erase(near, order.end());

        out.clear();
        if (distance(order[0]) < tactor::same_place_mm) {
            out.push_back({order[0], a_v}); // on a tactor: that one alone
            return;
        }
        std::sort(order.begin(), order.end()); // drives come in order of tactor
        double sum = 0.0;
        for (const unsigned i : order)
            sum += std::pow(distance(i), -power_);
        // The square roots of energies that add up to that of the point.
        for (const unsigned i : order)
            out.push_back({i, a_v * std::sqrt(std::pow(distance(i), -power_) / sum)});
    }

private:
    std::vector<tactor::point> places_;
    double power_;
};

void report(const tactor::array& a, const tactor::stroke& s, const tactor::plan_options& o)
{
    const tactor::plan plan = tactor::make_plan(a, s, o);
    const tactor::percept_summary felt = tactor::summarise(tactor::predict_percept(a, s, plan));
    std::printf("%-18s RMS error %.2f mm, CV of speed %.2f\n", plan.phantom.c_str(), *felt.rms_error_mm,
                *felt.speed_cv);
}

} // namespace

int main(int argc, char** argv)
try {
    const tactor::array palm = tactor::preset_array("palm-3x3");
    const tactor::stroke stroke = tactor::preset_stroke("park2016-3");
    report(palm, stroke, {.phantom = tactor::phantom_kind::inverse_distance});
    report(palm, stroke, {.phantom = tactor::phantom_kind::barycentric});

    tactor::plan_options mine;
    mine.custom_phantom =
        std::make_shared<inverse_power>(tactor::layout(palm), argc > 1 ? std::atof(argv[1]) : 2.0);
    report(palm, stroke, mine);
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "own_phantom: %s\n", e.what());
    return 1;
}
