// SPDX-License-Identifier: MIT
/// \file
/// Values from JSON, by their members; strict: each must be there, of its type and within its bounds, and no
/// other.
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

#include "core/members.hpp"
#include "files/json/json_value.hpp"

namespace tactor::files {

/// Reads the members of one object. All throw error (bad_input) with the file and the place.
class json_reader {
public:
    explicit json_reader(json_value object) : object_(std::move(object)) {}

    template <class T>
    void operator()(const char* name, T& v, const detail::about& what)
    {
        take(member(name), v, what);
    }
    template <class T>
    void or_null(const char* name, std::optional<T>& v, const detail::about& what)
    {
        take(member(name).need_member(), v, what);
    }
    template <class Kind>
    void named(const char* name, std::string& v, const detail::about& what)
    {
        (*this)(name, v, what);
    }
    void constant(const char* name, std::string_view text)
    {
        if (const json_value at = member(name); at.need_text() != text)
            at.refuse("is no \"" + std::string(text) + '"');
    }
    template <class Make>
    void fact(const char* name, const Make&, const detail::about& what)
    {
        std::remove_cvref_t<std::invoke_result_t<Make>> unused{};
        (*this)(name, unused, what);
    }
    template <class T, class Take>
    void with(const char* name, T v, const Take& take_it, const detail::about& what)
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
    void part(const char* name, bool& there, const detail::about& what, const Body& body)
    {
        there = member(name).there();
        if (there)
            object(name, what, body);
    }
    template <class T, class Each>
    void list(const char* name, std::vector<T>& all, const detail::about&, const Each& each)
    {
        for (const json_value& one : member(name).need_list())
            read(one, [&](auto& io) { each(io, all.emplace_back(), all.size() - 1); });
    }
    /// Its rows are taken as they are parsed, and are not there any more.
    template <class T, class ForEach, class Each>
    void rows(const char* name, const ForEach&, const detail::about&, const Each&)
    {
        static_cast<void>(member(name).need_list());
    }
    void exactly_one(const char* a, const char* b) const
    {
        if (object_[a].there() == object_[b].there())
            object_.refuse(std::string("has not exactly one of ") + a + " and " + b);
    }
    void new_line() const noexcept {}

    /// \throws error (bad_input) for a member that nobody asked for.
    void finish() const;

    /// Reads an object whose members are described by `body(io)`.
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
            v = number(from, what.range);
        else if constexpr (std::is_enum_v<T>)
            v = from.need_kind<T>();
        else
            read(from, [&v](auto& io) { members(io, v); });
    }
    static void take(const json_value& from, std::string& v, const detail::about&) { v = from.need_text(); }
    template <class T>
    static void take(const json_value& from, std::optional<T>& v, const detail::about& what)
    {
        if (from.there())
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
        const std::vector<json_value> given = from.need_list();
        if (given.size() != Size)
            from.refuse("is no list of " + std::to_string(Size) + " numbers");
        for (std::size_t i = 0; i < Size; ++i)
            take(given[i], all[i], what);
    }
    static double number(const json_value& from, const detail::bounds& range);
    static double whole(const json_value& from, const detail::bounds& range, bool is_unsigned, bool is_long);

    json_value object_;
    std::vector<std::string_view> known_;
};

} // namespace tactor::files
