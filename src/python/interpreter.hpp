// SPDX-License-Identifier: MIT
/// \file
/// The interpreter's lock, given back and taken, also while the program ends.
#pragma once

#include <utility>

#include <cxxabi.h>
#include <unistd.h>

#include <pybind11/pybind11.h>

namespace tactor::python {

/// Calls what may take the interpreter's lock, as all does that runs Python's code. `f` calls C alone and has
/// no objects, which would be destroyed without the lock. Where a program ends while one of its daemon
/// threads is in here, Python before 3.14 ends that thread by unwinding its stack; a destructor in between
/// would end the process by abort(). It waits for the process's end instead, as Python 3.14 has it.
template <class F>
decltype(auto) in_python(F&& f)
{
    try {
        return std::forward<F>(f)();
    } catch (abi::__forced_unwind&) {
        for (;;)
            ::pause();
    }
}

/// While it lives, others may have the lock, which the caller has.
class without_lock {
public:
    without_lock() : mine_(PyEval_SaveThread()) {}
    ~without_lock()
    {
        in_python([this] { PyEval_RestoreThread(mine_); });
    }
    without_lock(const without_lock&) = delete;
    without_lock& operator=(const without_lock&) = delete;

private:
    PyThreadState* mine_;
};

/// While it lives, the caller has the lock; it may have had it before.
class with_lock {
public:
    with_lock() : before_(in_python([] { return PyGILState_Ensure(); })) {}
    ~with_lock() { PyGILState_Release(before_); }
    with_lock(const with_lock&) = delete;
    with_lock& operator=(const with_lock&) = delete;

private:
    PyGILState_STATE before_;
};

/// What a function of Python's returns. \throws py::error_already_set.
inline pybind11::object called(const pybind11::object& function, const pybind11::tuple& arguments)
{
    PyObject* const result = in_python([&] { return PyObject_CallObject(function.ptr(), arguments.ptr()); });
    if (result == nullptr)
        throw pybind11::error_already_set();
    return pybind11::reinterpret_steal<pybind11::object>(result);
}

} // namespace tactor::python
