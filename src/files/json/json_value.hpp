// SPDX-License-Identifier: MIT
/// \file
/// A value of a JSON file with its place there, such as bursts[3].onset_s, for what is refused.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/kind_names.hpp"
#include "files/json/writer.hpp"

namespace tactor::files {

/// Reads a text that is one object. \throws error (bad_input) with the file's name and the line.
nlohmann::ordered_json read_object(const std::string& text, const std::string& file);

/// A value that may not be there: null is not there either. It refers to the document and to the file's name,
/// which must outlive it. All but there() and is_list() throw error (bad_input) for a value of another type,
/// and what begins with need_ for one that is not there.
class json_value {
public:
    /// `hint` ends what is refused.
    json_value(const nlohmann::ordered_json& document, const std::string& file, const char* hint,
               std::string place = {})
        : json_value(&document, file, hint, std::move(place))
    {
    }
    json_value(const nlohmann::ordered_json&, std::string&&, const char*, std::string = {}) = delete;

    bool there() const noexcept { return value_ != nullptr && !value_->is_null(); }
    /// Returns the name of the file.
    const std::string& file() const noexcept { return *file_; }
    bool is_list() const noexcept { return there() && value_->is_array(); }
    /// Returns the names of an object's members.
    std::vector<std::string> keys() const;

    /// A member of an object; not there where this is not.
    json_value operator[](const std::string& key) const;
    /// This value, where its object has it; it may be null. \throws error (bad_input).
    const json_value& need_member() const;
    /// Returns the members of a list; none where it is not there.
    std::vector<json_value> list() const;

    std::optional<double> number() const;
    std::optional<std::string> text() const;
    std::optional<bool> truth() const;

    double need_number() const { return need(number()); }
    std::string need_text() const { return need(text()); }
    bool need_truth() const { return need(truth()); }
    /// Returns a value of a closed set, by its name.
    template <class Kind>
    Kind need_kind() const
    {
        const std::string name = need_text();
        const std::optional<Kind> k = detail::find_kind<Kind>(name);
        if (!k)
            refuse("is \"" + name + "\", which is not known");
        return *k;
    }
    std::vector<json_value> need_list() const;
    std::vector<double> need_numbers() const;
    /// \throws error (bad_input) for what is no object.
    void need_members() const;

    /// Returns any value in words: members of objects and lists with commas between; empty where it is not
    /// there.
    std::string words() const;

    /// \throws error (bad_input) with file and place. An empty hint is that of the file.
    [[noreturn]] void refuse(std::string_view why, std::string_view hint = {}) const;

private:
    json_value(const nlohmann::ordered_json* value, const std::string& file, const char* hint,
               std::string place)
        : value_(value), file_(&file), hint_(hint), place_(std::move(place))
    {
    }

    template <class T>
    std::optional<T> get(bool (nlohmann::ordered_json::*is_one)() const noexcept, std::string_view why) const;
    template <class T>
    T need(std::optional<T> v) const
    {
        if (!v)
            need_member().refuse("is null");
        return *std::move(v);
    }

    const nlohmann::ordered_json* value_;
    const std::string* file_;
    const char* hint_;
    std::string place_;
};

template <class T>
nlohmann::ordered_json or_null(const std::optional<T>& v)
{
    return v ? nlohmann::ordered_json(*v) : nlohmann::ordered_json(nullptr);
}

/// Returns null for an empty text.
inline nlohmann::ordered_json or_null(const std::string& s)
{
    return s.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(s);
}

/// Returns an object whose members are described by `body(io)`.
template <class Body>
nlohmann::ordered_json make_object(const Body& body)
{
    std::string text = "{";
    json_writer io(text);
    body(io);
    return nlohmann::ordered_json::parse(text + '}');
}

/// Returns a value as a document.
template <class T>
nlohmann::ordered_json make_document(const T& v)
{
    std::string text;
    json_writer(text).put(v);
    return nlohmann::ordered_json::parse(text);
}

} // namespace tactor::files
