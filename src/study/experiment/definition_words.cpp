// SPDX-License-Identifier: MIT
#include "study/experiment/definition_words.hpp"

#include <array>

#include <fmt/format.h>

#include "options/words.hpp"

namespace tactor::study {
namespace {

constexpr std::array own_words{options::own_word{"level_dbfs", "level.dbfs"},
                               options::own_word{"sl_db", "level.sl_db"},
                               options::own_word{"fit_strokes() scales it to the array, ", ""}};

std::string write_choice(const options::option& o, std::string_view value)
{
    if (value.empty())
        return std::string(o.field_name());
    const char* quote = o.what == options::kind::flag ? "" : "\"";
    return fmt::format("the method's {}, {}{}{},", options::dashed(o), quote, value, quote);
}

} // namespace

std::string in_definition_words(std::string_view hint)
{
    return options::spell(hint, {write_choice, options::in_method, own_words});
}

} // namespace tactor::study
