// SPDX-License-Identifier: MIT
#include "cli/option_words.hpp"

#include <array>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "options/words.hpp"

namespace tactor::cli {
namespace {

// Words of the library that are no field of an option.
constexpr std::array own_words{
    options::own_word{"measure its detection threshold", "run tactor calibrate"},
    options::own_word{"force = true", "--force"},
    options::own_word{"array = ", "--array "},
    options::own_word{"config = FILE", "--config FILE"},
    options::own_word{"wider = true leaves", "without a number of channels it leaves"},
    options::own_word{"leave array out", "say no --array"},
    options::own_word{"fit_strokes()", "--fit"}};

std::string spell_option(const options::option& o, std::string_view value)
{
    if (value.empty() || o.what == options::kind::flag)
        return option_name(o);
    return fmt::format("{} {}", option_name(o), value);
}

constexpr options::spelling by_tool{.write = spell_option, .own = own_words};

// Returns true where the library uses the name for nothing else.
bool is_option(const options::option& o)
{
    if (o.what == options::kind::flag)
        return false;
    return o.what != options::kind::text || (o.where & options::by_client) != 0 || o.choices != nullptr;
}

std::string subject(std::string_view what)
{
    // A file's name and its keys stay as they are.
    const options::option* o = options::find_field(what.substr(0, what.find_first_of(": ")));
    if (o != nullptr && what == o->field_name() && is_option(*o))
        return option_name(*o);
    if (o != nullptr && what.starts_with(fmt::format("{} = ", o->name)))
        return options::spell(what, by_tool);
    if (o != nullptr && o->field_name().find('_') != std::string_view::npos)
        return options::spell(what, by_tool);
    return what == "simulate" ? "--simulate" : std::string(what);
}

} // namespace

std::string option_name(const options::option& o)
{
    return "--" + options::dashed(o);
}

std::string spelled(std::string_view marked)
{
    return options::spell_marks(marked, by_tool);
}

error in_options(const error& e)
{
    const error marked = options::spell_marks(e, by_tool);
    return marked.reworded(subject(marked.subject()), marked.why(),
                           options::spell(marked.hint(), by_tool, e.place().line != 0));
}

} // namespace tactor::cli
