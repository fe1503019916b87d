// SPDX-License-Identifier: MIT
#include <string>
#include <string_view>
#include <variant>

#include <doctest/doctest.h>

#include "net/rpc.hpp"

namespace rpc_test {

using namespace tactor::net;

namespace {

int refusal_code(std::string_view text)
{
    const rpc_message m = parse_rpc(text, {});
    REQUIRE(m.parts.size() == 1);
    const auto* r = std::get_if<rpc_refusal>(&m.parts.front());
    return r == nullptr ? 0 : r->why.code;
}

} // namespace

TEST_CASE("requests, notifications and batches are told apart")
{
    const rpc_message one = parse_rpc(R"({"jsonrpc":"2.0","id":"a","method":"m","params":{"x":1}})", {});
    REQUIRE(one.parts.size() == 1);
    CHECK_FALSE(one.batch);
    const auto& r = std::get<rpc_request>(one.parts.front());
    CHECK(r.method == "m");
    CHECK(r.id == "a");
    CHECK(r.params["x"] == 1);
    CHECK(r.wants_reply);
    const rpc_message many = parse_rpc(R"([{"jsonrpc":"2.0","method":"m"},7])", {});
    CHECK(many.batch);
    REQUIRE(many.parts.size() == 2);
    CHECK_FALSE(std::get<rpc_request>(many.parts[0]).wants_reply);
    CHECK(std::get<rpc_refusal>(many.parts[1]).why.code == code_invalid_request);
    CHECK(parse_rpc(R"([{"jsonrpc":"2.0","method":"m"}])", {}).batch);
}

TEST_CASE("a bad request has the standard's code")
{
    for (const char* text : {"", "{", "nul", "\"\xff\"", "{\"a\":1,}", "[1] 2", "\xc0\x80"})
        CHECK_MESSAGE(refusal_code(text) == code_parse_error, text);
    for (const char* text :
         {"1", "null", "[]", "{}", R"({"jsonrpc":"2.0"})", R"({"jsonrpc":2.0,"method":"m"})",
          R"({"jsonrpc":"2.0","method":1})", R"({"jsonrpc":"2.0","method":"m","params":"p"})",
          R"({"jsonrpc":"2.0","method":"m","id":true})", R"({"jsonrpc":"2.0","method":"m","id":{}})"})
        CHECK_MESSAGE(refusal_code(text) == code_invalid_request, text);
    CHECK(refusal_code(R"({"jsonrpc":"2.0","method":"m","params":[1],"id":null})") == 0);
}

TEST_CASE("no parameters are the same in each form")
{
    for (const char* text :
         {R"({"jsonrpc":"2.0","method":"m"})", R"({"jsonrpc":"2.0","method":"m","params":{}})",
          R"({"jsonrpc":"2.0","method":"m","params":[]})",
          R"({"jsonrpc":"2.0","method":"m","params":null})"}) {
        CAPTURE(text);
        CHECK(std::get<rpc_request>(parse_rpc(text, {}).parts.front()).params == json::object());
    }
    for (const char* params : {"0", "false", "\"\"", "1"})
        CHECK(refusal_code(R"({"jsonrpc":"2.0","method":"m","params":)" + std::string(params) + "}") ==
              code_invalid_request);
}

TEST_CASE("a method that is accepted in any form is a request, whatever is beside its name")
{
    for (const char* rest :
         {"", R"(,"params":1)", R"(,"params":["x"],"id":5)", R"(,"jsonrpc":"1.0","params":{"x":[]},"id":5)",
          R"(,"id":{},"params":null)", R"(,"id":true)"}) {
        CAPTURE(rest);
        const std::string text = R"({"method":"halt")" + std::string(rest) + "}";
        const rpc_message m = parse_rpc(text, {.any_form = "halt"});
        const auto& r = std::get<rpc_request>(m.parts.front());
        CHECK(r.method == "halt");
        CHECK(r.params == json::object());
        CHECK(r.wants_reply == (text.find("id") != std::string::npos));
        CHECK(r.id == (text.find("5") != std::string::npos ? json(5) : json(nullptr)));
    }
    CHECK(refusal_code(R"({"method":""})") == code_invalid_request); // as without such a method
}

TEST_CASE("a message refused as a whole still reports a method that is accepted in any form")
{
    const auto acts = [](const std::string& text) {
        const rpc_message m = parse_rpc(text, {.batch = 3, .any_form = "halt"});
        CHECK(std::holds_alternative<rpc_refusal>(m.parts.front()));
        return m.refused_any_form;
    };
    const std::string deep = std::string(99, '[') + std::string(99, ']');
    CHECK(acts(R"([1,{"method":"x"},3,{"id":[1,{}],"method":"halt"}])"));
    CHECK_FALSE(acts(R"([1,{"method":"x"},3,{"params":{"method":"halt"}}])"));
    CHECK_FALSE(acts(R"([1,[{"method":"halt"}],3,4])"));
    CHECK_FALSE(acts(R"([1,"method","halt",{"x":"halt"}])"));
    CHECK(acts(R"([{"params":[1e400,-1e999,)" + deep + R"(]},{"method":"halt"}])"));
    CHECK_FALSE(acts(R"({"method":"x","params":{"x":)" + deep + R"(,"method":"halt"}})"));
    CHECK_FALSE(acts(R"({"method":["halt"],"params":)" + deep + "}"));
    CHECK_FALSE(parse_rpc("[1,2,3,4]", {.batch = 3}).refused_any_form);
    // Such a request is accepted also where it nests too deep.
    for (const std::string& text : {R"({"params":)" + deep + R"(,"id":7,"method":"halt"})",
                                    R"({"id":7,"method":"halt","params":{"x":)" + deep + "}}"}) {
        const rpc_message m = parse_rpc(text, {.any_form = "halt"});
        CHECK(std::get<rpc_request>(m.parts.front()).id == 7);
    }
}

TEST_CASE("a number that no double holds is no number, and its message is answered")
{
    const rpc_message m = parse_rpc(
        R"({"jsonrpc":"2.0","id":6,"method":"a\"1e400","params":{"x":1e400,"y":[-1E+400,1e-400],"z":"1e400","d":2}})",
        {});
    const auto& r = std::get<rpc_request>(m.parts.front());
    CHECK(r.id == 6);
    CHECK(r.method == "a\"1e400");
    CHECK(r.params["x"].is_null());
    CHECK(r.params["y"][0].is_null());
    CHECK(r.params["y"][1] == 0.0);
    CHECK(r.params["z"] == "1e400");
    CHECK(r.params["d"] == 2);
    CHECK(refusal_code("[1e400,") == code_parse_error);
    // Read once, whatever follows: twice as long takes twice as long.
    CHECK(refusal_code("[1e400," + std::string(1U << 20, 'e')) == code_parse_error);
}

