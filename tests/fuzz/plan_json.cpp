// SPDX-License-Identifier: MIT
// Plans as JSON, which give the amplitudes and the carrier themselves: what is accepted has samples within
// full scale.
#include <optional>

#include "files/plan/plan_json.hpp"
#include "holds.hpp"

using namespace tactor;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const auto file = fuzz::accepted([&] {
        return std::optional(
            files::read_plans(fuzz::as_text(data, size), "fuzz.json", files::recordings_kind::refuse));
    });
    if (!file)
        return 0;
    if (const auto s = fuzz::accepted(
            [&] { return std::optional(score(file->tactors, file->made.plans, file->render)); }))
        fuzz::check_samples(*s);
    return 0;
}
