// SPDX-License-Identifier: MIT
#include "python/binding.hpp"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <tactor/setup.hpp>

#include "options/option.hpp"
#include "options/resolve.hpp"
#include "session/device.hpp"
#include "session/piece.hpp"

namespace tactor::python {
namespace {

using options::option;
using namespace py::literals;

constexpr std::uint64_t of_python = options::in_plan | options::in_score | options::in_compare;

std::string format_keyword(const option& o, std::string_view value)
{
    if (value.empty())
        return std::string(o.name);
    if (o.what == options::kind::flag)
        return fmt::format("{}=True", o.name);
    const bool is_text = o.what == options::kind::choice || o.what == options::kind::text;
    return is_text ? fmt::format("{}=\"{}\"", o.name, value) : fmt::format("{}={}", o.name, value);
}

// Words for the library's marks and fields for which there is no option.
constexpr std::array own_words{options::own_word{"command:devices", "tactor.devices()"},
                               options::own_word{"command:plan", "Plan.write()"},
                               options::own_word{"array=none", "use plan.array"},
                               options::own_word{"array=FILE", "Array.from_file(FILE)"},
                               options::own_word{"array", "Array.preset(\"{}\")"},
                               options::own_word{"force=true", "force=True"},
                               options::own_word{"wider=true", "leave out channels"},
                               options::own_word{"participants", "participants"},
                               options::own_word{"exclude", "exclude"},
                               options::own_word{"pitch_x_mm", "pitch_mm"},
                               options::own_word{"pitch_y_mm", "pitch_mm"},
                               options::own_word{"start_s", "start"},
                               options::own_word{"timeout_s", "timeout"},
                               options::own_word{"longest_s", "longest"},
                               options::own_word{"at_ns", "at_s"}};

constexpr options::spelling by_python{.write = format_keyword, .own = own_words};

std::string shown(py::handle v)
{
    return py::module_::import("tactor._checks").attr("_shown")(v).cast<std::string>();
}

double number(const option& o, py::handle v)
{
    const double d =
        py::module_::import("tactor._checks")
            .attr("_number")(o.name, v, "hint"_a = "use " + options::spell(range_text(o), by_python),
                             "finite"_a = false)
            .cast<double>();
    const bool is_rounded = PyLong_Check(v.ptr()) && !py::float_(d).equal(v);
    if (is_rounded || !o.allowed.holds(d))
        throw refusal(o, fmt::format("{} is out of range", shown(v)),
                      options::sign_hint(o.allowed, d) + range_text(o));
    return d;
}

bool truth(const option& o, py::handle v)
{
    const py::object kind = py::getattr(py::getattr(v, "dtype", py::none()), "kind", py::none());
    const bool is_of_numpy =
        kind.equal(py::str("b")) && py::getattr(v, "ndim", py::none()).equal(py::int_(0));
    if (!py::isinstance<py::bool_>(v) && !is_of_numpy)
        throw refusal(o, fmt::format("{} is neither True nor False", shown(v)), "");
    return v.cast<bool>();
}

std::string text(const option& o, py::handle v)
{
    if (!py::isinstance<py::str>(v))
        throw refusal(o,
                      o.choices == nullptr ? fmt::format("{} is not a text", shown(v))
                                           : fmt::format("{} is unknown", shown(v)),
                      o.choices == nullptr ? "" : fmt::format("use one of {}", choices_text(o)));
    py::module_::import("tactor._checks").attr("_need_utf8")(v, o.name);
    auto spelled = v.cast<std::string>();
    if (spelled.find('\0') != std::string::npos)
        throw refusal(o, fmt::format("{} has a zero byte", shown(v)), "");
    return spelled;
}

options::value read_handle(const option& o, py::handle v)
{
    switch (o.what) {
    case options::kind::number:
        return number(o, v);
    case options::kind::whole:
        return options::read_value(o, number(o, v));
    case options::kind::flag:
        return truth(o, v);
    case options::kind::choice:
        return options::read_value(o, text(o, v));
    case options::kind::text:
        break;
    }
    const bool takes_number = o.allowed.high > 0.0 && !py::isinstance<py::str>(v);
    return takes_number ? options::value(number(o, v)) : options::value(text(o, v));
}

void refuse_rivals(const py::dict& keywords)
{
    const auto says = [&keywords](std::string_view name) {
        const py::str key(name.data(), name.size());
        return keywords.contains(key) && !keywords[key].is_none();
    };
    for (const option& o : options::all())
        if (!o.rival.empty() && o.name < o.rival && says(o.name) && says(o.rival))
            throw refusal(o, fmt::format("it cannot be combined with {{{}}}", o.rival), "give one of them");
    if (says("tukey_part") && says("envelope") &&
        py::str(keywords["envelope"]).cast<std::string>().find(':') != std::string::npos)
        throw refusal(*options::find("envelope"), "it has a part, so it cannot be combined with {tukey_part}",
                      "give the part once");
}

/// A phantom model that is a Python object with a name and a method weights(x_mm, y_mm, intensity).
class own_phantom final : public phantom_model {
public:
    own_phantom(py::object model, std::size_t tactors)
        : model_(std::move(model)),
          name_(py::hasattr(model_, "name")
                    ? py::str(model_.attr("name")).cast<std::string>()
                    : py::str(py::type::of(model_).attr("__name__")).cast<std::string>()),
          answer_(py::module_::import("tactor._plan").attr("ask_model")),
          tactors_(tactors)
    {
    }

    // Takes the lock, because any thread may destroy the last plan that shares this model.
    ~own_phantom() override
    {
        const with_lock lock;
        model_ = py::object();
        answer_ = py::object();
    }
    own_phantom(const own_phantom&) = delete;
    own_phantom& operator=(const own_phantom&) = delete;

