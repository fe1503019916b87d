// to_png() and to_pdf() of the tool and of Python's extension, each of which compiles this file. They use the
// module, which is loaded for the first picture that needs it.
#include <array>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "plot/paint/output.hpp"
#include "plot/paint/painter_module.hpp"

namespace tactor::plot {
namespace {

// Places of the module, relative to the folder of tool or extension: the installed one and the one in the
// build folder. The environment cannot change them.
constexpr std::array places{TACTOR_PAINTERS};

// Returns the folder of tool or extension. $ORIGIN would be the folder of a sanitizer's dlopen().
std::filesystem::path own_folder()
{
#ifdef TACTOR_IN_EXTENSION
    Dl_info here{};
    if (dladdr(reinterpret_cast<const void*>(&own_folder), &here) == 0 || here.dli_fname == nullptr)
        return {};
    return std::filesystem::path(here.dli_fname).parent_path();
#else
    std::error_code none;
    return std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
#endif
}

// Loads the module for good: fonts and libraries below it keep state.
const painter_module& load()
{
    if (TACTOR_HAS_PAINTER == 0)
        throw error(error_kind::runtime, "picture", "tactor was built without PNG and PDF",
                    "write SVG, or build it again with -Dplots=enabled and Cairo");
    const std::filesystem::path folder = own_folder();
    std::string why = folder.empty() ? "/proc/self/exe, the place of the tool, cannot be read" : "";
    for (const char* place : places) {
        if (folder.empty())
            break;
        const std::string file = (folder / place).lexically_normal().string();
        void* const module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (module == nullptr) {
            const char* const failed = dlerror();
            why += fmt::format("{}{}", why.empty() ? "" : "; ", failed != nullptr ? failed : file);
            continue;
        }
        if (const void* entry = dlsym(module, "tactor_painter"))
            return *static_cast<const painter_module*>(entry);
    }
    throw error(error_kind::runtime, "picture",
                fmt::format("the module for PNG and PDF cannot be loaded: {}", why),
                "write SVG, or install tactor again");
}

const painter_module& painter()
{
    static const painter_module& loaded = load();
    return loaded;
}

// Returns the bytes. \throws error, std::bad_alloc.
std::string take_bytes(painting p)
{
    if (p.no_memory)
        throw std::bad_alloc();
    if (p.failed)
        throw error(*p.failed, p.what, p.why, p.hint);
    return std::move(p.bytes);
}

} // namespace

std::string to_png(const canvas& c, unsigned dpi)
{
    return take_bytes(painter().to_png(c, dpi));
}

std::string to_pdf(const canvas& c)
{
    return take_bytes(painter().to_pdf(c));
}

} // namespace tactor::plot
