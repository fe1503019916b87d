// SPDX-License-Identifier: MIT
// Replacement without libgpiod: chips are visible as files, but cannot be opened.
#include <cerrno>

#include "amplifier/line.hpp"

namespace tactor::amplifier {

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

requested<code_lines> request_code_lines(const std::string&, const std::vector<unsigned>&)
{
    return {nullptr, ENOSYS};
}

requested<edge_input> request_input(const input_request&)
{
    return {nullptr, ENOSYS};
}

} // namespace tactor::amplifier
