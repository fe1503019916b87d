// SPDX-License-Identifier: MIT
/// \file
/// Which requests of a browser are meant for this server. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tactor::net {

/// Whether a Host header is ours: localhost or the very address that the connection came to, each with its
/// port (a page whose name was made to point here has another name), or one of `allowed` ("pi.lan" or
/// "pi.lan:4003"). `local`: "127.0.0.1:4003" or "[::1]:4003".
bool host_is_ours(std::string_view host, std::string_view local, const std::vector<std::string>& allowed);

/// Whether an Origin header is ours: http://HOST, or http or https with one of `allowed`.
bool origin_is_ours(std::string_view origin, std::string_view host, const std::vector<std::string>& allowed);

/// What a request is for.
struct web_target {
    std::string_view host;
    std::string_view path;
};

/// Of a request's target, which may be a whole address ("http://pi.lan/rpc", as to a proxy), and its Host
/// header, which stands behind that. What is neither an address nor a path is a path that is not there.
web_target target_of(std::string_view target, std::string_view host);

/// What follows "Bearer " in an Authorization header; empty for others.
std::string_view bearer_of(std::string_view authorization);

} // namespace tactor::net
