// SPDX-License-Identifier: MIT
// Entry of the module that paints with Cairo.
#include "plot/paint/painter_module.hpp"

#include "plot/paint/output.hpp"

namespace tactor::plot {
namespace {

template <typename F>
painting painted(F paint) noexcept
{
    try {
        return {.bytes = paint()};
    } catch (const error& e) {
        return {.failed = e.kind(),
                .what = std::string(e.subject()),
                .why = std::string(e.why()),
                .hint = std::string(e.hint())};
    } catch (const std::bad_alloc&) {
        return {.no_memory = true};
    }
}

} // namespace

extern "C" __attribute__((visibility("default"))) const painter_module tactor_painter{
    [](const canvas& c, unsigned dpi) noexcept { return painted([&] { return to_png(c, dpi); }); },
    [](const canvas& c) noexcept { return painted([&] { return to_pdf(c); }); }};

} // namespace tactor::plot
