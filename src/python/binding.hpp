// SPDX-License-Identifier: MIT
/// \file
/// Declarations for all parts of the extension. The extension only binds: users of Python see
/// python/tactor/*.py. This file also releases and takes the lock of the interpreter, even while the program
/// ends.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <cxxabi.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <tactor/tactor.hpp>

#include "options/option.hpp"
#include "session/piece.hpp"

namespace tactor::python {

/// Pointers to the members of a struct that is a tuple in Python.
template <class T>
inline constexpr auto tuple_members = std::tuple();
template <>
inline constexpr auto tuple_members<point> = std::tuple(&point::x_mm, &point::y_mm);
template <>
inline constexpr auto tuple_members<profile_point> = std::tuple(&profile_point::part, &profile_point::value);
template <>
inline constexpr auto tuple_members<rest> = std::tuple(&rest::part, &rest::time_s, &rest::intensity);
template <>
inline constexpr auto tuple_members<threshold_point> = std::tuple(&threshold_point::hz,
                                                                  &threshold_point::dbfs);
template <>
inline constexpr auto tuple_members<tactor_spec> = std::tuple(&tactor_spec::position, &tactor_spec::channel,
                                                              &tactor_spec::gain_db, &tactor_spec::max_dbfs,
                                                              &tactor_spec::threshold_dbfs,
                                                              &tactor_spec::polarity, &tactor_spec::actuator,
                                                              &tactor_spec::thresholds, &tactor_spec::rise_s,
                                                              &tactor_spec::displacement_um_at_0dbfs);
template <>
inline constexpr auto tuple_members<array> = std::tuple(&array::name, &array::tactors, &array::site,
                                                        &array::up, &array::place, &array::turn_deg,
                                                        &array::body_mm);
template <>
inline constexpr auto tuple_members<drive> = std::tuple(&drive::tactor, &drive::amplitude);
template <>
inline constexpr auto tuple_members<burst> = std::tuple(&burst::onset_s, &burst::duration_s, &burst::position,
                                                        &burst::intensity, &burst::drives);
template <>
inline constexpr auto tuple_members<conflict> = std::tuple(&conflict::tactor, &conflict::from_s,
                                                           &conflict::to_s);
template <>
inline constexpr auto tuple_members<meeting> = std::tuple(&meeting::t_s, &meeting::position);
template <>
inline constexpr auto tuple_members<drive_limits> = std::tuple(&drive_limits::power_dbfs,
                                                               &drive_limits::max_drive_s,
                                                               &drive_limits::window_s);
template <>
inline constexpr auto tuple_members<live_delay> = std::tuple(&live_delay::points, &live_delay::least_s,
                                                             &live_delay::mean_s, &live_delay::most_s);

template <class T>
inline constexpr bool is_tuple = std::tuple_size_v<std::remove_cv_t<decltype(tuple_members<T>)>> != 0;

} // namespace tactor::python

namespace pybind11::detail {

template <class Kind>
concept named_kind = std::is_enum_v<Kind> && requires(Kind k)
{
    tactor::to_string(k);
};

/// Conversion between an enumeration's value and its name.
/// \throws tactor::error (bad_input) that lists the names.
template <class Kind>
struct type_caster<Kind, enable_if_t<named_kind<Kind>>> {
    PYBIND11_TYPE_CASTER(Kind, const_name("str"));

    bool load(handle from, bool convert)
    {
        make_caster<std::string> text;
        if (!text.load(from, convert))
            return false;
        value = tactor::from_string<Kind>(cast_op<std::string&>(text));
        return true;
    }
    static handle cast(Kind k, return_value_policy, handle)
    {
        return pybind11::cast(tactor::to_string(k)).release();
    }
};

/// Conversion between a struct with tuple_members and a tuple.
template <class T>
struct type_caster<T, enable_if_t<tactor::python::is_tuple<T>>> {
    PYBIND11_TYPE_CASTER(T, const_name("tuple"));

    bool load(handle from, bool convert)
    {
        const auto take = [&](auto... m) {
            using members = std::tuple<std::remove_cvref_t<decltype(value.*m)>...>;
            make_caster<members> all;
            if (!all.load(from, convert))
                return false;
            std::tie(value.*m...) = cast_op<members>(all);
            return true;
        };
        return std::apply(take, tactor::python::tuple_members<T>);
    }
    static handle cast(const T& v, return_value_policy, handle)
    {
        const auto give = [&](auto... m) { return pybind11::make_tuple(v.*m...).release(); };
        return std::apply(give, tactor::python::tuple_members<T>);
    }
};

} // namespace pybind11::detail

