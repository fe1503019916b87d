// SPDX-License-Identifier: MIT
#include <string>
#include <string_view>
#include <utility>

#include <doctest/doctest.h>

#include "net/base64.hpp"

namespace base64_test {

using namespace tactor::net;

TEST_CASE("bytes become base64 and come back, as RFC 4648 says")
{
    for (const auto& [bytes, text] : {std::pair<std::string_view, std::string_view>{"", ""},
                                      {"f", "Zg=="},
                                      {"fo", "Zm8="},
                                      {"foo", "Zm9v"},
                                      {"foob", "Zm9vYg=="},
                                      {"fooba", "Zm9vYmE="},
                                      {"foobar", "Zm9vYmFy"}}) {
        std::string made = "x";
        append_base64(made, bytes);
        CHECK(made == "x" + std::string(text));
        CHECK(made.size() == 1 + base64_size(bytes.size()));
        CHECK(read_base64(text) == bytes);
    }
    std::string all;
    for (int i = 0; i < 256; ++i)
        all += static_cast<char>(i);
    std::string made;
    append_base64(made, all);
    CHECK(read_base64(made) == all);
}

TEST_CASE("other texts are no base64")
{
    for (const char* text :
         {"Z", "Zg", "Zg=", "Zg==\n", "Z===", "====", "Zm9v!A==", "Zm-v", "Zh==", "Zm9=", "Zg==Zg=="})
        CHECK_FALSE(read_base64(text));
}

} // namespace base64_test
