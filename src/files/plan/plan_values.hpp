// SPDX-License-Identifier: MIT
/// \file
/// From the objects of tactor-plan/1 to values.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include <tactor/tactor.hpp>

#include "core/kind_names.hpp"

namespace tactor::files {

/// The members of an object; what is missing or of another kind is an error (bad_input) that names it.
class fields {
public:
    fields(const std::string& file, std::string place, const nlohmann::json& object)
        : file_(file), place_(std::move(place)), object_(object)
    {
    }

    double number(const char* name) const;
    std::optional<double> number_or_null(const char* name) const;
    unsigned count(const char* name) const;
    std::string text(const char* name) const;
    bool flag(const char* name) const;
    bool has(const char* name) const;
    bool is_null(const char* name) const;
    /// A value of a closed set, by its name.
    template <class Kind>
    Kind kind(const char* name) const
    {
        const std::string given = text(name);
        if (const auto k = detail::kind_named<Kind>(given))
            return *k;
        refuse(name, "is \"" + given + "\", which is not known");
    }
    fields object(const char* name) const;
    std::vector<fields> list(const char* name) const;
    std::vector<std::string> texts(const char* name) const;
    std::vector<double> numbers(const char* name) const;
    bool is_list(const char* name) const;
    /// A list of lists of two numbers.
    std::vector<std::pair<double, double>> pairs(const char* name) const;
    [[noreturn]] void refuse(const char* name, const std::string& why) const;

private:
    const nlohmann::json& member(const char* name) const;

    const std::string& file_;
    std::string place_;
    const nlohmann::json& object_;
};

burst read_burst(const fields& f);
/// A point of a continuous stroke.
burst read_sample(const fields& f);
array read_array(const fields& plan);
render_options read_render(const fields& plan);
placed_plan read_plan(const fields& f, const array& a, std::vector<burst> bursts, curve_samples samples);
/// What --compensate did, without the schedule; none where it was not asked for.
std::optional<compensated_plan> read_compensation(const fields& plan);
/// The way of a plan's bursts or samples, or of what moved ones are to be felt as, for pictures.
stroke read_stroke(const fields& f, const plan& p, const std::optional<compensated_plan>& moved);

} // namespace tactor::files
