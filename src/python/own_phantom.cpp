// SPDX-License-Identifier: MIT
// A phantom model that is a Python object.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "python/options.hpp"

namespace tactor::python {
namespace {

class own_phantom final : public phantom_model {
public:
    own_phantom(py::object model, std::size_t tactors)
        : model_(std::move(model)),
          name_(py::hasattr(model_, "name")
                    ? py::str(model_.attr("name")).cast<std::string>()
                    : py::str(py::type::of(model_).attr("__name__")).cast<std::string>()),
          tactors_(tactors)
    {
    }

    // The last plan that shares it may be dropped by any thread.
    ~own_phantom() override
    {
        const py::gil_scoped_acquire lock;
        model_ = py::object();
    }
    own_phantom(const own_phantom&) = delete;
    own_phantom& operator=(const own_phantom&) = delete;

    std::string_view name() const noexcept override { return name_; }

    void weights(point p, double a_v, std::vector<drive>& out) const override
    {
        const py::gil_scoped_acquire lock;
        out.clear();
        const py::object said = model_.attr("weights")(p.x_mm, p.y_mm, a_v);
        for (const py::handle one : said.attr("items")())
            take(one, out);
        std::sort(out.begin(), out.end(), [](const drive& a, const drive& b) { return a.tactor < b.tactor; });
    }

private:
    void take(py::handle one, std::vector<drive>& out) const
    {
        const auto [tactor, amplitude] = one.cast<std::pair<py::object, py::object>>();
        const long long index = PyLong_AsLongLong(py::int_(tactor).ptr());
        const double a = py::float_(amplitude);
        if (index < 0 || index >= static_cast<long long>(tactors_))
            refuse(fmt::format("it drives tactor {} of {}", index, tactors_));
        if (!std::isfinite(a) || a < 0.0)
            refuse(fmt::format("tactor {} has the amplitude {}", index, a));
        if (a > 0.0)
            out.push_back({static_cast<unsigned>(index), a});
    }

    [[noreturn]] void refuse(const std::string& why) const
    {
        // As what Python raises: the model has failed, whatever it was asked for.
        set_error(error(error_kind::bad_input, fmt::format("phantom {}", name_), why,
                        "weights() returns a dict of tactor and amplitude, which is finite and not below 0"));
        throw py::error_already_set();
    }

    py::object model_;
    std::string name_;
    std::size_t tactors_;
};

} // namespace

std::shared_ptr<const phantom_model> model_of(const py::object& own, std::size_t tactors)
{
    return std::make_shared<const own_phantom>(own, tactors);
}

} // namespace tactor::python
