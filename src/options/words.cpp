// SPDX-License-Identifier: MIT
#include "options/words.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/marks.hpp"

namespace tactor::options {
namespace {

const own_word* find_own(std::string_view mark, const spelling& by)
{
    const auto found =
        std::find_if(by.own.begin(), by.own.end(), [mark](const own_word& w) { return w.mark == mark; });
    return found == by.own.end() ? nullptr : &*found;
}

std::string write(const detail::mark& m, const spelling& by, bool in_file)
{
    const own_word* own = find_own(m.setting, by);
    if (own == nullptr)
        own = find_own(m.name, by);
    if (own != nullptr)
        return own->here.empty() ? "" : fmt::format(fmt::runtime(own->here), m.value).append(m.clause);
    const option* o = find(m.name);
    if (o == nullptr && detail::command_name(m).empty())
        return std::string(m.text);
    const bool has_it =
        o != nullptr && (o->where & by.where) != 0 && !(in_file && (o->where & in_stroke) != 0);
    return (has_it ? by.write(*o, m.value) : detail::plain(m)).append(m.clause);
}

} // namespace

std::string spell(std::string_view text, const spelling& by, bool in_file)
{
    return detail::write_marks(text, [&](const detail::mark& m) { return write(m, by, in_file); });
}

std::string spell_field(std::string_view field, const spelling& by)
{
    return write({.text = field, .setting = field, .name = field}, by, false);
}

error spell(const error& e, const spelling& by)
{
    const bool in_file = e.place().line != 0;
    const bool is_field = !in_file && e.subject() == e.field();
    return e.reworded(is_field ? spell_field(e.field(), by) : spell(e.subject(), by, in_file),
                      spell(e.why(), by, in_file), spell(e.hint(), by, in_file));
}

} // namespace tactor::options
