// SPDX-License-Identifier: MIT
/// \file
/// Writers of values as JSON text. A description of a value's members determines the text.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/members.hpp"

namespace tactor::files {

/// Function that receives the next part of a text. An exception from this function stops the writing.
using text_sink = std::function<void(std::string_view)>;

/// Appends a number in the format of nlohmann-json, which writes 1.0 rather than 1. Appends null if the
/// number is not finite.
void append_number(std::string& out, double v);
/// Appends a text in quotes. Bytes that are not UTF-8 become U+FFFD.
void append_text(std::string& out, std::string_view text);

/// Writer of an object's members, which does not build a document.
class json_writer {
public:
    /// Constructs a writer that appends to `out`. After each row, `sink`, if not null, receives the text of
    /// `out`, which is then cleared. Both must outlive this object.
    explicit json_writer(std::string& out, const text_sink* sink = nullptr) : out_(out), sink_(sink) {}

    template <class T>
    void operator()(const char* name, const T& v, const detail::about&)
    {
        begin(name);
        put(v);
    }
    template <class T>
    void operator()(const char* name, const std::optional<T>& v, const detail::about& what)
    {
        if (v)
            (*this)(name, *v, what);
    }
    template <class T>
    void describe_or_null(const char* name, const std::optional<T>& v, const detail::about&)
    {
        begin(name);
        put(v);
    }
    /// Writes a text that is usually the name of an enumeration's value.
    template <class Kind>
    void describe_enum(const char* name, const std::string& v, const detail::about& what)
    {
        (*this)(name, v, what);
    }
    /// Writes a text that is one of a list of texts.
    void one_of(const char* name, std::string_view text, std::initializer_list<const char*>,
                const detail::about&)
    {
        constant(name, text);
    }
    void one_of(const char* name, std::string_view text, const std::vector<std::string_view>&,
                const detail::about&)
    {
        constant(name, text);
    }
    void constant(const char* name, std::string_view text)
    {
        begin(name);
        append_text(out_, text);
    }
    /// Writes a value that is derived from other members, or that readers ignore.
    template <class Make>
    void describe_derived(const char* name, const Make& make, const detail::about& what)
    {
        (*this)(name, make(), what);
    }
    /// Writes `v` as the member; ignores the third argument.
    template <class T, class Take>
    void describe_converted(const char* name, const T& v, const Take&, const detail::about& what)
    {
        (*this)(name, v, what);
    }
    /// Writes an object. `body(io)` describes its members.
    template <class Body>
    void object(const char* name, const detail::about&, const Body& body)
    {
        begin(name);
        braces(body);
    }
    /// Writes a value as an object, or null if there is no value. each(io, value) describes the object.
    template <class T, class Each>
    void object_or_null(const char* name, const std::optional<T>& v, const detail::about&, const Each& each)
    {
        begin(name);
        if (v)
            braces([&](auto& io) { each(io, *v); });
        else
            out_ += "null";
    }
    template <class Body>
    void describe_if_present(const char* name, const bool& exists, const detail::about& what,
                             const Body& body)
    {
        if (exists)
            object(name, what, body);
    }
    /// Writes a list of objects. each(io, value, index) describes an object.
    template <class T, class Each>
    void list(const char* name, const std::vector<T>& all, const detail::about&, const Each& each)
    {
        begin(name);
        out_ += '[';
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (i > 0)
                out_ += ',';
            braces([&](auto& io) { each(io, all[i], i); });
        }
        out_ += ']';
    }
    /// Writes values as objects that are members of one object. Their names are the keys, and each(io, value)
    /// describes an object.
    template <class T, class Each>
    void named_objects(const char* name, const std::vector<T>& all, const detail::about& what,
                       const Each& each)
    {
        std::vector<std::string> names;
        for (const T& v : all)
            names.push_back(v.name);
        named_objects(name, names, all, what, each);
    }
    template <class T, class Each>
    void named_objects(const char* name, const std::vector<std::string>& names, const std::vector<T>& all,
                       const detail::about&, const Each& each)
    {
        begin(name);
        out_ += '{';
        for (std::size_t i = 0; i < all.size(); ++i) {
            begin_member(names[i], i == 0);
            braces([&](auto& io) { each(io, all[i]); });
        }
        out_ += '}';
    }
    /// Writes a list of up to half a million elements, with each on a line. for_each(row) calls row(value)
    /// for each element.
    template <class T, class ForEach, class Each>
    void rows(const char* name, const ForEach& for_each, const detail::about&, const Each& each)
    {
        begin(name);
        out_ += '[';
        bool first = true;
        for_each([&](const T& v) {
            out_ += std::exchange(first, false) ? "\n  " : ",\n  ";
            braces([&](auto& io) { each(io, v); });
            if (sink_ == nullptr)
                return;
            (*sink_)(out_);
            out_.clear();
        });
        out_ += ']';
    }
    /// Writes members that are present only if another member is null.
    template <class Body>
    void describe_if_null(const char*, bool is_null, const Body& body)
    {
        if (is_null)
            body(*this);
    }
    /// Declares that exactly one of two members is present.
    void require_exactly_one(const char*, const char*) const noexcept {}
    /// Puts the next member on a new line.
    void begin_new_line() { next_line_ = true; }

    template <class T>
    void put(const T& v)
    {
        if constexpr (std::same_as<T, bool>)
            out_ += v ? "true" : "false";
        else if constexpr (std::integral<T>)
            out_ += std::to_string(v);
        else if constexpr (std::floating_point<T>)
            append_number(out_, v);
        else if constexpr (std::is_enum_v<T>)
            append_text(out_, to_string(v));
        else if constexpr (std::same_as<T, std::string>)
            append_text(out_, v);
        else
            braces([&v](auto& io) { members(io, v); });
    }
    template <class T>
    void put(const std::optional<T>& v)
    {
        if (v)
            put(*v);
        else
            out_ += "null";
    }
    template <class T>
    void put(const detail::nullable<T>& v)
    {
        put(v.value);
    }
    template <class... T>
    void put(const std::variant<T...>& v)
    {
        std::visit([this](const auto& one) { this->put(one); }, v);
    }
    template <class T>
    void put(const detail::by_name<T>& v)
    {
        out_ += '{';
        for (std::size_t i = 0; i < v.all.size(); ++i) {
            begin_member(v.all[i].first, i == 0);
            put(v.all[i].second);
        }
        out_ += '}';
    }
    template <class T>
    void put(const std::vector<T>& all)
    {
        brackets(all);
    }
    template <class T, std::size_t Size>
    void put(const std::array<T, Size>& all)
    {
        brackets(all);
    }

private:
    void begin(const char* name);
    void begin_member(std::string_view name, bool first)
    {
        out_ += first ? "" : ",";
        append_text(out_, name);
        out_ += ':';
    }
    template <class Body>
    void braces(const Body& body)
    {
        out_ += '{';
        json_writer inner(out_, sink_);
        body(inner);
        out_ += '}';
    }
    template <class All>
    void brackets(const All& all)
    {
        out_ += '[';
        bool first = true;
        for (const auto& v : all) {
            if (!std::exchange(first, false))
                out_ += ',';
            put(v);
        }
        out_ += ']';
    }

    std::string& out_;
    const text_sink* sink_;
    bool first_ = true;
    bool next_line_ = false;
};

} // namespace tactor::files
