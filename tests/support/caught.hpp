// SPDX-License-Identifier: MIT
// Messages are part of the interface: tests compare them.
#pragma once

#include <string>

#include <tactor/error.hpp>

/// Returns the message of a call's error, or "". Other exceptions go through and fail the test.
template <class F>
std::string caught_message(F call)
{
    try {
        call();
    } catch (const tactor::error& e) {
        return e.kind() == tactor::error_kind::bad_input ? e.what()
                                                         : std::string("another kind: ") + e.what();
    }
    return {};
}

/// Returns the field of a call's error; "" for none, "no error" where it succeeds.
template <class F>
std::string caught_field(F call)
{
    try {
        call();
    } catch (const tactor::error& e) {
        return std::string(e.field());
    }
    return "no error";
}

/// Returns the errno of a call's error; 0 for none.
template <class F>
int os_code(F call)
{
    try {
        call();
    } catch (const tactor::error& e) {
        return e.os_code();
    }
    return 0;
}
