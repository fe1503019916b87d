// SPDX-License-Identifier: MIT
// Exceptions across the border: libtactor's are caught here, and this program's pass through it.
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include <tactor/tactor.hpp>

namespace {

struct deaf : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct deaf_model final : tactor::phantom_model {
    std::string_view name() const noexcept override { return "deaf"; }
    void weights(tactor::point, double, std::vector<tactor::drive>&) const override
    {
        throw deaf("no level");
    }
};

void fail()
{
    static_cast<void>(tactor::path::from_svg("M 0 0 X"));
}

} // namespace

int main()
{
    try {
        fail();
    } catch (const tactor::error& e) {
        std::printf("error: %.*s\n", static_cast<int>(e.subject().size()), e.subject().data());
    }
    try {
        fail();
    } catch (const std::system_error& e) {
        if (e.code() == make_error_code(tactor::error_kind::bad_input))
            std::printf("system_error: %s\n", e.code().category().name());
    }
    try {
        fail();
    } catch (const std::exception& e) {
        if (dynamic_cast<const tactor::error*>(&e) != nullptr)
            std::puts("exception");
    }
    try {
        tactor::plan_options o;
        o.custom_phantom = std::make_shared<deaf_model>();
        static_cast<void>(
            tactor::make_plan(tactor::preset_array("palm-3x3"), tactor::preset_stroke("park2016-1"), o));
    } catch (const deaf& e) {
        std::printf("own: %s\n", e.what());
    }
    return 0;
}
