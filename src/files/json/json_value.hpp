// SPDX-License-Identifier: MIT
/// \file
/// Values of JSON files. A value knows its place in the file, such as bursts[3].onset_s, for messages.
/// Objects are read member by member.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/kind_names.hpp"
#include "core/members.hpp"
#include "files/json/writer.hpp"

namespace tactor::files {

/// Parses a text, which must be an object. \throws error (bad_input) with the file's name and the line.
nlohmann::ordered_json read_object(const std::string& text, const std::string& file);
/// Parses a file that another program wrote. The text must be an object. Byte order mark, comments, and
/// commas after the last element are ignored. With `json5`, names may lack quotes, and texts may be in single
/// quotes.
/// \throws error (bad_input) as read_object() does, and for more than 64 nested values.
nlohmann::ordered_json read_foreign_object(std::string_view text, const std::string& file,
                                           bool json5 = false);

/// A value that may be missing; null counts as missing. The document and the file's name must outlive this
/// object. All members except exists(), is_list() and is_text() throw error (bad_input) for a value of
/// another type. The members need_... also throw it for a missing value.
class json_value {
public:
    /// Constructs the value of a document. `hint` ends each message about the value.
    json_value(const nlohmann::ordered_json& document, const std::string& file, const char* hint,
               std::string place = {})
        : json_value(&document, file, hint, std::move(place))
    {
    }
    json_value(const nlohmann::ordered_json&, std::string&&, const char*, std::string = {}) = delete;

    bool exists() const noexcept { return value_ != nullptr && !value_->is_null(); }
    /// Returns the name of the file.
    const std::string& file() const noexcept { return *file_; }
    bool is_list() const noexcept { return exists() && value_->is_array(); }
    bool is_text() const noexcept { return exists() && value_->is_string(); }
    /// Returns the names of an object's members.
    std::vector<std::string> keys() const;

    /// Returns a member of an object. The result is missing if this value or the member is missing.
    json_value operator[](const std::string& key) const;
    /// Returns this value if the file contains it, even as null.
    /// \throws error (bad_input) if it is missing.
    const json_value& need_member() const;
    /// Returns the elements of a list. Returns none if the value is missing.
    std::vector<json_value> list() const;

    std::optional<double> number() const;
    std::optional<std::string> text() const;
    std::optional<bool> truth() const;

    double need_number() const { return need(number()); }
    /// Returns a number within bounds. With `texts`, a text that contains a number counts as this number.
    double need_number(const detail::bounds& range, bool texts = false) const;
    std::string need_text() const { return need(text()); }
    bool need_truth() const { return need(truth()); }
    /// Reads the name of an enumeration's value, and returns the value.
    template <class Kind>
    Kind need_kind() const
    {
        const std::string name = need_text();
        const std::optional<Kind> k = detail::find_kind<Kind>(name);
        if (!k)
            refuse("\"" + name + "\" is unknown");
        return *k;
    }
    std::vector<json_value> need_list() const;
    std::vector<double> need_numbers() const;
    /// Checks that this is an object.
    /// \throws error (bad_input).
    void need_members() const;

    /// Returns a description of any value. The parts of objects and lists are separated by commas. Returns ""
    /// for a missing value.
    std::string words() const;

    /// Throws error (bad_input) with the file and the place. If `hint` is empty, the error has the hint of
    /// the document.
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
            need_member().refuse("it is null");
        return *std::move(v);
    }

    const nlohmann::ordered_json* value_;
    const std::string* file_;
    const char* hint_;
    std::string place_;
};

/// Strict reader of the members of one object. Each member must be present, have the right type and be within
/// its bounds. Other members are not allowed. All functions throw error (bad_input) with the file and the
/// place.
class json_reader {
public:
    explicit json_reader(json_value object) : object_(std::move(object)) {}

