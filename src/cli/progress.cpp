// SPDX-License-Identifier: MIT
#include "cli/progress.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/say.hpp"

namespace tactor::cli {

progress_line::progress_line(const std::string& name)
    : name_(shown(name)), terminal_(::isatty(STDERR_FILENO) != 0)
{
}

progress_line::~progress_line()
{
    if (shown_)
        std::fputs("\r\033[K", stderr);
}

void progress_line::update(std::uint64_t done, std::uint64_t all)
{
    const auto now = std::chrono::steady_clock::now();
    if (!terminal_ || now - last_ < std::chrono::milliseconds(500))
        return;
    last_ = now;
    shown_ = true;
    const double percent = 100.0 * static_cast<double>(done) / static_cast<double>(all);
    std::fputs(fmt::format("\r\033[K{}: {:.1f} %", name_, percent).c_str(), stderr);
    std::fflush(stderr);
}

} // namespace tactor::cli
