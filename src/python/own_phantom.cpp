// SPDX-License-Identifier: MIT
// A phantom model that is a Python object.
#include <utility>

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
          answer_(py::module_::import("tactor._plan").attr("ask_model")),
          tactors_(tactors)
    {
    }

    // The last plan that shares it may be dropped by any thread.
    ~own_phantom() override
    {
        const with_lock lock;
        model_ = py::object();
        answer_ = py::object();
    }
    own_phantom(const own_phantom&) = delete;
    own_phantom& operator=(const own_phantom&) = delete;

    std::string_view name() const noexcept override { return name_; }

    void weights(point p, double a_v, std::vector<drive>& out) const override
    {
        const with_lock lock;
        out.clear();
        for (const py::handle one :
             called(answer_, py::make_tuple(model_, name_, p.x_mm, p.y_mm, a_v, tactors_))) {
            const auto [tactor, amplitude] = one.cast<std::pair<unsigned, double>>();
            out.push_back({tactor, amplitude});
        }
    }

private:
    py::object model_;
    std::string name_;
    py::object answer_; ///< asks the model, and looks at what it says
    std::size_t tactors_;
};

} // namespace

std::shared_ptr<const phantom_model> wrap_model(const py::object& own, std::size_t tactors)
{
    return std::make_shared<const own_phantom>(own, tactors);
}

} // namespace tactor::python
