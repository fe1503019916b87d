// SPDX-License-Identifier: MIT
/// \file
/// Errors in terms of the protocol. Such an error names a parameter, never a field of the library or an
/// option of the tool.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include <tactor/error.hpp>

#include "net/rpc.hpp"

namespace tactor::server {

/// Exception that carries the error for an answer.
class fault_error : public std::exception {
public:
    explicit fault_error(net::rpc_fault f) : fault_(std::move(f)) {}
    const net::rpc_fault& fault() const noexcept { return fault_; }
    const char* what() const noexcept override { return fault_.why.c_str(); }

private:
    net::rpc_fault fault_;
};

[[noreturn]] void refuse_param(std::string what, std::string why, std::string hint = {});
[[noreturn]] void refuse_over_limit(std::string what, std::string why, std::string hint = "try again later");
[[noreturn]] void refuse_too_many_strokes(std::size_t strokes, std::size_t most);
[[noreturn]] void refuse_unknown_stroke(std::uint32_t number, std::string why = "you have no such stroke");
[[noreturn]] void refuse_without_stream(const std::string& why);

/// Replaces the marks of a text by the protocol's names of options, such as "options.soa".
std::string spell_for_protocol(std::string_view marked);
/// Converts an error of the library to a fault. The fault is about the option of the error's field; if there
/// is none, it is about the parameter `source`. `named` is the name of the parameter's text in errors; if it
/// is empty, the name is `source`.
net::rpc_fault library_fault(const error& e, const std::string& source, const std::string& named = {});
/// Returns the fault for the current exception. Call it in catch (...).
net::rpc_fault current_fault(const std::string& source, const std::string& named = {});

} // namespace tactor::server