    std::string_view name() const noexcept override { return name_; }

    void weights(point p, double a_v, std::vector<drive>& out) const override
    {
        const with_lock lock;
        out = call_function(answer_, py::make_tuple(model_, name_, p.x_mm, p.y_mm, a_v, tactors_))
                  .cast<std::vector<drive>>();
    }

private:
    py::object model_;
    std::string name_;
    py::object answer_; ///< Python function that calls the model and checks its answer
    std::size_t tactors_;
};

void take_phantom(option_values& w, const option& o, py::handle v, std::size_t tactors)
{
    if (py::hasattr(v, "weights"))
        w.plan.custom_phantom =
            std::make_shared<const own_phantom>(py::reinterpret_borrow<py::object>(v), tactors);
    else
        options::put(w, o, read_handle(o, v));
}

std::vector<std::pair<const option*, py::handle>> find_keywords(const py::dict& keywords)
{
    std::vector<std::pair<const option*, py::handle>> found;
    for (const auto& [key, value] : keywords) {
        const auto name = key.cast<std::string>();
        const option* o = options::find(name);
        if (value.is_none())
            continue;
        if (o == nullptr || o->name != name || (o->where & of_python) == 0)
            throw py::type_error(fmt::format("there is no option '{}'", name));
        found.emplace_back(o, value);
    }
    return found;
}

// Sets rate, channels and marker from the array's file.
void apply_output(option_values& w, const setup& file)
{
    if (!w.rate && !w.gives("rate"))
        w.rate = file.output.rate;
    if (!w.gives("channels"))
        w.channels = file.output.channels;
    if (w.gives("marker_channel") || !file.sync || !file.sync->channel)
        return;
    w.render.marker_channel = file.sync->channel;
    if (!w.gives("marker_s"))
        w.render.marker_s = file.sync->pulse_s;
}

// Sets rate, channels and limits of a score. The limits of a player are set when its stream is opened.
void resolve_score(option_values& w)
{
    render_options& r = w.render;
    r.rate = w.rate.value_or(r.rate);
    r.channels = w.channels.value_or(r.channels);
    const options::stream_options& s = w.stream;
    if (!s.power_dbfs && !s.max_drive_s && !s.drive_window_s)
        return;
    r.limits = session::override_limits(s, r.limits.value_or(drive_limits()));
}

// Returns an option with the data for the manual. Its texts contain marks.
py::dict manual_entry(const option& o)
{
    py::list takers;
    for (const options::place_name& c : options::command_names())
        if ((o.where & c.bit) != 0)
            takers.append(c.name);
    return py::dict("group"_a = o.in, "letter"_a = o.letter, "commands"_a = takers,
                    "file_only"_a = (o.where & options::file_only) != 0,
                    "type"_a = o.what == options::kind::flag ? "" : options::type_text(o),
                    "range"_a = options::range_text(o), "default"_a = o.to.get(options::option_values{}),
                    "help"_a = o.help, "rival"_a = o.rival, "needs"_a = o.needs);
}

} // namespace

void take_options(option_values& into, const py::dict& keywords, std::size_t tactors, const setup* file)
{
    refuse_rivals(keywords);
    const auto all = find_keywords(keywords);
    for (const auto& [o, value] : all)
        into.by_user.set(index(*o));
    if (file != nullptr)
        options::apply_defaults(into, *file);
    if (file != nullptr && (into.place & options::in_score) != 0)
        apply_output(into, *file);
    if (keywords.contains("level_dbfs") && !keywords["level_dbfs"].is_none())
        into.render.sl_db.reset();
    for (const auto& [o, value] : all)
        if (o->name == "phantom")
            take_phantom(into, *o, value, tactors);
        else
            options::put(into, *o, read_handle(*o, value));
    options::resolve(into);
    if (file != nullptr) {
        into.actuator = file->texture;
        session::use_actuator(into.plan.wave, into.actuator);
    }
    resolve_score(into);
}

void set_player_options(option_values& into, const py::dict& keywords)
{
    for (const option& o : options::all()) {
        const py::str name(o.name.data(), o.name.size());
        if ((o.where & options::in_player) != 0 && keywords.contains(name) && !keywords[name].is_none())
            options::give(into, o, read_handle(o, keywords[name]));
    }
}

py::list option_rows()
{
    constexpr std::array places{
        std::pair{"plan", options::in_plan},       std::pair{"score", options::in_score},
        std::pair{"compare", options::in_compare}, std::pair{"player", options::in_player},
        std::pair{"live", options::live},          std::pair{"client", options::by_client}};
    constexpr std::array kinds{"float", "int", "choice", "bool", "str"};
    py::list all;
    for (const option& o : options::all()) {
        py::list where;
        for (const auto& [name, place] : places)
            if ((o.where & place) != 0)
                where.append(name);
        const bool is_number = o.what == options::kind::number || o.what == options::kind::whole;
        all.append(
            py::dict("name"_a = o.name, "kind"_a = kinds.at(static_cast<std::size_t>(o.what)),
                     "may_be_number"_a = o.allowed.high > 0.0, "unit"_a = o.unit,
                     "choices"_a = o.choices == nullptr ? std::vector<std::string_view>() : o.choices(),
                     "help"_a = options::spell(o.help, by_python),
                     "form"_a = o.what == options::kind::text ? o.shown : "",
                     "range"_a = is_number ? options::spell(range_text(o), by_python) : "",
                     "places"_a = where, "manual"_a = manual_entry(o)));
    }
    return all;
}

error spell_as_keywords(const error& e)
{
    const error spelled = options::spell(e, by_python);
    const bool in_file = !e.place().file.empty() || e.place().line != 0; // then the message has the place
    return in_file ? spelled : spelled.with_field(options::spell_field(e.field(), by_python));
}

} // namespace tactor::python
