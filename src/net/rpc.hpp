// SPDX-License-Identifier: MIT
/// \file
/// JSON-RPC 2.0: conversion of text to requests and of answers to text. Pure functions.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

namespace tactor::net {

/// A received message. Objects are maps, because lookup in lists of members would take quadratic time.
using json = nlohmann::json;
/// A message to be sent. Members keep the order in which they are added.
using reply_json = nlohmann::ordered_json;

inline constexpr std::size_t most_requests = 64; ///< greatest number of requests in a batch

/// Error codes from the standard, and tactor's own error codes.
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

/// An error of a request. In JSON it becomes an error object with data {kind what why hint}. The data also
/// has line and column in the parameter's text, if these are known.
struct rpc_fault {
    int code = code_internal;
    std::string kind = {};
    std::string what = {}; ///< name of the wrong parameter
    std::string why = {};
    std::string hint = {};
    unsigned line = 0; ///< from 1; 0 if not known
    unsigned column = 0;
};

struct rpc_request {
    std::string method;
    json params = json::object();
    json id = nullptr;
    bool wants_reply = true; ///< false for a notification
};

/// Part of a message that is not a valid request, with the id for the error reply.
struct rpc_refusal {
    rpc_fault why;
    json id = nullptr;
};

struct rpc_message {
    std::vector<std::variant<rpc_request, rpc_refusal>> parts;
    bool batch = false;
    bool has_stop = false; ///< true if the refused message contains a stop, which is executed anyway
};

/// Parses JSON; nothing for another text, and for one that nests deeper.
std::optional<json> parse_json(std::string_view text, std::size_t most_nesting);

/// Parses a message, which is a request or a batch of at most 64 requests. Does not throw for invalid text:
/// faults are among the parts of the result. A stop is accepted with any params, id and version.
rpc_message parse_rpc(std::string_view text, std::size_t most_nesting = 64);

reply_json result_reply(const json& id, reply_json result);
/// Shortens a client's text for repetition in a message. Words and quoted pieces get at most 80 characters,
/// the text at most 1,000.
std::string truncate_echo(std::string_view text);
/// Returns "what: why (hint)". Repeated text is shortened.
std::string fault_text(const rpc_fault& f);
reply_json error_reply(const json& id, const rpc_fault& f);
reply_json notification(std::string_view method, reply_json params);

/// Returns JSON on one line, without a line end. Replaces bytes that are not UTF-8.
std::string json_line(const reply_json& j);

/// Appends bytes in base64 (RFC 4648, section 4), the format of files in messages.
void append_base64(std::string& to, std::string_view bytes);
/// Decodes base64. Returns nothing if the text is not valid base64 with padding.
std::optional<std::string> decode_base64(std::string_view text);

} // namespace tactor::net
