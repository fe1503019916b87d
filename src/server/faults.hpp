// SPDX-License-Identifier: MIT
/// \file
/// Refusals in terms of the protocol: parameters, never fields of the library or options of the tool. Readers
/// of parameters, which throw them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <tactor/error.hpp>
#include <tactor/render.hpp>

#include "core/bounds.hpp"
#include "net/rpc.hpp"

namespace tactor::server {

/// Exception with an error for the answer.
class fault_error : public std::exception {
public:
    explicit fault_error(net::rpc_fault f) : fault_(std::move(f)) {}
    const net::rpc_fault& fault() const noexcept { return fault_; }
    const char* what() const noexcept override { return fault_.why.c_str(); }

private:
    net::rpc_fault fault_;
};

[[noreturn]] void bad_param(std::string what, std::string why, std::string hint = {});
[[noreturn]] void limit_reached(std::string what, std::string why, std::string hint = "try again later");
[[noreturn]] void too_many_strokes(std::size_t strokes, std::size_t most);
[[noreturn]] void no_such_stroke(std::uint32_t number, std::string why = "you have no such stroke");
[[noreturn]] void no_stream(const std::string& why);

/// Writes the marks of a text with the protocol's names of options: "options.soa".
std::string in_words_of_protocol(std::string_view marked);
/// Converts an error of the library to a fault about the option in its field, or else about the parameter
/// `source`. `named`: name of the parameter's text in errors; empty: `source`.
net::rpc_fault library_fault(const error& e, const std::string& source, const std::string& named = {});
/// Returns the fault of the current exception. Call it in catch (...).
net::rpc_fault current_fault(const std::string& source, const std::string& named = {});

/// Refuses unknown parameters, and params that are a list. `sources`: more that are known.
void allow_only(const net::json& params, std::initializer_list<std::string_view> known,
                std::span<const std::string_view> sources = {});
/// Returns a member; null if there is none.
const net::json* member(const net::json& params, const char* name);
/// Returns a number within bounds. \throws fault_error.
double number(const net::json& v, const std::string& what, detail::bounds b);
/// Returns a member that is a number within bounds; `usual` if there is none. \throws fault_error.
double number_or(const net::json& params, const char* name, detail::bounds b, double usual);
/// Returns a required number within bounds. \throws fault_error.
double need_number(const net::json& params, const char* name, detail::bounds b);
/// Returns a whole number within bounds. \throws fault_error.
double whole(const net::json& v, const std::string& what, detail::bounds b);
/// Returns the name that `params` has; empty for none.
/// \throws fault_error for several.
std::string_view find_one(const net::json& params, std::span<const std::string_view> names);
/// Returns a member that is true or false; false if there is none. \throws fault_error.
bool flag(const net::json& params, const char* name);
std::uint32_t need_stroke(const net::json& params);
const std::string& text(const net::json& v, const std::string& what);

} // namespace tactor::server
