// SPDX-License-Identifier: MIT
#include "net/rpc.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <boost/beast/core/detail/base64.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::net {
namespace {

namespace base64 = boost::beast::detail::base64;

constexpr std::size_t most_id_bytes = 80;

// Replaces numbers that are too large for a double by null. A parameter that is null is also wrong, but the
// message then has an id for the error reply.
std::string replace_overflows(std::string_view text)
{
    std::string out;
    out.reserve(text.size());
    bool quoted = false;
    for (std::size_t i = 0; i < text.size();) {
        if (!quoted && (text[i] == '-' || (text[i] >= '0' && text[i] <= '9'))) {
            const std::size_t end = std::min(text.find_first_not_of("+-.0123456789eE", i), text.size());
            const std::string number(text.substr(i, end - i));
            out += std::isfinite(std::strtod(number.c_str(), nullptr)) ? number : "null";
            i = end;
            continue;
        }
        if (quoted && text[i] == '\\' && i + 1 < text.size())
            out += text[i++];
        else if (text[i] == '"')
            quoted = !quoted;
        out += text[i++];
    }
    return out;
}

struct parsed_text {
    json value;
    bool too_deep = false; ///< true if null replaced parts that are nested too deeply
};

// Returns the text with null in place of each value that is nested too deeply; nothing without such a value.
// The parser's callback could drop them, too, but takes time that is quadratic in the members of an array.
std::optional<std::string> cut_nesting(std::string_view text, std::size_t most_nesting)
{
    std::string out;
    std::size_t depth = 0;
    std::size_t from = 0; // of the part that is not yet in `out`
    bool cut = false;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"')
            quoted = !quoted;
        else if (quoted)
            i += c == '\\' ? 1 : 0;
        else if ((c == '[' || c == '{') && depth++ == most_nesting) {
            out.append(text.substr(from, i - from)).append("null");
            cut = true;
        } else if ((c == ']' || c == '}') && depth > 0 && --depth == most_nesting)
            from = i + 1;
    }
    if (!cut)
        return {};
    if (depth <= most_nesting)
        out.append(text.substr(from));
    return out;
}

// Parses a text. Throws json::exception, but sets too_deep even then.
void parse(parsed_text& p, std::string_view text, std::size_t most_nesting)
{
    constexpr int number_overflow = 406;
    const std::optional<std::string> shallow = cut_nesting(text, most_nesting);
    p.too_deep = shallow.has_value();
    if (shallow)
        text = *shallow;
    try {
        p.value = json::parse(text);
    } catch (const json::out_of_range& e) {
        if (e.id != number_overflow)
            throw;
        p.value = json::parse(replace_overflows(text));
    }
}

rpc_refusal invalid(json id, std::string why)
{
    return {{code_invalid_request, "bad-input", "request", std::move(why),
             R"(send an object such as {"jsonrpc":"2.0","id":1,"method":"status"})"},
            std::move(id)};
}

bool is_stop(const json& j)
{
    const auto method = j.find("method"); // end() if j is not an object
    return method != j.end() && *method == "stop";
}

std::variant<rpc_request, rpc_refusal> read_request(json& j)
{
    if (!j.is_object())
        return invalid(nullptr, "it is not an object");
    rpc_request r;
    const auto id = j.find("id");
    r.wants_reply = id != j.end();
    // A reply repeats the id, so a text as id must be short.
    const bool text =
        r.wants_reply && id->is_string() && id->get_ref<const std::string&>().size() <= most_id_bytes;
    const bool usable = text || (r.wants_reply && (id->is_number() || id->is_null()));
    if (usable)
        r.id = *id;
    if (is_stop(j)) {
        r.method = "stop";
        return r;
    }
    if (r.wants_reply && !usable)
        return invalid(nullptr, id->is_string() ? "its id is longer than 80 bytes"
                                                : "its id is neither a text nor a number");
    if (const auto version = j.find("jsonrpc"); version == j.end() || *version != "2.0")
        return invalid(r.id, R"(its "jsonrpc" is not "2.0")");
    const auto method = j.find("method");
    if (method == j.end() || !method->is_string())
        return invalid(r.id, R"(its "method" is not a text)");
    r.method = method->get<std::string>();
    const auto params = j.find("params");
    if (params == j.end() || params->empty()) // null also counts as empty
        return r;
    if (!params->is_structured())
        return invalid(r.id, R"(its "params" are not an object)");
    r.params = std::move(*params);
    return r;
}

rpc_message alone(rpc_refusal r)
{
    rpc_message m;
    m.parts.emplace_back(std::move(r));
    return m;
}

rpc_refusal over(std::string what, std::string why, std::string hint)
{
    return {{code_limit, "limit", std::move(what), std::move(why), std::move(hint)}, nullptr};
}

// Refuses a complete batch.
rpc_message refused(rpc_refusal why, const json& batch)
{
    rpc_message m = alone(std::move(why));
    m.has_stop = std::any_of(batch.begin(), batch.end(), is_stop);
    return m;
}

} // namespace

