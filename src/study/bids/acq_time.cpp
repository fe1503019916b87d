// SPDX-License-Identifier: MIT
#include "study/bids/acq_time.hpp"

#include <ctime>

#include <fmt/format.h>

#include "core/split.hpp"

namespace tactor::study {
namespace {

constexpr std::int64_t second_ns = 1000000000;
constexpr std::int64_t microsecond_ns = 1000;
constexpr std::size_t seconds_length = 19; // 2026-11-21T14:03:00
constexpr std::size_t fraction_length = 7;

} // namespace

std::string acq_time_text(std::int64_t utc_ns)
{
    const std::time_t t = utc_ns / second_ns;
    std::tm utc{};
    ::gmtime_r(&t, &utc);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                       utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec, utc_ns % second_ns / microsecond_ns);
}

std::optional<std::int64_t> acq_time_ns(const std::string& text)
{
    std::tm utc{};
    const std::size_t length = text.size() - (text.ends_with('Z') ? 1 : 0);
    if (length != seconds_length + fraction_length ||
        ::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S.", &utc) != text.c_str() + seconds_length + 1)
        return {};
    const auto microseconds = detail::number_in<std::int64_t>(
        std::string_view(text).substr(seconds_length + 1, fraction_length - 1));
    if (!microseconds || *microseconds < 0)
        return {};
    return ::timegm(&utc) * second_ns + *microseconds * microsecond_ns;
}

std::int64_t utc_now_ns() noexcept
{
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    return now.tv_sec * second_ns + now.tv_nsec;
}

} // namespace tactor::study
