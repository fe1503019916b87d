// SPDX-License-Identifier: MIT
/// \file
/// JSON Schemas (draft 2020-12) of values. Each schema is generated from a description of the value's
/// members.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <initializer_list>
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

namespace tactor::files {

/// Generator of the schema of one object. The schema forbids other members.
class json_schema {
public:
    template <class T>
    void operator()(const char* name, const T&, const detail::about& what)
    {
        add<T>(name, what, true);
    }
    template <class T>
    void operator()(const char* name, const std::optional<T>&, const detail::about& what)
    {
        add<T>(name, what, false);
    }
    template <class T>
    void describe_or_null(const char* name, const std::optional<T>&, const detail::about& what)
    {
        add<std::optional<T>>(name, what, true);
    }
    template <class Kind>
    void describe_enum(const char* name, const std::string&, const detail::about& what)
    {
        add<Kind>(name, what, true);
    }
    void one_of(const char* name, std::string_view, std::initializer_list<const char*> all,
                const detail::about& what)
    {
        put(name, described({{"enum", all}}, what), true);
    }
    void one_of(const char* name, std::string_view, const std::vector<std::string_view>& all,
                const detail::about& what)
    {
        put(name, described({{"enum", all}}, what), true);
    }
    void constant(const char* name, std::string_view text) { put(name, {{"const", text}}, true); }
    template <class Make>
    void describe_derived(const char* name, const Make&, const detail::about& what)
    {
        (*this)(name, std::remove_cvref_t<std::invoke_result_t<Make>>{}, what);
    }
    template <class T, class Take>
    void describe_converted(const char* name, const T& v, const Take&, const detail::about& what)
    {
        (*this)(name, v, what);
    }
    template <class Body>
    void object(const char* name, const detail::about& what, const Body& body)
    {
        put(name, described(describe_object(body), what), true);
    }
    template <class T, class Each>
    void object_or_null(const char* name, const std::optional<T>&, const detail::about& what,
                        const Each& each)
    {
        const T v{};
        put(name, described(allow_null(describe_object([&](auto& io) { each(io, v); })), what), true);
    }
    template <class Body>
    void describe_if_present(const char* name, const bool&, const detail::about& what, const Body& body)
    {
        put(name, described(describe_object(body), what), false);
    }
    template <class T, class Each>
    void list(const char* name, const std::vector<T>&, const detail::about& what, const Each& each)
    {
        T one{};
        put(name, described(make_list(describe_object([&](auto& io) { each(io, one, 0); })), what), true);
    }
    template <class T, class Each>
    void named_objects(const char* name, const std::vector<T>&, const detail::about& what, const Each& each)
    {
        T one{};
        put(name, described(make_map(describe_object([&](auto& io) { each(io, one); })), what), true);
    }
    template <class T, class Each>
    void named_objects(const char* name, const std::vector<std::string>&, const std::vector<T>& all,
                       const detail::about& what, const Each& each)
    {
        named_objects(name, all, what, each);
    }
    template <class T, class ForEach, class Each>
    void rows(const char* name, const ForEach&, const detail::about& what, const Each& each)
    {
        T one{};
        put(name, described(make_list(describe_object([&](auto& io) { each(io, one); })), what), true);
    }
    /// Describes members that are present only if member `name` is null. Call it after describing the members
    /// that are always present.
    template <class Body>
    void describe_if_null(const char* name, bool, const Body& body)
    {
        condition_ = name;
        body(*this);
    }
    void require_exactly_one(const char* a, const char* b);
    void begin_new_line() const noexcept {}

    /// Returns the schema of an object. `body(io)` describes its members.
    template <class Body>
    static nlohmann::ordered_json describe_object(const Body& body)
    {
        json_schema io;
        body(io);
        return std::move(io).result();
    }
    /// Returns the schema of an object whose members have arbitrary names. Each member has the schema
    /// `values`.
    static nlohmann::ordered_json make_map(nlohmann::ordered_json values);
    /// Returns a schema that also allows null.
    static nlohmann::ordered_json allow_null(nlohmann::ordered_json schema);

private:
    template <class T>
    void add(const char* name, const detail::about& what, bool required)
    {
        put(name, described(kind(std::type_identity<T>{}, what.range), what), required);
    }
    void put(const char* name, nlohmann::ordered_json schema, bool required);
    nlohmann::ordered_json result() &&;
    static nlohmann::ordered_json described(nlohmann::ordered_json schema, const detail::about& what);
    static nlohmann::ordered_json make_list(nlohmann::ordered_json items);
    static nlohmann::ordered_json number(const char* type, const detail::bounds& range);

    template <class T>
    static nlohmann::ordered_json kind(std::type_identity<T>, const detail::bounds& range)
    {
        if constexpr (std::same_as<T, bool>) {
            return {{"type", "boolean"}};
        } else if constexpr (std::same_as<T, std::string>) {
            return {{"type", "string"}};
        } else if constexpr (std::integral<T>) {
            detail::bounds whole = range;
            if (std::is_unsigned_v<T> && !(whole.low > 0.0))
                whole.low = 0.0;
            return number("integer", whole);
        } else if constexpr (std::floating_point<T>) {
            return number("number", range);
        } else if constexpr (std::is_enum_v<T>) {
            return {{"enum", detail::kind_names<T>()}};
        } else {
            T v{};
            return describe_object([&v](auto& io) { members(io, v); });
        }
    }
    template <class T>
    static nlohmann::ordered_json kind(std::type_identity<std::optional<T>>, const detail::bounds& range)
    {
        return allow_null(kind(std::type_identity<T>{}, range));
    }
    template <class T>
    static nlohmann::ordered_json kind(std::type_identity<detail::nullable<T>>, const detail::bounds& range)
    {
        return allow_null(kind(std::type_identity<T>{}, range));
    }
    template <class T>
    static nlohmann::ordered_json kind(std::type_identity<detail::by_name<T>>, const detail::bounds& range)
    {
        return make_map(kind(std::type_identity<T>{}, range));
    }
    template <class... T>
    static nlohmann::ordered_json kind(std::type_identity<std::variant<T...>>, const detail::bounds& range)
    {
        return {{"anyOf", {kind(std::type_identity<T>{}, range)...}}};
    }
    template <class T>
    static nlohmann::ordered_json kind(std::type_identity<std::vector<T>>, const detail::bounds& range)
    {
        return make_list(kind(std::type_identity<T>{}, range));
    }
    template <class T, std::size_t Size>
    static nlohmann::ordered_json kind(std::type_identity<std::array<T, Size>>, const detail::bounds& range)
    {
        nlohmann::ordered_json j = make_list(kind(std::type_identity<T>{}, range));
        j["minItems"] = Size;
        j["maxItems"] = Size;
        return j;
    }

    nlohmann::ordered_json properties_ = nlohmann::ordered_json::object();
    nlohmann::ordered_json required_ = nlohmann::ordered_json::array();
    nlohmann::ordered_json one_of_ = {};
    nlohmann::ordered_json conditional_ = nlohmann::ordered_json::array();
    std::string condition_ = {}; ///< member that must be null if conditional members are present
};

} // namespace tactor::files