std::optional<json> parse_json(std::string_view text, std::size_t most_nesting)
{
    parsed_text p;
    try {
        parse(p, text, most_nesting);
    } catch (const json::exception&) {
        return {};
    }
    return p.too_deep ? std::nullopt : std::optional(std::move(p.value));
}

rpc_message parse_rpc(std::string_view text, std::size_t most_nesting)
{
    const auto too_deep = [&] {
        return over("max_nesting", fmt::format("a message nests deeper than {} levels", most_nesting), "");
    };
    parsed_text p;
    try {
        parse(p, text, most_nesting);
    } catch (const json::exception& e) {
        if (p.too_deep)
            return alone(too_deep());
        // Remove the name and number of the error in the library.
        std::string_view why = e.what();
        why.remove_prefix(std::min(why.find("] ") + 2, why.size()));
        std::string plain;
        for (const char c : truncate_echo(why))
            plain += static_cast<unsigned char>(c) < 0x80U ? c : '?';
        return alone(
            {{code_parse_error, "bad-input", "message", plain, "send one JSON value on each line, in UTF-8"},
             nullptr});
    }
    json& j = p.value;
    rpc_message m;
    if (!j.is_array()) {
        auto part = read_request(j);
        if (const auto* r = std::get_if<rpc_request>(&part); p.too_deep && !is_stop(j))
            part = rpc_refusal{too_deep().why, r != nullptr ? r->id : nullptr};
        m.parts.push_back(std::move(part));
        return m;
    }
    if (j.empty())
        return alone(p.too_deep ? too_deep() : invalid(nullptr, "the batch is empty"));
    if (j.size() > most_requests)
        return refused(
            over("batch",
                 fmt::format("it has {} requests, but at most {} are allowed", j.size(), most_requests),
                 "send several batches"),
            j);
    if (p.too_deep)
        return refused(too_deep(), j);
    m.batch = true;
    for (json& one : j)
        m.parts.push_back(read_request(one));
    return m;
}

reply_json result_reply(const json& id, reply_json result)
{
    return {{"jsonrpc", "2.0"}, {"id", id}, {"result", std::move(result)}};
}

std::string truncate_echo(std::string_view text)
{
    constexpr std::size_t most_echoed = 80; // greatest number of characters of a word that are repeated
    constexpr std::size_t most = 1000;
    std::string out;
    std::size_t run = 0; // characters since the last blank, or since the opening quote
    char quote = '\0';
    for (std::size_t i = 0; i < text.size() && out.size() < most; ++i) {
        const char c = text[i];
        const bool continues = (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; // inside a UTF-8 sequence
        if (c == quote || (quote == '\0' && c == ' '))
            run = 0;
        else if (!continues)
            ++run;
        if (quote == '\0' && run == 1 && (c == '"' || c == '\''))
            quote = c, run = 0;
        else if (c == quote)
            quote = '\0';
        if (run <= most_echoed)
            out += c;
        else if (run == most_echoed + 1 && !continues)
            out += "...";
    }
    if (out.size() >= most)
        out += "...";
    return out;
}

std::string fault_text(const rpc_fault& f)
{
    const std::string what = source_place{truncate_echo(f.what), f.line, f.column}.text();
    const std::string why = truncate_echo(f.why);
    return f.hint.empty() ? fmt::format("{}: {}", what, why)
                          : fmt::format("{}: {} ({})", what, why, truncate_echo(f.hint));
}

reply_json error_reply(const json& id, const rpc_fault& f)
{
    reply_json data{{"kind", f.kind},
                    {"what", truncate_echo(f.what)},
                    {"why", truncate_echo(f.why)},
                    {"hint", truncate_echo(f.hint)}};
    for (const auto& [name, number] : {std::pair("line", f.line), std::pair("column", f.column)})
        if (number != 0)
            data[name] = number;
    return {{"jsonrpc", "2.0"},
            {"id", id},
            {"error", {{"code", f.code}, {"message", fault_text(f)}, {"data", std::move(data)}}}};
}

reply_json notification(std::string_view method, reply_json params)
{
    return {{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(params)}};
}

std::string json_line(const reply_json& j)
{
    return j.dump(-1, ' ', false, reply_json::error_handler_t::replace);
}

void append_base64(std::string& to, std::string_view bytes)
{
    const std::size_t before = to.size();
    to.resize(before + base64::encoded_size(bytes.size()));
    base64::encode(to.data() + before, bytes.data(), bytes.size());
}

std::optional<std::string> decode_base64(std::string_view text)
{
    if (text.size() % 4 != 0) // Beast would write past the end of the buffer
        return std::nullopt;
    std::string bytes(base64::decoded_size(text.size()), '\0');
    bytes.resize(base64::decode(bytes.data(), text.data(), text.size()).first);
    // Beast stops at the first character that is not base64, and ignores left-over bits. Compare with the
    // text to detect both.
    std::string again;
    append_base64(again, bytes);
    return again == text ? std::optional(std::move(bytes)) : std::nullopt;
}

} // namespace tactor::net
