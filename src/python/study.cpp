// SPDX-License-Identifier: MIT
// Binds functions for studies. They call the same code as the tool.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/binding.hpp"
#include "study/analysis/analysis.hpp"
#include "study/analysis/result_json.hpp"
#include "study/bids/dataset.hpp"

namespace tactor::python {
namespace {

using codes = std::vector<std::string>;

study::selection select_participants(const codes& only, const codes& without)
{
    study::selection chosen{only};
    for (const std::string& code : without)
        chosen.without.try_emplace(code);
    return chosen;
}

std::vector<study::trial_cells> read_trials(const std::string& folder, const study::selection& chosen)
{
    const without_lock free;
    return study::read_study(folder, chosen);
}

py::list read_study(const std::string& folder, const codes& only, const codes& without)
{
    py::list trials;
    for (const study::trial_cells& cells : read_trials(folder, select_participants(only, without))) {
        py::dict trial;
        for (const auto& [name, value] : cells)
            if (!trial.contains(py::str(name))) // a lab's column of the same name must not replace it
                trial[py::str(name)] = value;
        trials.append(std::move(trial));
    }
    return trials;
}

std::string analyze_study(const std::string& folder, const codes& only, const codes& without, bool drop_early,
                          std::optional<std::pair<double, double>> response_time_s)
{
    const without_lock free;
    study::selection chosen = select_participants(only, without);
    chosen.drop_early = drop_early;
    chosen.response_time_s = response_time_s;
    const study::dataset d = study::read_dataset({folder}, chosen);
    return study::make_analysis_json(study::analyse(d)).dump();
}

} // namespace

void bind_study(py::module_& m)
{
    m.def("read_study", &read_study);
    m.def("analyze_study", &analyze_study);
}

} // namespace tactor::python
