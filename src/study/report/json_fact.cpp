// SPDX-License-Identifier: MIT
#include "study/report/json_fact.hpp"

#include <cmath>

#include <fmt/format.h>

#include <tactor/error.hpp>

namespace tactor::study {

using ordered = nlohmann::ordered_json;

void json_fact::refuse(std::string_view why, std::string_view hint) const
{
    throw error(error_kind::bad_input, file_,
                place_.empty() ? std::string(why) : fmt::format("{} {}", place_, why), hint);
}

json_fact json_fact::operator[](const std::string& key) const
{
    const std::string place = place_.empty() ? key : place_ + "." + key;
    if (!there())
        return {nullptr, file_, place};
    if (!value_->is_object())
        refuse("is no object", "it was changed");
    const auto at = value_->find(key);
    return {at == value_->end() ? nullptr : &*at, file_, place};
}

std::vector<json_fact> json_fact::list() const
{
    std::vector<json_fact> all;
    if (!there())
        return all;
    if (!value_->is_array())
        refuse("is no list", "it was changed");
    for (const ordered& one : *value_)
        all.push_back({&one, file_, fmt::format("{}[{}]", place_, all.size())});
    return all;
}

std::optional<double> json_fact::number() const
{
    if (!there())
        return {};
    if (!value_->is_number())
        refuse("is no number", "it was changed");
    return value_->get<double>();
}

std::optional<std::string> json_fact::text() const
{
    if (!there())
        return {};
    if (!value_->is_string())
        refuse("is no text", "it was changed");
    return value_->get<std::string>();
}

std::optional<bool> json_fact::truth() const
{
    if (!there())
        return {};
    if (!value_->is_boolean())
        refuse("is neither true nor false", "it was changed");
    return value_->get<bool>();
}

double json_fact::need_number() const
{
    if (!there())
        refuse("is missing", "it was changed");
    return *number();
}

int json_fact::need_whole(int least, int most) const
{
    const double v = need_number();
    if (!(v >= least && v <= most) || v != std::floor(v))
        refuse(fmt::format("is no whole number from {} to {}", least, most), "it was changed");
    return static_cast<int>(v);
}

std::string json_fact::need_text() const
{
    if (!there())
        refuse("is missing", "it was changed");
    return *text();
}

std::string json_fact::words() const
{
    if (!there())
        return {};
    if (value_->is_string())
        return value_->get<std::string>();
    if (!value_->is_structured())
        return value_->dump();
    std::string all;
    for (const auto& [key, value] : value_->items()) {
        const std::string one = json_fact(&value, file_, place_).words();
        if (one.empty())
            continue;
        all += all.empty() ? "" : ", ";
        all += value_->is_object() ? fmt::format("{}: {}", key, one) : one;
    }
    return all;
}

ordered read_json(const std::filesystem::path& file, const std::string& text)
{
    ordered j = ordered::parse(text, nullptr, false);
    if (!j.is_object())
        throw error(error_kind::bad_input, file.string(), "it is no JSON object",
                    "it was changed, or not written to its end");
    return j;
}

} // namespace tactor::study
