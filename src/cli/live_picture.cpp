// SPDX-License-Identifier: MIT
#include "cli/live_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace tactor::cli {
namespace {

// Bursts are in order of onset and last at most seconds: look back from the first that is later.
void add_bursts(const plan& p, double t_s, instant& now)
{
    auto b = std::upper_bound(p.bursts.begin(), p.bursts.end(), t_s,
                              [](double t, const burst& x) { return t < x.onset_s; });
    constexpr int look_back = 64;
    for (int i = 0; i < look_back && b != p.bursts.begin(); ++i) {
        --b;
        if (t_s >= b->onset_s + b->duration_s)
            continue;
        for (const drive& d : b->drives)
            now.levels[d.tactor] = std::hypot(now.levels[d.tactor], d.amplitude);
        if (!now.target)
            now.target = b->position;
    }
}

void add_continuous(const plan& p, double t_s, instant& now)
{
    if (t_s > p.stroke_duration_s)
        return;
    burst b;
    p.at(t_s, b);
    for (const drive& d : b.drives)
        now.levels[d.tactor] = std::hypot(now.levels[d.tactor], d.amplitude);
    now.target = b.position;
}

// A cell's shade: how strongly it vibrates. Digits would say more, shades are seen while they change.
const char* shade(double level)
{
    static constexpr const char* shades[] = {"·", "░", "▒", "▓", "█"};
    const auto i = static_cast<std::size_t>(std::clamp(std::ceil(level * 4.0), 0.0, 4.0));
    return shades[i];
}

} // namespace

instant at_time(const std::vector<placed_plan>& plans, const std::vector<double>& starts_s,
                std::size_t tactors, double t_s)
{
    instant now;
    now.levels.assign(tactors, 0.0);
    for (std::size_t i = 0; i < plans.size(); ++i) {
        const double t = t_s - starts_s[i];
        if (t < 0.0 || t > plans[i].schedule.total_s)
            continue;
        if (plans[i].schedule.at)
            add_continuous(plans[i].schedule, t, now);
        else
            add_bursts(plans[i].schedule, t, now);
    }
    return now;
}

live_picture::live_picture(const array& a, bool wanted)
    : active_(wanted && isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr)
{
    if (!active_)
        return;
    point low = a.tactors.front().position;
    point high = low;
    for (const tactor_spec& t : a.tactors) {
        low = {std::min(low.x_mm, t.position.x_mm), std::min(low.y_mm, t.position.y_mm)};
        high = {std::max(high.x_mm, t.position.x_mm), std::max(high.y_mm, t.position.y_mm)};
    }
    origin_ = low;
    winsize size{};
    ioctl(STDOUT_FILENO, TIOCGWINSZ, &size);
    const double wide = std::max<int>(20, (size.ws_col != 0 ? size.ws_col : 80) - 8);
    const double tall = std::max<int>(5, (size.ws_row != 0 ? size.ws_row : 24) - 5);
    // A character is about twice as tall as wide. Not larger than life needs: 4 columns to 5 mm.
    mm_per_column_ = std::max({(high.x_mm - low.x_mm) / wide, (high.y_mm - low.y_mm) / (2.0 * tall), 1.25});
    columns_ = cell_of(high).column + 1;
    rows_ = cell_of(high).row + 1;
    for (const tactor_spec& t : a.tactors)
        tactors_.push_back(cell_of(t.position));
    fmt::print("\033[?25l");
}

live_picture::~live_picture()
{
    if (!active_)
        return;
    clear();
    fmt::print("\033[?25h");
    std::fflush(stdout);
}

live_picture::cell live_picture::cell_of(point p) const
{
    const auto whole = [](double v) { return static_cast<unsigned>(std::max(0.0, std::round(v))); };
    return {whole((p.y_mm - origin_.y_mm) / (2.0 * mm_per_column_)),
            whole((p.x_mm - origin_.x_mm) / mm_per_column_)};
}

void live_picture::clear()
{
    if (drawn_lines_ != 0)
        fmt::print("\r\033[{}A\033[J", drawn_lines_);
    drawn_lines_ = 0;
}

void live_picture::draw(const instant& now, double t_s, double total_s)
{
    if (!active_)
        return;
    // Each tactor takes three cells in a row, so that a level can be seen.
    std::vector<std::vector<std::string>> canvas(rows_, std::vector<std::string>(columns_ + 2, " "));
    for (std::size_t i = 0; i < tactors_.size(); ++i)
        for (unsigned k = 0; k < 3; ++k)
            canvas[tactors_[i].row][tactors_[i].column + k] =
                now.levels[i] > 0.0 ? fmt::format("\033[33m{}\033[0m", shade(now.levels[i])) : shade(0.0);
    if (now.target) {
        const cell c = cell_of(*now.target);
        if (c.row < rows_ && c.column < columns_)
            canvas[c.row][c.column + 1] = "\033[1;36mo\033[0m";
    }
    std::string text;
    for (const auto& line : canvas) {
        text += "   ";
        for (const std::string& s : line)
            text += s;
        text += "\033[K\n";
    }
    const auto bar = static_cast<unsigned>(std::clamp(t_s / std::max(total_s, 1e-9), 0.0, 1.0) * 30.0);
    text += fmt::format("\n   [{}{}] {:.2f} / {:.2f} s\033[K\n", std::string(bar, '='),
                        std::string(30 - bar, ' '), std::max(t_s, 0.0), total_s);
    clear();
    fmt::print("{}", text);
    std::fflush(stdout);
    drawn_lines_ = rows_ + 2;
}

} // namespace tactor::cli
