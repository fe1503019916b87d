// SPDX-License-Identifier: MIT
#include "options/words.hpp"

#include <fmt/format.h>

namespace tactor::options {
namespace {

bool in_a_word(char c)
{
    return c == '_' || c == '-' || c == '.' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
           (c >= 'A' && c <= 'Z');
}

// Finds `from`, at or after `at`, where it is no part of a longer word; npos: nowhere.
std::size_t find_word(std::string_view text, std::string_view from, std::size_t at)
{
    for (at = text.find(from, at); at != text.npos; at = text.find(from, at + 1)) {
        const std::size_t end = at + from.size();
        const bool begins = at == 0 || !in_a_word(text[at - 1]);
        const bool ends = from.back() == ' ' || end == text.size() || !in_a_word(text[end]);
        if (begins && ends)
            return at;
    }
    return at;
}

void replace_word(std::string& text, std::string_view from, std::string_view to)
{
    for (std::size_t at = find_word(text, from, 0); at != text.npos;
         at = find_word(text, from, at + to.size()))
        text.replace(at, from.size(), to);
}

// "timing = fit": the name with the word behind it.
void replace_choice(std::string& text, const option& o, const spelling& by)
{
    const std::string from = fmt::format("{} = ", o.name);
    for (std::size_t at = find_word(text, from, 0); at != text.npos;) {
        std::size_t end = at + from.size();
        while (end < text.size() && in_a_word(text[end]) && text[end] != '.')
            ++end;
        const std::string to =
            by.write(o, std::string_view(text).substr(at + from.size(), end - at - from.size()));
        text.replace(at, end - at, to);
        at = find_word(text, from, at + to.size());
    }
}

} // namespace

std::string spell_marks(std::string_view text, const spelling& by)
{
    std::string out;
    for (;;) {
        const std::size_t begin = text.find('{');
        const std::size_t end = begin == text.npos ? begin : text.find('}', begin);
        if (end == text.npos)
            return out.append(text);
        const std::string_view inside = text.substr(begin + 1, end - begin - 1);
        const std::size_t equals = inside.find('=');
        const option* o = find_field(inside.substr(0, equals));
        out.append(text.substr(0, begin));
        if (o == nullptr)
            out.append(text.substr(begin, end + 1 - begin));
        else
            out += by.write(*o, equals == inside.npos ? std::string_view() : inside.substr(equals + 1));
        text.remove_prefix(end + 1);
    }
}

error spell_marks(const error& e, const spelling& by)
{
    return e.reworded(spell_marks(e.subject(), by), spell_marks(e.why(), by), spell_marks(e.hint(), by));
}

std::string spell(std::string_view text, const spelling& by, bool but_keys)
{
    std::string out = spell_marks(text, by);
    for (const own_word& w : by.own)
        replace_word(out, w.of_library, w.here);
    for (const option& o : all()) {
        if ((o.where & by.where) == 0 || (but_keys && (o.where & in_stroke) != 0))
            continue;
        if (o.what == kind::flag)
            replace_word(out, fmt::format("{} = true", o.name), by.write(o, "true"));
        else if (o.what == kind::choice)
            replace_choice(out, o, by);
        if (o.field_name().find('_') != std::string_view::npos)
            replace_word(out, o.field_name(), by.write(o, {}));
    }
    return out;
}

} // namespace tactor::options
