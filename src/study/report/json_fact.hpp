// SPDX-License-Identifier: MIT
/// \file
/// A value in a JSON file that is told with its place when it is not what it should be.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace tactor::study {

/// A value that may not be there: null is not there either. It refers to the document, which must outlive it.
class json_fact {
public:
    json_fact(const nlohmann::ordered_json& document, std::string file)
        : value_(&document), file_(std::move(file))
    {
    }

    bool there() const noexcept { return value_ != nullptr && !value_->is_null(); }

    bool is_list() const noexcept { return there() && value_->is_array(); }

    /// A member of an object; not there where this is not. \throws error (bad_input) where this is no object.
    json_fact operator[](const std::string& key) const;
    /// The members of a list; none where it is not there. \throws error (bad_input) where this is no list.
    std::vector<json_fact> list() const;

    /// All throw error (bad_input) for a value of another type.
    std::optional<double> number() const;
    std::optional<std::string> text() const;
    std::optional<bool> truth() const;
    /// What must be there.
    double need_number() const;
    int need_whole(int least, int most) const;
    std::string need_text() const;

    /// Any value in words: members of objects and lists with commas between; empty where it is not there.
    std::string words() const;

    [[noreturn]] void refuse(std::string_view why, std::string_view hint) const;

private:
    json_fact(const nlohmann::ordered_json* value, std::string file, std::string place)
        : value_(value), file_(std::move(file)), place_(std::move(place))
    {
    }

    const nlohmann::ordered_json* value_;
    std::string file_;
    std::string place_ = {};
};

/// \throws error (bad_input) for what is no JSON object, with the file's name.
nlohmann::ordered_json read_json(const std::filesystem::path& file, const std::string& text);

} // namespace tactor::study
