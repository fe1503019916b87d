// SPDX-License-Identifier: MIT
/// \file
/// Errors in terms of the protocol, and functions that read parameters and throw these errors. Such an error
/// names a parameter, never a field of the library or an option of the tool.
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

/// Exception that carries the error for an answer.
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

/// Replaces the marks of a text by the protocol's names of options, such as "options.soa".
std::string in_words_of_protocol(std::string_view marked);
/// Converts an error of the library to a fault. The fault is about the option of the error's field; if there
/// is none, it is about the parameter `source`. `named` is the name of the parameter's text in errors; if it
/// is empty, the name is `source`.
net::rpc_fault library_fault(const error& e, const std::string& source, const std::string& named = {});
/// Returns the fault for the current exception. Call it in catch (...).
net::rpc_fault current_fault(const std::string& source, const std::string& named = {});

/// Refuses unknown parameters, and parameters in a list. `sources` are additional known names.
void allow_only(const net::json& params, std::initializer_list<std::string_view> known,
                std::span<const std::string_view> sources = {});
/// Returns a member, or null if it is missing.
const net::json* member(const net::json& params, const char* name);
/// Returns a number within bounds. \throws fault_error.
double number(const net::json& v, const std::string& what, detail::bounds b);
/// Returns a member that is a number within bounds, or `usual` if it is missing. \throws fault_error.
double number_or(const net::json& params, const char* name, detail::bounds b, double usual);
/// Returns a required member that is a number within bounds. \throws fault_error.
double need_number(const net::json& params, const char* name, detail::bounds b);
/// Returns a whole number within bounds. \throws fault_error.
double whole(const net::json& v, const std::string& what, detail::bounds b);
/// Returns the name in `names` that `params` contains, or "" if it contains none.
/// \throws fault_error if it contains more than one.
std::string_view find_one(const net::json& params, std::span<const std::string_view> names);
/// Returns a boolean member, or false if it is missing. \throws fault_error.
bool flag(const net::json& params, const char* name);
std::uint32_t need_stroke(const net::json& params);
const std::string& text(const net::json& v, const std::string& what);

} // namespace tactor::server
