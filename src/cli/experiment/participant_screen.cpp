// SPDX-License-Identifier: MIT
#include "cli/experiment/participant_screen.hpp"

#include <memory>

#include "cli/play/live_picture.hpp"
#include "cli/play/terminal.hpp"
#include "cli/say.hpp"

namespace tactor::cli {
namespace {

class target_picture {
public:
    target_picture(const array& a, const stroke& target)
        : motion_(target.motion), faces_(a), picture_(a), now_{std::vector<double>(a.tactors.size(), 0.0), {}}
    {
    }

    bool active() const noexcept { return picture_.active(); }

    void draw(double t_s)
    {
        const point p = motion_.position(t_s);
        now_.target = faces_.contains(p) ? p : faces_.nearest(p);
        picture_.draw(now_, t_s, motion_.duration_s());
    }

private:
    const trajectory& motion_;
    layout faces_;
    live_picture picture_;
    instant now_;
};

} // namespace

bool terminal_display::moves() const
{
    return can_draw();
}

std::function<void(double)> terminal_display::show(const array& a, const stroke& target,
                                                   const study::page_words& words)
{
    const auto picture = std::make_shared<target_picture>(a, target);
    if (!picture->active())
        cli::show(words["target"] + "\n");
    return [picture](double t_s) { picture->draw(t_s); };
}

} // namespace tactor::cli