    template <class T>
    void operator()(const char* name, T& v, const detail::about& what)
    {
        take(member(name), v, what);
    }
    template <class T>
    void describe_or_null(const char* name, std::optional<T>& v, const detail::about& what)
    {
        take(member(name).need_member(), v, what);
    }
    template <class Kind>
    void describe_enum(const char* name, std::string& v, const detail::about& what)
    {
        (*this)(name, v, what);
    }
    void constant(const char* name, std::string_view text)
    {
        if (const json_value at = member(name); at.need_text() != text)
            at.refuse("it is not a \"" + std::string(text) + '"');
    }
    template <class Make>
    void describe_derived(const char* name, const Make&, const detail::about& what)
    {
        std::remove_cvref_t<std::invoke_result_t<Make>> unused{};
        (*this)(name, unused, what);
    }
    template <class T, class Take>
    void describe_converted(const char* name, T v, const Take& take_it, const detail::about& what)
    {
        v = T{};
        (*this)(name, v, what);
        take_it(v);
    }
    template <class Body>
    void object(const char* name, const detail::about&, const Body& body)
    {
        read(member(name), body);
    }
    template <class Body>
    void describe_if_present(const char* name, bool& exists, const detail::about& what, const Body& body)
    {
        exists = member(name).exists();
        if (exists)
            object(name, what, body);
    }
    template <class T, class Each>
    void list(const char* name, std::vector<T>& all, const detail::about&, const Each& each)
    {
        for (const json_value& one : member(name).need_list())
            read(one, [&](auto& io) { each(io, all.emplace_back(), all.size() - 1); });
    }
    /// Checks a list whose rows the parser has already removed from the document.
    template <class T, class ForEach, class Each>
    void rows(const char* name, const ForEach&, const detail::about&, const Each&)
    {
        static_cast<void>(member(name).need_list());
    }
    void require_exactly_one(const char* a, const char* b) const
    {
        if (object_[a].exists() == object_[b].exists())
            object_.refuse(std::string("it must have exactly one of ") + a + " and " + b);
    }
    void begin_new_line() const noexcept {}

    /// Checks that all members of the object have been read.
    /// \throws error (bad_input) for a member that was not read.
    void finish() const;

    /// Reads an object. `body(io)` describes its members.
    template <class Body>
    static void read(const json_value& from, const Body& body)
    {
        from.need_members();
        json_reader io(from);
        body(io);
        io.finish();
    }

private:
    json_value member(const char* name)
    {
        known_.emplace_back(name);
        return object_[name];
    }
    template <class T>
    static void take(const json_value& from, T& v, const detail::about& what)
    {
        if constexpr (std::same_as<T, bool>)
            v = from.need_truth();
        else if constexpr (std::integral<T>)
            v = static_cast<T>(whole(from, what.range, std::is_unsigned_v<T>, sizeof(T) > sizeof(unsigned)));
        else if constexpr (std::floating_point<T>)
            v = from.need_number(what.range);
        else if constexpr (std::is_enum_v<T>)
            v = from.need_kind<T>();
        else
            read(from, [&v](auto& io) { members(io, v); });
    }
    static void take(const json_value& from, std::string& v, const detail::about&) { v = from.need_text(); }
    template <class T>
    static void take(const json_value& from, std::optional<T>& v, const detail::about& what)
    {
        if (from.exists())
            take(from, v.emplace(), what);
    }
    template <class T>
    static void take(const json_value& from, detail::nullable<T>& v, const detail::about& what)
    {
        take(from.need_member(), v.value, what);
    }
    template <class T, class List>
    static void take(const json_value& from, std::variant<T, List>& v, const detail::about& what)
    {
        if (from.is_list())
            take(from, v.template emplace<List>(), what);
        else
            take(from, v.template emplace<T>(), what);
    }
    template <class T>
    static void take(const json_value& from, std::vector<T>& all, const detail::about& what)
    {
        for (const json_value& one : from.need_list())
            take(one, all.emplace_back(), what);
    }
    template <class T, std::size_t Size>
    static void take(const json_value& from, std::array<T, Size>& all, const detail::about& what)
    {
        const std::vector<json_value> items = from.need_list();
        if (items.size() != Size)
            from.refuse("it is not a list of " + std::to_string(Size) + " numbers");
        for (std::size_t i = 0; i < Size; ++i)
            take(items[i], all[i], what);
    }
    static double whole(const json_value& from, const detail::bounds& range, bool is_unsigned, bool is_long);

    json_value object_;
    std::vector<std::string_view> known_;
};

template <class T>
nlohmann::ordered_json or_null(const std::optional<T>& v)
{
    return v ? nlohmann::ordered_json(*v) : nlohmann::ordered_json(nullptr);
}

/// Returns a text as a document, or null if the text is empty.
inline nlohmann::ordered_json or_null(const std::string& s)
{
    return s.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(s);
}

/// Returns a document with one object. `body(io)` describes its members.
template <class Body>
nlohmann::ordered_json make_object(const Body& body)
{
    std::string text = "{";
    json_writer io(text);
    body(io);
    return nlohmann::ordered_json::parse(text + '}');
}

/// Converts a value to a document.
template <class T>
nlohmann::ordered_json make_document(const T& v)
{
    std::string text;
    json_writer(text).put(v);
    return nlohmann::ordered_json::parse(text);
}

} // namespace tactor::files
