// SPDX-License-Identifier: MIT
#include "plan/scaled.hpp"

#include <memory>
#include <optional>

#include "plan/curve_impl.hpp"

namespace tactor::detail {
namespace {

void scale(burst& b, double factor)
{
    b.intensity *= factor;
    for (drive& d : b.drives)
        d.amplitude *= factor;
}

class scaled_curve final : public curve::impl {
public:
    scaled_curve(const curve& from, double factor) : impl(from.duration_s()), from_(from), factor_(factor)
    {
        if (const trajectory* b = curve_access::of(from_).bounds())
            bounds_ = b->with_intensity(factor);
    }

    void fill(std::uint64_t k, same_tactors& seen, burst& out) const override
    {
        curve_access::of(from_).fill(k, seen, out);
        scale(out, factor_);
    }
    const trajectory* bounds() const noexcept override { return bounds_ ? &*bounds_ : nullptr; }

private:
    curve from_;
    double factor_;
    std::optional<trajectory> bounds_;
};

} // namespace

plan scaled(plan p, double factor)
{
    for (burst& b : p.bursts)
        scale(b, factor);
    if (p.curve)
        p.curve = curve_access::make(std::make_shared<scaled_curve>(*p.curve, factor));
    return p;
}

} // namespace tactor::detail
