// SPDX-License-Identifier: MIT
/// \file
/// What the parts of the extension share. They only bind: what Python's users see is python/tactor/*.py.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <tactor/tactor.hpp>

#include "python/interpreter.hpp"

namespace tactor::python {

namespace py = pybind11;

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

/// A look at doubles that belong to `owner`; NumPy may read, not write.
inline py::array_t<double> view_of(std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                                   const double* first, py::handle owner)
{
    py::array_t<double> a(std::move(shape), std::move(strides), first, owner);
    a.attr("flags").attr("writeable") = false;
    return a;
}

/// Doubles that go over to NumPy without a copy, rows of `columns` (0: a plain row), not to be written.
py::array_t<double> given(std::vector<double> values, std::size_t columns = 0);

/// Ctrl-C, asked for where the lock is not held: throws what Python's handler raised.
void check_signals();
/// Python's error is this one. With the interpreter's lock.
void set_error(const error& marked);

void bind_values(py::module_& m);
void bind_plan(py::module_& m);
void bind_score(py::module_& m);
void bind_tool(py::module_& m);
void bind_player(py::module_& m);

} // namespace tactor::python
