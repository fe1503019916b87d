// SPDX-License-Identifier: MIT
// [array] and [[tactor]].
#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/kind_names.hpp"
#include "core/label.hpp"
#include "core/words.hpp"
#include "files/setup_parts.hpp"
#include "files/stroke/parts.hpp"
#include "files/text_file.hpp"

namespace tactor::detail {
namespace {

constexpr std::size_t longest_chain = 16;
constexpr bounds anywhere{-max_mm, max_mm};
constexpr bounds limit_db{min_db, 0.0};
constexpr bounds body_mm{1.0, 3000.0};
constexpr bounds displacement_um{0.0, max_displacement_um, true};

array read_grid(const toml_table& grid)
{
    grid.only({"rows", "columns", "pitch_mm"});
    const unsigned rows = grid.need(grid.whole("rows", 1, max_channels), "rows");
    const unsigned columns = grid.need(grid.whole("columns", 1, max_channels), "columns");
    if (!grid.has("pitch_mm"))
        grid.need(std::optional<double>(), "pitch_mm");
    constexpr bounds positive{0.0, max_mm, true};
    std::vector<double> pitch;
    if (const toml::array* xy = grid.node("pitch_mm")->as_array()) {
        if (xy->size() != 2)
            grid.fail("pitch_mm", fmt::format("pitch_mm has {}", counted(xy->size(), "number")),
                      "give one, or [x, y]");
        for (const toml::node& n : *xy)
            pitch.push_back(grid.to_number(n, "pitch_mm", positive));
    } else {
        pitch.assign(2, *grid.number("pitch_mm", positive));
    }
    try {
        return make_grid({}, rows, columns, pitch[0], pitch[1]);
    } catch (const error& e) {
        grid.fail(e.what());
    }
}

// Reads the array of another file. The other tables of that file hold here too, unless this file has them.
array read_included(const toml_table& table, const setup_source& source, located_setup& out)
{
    const std::filesystem::path file = source.folder / *table.text("file");
    std::error_code ignored;
    const std::filesystem::path full = std::filesystem::weakly_canonical(file, ignored);
    if (std::find(source.opened.begin(), source.opened.end(), full) != source.opened.end())
        table.fail("file",
                   fmt::format("{} takes its array from itself",
                               full == source.opened.back() ? "it" : file.string()),
                   "break the circle of files");
    if (source.opened.size() == longest_chain)
        table.fail("file", "a chain of too many files", fmt::format("at most {}", longest_chain));
    // Opening a pipe that someone else's file names could block, and a device may take it for a command.
    if (std::filesystem::exists(file, ignored) && !std::filesystem::is_directory(file, ignored) &&
        !std::filesystem::is_regular_file(file, ignored))
        table.fail("file", fmt::format("{} is not a regular file", file.string()), "name an array file");
    const whole_text text = table.at_key("file", [&] { return read_text_file(file, max_setup_bytes); });
    setup_source next{file.string(), file.parent_path(), source.opened};
    next.opened.push_back(full);
    out = read_setup(text, next);
    out.said.output.pcm_included = out.said.output.pcm.has_value();
    if (!out.said.array)
        table.fail("file", fmt::format("{} has no array", file.string()), "name an array file");
    return *std::exchange(out.said.array, std::nullopt);
}

// Reads a text that is shown to people as it is.
std::optional<std::string> read_label(const toml_table& t, std::string_view key)
{
    std::optional<std::string> said = t.text(key);
    if (const std::string why = said ? label_fault(*said) : ""; !why.empty())
        t.fail(key, fmt::format("{} {}", key, why), label_hint);
    return said;
}

// Reads the kind of actuator. A missing one is unknown, which no file can say.
std::optional<actuator_kind> read_actuator(const toml_table& t)
{
    std::vector<std::string_view> known = kind_names<actuator_kind>();
    std::erase(known, to_string(actuator_kind::unknown));
    const auto name = t.choice("actuator", known);
    return name ? find_kind<actuator_kind>(*name) : std::nullopt;
}

// Reads a level, or [[Hz, dBFS], ...] in order of frequency.
void read_threshold(const toml_table& entry, tactor_spec& t)
{
    const toml::node* node = entry.node("threshold_dbfs");
    if (node == nullptr)
        return;
    t.threshold_dbfs.reset();
    t.thresholds.clear();
    if (!node->is_array()) {
        t.threshold_dbfs = entry.number("threshold_dbfs", limit_db);
        return;
    }
    std::vector<double> pair;
    for (const toml::node& e : *entry.list("threshold_dbfs", "[Hz, dBFS]")) {
        entry.numbers(e, "a threshold", 2, 2, pair);
        const threshold_point p{entry.within(e, "the frequency", pair[0], bounds_of::carrier_hz),
                                entry.within(e, "the threshold", pair[1], limit_db)};
        if (!t.thresholds.empty() && p.hz <= t.thresholds.back().hz)
            fail_at(entry.where(e),
                    fmt::format("the frequency {} does not come after {}", p.hz, t.thresholds.back().hz),
                    "put thresholds in order of frequency, each once");
        t.thresholds.push_back(p);
    }
    if (t.thresholds.empty())
        entry.fail("threshold_dbfs", "there is no threshold in it", "give [[100, -20], [250, -41]]");
}

void read_tactor(const toml_table& entry, tactor_spec& t)
{
    t.where = entry.where();
    t.channel = entry.whole("channel", 0, max_channels - 1).value_or(t.channel);
    t.gain_db = entry.number("gain_db", {min_db, max_gain_db}).value_or(t.gain_db);
    t.max_dbfs = entry.number("max_dbfs", limit_db).value_or(t.max_dbfs);
    read_threshold(entry, t);
    if (const auto rise = entry.number("rise_ms", {0.0, 1000.0, true}))
        t.rise_s = *rise / 1e3;
    if (const auto um = entry.number("displacement_um_at_0dbfs", displacement_um))
        t.displacement_um_at_0dbfs = um;
    if (const auto sign = entry.number("polarity", {-1.0, 1.0})) {
        if (*sign != 1.0 && *sign != -1.0)
            entry.fail("polarity", fmt::format("polarity is {}", *sign),
                       "1, or -1 where it is wired the other way round");
        t.polarity = *sign > 0.0 ? 1 : -1;
    }
    t.actuator = read_actuator(entry).value_or(t.actuator);
}

// Reads entries without a grid: each is a tactor and says where it is.
void append_tactors(const std::vector<toml_table>& entries, array& a)
{
    for (const toml_table& e : entries) {
        e.only({"x_mm", "y_mm", "channel", "gain_db", "max_dbfs", "threshold_dbfs", "polarity", "actuator",
                "rise_ms", "displacement_um_at_0dbfs", "tactor"});
        const unsigned i = static_cast<unsigned>(a.tactors.size());
        if (i == max_channels)
            e.fail(fmt::format("more than {} tactors", max_channels));
        if (const auto said = e.whole("tactor", 0, max_channels - 1); said && *said != i)
            e.fail("tactor", fmt::format("tactor is {}, but this is entry {}", *said, i),
                   "without a grid, tactors are numbered from 0 in the order of the file");
        tactor_spec t;
        t.position = {e.need(e.number("x_mm", anywhere), "x_mm"), e.need(e.number("y_mm", anywhere), "y_mm")};
        t.channel = i;
        read_tactor(e, t);
        a.tactors.push_back(std::move(t));
    }
}

// Reads entries beside a grid, a preset or a file: each adds to the tactor that it names.
void adjust_tactors(const std::vector<toml_table>& entries, std::string_view base, array& a)
{
    std::vector<const toml_table*> said(a.tactors.size());
    const unsigned last = static_cast<unsigned>(a.tactors.size()) - 1;
    for (const toml_table& e : entries) {
        for (const char* key : {"x_mm", "y_mm"})
            if (e.has(key))
                e.fail(key, fmt::format("[[tactor]] says {}, but its place comes from the {}", key, base),
                       fmt::format("leave {} out, or the {}", key, base));
        e.only({"tactor", "channel", "gain_db", "max_dbfs", "threshold_dbfs", "polarity", "actuator",
                "rise_ms", "displacement_um_at_0dbfs"});
        if (!e.has("tactor"))
            e.fail("[[tactor]] does not say which tactor it is",
                   fmt::format("add tactor = INDEX, 0 to {}", last));
        const unsigned i = *e.whole("tactor", 0, last);
        if (said[i])
            e.fail("tactor", fmt::format("tactor {} has an entry already ({})", i, said[i]->where().text()),
                   "join the two");
        said[i] = &e;
        read_tactor(e, a.tactors[i]);
    }
}

array read_base(const toml_table& table, std::string_view base, const setup_source& source,
                located_setup& out)
{
    if (base == "grid") {
        const toml_table grid = *table.table("grid", "grid", "grid = { rows, columns, pitch_mm }");
        array a = read_grid(grid);
        for (tactor_spec& t : a.tactors)
            t.where = grid.where();
        return a;
    }
    if (base == "file")
        return read_included(table, source, out);
    const std::string name = *table.text("preset");
    array a = table.at_key("preset", [&] { return preset_array(name); });
    for (tactor_spec& t : a.tactors)
        t.where = table.where("preset");
    return a;
}

// Mirrors and turns the array about the middle of its tactors. Each stays the tactor and the channel that it
// is.
void turn_array(const toml_table& table, array& a)
{
    if (!table.has("mirror") && !table.has("rotate_deg"))
        return;
    affine m = read_turn(table);
    point least = a.tactors.front().position;
    point most = least;
    for (const tactor_spec& t : a.tactors) {
        least = {std::min(least.x_mm, t.position.x_mm), std::min(least.y_mm, t.position.y_mm)};
        most = {std::max(most.x_mm, t.position.x_mm), std::max(most.y_mm, t.position.y_mm)};
    }
    const point middle{(least.x_mm + most.x_mm) / 2.0, (least.y_mm + most.y_mm) / 2.0};
    m.e = middle.x_mm;
    m.f = middle.y_mm;
    for (tactor_spec& t : a.tactors)
        t.position = m({t.position.x_mm - middle.x_mm, t.position.y_mm - middle.y_mm});
}

} // namespace

void read_array(const toml_table& root, const setup_source& source, located_setup& out)
{
    if (!root.has("array") && !root.has("tactor"))
        return;
    const toml::table none;
    const toml_table table =
        root.table("array", "[array]", "[array]").value_or(toml_table(none, "[array]", source.name));
    if (table.has("tactor"))
        table.fail("tactor", "tactors inside [array]", "write [[tactor]], which stands beside [array]");
    table.only({"name", "site", "up", "place", "turn", "body", "grid", "preset", "file", "actuator", "mirror",
                "rotate_deg", "displacement_um_at_0dbfs"});
    const std::vector<toml_table> entries = root.tables("tactor");

    std::string_view base;
    if (table.has("grid") || table.has("preset") || table.has("file"))
        base = table.one_of({"grid", "preset", "file"});
    array a;
    if (base.empty()) {
        if (entries.empty())
            table.fail("[array] has no tactors", "add grid, preset or file, or [[tactor]] entries");
        append_tactors(entries, a);
    } else {
        a = read_base(table, base, source, out);
        adjust_tactors(entries, base, a);
    }

    turn_array(table, a);
    if (const auto name = table.text("name"))
        a.name = *name;
    else if (a.name.empty())
        a.name = std::filesystem::path(source.name).stem().string();
    a.site = read_label(table, "site").value_or(a.site);
    a.up = read_label(table, "up").value_or(a.up);
    if (const auto place = table.place("place"))
        a.place = place;
    if (const auto turn = table.number("turn", turn_deg))
        a.turn_deg = turn;
    if (const auto length = table.number("body", body_mm))
        a.body_mm = length;
    if (const auto actuator = read_actuator(table))
        for (tactor_spec& t : a.tactors)
            if (t.actuator == actuator_kind::unknown)
                t.actuator = *actuator;
    if (const auto um = table.number("displacement_um_at_0dbfs", displacement_um))
        for (tactor_spec& t : a.tactors)
            if (!t.displacement_um_at_0dbfs)
                t.displacement_um_at_0dbfs = um;
    a.where = root.has("array") ? table.where() : entries.front().where();
    out.said.array = std::move(a);
}

} // namespace tactor::detail
