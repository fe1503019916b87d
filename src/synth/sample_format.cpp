// SPDX-License-Identifier: MIT
#include <tactor/sample_format.hpp>

#include <array>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor {

namespace {

constexpr std::array<std::pair<std::string_view, sample_format>, 5> names{{
    {"float", sample_format::float32},
    {"s16", sample_format::s16},
    {"s24", sample_format::s24_3},
    {"s24-4", sample_format::s24_4},
    {"s32", sample_format::s32},
}};

} // namespace

std::size_t bytes_of(sample_format f) noexcept
{
    switch (f) {
    case sample_format::s16:
        return 2;
    case sample_format::s24_3:
        return 3;
    case sample_format::float32:
    case sample_format::s24_4:
    case sample_format::s32:
        break;
    }
    return 4;
}

std::string_view to_string(sample_format f) noexcept
{
    for (const auto& [name, format] : names) {
        if (format == f) {
            return name;
        }
    }
    return "?";
}

sample_format sample_format_from_string(std::string_view name)
{
    for (const auto& [known, format] : names) {
        if (known == name) {
            return format;
        }
    }
    throw error(errc::bad_input, "sample format", fmt::format("\"{}\" is not known", name),
                "use float, s16, s24, s24-4 or s32");
}

} // namespace tactor
