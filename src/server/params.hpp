// SPDX-License-Identifier: MIT
/// \file
/// JSON Schemas of parameters, and the check of parameters against them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/members.hpp"
#include "net/rpc.hpp"

namespace tactor::server {

/// Returns the schema of a JSON type. The bounds are those of a number, of the bytes of a text, or of the
/// number of elements.
net::reply_json make_schema(std::string_view type, const detail::bounds& b = detail::any_number);
/// Returns the schema of a text that is one of these names.
net::reply_json make_choice(const std::vector<std::string_view>& names);
/// Returns the schema of an object with these members and no others. If `sources` has names, exactly one of
/// these members is present.
net::reply_json make_object(net::reply_json members = net::reply_json::object(),
                            const std::vector<std::string_view>& required = {},
                            const std::vector<std::string_view>& sources = {});

/// Checks a value against a schema from these functions, which may also have "anyOf", "const", "items" and
/// "pattern". `place` is the path of the value, such as "start.delay_s", or "" for all parameters of a
/// method. Does not check values whose schema has no type. \throws fault_error that names the wrong part by
/// its path.
void check_param(const net::reply_json& schema, const net::json& v, const std::string& place = {});

/// Checks that a number is within bounds.
/// \throws fault_error.
void check_range(const std::string& place, double v, const detail::bounds& b);

} // namespace tactor::server
