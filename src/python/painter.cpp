// SPDX-License-Identifier: MIT
// to_png() and to_pdf() of the package, by the tool's module, which lies beside this one.
#include <filesystem>
#include <string>

#include <dlfcn.h>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "plot/paint/output.hpp"
#include "plot/paint/painter_module.hpp"

namespace tactor::plot {
namespace {

std::filesystem::path beside()
{
    Dl_info here{};
    if (::dladdr(reinterpret_cast<const void*>(&beside), &here) == 0 || here.dli_fname == nullptr)
        return {};
    return std::filesystem::path(here.dli_fname).parent_path() / TACTOR_PAINTER;
}

// It stays loaded: fonts and libraries below it keep what they have begun.
const painter_module& load()
{
    if (TACTOR_HAS_PAINTER == 0)
        throw error(error_kind::runtime, "picture", "tactor was built without what paints PNG and PDF",
                    "write SVG, or build it anew where Cairo is");
    void* const module = dlopen(beside().c_str(), RTLD_NOW | RTLD_LOCAL);
    const void* const entry = module != nullptr ? dlsym(module, "tactor_painter") : nullptr;
    if (entry == nullptr) {
        const char* const said = dlerror();
        throw error(error_kind::runtime, "picture",
                    fmt::format("what paints PNG and PDF cannot be loaded: {}",
                                said != nullptr ? said : beside().string()),
                    "write SVG, or install tactor anew");
    }
    return *static_cast<const painter_module*>(entry);
}

const painter_module& painter()
{
    static const painter_module& loaded = load();
    return loaded;
}

} // namespace

std::string to_png(const canvas& c, unsigned dpi)
{
    return bytes_of(painter().to_png(c, dpi));
}

std::string to_pdf(const canvas& c)
{
    return bytes_of(painter().to_pdf(c));
}

} // namespace tactor::plot
