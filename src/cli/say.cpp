// SPDX-License-Identifier: MIT
#include "cli/say.hpp"

namespace tactor::cli {
namespace {

// Of UTF-8, the C1 controls are C2 80 to C2 9F.
bool starts_c1(std::string_view s, std::size_t at)
{
    return s[at] == '\xC2' && at + 1 < s.size() && (static_cast<unsigned char>(s[at + 1]) & 0xE0U) == 0x80U;
}

std::string escaped(std::string_view text, bool lines)
{
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        if (c == '\n')
            out += lines ? "\n" : "\\n";
        else if (c < 0x20U || c == 0x7FU)
            out += fmt::format("\\x{:02x}", c);
        else if (starts_c1(text, i))
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[++i]));
        else
            out += text[i];
    }
    return out;
}

} // namespace

std::string shown(std::string_view name)
{
    return escaped(name, false);
}

void say_text(std::FILE* to, std::string_view text)
{
    const std::string line = escaped(text, true);
    std::fwrite(line.data(), 1, line.size(), to);
}

} // namespace tactor::cli
