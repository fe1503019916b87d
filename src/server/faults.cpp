// SPDX-License-Identifier: MIT
#include "server/faults.hpp"

#include <algorithm>
#include <array>
#include <new>

#include <fmt/format.h>

#include "options/option.hpp"

namespace tactor::server {
namespace {

using net::rpc_fault;

std::string format_param(const options::option& o, std::string_view value)
{
    return fmt::format("options.{}{}{}", o.name, value.empty() ? "" : " ", value);
}

// Words for options that clients do not have, because they can neither fit strokes nor change the array.
constexpr std::array own_words{options::own_word{"fit=true", ""}, options::own_word{"array", "{}"},
                               options::own_word{"array=FILE", "an array"},
                               options::own_word{"config=FILE", "a configuration of the server"}};

constexpr options::spelling by_protocol{format_param, options::by_client, own_words};

} // namespace

void refuse_param(std::string what, std::string why, std::string hint)
{
    throw fault_error({net::code_bad_params, "bad-input", std::move(what), std::move(why), std::move(hint)});
}

void refuse_over_limit(std::string what, std::string why, std::string hint)
{
    throw fault_error({net::code_limit, "limit", std::move(what), std::move(why), std::move(hint)});
}

void refuse_too_many_strokes(std::size_t strokes, std::size_t most)
{
    refuse_over_limit(
        "max_strokes",
        fmt::format("there are {} strokes, but a client may have at most {} at once", strokes, most),
        "send fewer, raise max_strokes under [serve], or use the tool");
}

void refuse_unknown_stroke(std::uint32_t number, std::string why)
{
    throw fault_error({net::code_no_stroke, "no-stroke", "stroke", fmt::format("{}: {}", number, why), ""});
}

void refuse_without_stream(const std::string& why)
{
    throw fault_error({net::code_no_stream, "not-available", "stream", why, "try again when it is back"});
}

std::string spell_for_protocol(std::string_view marked)
{
    return options::spell(marked, by_protocol);
}

rpc_fault library_fault(const error& e, const std::string& source, const std::string& named)
{
    const error worded = options::spell(e, by_protocol);
    rpc_fault f{net::code_bad_params, std::string(to_string(e.kind())), source, std::string(worded.why()),
                std::string(worded.hint())};
    if (e.kind() == error_kind::runtime)
        f.code = net::code_internal;
    if (e.kind() == error_kind::not_available)
        f.code = net::code_no_stream;
    const std::string& text = named.empty() ? source : named;
    if (!text.empty() && e.place().file == text) {
        f.line = e.place().line;
        f.column = e.place().column;
        return f;
    }
    if (!e.place().file.empty())
        return f; // a file of the owner that the client does not know
    const options::option* o = options::find(e.field());
    if (o != nullptr && (o->where & options::by_client) != 0 && worded.subject() != text)
        f.what = format_param(*o, {});
    // Names that the library gives to a client's strokes.
    const std::array own{f.what,
                         text,
                         fmt::format("stroke \"{}\"", text),
                         std::string("stroke"),
                         std::string("live stroke"),
                         std::string("path data")};
    if (std::find(own.begin(), own.end(), worded.subject()) == own.end())
        f.why = fmt::format("{}: {}", worded.subject(), f.why);
    return f;
}

rpc_fault current_fault(const std::string& source, const std::string& named)
{
    try {
        throw;
    } catch (const fault_error& e) {
        return e.fault();
    } catch (const error& e) {
        return library_fault(e, source, named);
    } catch (const std::bad_alloc&) {
        return {net::code_limit, "limit", source, "there is not enough memory for it", "make it smaller"};
    } catch (const std::exception& e) {
        return {net::code_internal, "runtime", source, e.what(), ""};
    }
}

} // namespace tactor::server
