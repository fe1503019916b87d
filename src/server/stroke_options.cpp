// SPDX-License-Identifier: MIT
#include "server/stroke_options.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "options/check.hpp"
#include "options/settle.hpp"
#include "server/faults.hpp"

namespace tactor::server {
namespace {

using net::json;
using options::option;

options::value plain_value(const json& v)
{
    if (v.is_boolean())
        return v.get<bool>();
    if (v.is_number())
        return v.get<double>();
    if (v.is_string())
        return v.get<std::string>();
    return {};
}

const option& known_option(const std::string& name, options_for which)
{
    const option* o = options::find(name);
    if (o == nullptr || o->name != name || (o->where & options::by_client) == 0) {
        std::vector<std::string_view> names;
        for (const option& x : options::all())
            if ((x.where & options::by_client) != 0)
                names.push_back(x.name);
        bad_param("options." + name, "there is no such option",
                  fmt::format("one of {}", fmt::join(names, ", ")));
    }
    if (which == options_for::live && (o->where & options::live) == 0)
        bad_param("options." + name, "a live stroke does not know it", "its points say when it is where");
    return *o;
}

// Files are the server's own.
void refuse_file(const option& o, const options::value& v)
{
    const auto* text = std::get_if<std::string>(&v);
    if (o.name == "waveform" && text != nullptr && waveform_names_file(*text))
        bad_param("options.waveform", "a client may name no file",
                  "one of sine, square, triangle, sawtooth, noise:LO-HI");
}

} // namespace

options::wishes with_options(options::wishes w, const json& given, options_for which)
{
    if (!given.is_object())
        bad_param("options", "they are no object", R"(such as {"algorithm":"continuous"})");
    // A client starts from the owner's values.
    w.given.reset();
    w.in_file.clear();
    w.place = options::by_client;
    try {
        for (const auto& [name, value] : given.items()) {
            const option& o = known_option(name, which);
            const options::value v = options::read_value(o, plain_value(value));
            refuse_file(o, v);
            options::give(w, o, v);
        }
        options::settle(w);
    } catch (const error& e) {
        throw fault_error(option_fault(e));
    }
    return w;
}

} // namespace tactor::server
