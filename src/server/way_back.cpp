// SPDX-License-Identifier: MIT
#include "server/way_back.hpp"

#include <fmt/format.h>

namespace tactor::server {

std::string refusal(std::string what, std::string why, std::string hint)
{
    return net::json_line(net::error_reply(
        nullptr, {net::code_limit, "limit", std::move(what), std::move(why), std::move(hint)}));
}

std::string no_descriptors()
{
    return refusal("descriptors", "the server has as many files open as it may", "try again later") + "\n";
}

std::string why_given_up(net::line_fault f, const service_limits& l, bool admitted)
{
    if (f == net::line_fault::too_long)
        return refusal("max_message_bytes",
                       fmt::format("a message of more than {} bytes", l.max_message_bytes),
                       "send smaller ones");
    if (f == net::line_fault::crowded)
        return refusal("max_all_unfinished_bytes",
                       fmt::format("unfinished messages of all clients take more than {} bytes",
                                   l.max_all_unfinished_bytes),
                       "try again later");
    if (f == net::line_fault::memory)
        return refusal("message", "there is not enough memory for it", "send smaller ones");
    if (f == net::line_fault::too_slow && !admitted)
        return refusal("max_message_s", fmt::format("no hello with the token in {} s", l.max_message_s),
                       "begin with it");
    if (f == net::line_fault::too_slow)
        return refusal("max_message_s", fmt::format("no whole message in {} s", l.max_message_s),
                       "send what is complete");
    return {};
}

} // namespace tactor::server
