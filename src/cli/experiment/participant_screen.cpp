// SPDX-License-Identifier: MIT
#include "cli/experiment/participant_screen.hpp"

#include <fmt/format.h>

#include "cli/say.hpp"
#include "cli/wrapped.hpp"
#include "core/split.hpp"

namespace tactor::cli {
namespace {

// A text for each step of the scale, or for its ends.
std::string scale_text(const study::page_words& w, const study::run_definition& r)
{
    const unsigned last = r.outline.scale;
    const bool each = r.labels.size() == last;
    std::string text;
    for (unsigned i = 1; i <= last; ++i) {
        if (!each && i != 1 && i != last)
            continue;
        if (i != 1)
            text += each ? ", " : fmt::format(" {} ", w["to"]);
        text += fmt::format("{}", i);
        if (each)
            text += fmt::format(" ({})", r.labels[i - 1]);
        else if (r.labels.size() == 2)
            text += fmt::format(" ({})", r.labels[i == 1 ? 0 : 1]);
    }
    return text;
}

} // namespace

unsigned choices_in(const study::run_definition& r)
{
    switch (r.outline.task) {
    case study::task_kind::choose:
        return 2;
    case study::task_kind::rate:
        return r.outline.scale;
    case study::task_kind::identify:
        break;
    }
    return static_cast<unsigned>(r.motions.size());
}

std::string choices_text(const study::experiment_definition& d, const study::run_definition& r)
{
    switch (r.outline.task) {
    case study::task_kind::choose:
        return fmt::format("1 {} 2", d.page["or"]);
    case study::task_kind::rate:
        return scale_text(d.page, r);
    case study::task_kind::identify:
        break;
    }
    std::string text;
    for (std::size_t i = 0; i < r.motions.size(); ++i)
        text += fmt::format("{}{} {}", i == 0 ? "" : ", ", i + 1, d.motions[r.motions[i]].name);
    return text;
}

void show_text(std::string_view text)
{
    for (const std::string_view line : detail::split(text, '\n'))
        show(wrapped("", std::string(line)));
}

target_picture::target_picture(const array& a, const stroke& target, const study::page_words& words)
    : motion_(target.motion), faces_(a), picture_(a), now_{std::vector<double>(a.tactors.size(), 0.0), {}}
{
    if (!picture_.active())
        show(words["target"] + "\n");
}

void target_picture::draw(double t_s)
{
    const point p = motion_.position(t_s);
    now_.target = faces_.contains(p) ? p : faces_.nearest(p);
    picture_.draw(now_, t_s, motion_.duration_s());
}

} // namespace tactor::cli
