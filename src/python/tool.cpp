// SPDX-License-Identifier: MIT
// Binds comparisons and pictures, which the code of the tool makes.
#include <optional>
#include <string>
#include <utility>

#include "files/plan/plan_json.hpp"
#include "percept/compare.hpp"
#include "plot/figure.hpp"
#include "plot/paint/output.hpp"
#include "python/binding.hpp"

namespace tactor::python {
namespace {

using plans = std::vector<std::pair<std::optional<double>, const plan_handle*>>;

struct compared {
    std::shared_ptr<array_handle> on;
    detail::comparison result;
};

compared compare(const std::shared_ptr<array_handle>& on, const stroke& s, const py::dict& options,
                 std::vector<algorithm_kind> algorithms, std::vector<phantom_kind> phantoms,
                 const setup* file)
{
    option_values w;
    w.place = options::in_compare;
    take_options(w, options, on->value().tactors.size(), file);
    if (w.gives("sl") && w.plan.scale.kind != scale_kind::sl)
        throw error(error_kind::bad_input, "sl", "nothing here uses it", "add intensity_scale=\"sl\"")
            .with_field("sl");
    const layout& faces = on->faces();
    const stroke target = place_stroke(s, faces, w).strokes.front();
    const without_lock free;
    static_cast<void>(burst_duration_s(w.plan)); // checks the request: an invalid one must not become a row
    if (algorithms.empty())
        algorithms = {w.plan.algorithm};
    if (phantoms.empty())
        phantoms = {w.plan.phantom};
    const detail::comparison_choice choice{
        std::move(algorithms), std::move(phantoms), {w.observer, w.low_speed}, w.compensate, true, w.spread};
    compared c{on, detail::compare(target, on->value(), faces, w.plan, choice)};
    if (!c.result.playable())
        throw error(*c.result.rows.back().refused);
    return c;
}

plot::canvas draw(const compared& c, double width_mm)
{
    return plot::draw_comparison(c.on->value(), c.result, c.result.target.name, width_mm);
}

plot::figure_view parse_view(const std::string& name)
{
    using enum plot::figure_view;
    for (const auto& [known, view] :
         {std::pair{"array", array}, {"timing", timing}, {"wave", wave}, {"both", both}})
        if (name == known)
            return view;
    throw error(error_kind::bad_input, "view", "\"" + name + "\" is unknown",
                "use one of array, timing, wave, both");
}

plot::canvas draw(const array_handle& on, const plans& all, const std::string& name, const score* sound,
                  const std::string& view, double width_mm)
{
    files::piece shown;
    for (const auto& [start_s, p] : all) {
        check_same_array(*p, on.value());
        shown.strokes.push_back(p->drawn());
        shown.plans.push_back(p->at(start_s));
        shown.moved.insert(shown.moved.end(), p->one.moved.begin(), p->one.moved.end());
    }
    // If only some plans were moved, shows all plans as they are played.
    if (shown.moved.size() != shown.plans.size())
        shown.moved.clear();
    return plot::draw_figure({on.value(), name, shown.strokes, shown.plans, sound, shown.moved},
                             {parse_view(view), width_mm});
}

} // namespace

void bind_tool(py::module_& m)
{
    m.attr("WIDTHS_MM") = py::make_tuple(plot::least_width_mm, plot::most_width_mm);
    m.attr("DPI") = py::make_tuple(plot::least_dpi, plot::most_dpi);
    py::class_<compared>(m, "Compared")
        .def(py::init(&compare))
        .def("json",
             [](const compared& c) {
                 const without_lock free;
                 return files::comparisons_text({c.result}, c.on->value());
             })
        .def("svg",
             [](const compared& c, double width_mm) {
                 const without_lock free;
                 return plot::to_bytes(draw(c, width_mm), plot::file_format::svg, plot::usual_dpi);
             })
        .def("save",
             [](const compared& c, const std::string& file, double width_mm, unsigned dpi, bool force) {
                 const without_lock free;
                 plot::save(draw(c, width_mm), file, dpi, force);
             });
    m.def("svg",
          [](const array_handle& on, const plans& all, const std::string& name, const std::string& view) {
              const without_lock free;
              return plot::to_bytes(draw(on, all, name, nullptr, view, plot::figure_options().width_mm),
                                    plot::file_format::svg, plot::usual_dpi);
          });
    m.def("save_picture",
          [](const array_handle& on, const plans& all, const std::string& name, const score* sound,
             const std::string& view, const std::string& file, double width_mm, unsigned dpi, bool force) {
              const without_lock free;
              plot::check_output(file, force);
              plot::save(draw(on, all, name, sound, view, width_mm), file, dpi, force);
          });
}

} // namespace tactor::python
