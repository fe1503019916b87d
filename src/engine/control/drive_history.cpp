// SPDX-License-Identifier: MIT
#include "engine/control/player_impl.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/limits.hpp"
#include "core/split.hpp"
#include "rt/clock.hpp"
#include "rt/system_files.hpp"
#include "synth/guard/guard.hpp"

namespace tactor {
inline namespace v0 {
namespace {

constexpr std::string_view first_words = "tactor-driven 1 ";
constexpr std::string_view last_line = "end";
constexpr unsigned most_channels = detail::max_tactors;
constexpr std::size_t most_stretches = 64; // of a channel, in a text
constexpr double longest_ahead_s = 86400.0;
constexpr std::int64_t longest_ns = 4'000'000'000'000'000'000;

[[noreturn]] void refuse(const char* why)
{
    throw error(error_kind::bad_input, "drive history", why, "begin with an empty one");
}

/// Returns the identifier of this boot, from which CLOCK_MONOTONIC counts.
std::string this_boot()
{
    const std::string text = rt::read_file("/proc/sys/kernel/random/boot_id");
    const std::string id = text.substr(0, text.find('\n'));
    return id.empty() ? "unknown" : id;
}

std::int64_t down(double seconds)
{
    return static_cast<std::int64_t>(std::floor(seconds * 1e9));
}

std::int64_t up(double seconds)
{
    return static_cast<std::int64_t>(std::ceil(seconds * 1e9));
}

double seconds(std::int64_t ns)
{
    return static_cast<double>(ns) * 1e-9;
}

/// The numbers of a line, one after the other.
class numbers {
public:
    explicit numbers(std::string_view line) : words_(detail::split(line, ' ')) {}

    std::int64_t next()
    {
        if (at_ == words_.size())
            refuse("a line breaks off");
        const auto n = detail::number_in<std::int64_t>(words_[at_++]);
        if (!n || *n < -longest_ns || *n > longest_ns)
            refuse("a word is no number");
        return *n;
    }
    std::string_view word() { return at_ < words_.size() ? words_[at_++] : std::string_view{}; }
    bool over() const noexcept { return at_ == words_.size(); }

private:
    std::vector<std::string_view> words_;
    std::size_t at_ = 0;
};

synth::drive_history::channel read_channel(numbers& n)
{
    synth::drive_history::channel c;
    c.opens_s = seconds(n.next());
    double before_s = seconds(-2 * longest_ns);
    while (!n.over()) {
        const synth::drive_history::stretch s{seconds(n.next()), seconds(n.next()), seconds(n.next())};
        if (c.stretches.size() == most_stretches)
            refuse("more stretches of time than a channel has");
        // Rounding of ns to seconds leaves a small difference.
        if (s.begin_s < before_s || s.end_s < s.begin_s || s.driven_s < 0.0 ||
            s.driven_s > s.end_s - s.begin_s + 1e-6)
            refuse("times are not in order");
        before_s = s.end_s;
        c.stretches.push_back(s);
    }
    return c;
}

} // namespace

synth::drive_history drive_history::impl::as_of(std::int64_t now_ns) const
{
    synth::drive_history h = channels;
    h.pass(seconds(now_ns - taken_ns));
    synth::forget(h, synth::longest_window_s);
    return h;
}

synth::drive_history drive_history::impl::until_now() const
{
    synth::drive_history h = as_of(rt::monotonic_ns());
    h.end_now();
    return h;
}

bool drive_history::empty() const noexcept
{
    return impl_ == nullptr || impl_->channels.empty();
}

drive_history drive_history::with(const drive_history& other) const
{
    if (impl_ == nullptr || other.impl_ == nullptr)
        return impl_ == nullptr ? other : *this;
    const std::int64_t now_ns = rt::monotonic_ns();
    return drive_history(std::make_shared<impl>(
        impl{synth::together(impl_->as_of(now_ns), other.impl_->as_of(now_ns)), now_ns}));
}

drive_history drive_history::with_ahead(unsigned channels, double ahead_s) const
{
    if (channels > most_channels)
        throw error(error_kind::bad_input, "drive history", fmt::format("{} channels", channels),
                    fmt::format("give 0 to {}", most_channels))
            .with_field("channels");
    if (!(ahead_s >= 0.0 && ahead_s <= longest_ahead_s))
        throw error(error_kind::bad_input, "drive history", fmt::format("{} s ahead", ahead_s),
                    fmt::format("give 0 to {} s", longest_ahead_s))
            .with_field("ahead_s");
    const std::int64_t now_ns = rt::monotonic_ns();
    synth::drive_history h = impl_ != nullptr ? impl_->as_of(now_ns) : synth::drive_history{};
    h.add_ahead(channels, ahead_s);
    return drive_history(std::make_shared<impl>(impl{std::move(h), now_ns}));
}

std::string drive_history::save() const
{
    auto [h, taken_ns] = impl_ != nullptr ? *impl_ : impl{};
    synth::coarsen(h, most_stretches);
    std::string text = fmt::format("{}{} {} {}\n", first_words, this_boot(), taken_ns, h.channels.size());
    for (std::size_t i = 0; i < h.channels.size(); ++i) {
        const synth::drive_history::channel& c = h.channels[i];
        if (c.empty())
            continue;
        fmt::format_to(std::back_inserter(text), "{} {}", i, up(c.opens_s));
        for (const synth::drive_history::stretch& s : c.stretches) {
            const std::int64_t begin = down(s.begin_s);
            const std::int64_t end = up(s.end_s);
            fmt::format_to(std::back_inserter(text), " {} {} {}", begin, end,
                           std::min(up(s.driven_s), end - begin));
        }
        text += '\n';
    }
    return text.append(last_line).append("\n");
}

drive_history drive_history::restore(std::string_view text)
{
    if (std::count(text.begin(), text.end(), '\n') > std::ptrdiff_t{most_channels} + 2)
        refuse("more lines than there are channels");
    const std::vector<std::string_view> lines = detail::split(text, '\n');
    if (lines.size() < 3 || !lines.back().empty() || lines[lines.size() - 2] != last_line)
        refuse("the text has no end");
    if (!lines.front().starts_with(first_words))
        refuse("the text is something else");
    numbers head(lines.front().substr(first_words.size()));
    const bool ours = head.word() == this_boot();
    impl h;
    h.taken_ns = head.next();
    const std::int64_t channels = head.next();
    if (!head.over() || channels < 0 || channels > most_channels)
        refuse("its first line is not whole");
    h.channels.channels.resize(static_cast<std::size_t>(channels));
    std::int64_t next = 0;
    for (std::size_t i = 1; i + 2 < lines.size(); ++i) {
        numbers line(lines[i]);
        const std::int64_t channel = line.next();
        if (channel < next || channel >= channels)
            refuse("channels are not in order");
        next = channel + 1;
        h.channels.channels[static_cast<std::size_t>(channel)] = read_channel(line);
    }
    if (!ours || h.taken_ns > rt::monotonic_ns())
        return {};
    return drive_history(std::make_shared<impl>(std::move(h)));
}

} // namespace v0
} // namespace tactor
