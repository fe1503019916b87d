// SPDX-License-Identifier: MIT
/// \file
/// JSON-RPC 2.0: text to requests, and answers to text. Pure functions of their arguments.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

namespace tactor::net {

/// A received message. Objects are maps, so that many keys do not take quadratic time.
using json = nlohmann::json;
/// A message to send, in the order in which it is written.
using reply_json = nlohmann::ordered_json;

/// Error codes of the standard and of tactor.
enum rpc_code : int {
    code_parse_error = -32700,
    code_invalid_request = -32600,
    code_no_method = -32601,
    code_bad_params = -32602,
    code_internal = -32603,
    code_no_stream = -32000,
    code_limit = -32001,
    code_no_stroke = -32002,
    code_no_token = -32003,
};

/// An error, which becomes an error object with data {kind what why hint}, and with line and column in the
/// parameter's text if they are known.
struct rpc_fault {
    int code = code_internal;
    std::string kind = {};
    std::string what = {}; ///< parameter at fault
    std::string why = {};
    std::string hint = {};
    unsigned line = 0; ///< from 1; 0: not known
    unsigned column = 0;
};

struct rpc_request {
    std::string method;
    json params = json::object();
    json id = nullptr;
    bool wants_reply = true; ///< false: a notification
};

/// An element of a message that is not a request, and the id for its error.
struct rpc_refusal {
    rpc_fault why;
    json id = nullptr;
};

struct rpc_message {
    std::vector<std::variant<rpc_request, rpc_refusal>> parts;
    bool batch = false;
    bool has_stop = false; ///< the refused message contains a stop, which is obeyed
};

/// Parses JSON; nothing for another text, and for one that nests deeper.
std::optional<json> parse_json(std::string_view text, std::size_t most_nesting);

/// Parses a message: a request, or a batch of at most 64. Never throws because of the text: faults are in the
/// parts. A stop is accepted in any form: with any params, id and version.
rpc_message parse_rpc(std::string_view text, std::size_t most_nesting = 64);

reply_json result_reply(const json& id, reply_json result);
/// Shortens a client's text that a message repeats: words and quoted pieces to 80 characters, the whole to
/// 1,000.
std::string cut_echo(std::string_view text);
/// Returns "what: why (hint)", with repeated text shortened.
std::string fault_text(const rpc_fault& f);
reply_json error_reply(const json& id, const rpc_fault& f);
reply_json notification(std::string_view method, reply_json params);

/// Returns the JSON on one line, without its end. Replaces bytes that are not UTF-8.
std::string json_line(const reply_json& j);

/// Appends bytes in base64 (RFC 4648, section 4), as messages carry files.
void append_base64(std::string& to, std::string_view bytes);
/// Decodes base64; nothing if the text is not base64 with its padding.
std::optional<std::string> read_base64(std::string_view text);

} // namespace tactor::net