namespace tactor::python {

namespace py = pybind11;
using options::option_values;

/// Calls `f`, which may take the lock of the interpreter. All calls that run Python code must use this
/// function. `f` must call only C functions and have no objects with destructors, since these would run
/// without the lock. If a program ends while one of its daemon threads is in this function, Python before
/// 3.14 ends the thread by unwinding its stack. A destructor on this stack would then end the process by
/// abort(). Therefore this function waits for the end of the process instead, as Python 3.14 does.
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

/// A guard that releases the interpreter's lock while it exists. Precondition: the thread has the lock.
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

/// A guard that holds the interpreter's lock while it exists. The thread may already have the lock.
class with_lock {
public:
    with_lock() : before_(in_python([] { return PyGILState_Ensure(); })) {}
    ~with_lock() { PyGILState_Release(before_); }
    with_lock(const with_lock&) = delete;
    with_lock& operator=(const with_lock&) = delete;

private:
    PyGILState_STATE before_;
};

/// Calls a Python function.
/// \throws py::error_already_set.
inline py::object call_function(const py::object& function, const py::tuple& arguments)
{
    PyObject* const result = in_python([&] { return PyObject_CallObject(function.ptr(), arguments.ptr()); });
    if (result == nullptr)
        throw py::error_already_set();
    return py::reinterpret_steal<py::object>(result);
}

/// An array with its faces, which are made when a plan first needs them. Python cannot change it.
class array_handle {
public:
    explicit array_handle(array a) : array_(std::move(a)) { validate(array_); }

    const array& value() const noexcept { return array_; }
    /// Returns the faces, and makes them in the first call. Precondition: the caller has the interpreter's
    /// lock.
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

/// Returns a NumPy view of doubles that belong to `owner`. NumPy cannot write to them.
inline py::array_t<double> make_view(std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
                                     const double* first, py::handle owner)
{
    py::array_t<double> a(std::move(shape), std::move(strides), first, owner);
    a.attr("flags").attr("writeable") = false;
    return a;
}

/// Passes doubles to NumPy without copying them. The result has rows of `columns` values, or is
/// one-dimensional if `columns` is 0. NumPy cannot write to it.
py::array_t<double> to_numpy(std::vector<double> values, std::size_t columns = 0);

/// Sets the options in `keywords`. A value None sets nothing. For options that are not yet set, uses
/// [defaults] of `file`; for a score also the rate, channels and marker of `file`. Vibrations play for the
/// actuator of `file`. `tactors` is the number of tactors for a phantom model that is written in Python.
/// \throws error (bad_input) for impossible values, and for options that have no effect.
void take_options(option_values& into, const py::dict& keywords, std::size_t tactors,
                  const setup* file = nullptr);

/// Sets the options of a player from `keywords`.
/// \throws error (bad_input).
void set_player_options(option_values& into, const py::dict& keywords);

/// Returns the rows of the table of options, for src/options/write.py.
py::list option_rows();

/// Returns an error in which options are written as keyword arguments: "soa", timing="fit".
error spell_as_keywords(const error& e);

/// A plan together with its stroke, array and sound, which are needed to record, draw and render it.
struct plan_handle {
    std::shared_ptr<array_handle> on;
    session::piece one;                          ///< piece with a single stroke
    render_options sound = {};                   ///< default sound of the plan
    std::vector<std::string> sound_options = {}; ///< names of the sound options that the user set

    /// Returns the plan with the start `start_s`. If this is the plan's own start, it is relative to the
    /// anchor of the stroke.
    placed_plan at(std::optional<double> start_s) const
    {
        const placed_plan& p = placed();
        return {p.plan, start_s, start_s == p.start_s ? p.anchor : start_anchor{}};
    }
    const stroke& drawn() const noexcept { return one.strokes.front(); }
    const placed_plan& placed() const noexcept { return one.plans.front(); }
    const tactor::plan& plan() const noexcept { return placed().plan; }
};

/// Returns a piece with one stroke. The stroke is fitted and timed as its file and the options require.
/// \throws error (bad_input) if the stroke belongs to a group that is fitted as a whole.
session::piece place_stroke(const stroke& s, const layout& faces, const option_values& w);

/// Checks that a plan fits an array.
/// \throws error (bad_input) if the plan's tactors are at other places or on other channels.
void check_same_array(const plan_handle& p, const array& in_use);

void bind_values(py::module_& m);
void bind_plan(py::module_& m);
void bind_tool(py::module_& m);
void bind_study(py::module_& m);
void bind_player(py::module_& m);

} // namespace tactor::python