TEST_CASE("nesting is counted outside of texts, and what is deeper is never built")
{
    const auto nested = [](std::size_t n) { return std::string(n, '['); };
    const auto closed = [&](std::size_t n) { return nested(n) + std::string(n, ']'); };
    CHECK(refusal_code(closed(65)) == code_limit);
    CHECK(refusal_code(closed(1'000'000)) == code_limit);
    CHECK(refusal_code(nested(1'000'000)) == code_limit);
    CHECK(refusal_code(nested(64)) == code_parse_error);
    CHECK(std::get<rpc_refusal>(parse_rpc(closed(65), {}).parts.front()).why.what == "max_nesting");
    CHECK(refusal_code(closed(64)) == code_invalid_request);
    const rpc_message m =
        parse_rpc(R"({"jsonrpc":"2.0","id":5,"method":"m","params":)" + closed(64) + "}", {});
    CHECK(std::get<rpc_refusal>(m.parts.front()).why.what == "max_nesting");
    CHECK(std::get<rpc_refusal>(m.parts.front()).id == 5);
    CHECK(refusal_code("\"" + nested(100) + "\\\"" + nested(100) + "\"") == code_invalid_request);
    std::string flat = "[";
    for (int i = 0; i < 1000; ++i)
        flat += "[],";
    CHECK(refusal_code(flat + "[]]") == code_limit); // a batch of 1001
    CHECK(refusal_code("[[[]]]") == code_invalid_request);
}

TEST_CASE("an error repeats at most 80 characters of a client's text")
{
    const std::string x(200, 'x');
    const std::string x80 = x.substr(0, 80) + "...";
    CHECK(cut_echo("there is no \"" + x + "\", sorry") == "there is no \"" + x80 + "\", sorry");
    CHECK(cut_echo("last read: '" + x + "'") == "last read: '" + x80 + "'");
    CHECK(cut_echo(x + " " + x) == x80 + " " + x80);
    std::string blanks;
    std::string umlauts;
    for (int i = 0; i < 1000; ++i)
        blanks += "a ", umlauts += "\xc3\xa4";
    CHECK(cut_echo('"' + blanks + '"') == '"' + blanks.substr(0, 80) + "...\"");
    CHECK(cut_echo(umlauts) == umlauts.substr(0, 160) + "...");
    CHECK(cut_echo(blanks) == blanks.substr(0, 1000) + "...");
    const std::string own =
        "one of algorithm, phantom, duration, speed, soa, burst, slope, intercept, timing, outside, \"snap\"";
    CHECK(cut_echo(own) == own);
    const rpc_fault f{code_bad_params, "bad-input", x, "no '" + x + "'", "not \"" + x + '"'};
    CHECK(json_line(error_reply(7, f)).size() < 1000);
    CHECK(fault_text(f) == x80 + ": no '" + x80 + "' (not \"" + x80 + "\")");
    CHECK(refusal_code(R"({"jsonrpc":"2.0","method":"m","id":")" + x + "\"}") == code_invalid_request);
    CHECK(refusal_code(R"({"jsonrpc":"2.0","method":"m","id":")" + x.substr(0, 80) + "\"}") == 0);
    CHECK(json_line(
              error_reply(nullptr,
                          std::get<rpc_refusal>(parse_rpc(std::string(1U << 20, 'x'), {}).parts.front()).why))
              .size() < 1000);
}

TEST_CASE("errors have kind, what, why and hint")
{
    const reply_json e = error_reply(7, {code_bad_params, "bad-input", "options.soa", "too long", "shorter"});
    CHECK(json_line(e) ==
          R"x({"jsonrpc":"2.0","id":7,"error":{"code":-32602,"message":"options.soa: too long (shorter)",)x"
          R"("data":{"kind":"bad-input","what":"options.soa","why":"too long","hint":"shorter"}}})");
    CHECK(json_line(result_reply(nullptr, reply_json::object())) ==
          R"({"jsonrpc":"2.0","id":null,"result":{}})");
    CHECK(json_line(notification("stroke", {{"stroke", 1}})) ==
          R"({"jsonrpc":"2.0","method":"stroke","params":{"stroke":1}})");
}

} // namespace rpc_test
