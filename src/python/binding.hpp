// SPDX-License-Identifier: MIT
/// \file
/// Common to the parts of the extension. They only bind: Python's users see python/tactor/*.py. The
/// interpreter's lock is given back and taken here, also while the program ends.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <cxxabi.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <tactor/tactor.hpp>

namespace tactor::python {

namespace py = pybind11;

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

/// Calls a function of Python's. \throws py::error_already_set.
inline py::object called(const py::object& function, const py::tuple& arguments)
{
    PyObject* const result = in_python([&] { return PyObject_CallObject(function.ptr(), arguments.ptr()); });
    if (result == nullptr)
        throw py::error_already_set();
    return py::reinterpret_steal<py::object>(result);
}

/// An array and, once somebody plans on it, its faces. Immutable for Python.
class array_handle {
public:
    explicit array_handle(array a) : array_(std::move(a)) { validate(array_); }

    const array& value() const noexcept { return array_; }
    /// With the interpreter's lock held, which is what makes one of it.
    const layout& faces() const
    {
        if (faces_ == nullptr)
            faces_ = std::make_unique<const layout>(array_);
        return *faces_;
    }

private:
    array array_;
    mutable std::unique_ptr<const layout> faces_;
};

/// Returns a view of doubles that belong to `owner`; NumPy may read, not write.
inline py::array_t<double> make_view(std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                                     const double* first, py::handle owner)
{
    py::array_t<double> a(std::move(shape), std::move(strides), first, owner);
    a.attr("flags").attr("writeable") = false;
    return a;
}

/// Gives doubles to NumPy without a copy, in rows of `columns` (0: a plain row); they cannot be written.
py::array_t<double> to_numpy(std::vector<double> values, std::size_t columns = 0);

/// Writes paths and strokes as bytes, for pickles and for comparing: the same bytes, the same value.
std::string write_state(const path& p);
std::string write_state(const stroke& s);

/// Read what write_state() wrote. \throws error (bad_input) for other bytes.
path read_path(std::string_view state);
stroke read_stroke(std::string_view state);

void bind_values(py::module_& m);
void bind_plan(py::module_& m);
void bind_score(py::module_& m);
void bind_tool(py::module_& m);
void bind_player(py::module_& m);

} // namespace tactor::python
