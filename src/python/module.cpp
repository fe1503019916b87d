// SPDX-License-Identifier: MIT
#include "python/binding.hpp"

#include <exception>
#include <string_view>

namespace tactor::python {

py::array_t<double> to_numpy(std::vector<double> values, std::size_t columns)
{
    auto kept = std::make_unique<std::vector<double>>(std::move(values));
    const auto size = static_cast<py::ssize_t>(kept->size());
    const double* const first = kept->data();
    const auto width = static_cast<py::ssize_t>(columns);
    constexpr auto bytes = static_cast<py::ssize_t>(sizeof(double));
    const py::capsule owner(kept.release(), [](void* p) { delete static_cast<std::vector<double>*>(p); });
    if (columns == 0)
        return make_view({size}, {bytes}, first, owner);
    return make_view({size / width, width}, {width * bytes, bytes}, first, owner);
}

namespace {

// Converts a text to Python. The text may contain a file name that is not valid UTF-8.
py::str text(std::string_view t)
{
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeUTF8(t.data(), static_cast<Py_ssize_t>(t.size()), "surrogateescape"));
}

// Sets the current Python exception. The class of the exception is defined in Python code.
void set_error(const error& marked)
{
    const error e = spell_as_keywords(marked);
    try {
        const py::object x =
            call_function(py::module_::import("tactor._errors").attr("make_error"),
                          py::make_tuple(std::string(to_string(e.kind())), text(e.subject()), text(e.why()),
                                         text(e.hint()), text(e.field()), text(e.place().file),
                                         e.place().line, e.place().column, e.os_code()));
        PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(x.ptr())), x.ptr());
    } catch (py::error_already_set& raised) {
        raised.restore();
    }
}

void translate(std::exception_ptr p)
{
    try {
        if (p)
            std::rethrow_exception(p);
    } catch (const error& e) {
        set_error(e);
    }
}

} // namespace

} // namespace tactor::python

PYBIND11_MODULE(_tactor, m)
{
    using namespace tactor::python;
    m.doc() = "The C++ library as the package's modules need it. Not an interface.";
    py::register_exception_translator(&translate);
    m.def("version", &tactor::version);
    m.def("build_facts", &tactor::build_facts);
    bind_values(m);
    bind_plan(m);
    bind_tool(m);
    bind_study(m);
    bind_player(m);
}
