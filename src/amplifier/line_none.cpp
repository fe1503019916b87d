// SPDX-License-Identifier: MIT
// Without libgpiod: chips are seen, as files, but nothing of them can be opened.
#include <cerrno>

#include "amplifier/line.hpp"

namespace tactor::gpio {

bool built_in() noexcept
{
    return false;
}

chip read_chip(const std::string& path)
{
    chip c;
    c.info.path = path;
    c.code = ENOSYS;
    return c;
}

requested<output> request_output(const output_request&)
{
    return {nullptr, ENOSYS};
}

requested<edge_input> request_input(const input_request&)
{
    return {nullptr, ENOSYS};
}

} // namespace tactor::gpio
