// SPDX-License-Identifier: MIT
#include "cli/play/live_picture.hpp"

#include <cstdio>
#include <new>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace tactor::cli {
namespace {

std::string to_its_beginning(std::size_t lines)
{
    return lines == 0 ? "\r" : fmt::format("\r\033[{}A", lines);
}

} // namespace

live_picture::live_picture(const array& a, bool wanted) : array_(a), style_{speaks_utf8(), may_colour()}
{
    std::fflush(stdout); // what was printed before stands above it
    if (wanted && can_draw())
        terminal_.emplace();
}

live_picture::~live_picture()
{
    if (!terminal_ || drawn_lines_ == 0)
        return;
    try {
        terminal_->write(to_its_beginning(drawn_lines_) + "\033[J");
        terminal_->finish();
    } catch (const std::bad_alloc&) { // then it stays
    }
}

void live_picture::draw(const instant& now, double t_s, double total_s)
{
    if (!terminal_ || !terminal_->idle())
        return;
    const auto lines = picture_lines(array_, now, t_s, total_s, terminal_->size(), style_);
    std::string text = to_its_beginning(drawn_lines_);
    for (const std::string& line : lines)
        text += line + "\033[K\n";
    terminal_->write(std::move(text) + "\033[J");
    drawn_lines_ = lines.size();
}

} // namespace tactor::cli
