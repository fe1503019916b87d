// SPDX-License-Identifier: MIT
#include <tactor/sample_format.hpp>

#include "core/kind_table.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr detail::kind_table<format_kind, 5> formats("sample format", {{format_kind::float32, "float"},
                                                                       {format_kind::s16, "s16"},
                                                                       {format_kind::s24_3, "s24"},
                                                                       {format_kind::s24_4, "s24-4"},
                                                                       {format_kind::s32, "s32"}});

} // namespace

std::size_t bytes_of(format_kind f) noexcept
{
    switch (f) {
    case format_kind::s16:
        return 2;
    case format_kind::s24_3:
        return 3;
    case format_kind::float32:
    case format_kind::s24_4:
    case format_kind::s32:
        break;
    }
    return 4;
}

TACTOR_KIND_FUNCTIONS(format_kind, formats)

} // namespace v0
} // namespace tactor
