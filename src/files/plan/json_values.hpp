// SPDX-License-Identifier: MIT
/// \file
/// Values in JSON, of several commands alike.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include <tactor/percept.hpp>

namespace tactor::files {

template <class T>
nlohmann::ordered_json or_null(const std::optional<T>& v)
{
    return v ? nlohmann::ordered_json(*v) : nlohmann::ordered_json(nullptr);
}

/// Null where a text is empty.
inline nlohmann::ordered_json or_null(const std::string& s)
{
    return s.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(s);
}

inline nlohmann::ordered_json tap_json(const tap& t)
{
    return {{"onset_s", t.onset_s},       {"target_x_mm", t.target.x_mm}, {"target_y_mm", t.target.y_mm},
            {"alone_x_mm", t.alone.x_mm}, {"alone_y_mm", t.alone.y_mm},   {"felt_x_mm", t.felt.x_mm},
            {"felt_y_mm", t.felt.y_mm}};
}

} // namespace tactor::files
