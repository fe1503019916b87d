// SPDX-License-Identifier: MIT
#include "study/session/entry.hpp"

#include <utility>

#include <boost/locale/utf.hpp>

namespace tactor::study {
namespace {

using utf8 = boost::locale::utf::utf_traits<char>;

} // namespace

std::optional<std::string> tidy_text(std::string_view entered)
{
    std::string tidy;
    std::size_t characters = 0;
    for (const char* at = entered.data(); at != entered.data() + entered.size();) {
        const char* const first = at;
        const auto c = utf8::decode(at, entered.data() + entered.size());
        if (!boost::locale::utf::is_valid_codepoint(c))
            return {};
        if (c == '\t')
            tidy += ' ';
        else if (c == '\n' || (c >= 0x20 && (c < 0x7f || c > 0x9f)))
            tidy.append(first, at);
        else
            continue;
        if (++characters > most_text_characters)
            return {};
    }
    return tidy;
}

bool typed_text::take(char byte)
{
    if (escape_ == '\x1b' && byte != '[' && byte != 'O')
        escape_ = '\0'; // Esc alone
    if (byte == '\x1b' || escape_ != '\0') {
        // Such as ESC [ A, ESC O P and ESC [ 3 ~.
        const bool goes_on =
            byte == '\x1b' || escape_ == '\x1b' ||
            (escape_ != 'O' && std::string_view(";0123456789").find(byte) != std::string_view::npos);
        escape_ = goes_on ? byte : '\0';
        return false;
    }
    if (byte == '\n' || byte == '\r')
        return true;
    if (byte == '\x7f' || byte == '\b') {
        while (!text_.empty() && utf8::is_trail(text_.back()))
            text_.pop_back();
        if (!text_.empty())
            text_.pop_back();
        return false;
    }
    begun_ += byte;
    if (auto at = begun_.cbegin(); utf8::decode(at, begun_.cend()) == boost::locale::utf::incomplete)
        return false;
    if (auto more = tidy_text(text_ + std::exchange(begun_, {})))
        text_ = *std::move(more);
    return false;
}

} // namespace tactor::study
