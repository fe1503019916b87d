// SPDX-License-Identifier: MIT
#include <tactor/setup.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/baud_rates.hpp"
#include "core/bounds.hpp"
#include "core/kind_names.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/setup_layers.hpp"
#include "files/text_file.hpp"
#include "files/toml_reader.hpp"
#include "files/vibration_file.hpp"

namespace tactor::detail {
namespace {

// Source of a text with TOML.
struct setup_source {
    std::string name;             // name of the source in messages
    std::filesystem::path folder; // folder for relative names; empty for the current one
    unsigned depth = 1;           // number of nested files, including this one
};

// A setup, and the source places of the values on which two tables must agree.
struct located_setup {
    setup contents;
    source_place channels_at;
    source_place sync_channel_at;
};

// Reads a setup. Then checks its values together.
located_setup read_setup(std::string_view text, const setup_source& source);

gpio_line_name read_gpio_line(const toml_table& t)
{
    gpio_line_name line;
    line.where = t.where();
    if (t.one_of({"chip", "name"}) == "name") {
        if (t.has("offset"))
            t.fail("offset", fmt::format("{} has both name and offset", t.title()), "keep the name");
        line.name = *t.text("name");
        return line;
    }
    line.chip = *t.text("chip");
    line.offset = t.need(t.whole("offset", 0, 65535), "offset");
    return line;
}

std::optional<double> seconds(std::optional<double> ms)
{
    return ms ? std::optional(*ms * 1e-3) : std::nullopt;
}

written_value read_value(const toml_table& t, const toml_table::key_value& e, const toml::node& n,
                         bool in_list)
{
    return {std::string(e.key), t.read_scalar(n, e.key), in_list, t.where(n), e.key_at};
}

constexpr bounds limit_db{min_db, 0.0};
constexpr bounds spread_db{0.0, -min_db};
constexpr unsigned most_whole = std::numeric_limits<unsigned>::max();

// Records the entry of tactor i. Refuses a second entry for the same tactor.
void record_entry(const toml_table& t, unsigned i, std::vector<const toml_table*>& entries, const char* hint)
{
    if (entries[i] != nullptr)
        t.fail("tactor", fmt::format("tactor {} has another entry ({})", i, entries[i]->where().text()),
               hint);
    entries[i] = &t;
}

constexpr unsigned longest_chain = 16;
constexpr bounds anywhere{-max_mm, max_mm};
constexpr bounds body_mm{1.0, 3000.0};
constexpr bounds displacement_um{0.0, max_displacement_um, true};

array read_grid(const toml_table& grid)
{
    grid.refuse_other_keys({"rows", "columns", "pitch_mm"});
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

// Reads the array from another file. The other tables of that file also apply. The caller reads tables of
// this file later, which replace their values or are joined with them (setup_layers.hpp).
array read_included_array(const toml_table& table, const setup_source& source, located_setup& out)
{
    const std::filesystem::path file = source.folder / *table.text("file");
    if (source.depth == longest_chain)
        table.fail("file", "the chain of files is too long",
                   fmt::format("use at most {} files, and no file that names itself", longest_chain));
    std::error_code ignored;
    // A file from another person may name a pipe, which could block, or a device, which may react to being
    // opened.
    if (std::filesystem::exists(file, ignored) && !std::filesystem::is_directory(file, ignored) &&
        !std::filesystem::is_regular_file(file, ignored))
        table.fail("file", fmt::format("{} is not a regular file", file.string()), "name an array file");
    const whole_text text =
        table.add_key_to_errors("file", [&] { return read_text_file(file, max_setup_bytes); });
    out = read_setup(text, {file.string(), file.parent_path(), source.depth + 1});
    out.contents.output.pcm_included = out.contents.output.pcm.has_value();
    if (!out.contents.array)
        table.fail("file", fmt::format("{} has no array", file.string()), "name an array file");
    return *std::exchange(out.contents.array, std::nullopt);
}

// Reads a text that is shown to people unchanged.
std::optional<std::string> read_label(const toml_table& t, std::string_view key)
{
    std::optional<std::string> text = t.text(key);
    if (const std::string why = text ? label_fault(*text) : ""; !why.empty())
        t.fail(key, fmt::format("{} {}", key, why), label_hint);
    return text;
}

// Reads the kind of actuator. If the key is missing, the kind is unknown. A file cannot contain the value
// "unknown".
std::optional<actuator_kind> read_actuator(const toml_table& t)
{
    std::vector<std::string_view> known = kind_names<actuator_kind>();
    std::erase(known, to_string(actuator_kind::unknown));
    const auto name = t.choice("actuator", known);
    return name ? find_kind<actuator_kind>(*name) : std::nullopt;
}

// Reads a threshold: one level, or [[Hz, dBFS], ...] with ascending frequencies.
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
    for (const toml::node& e : *entry.list("threshold_dbfs", "[Hz, dBFS]")) {
        const toml::array& pair = entry.pair(e, "a threshold");
        const threshold_point p{entry.to_number(pair[0], "the frequency", bounds_of::carrier_hz),
                                entry.to_number(pair[1], "the threshold", limit_db)};
        if (!t.thresholds.empty() && p.hz <= t.thresholds.back().hz)
            fail_at(entry.where(e),
                    fmt::format("the frequency {} Hz is not above the previous one, {} Hz", p.hz,
                                t.thresholds.back().hz),
                    "give each frequency once, in ascending order");
        t.thresholds.push_back(p);
    }
    if (t.thresholds.empty())
        entry.fail("threshold_dbfs", "threshold_dbfs is an empty list",
                   "give thresholds, such as [[100, -20], [250, -41]]");
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
                       "use 1, or -1 if its wires are swapped");
        t.polarity = *sign > 0.0 ? 1 : -1;
    }
    t.actuator = read_actuator(entry).value_or(t.actuator);
}

// Reads the entries of an array without a grid. Each entry is a tactor with its own place. `max_dbfs` is the
// limit of tactors whose entries have none.
void append_tactors(const std::vector<toml_table>& entries, double max_dbfs, array& a)
{
    for (const toml_table& e : entries) {
        e.refuse_other_keys({"x_mm", "y_mm", "channel", "gain_db", "max_dbfs", "threshold_dbfs", "polarity",
                             "actuator", "rise_ms", "displacement_um_at_0dbfs", "tactor"});
        const unsigned i = static_cast<unsigned>(a.tactors.size());
        if (i == max_channels)
            e.fail(fmt::format("the array has more than {} tactors", max_channels));
        if (const auto number = e.whole("tactor", 0, max_channels - 1); number && *number != i)
            e.fail("tactor", fmt::format("tactor is {}, but this is entry {}", *number, i),
                   "without a grid, number the tactors from 0 in the order of the file");
        tactor_spec t;
        t.position = {e.need(e.number("x_mm", anywhere), "x_mm"), e.need(e.number("y_mm", anywhere), "y_mm")};
        t.channel = i;
        t.max_dbfs = max_dbfs;
        read_tactor(e, t);
        a.tactors.push_back(std::move(t));
    }
}

// Reads entries that change the tactors of a grid, a preset or a file. Each entry names a tactor and changes
// it.
void adjust_tactors(const std::vector<toml_table>& entries, std::string_view base, array& a)
{
    std::vector<const toml_table*> by_tactor(a.tactors.size());
    const unsigned last = static_cast<unsigned>(a.tactors.size()) - 1;
    for (const toml_table& e : entries) {
        for (const char* key : {"x_mm", "y_mm"})
            if (e.has(key))
                e.fail(key, fmt::format("[[tactor]] has {}, but its place comes from the {}", key, base),
                       fmt::format("leave out {}, or the {}", key, base));
        e.refuse_other_keys({"tactor", "channel", "gain_db", "max_dbfs", "threshold_dbfs", "polarity",
                             "actuator", "rise_ms", "displacement_um_at_0dbfs"});
        if (!e.has("tactor"))
            e.fail("[[tactor]] has no tactor number", fmt::format("add tactor = INDEX, 0 to {}", last));
        const unsigned i = *e.whole("tactor", 0, last);
        record_entry(e, i, by_tactor, "join the two entries");
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
        return read_included_array(table, source, out);
    const std::string name = *table.text("preset");
    array a = table.add_key_to_errors("preset", [&] { return preset_array(name); });
    for (tactor_spec& t : a.tactors)
        t.where = table.where("preset");
    return a;
}

// Mirrors and rotates the array about the centre of its tactors. Each tactor keeps its index and its channel.
void turn_array(const toml_table& table, array& a)
{
    if (!table.has("mirror") && !table.has("rotate_deg"))
        return;
    affine m = table.turn();
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

std::string format_place(const source_place& at)
{
    return at.line != 0 ? fmt::format(" ({})", at.text()) : std::string();
}

// Refuses a number of channels that is too small for the channels of the tactors or of the marker.
void check_channels(const located_setup& s)
{
    const auto& count = s.contents.output.channels;
    if (!count)
        return;
    if (s.contents.array) {
        const unsigned needed = s.contents.array->channels();
        for (std::size_t i = 0; needed > *count && i < s.contents.array->tactors.size(); ++i) {
            const tactor_spec& t = s.contents.array->tactors[i];
            if (t.channel + 1 == needed)
                fail_at(s.channels_at,
                        fmt::format("channels is {}, but tactor {}{} is on channel {}", *count, i,
                                    format_place(t.where), t.channel),
                        fmt::format("use {} or more: they count from 0", counted(needed, "channel")));
        }
    }
    if (s.contents.sync && s.contents.sync->channel && *s.contents.sync->channel >= *count)
        fail_at(s.sync_channel_at,
                fmt::format("the marker's channel is {}, but there {} {}{}", *s.contents.sync->channel,
                            *count == 1 ? "is" : "are", counted(*count, "channel"),
                            format_place(s.channels_at)),
                "count channels from 0");
}

void check_marker(const located_setup& s)
{
    if (!s.contents.array || !s.contents.sync || !s.contents.sync->channel)
        return;
    for (std::size_t i = 0; i < s.contents.array->tactors.size(); ++i) {
        const tactor_spec& t = s.contents.array->tactors[i];
        if (t.channel == *s.contents.sync->channel)
            fail_at(s.sync_channel_at,
                    fmt::format("the marker's channel, {}, is also that of tactor {}{}", t.channel, i,
                                format_place(t.where)),
                    "give the marker a channel without a tactor");
    }
}

bool is_same_line(const gpio_line_name& a, const gpio_line_name& b)
{
    return a.chip == b.chip && a.offset == b.offset && a.name == b.name;
}

// Refuses a GPIO line that is used for two purposes.
void check_lines(const setup& s)
{
    std::vector<const gpio_line_name*> lines;
    std::vector<gpio_line_name> coded;
    if (s.sync && s.sync->code)
        for (const unsigned offset : s.sync->code->offsets)
            coded.push_back({.chip = s.sync->code->chip, .offset = offset, .where = s.sync->code->where});
    if (s.amplifier)
        lines.push_back(&s.amplifier->line);
    if (s.sync && s.sync->out)
        lines.push_back(&*s.sync->out);
    if (s.sync && s.sync->in)
        lines.push_back(&*s.sync->in);
    for (const gpio_line_name& l : coded)
        lines.push_back(&l);
    for (std::size_t i = 0; i < lines.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (is_same_line(*lines[i], *lines[j]))
                fail_at(lines[i]->where, fmt::format("the line is in use at {}", lines[j]->where.text()),
                        "give each purpose its own GPIO line");
}

void read_output(const toml_table& t, located_setup& out)
{
    t.refuse_other_keys({"pcm", "rate", "channels", "period_frames", "periods"});
    output_settings& o = out.contents.output;
    if (t.has("pcm")) {
        o.pcm = t.text("pcm");
        o.pcm_at = t.where("pcm");
        o.pcm_included = false;
    }
    if (t.has("rate"))
        o.rate = t.whole("rate", bounds_of::rate_hz);
    if (t.has("channels")) {
        o.channels = t.whole("channels", bounds_of::device_channels);
        out.channels_at = t.where("channels");
    }
    if (t.has("period_frames"))
        o.period_frames = t.whole("period_frames", {double(min_period_frames(o.rate.value_or(48'000))),
                                                    bounds_of::period_frames.high});
    if (t.has("periods"))
        o.periods = t.whole("periods", bounds_of::periods);
}

void read_amplifier(const toml_table& t, located_setup& out)
{
    t.refuse_other_keys({"line", "active_low", "settle_ms"});
    const toml_table line = t.need(t.table("line", "line", "line = { chip, offset } or { name }"), "line");
    amplifier_settings a;
    line.refuse_other_keys({"chip", "offset", "name"});
    a.line = read_gpio_line(line);
    a.active_low = t.boolean("active_low").value_or(a.active_low);
    a.settle_s = seconds(t.number("settle_ms", {0.0, 10000.0})).value_or(a.settle_s);
    out.contents.amplifier = a;
}

constexpr const char* code_hint = "code = { channel = 15 }, { chip, offsets } or { serial, baud }";

// Reads the outputs for event codes.
void read_code(const toml_table& t, code_settings& c)
{
    t.refuse_other_keys({"channel", "bit_ms", "chip", "offsets", "pulse_ms", "lsl", "serial", "baud"});
    c.where = t.where();
    c.channel = t.whole("channel", bounds_of::marker_channel);
    c.bit_s = seconds(t.number("bit_ms", {0.1, 20.0})).value_or(c.bit_s);
    c.pulse_s = seconds(t.number("pulse_ms", {0.0, 1000.0, true})).value_or(c.pulse_s);
    c.lsl = t.boolean("lsl").value_or(c.lsl);
    if (t.has("chip") || t.has("offsets")) {
        c.chip = t.need(t.text("chip"), "chip");
        const toml::array* offsets = t.list("offsets", "lines, [5, 6]");
        if (offsets == nullptr || offsets->empty() || offsets->size() > 8)
            t.fail("offsets", fmt::format("there are {}", counted(offsets ? offsets->size() : 0, "offset")),
                   "give one to eight lines, the least significant bit first");
        for (const toml::node& n : *offsets) {
            if (!n.is_integer())
                fail_at(t.where(n), fmt::format("an offset is {}", shown(n)), "give a whole number");
            c.offsets.push_back(static_cast<unsigned>(t.to_number(n, "an offset", {0.0, 65535.0})));
        }
    }
    if (t.has("serial") || t.has("baud")) {
        c.serial = t.need(t.text("serial"), "serial");
        c.baud = t.whole("baud", 0, std::numeric_limits<int>::max()).value_or(c.baud);
        if (std::ranges::count(detail::baud_rates, c.baud, &detail::baud_rate::baud) == 0) {
            std::vector<unsigned> rates;
            for (const detail::baud_rate& one : detail::baud_rates)
                rates.push_back(one.baud);
            t.fail("baud", fmt::format("baud is {}", c.baud),
                   fmt::format("use one of {}", fmt::join(rates, ", ")));
        }
    }
    if (!c.channel && !c.lsl && c.chip.empty() && c.serial.empty())
        t.fail("code has neither channel nor chip nor serial", code_hint);
}

// Reads the numbers for one kind of event: the first number, or a table of numbers.
code_numbering read_numbering(const toml_table& t, std::string_view key)
{
    constexpr unsigned greatest = 255;
    code_numbering n;
    if (const toml::node* node = t.node(key); node == nullptr || !node->is_table()) {
        n.first = t.whole(key, 1, greatest);
        return n;
    }
    const toml_table own = *t.table(key, std::string(key), "{ first = 10, by = [\"motion\", \"method\"] }");
    own.refuse_other_keys({"first", "by"});
    n.first = own.whole("first", 1, greatest);
    constexpr std::array<std::string_view, 6> parts{"run", "motion", "method", "value", "interval", "answer"};
    if (!own.has("by"))
        return n;
    n.by.emplace();
    for (const std::string& part : own.texts("by", parts.size())) {
        if (std::ranges::count(parts, part) == 0)
            own.fail("by", fmt::format("by has {}", detail::quoted(part)),
                     fmt::format("some of {}", fmt::join(parts, ", ")));
        n.by->push_back(part);
    }
    return n;
}

void read_sync(const toml_table& t, located_setup& out)
{
    t.refuse_other_keys({"out", "channel", "in", "code", "codes"});
    sync_settings s;
    if (const auto pulse = t.table("out", "out", "out = { chip, offset, pulse_ms }")) {
        pulse->refuse_other_keys({"chip", "offset", "name", "pulse_ms"});
        s.out = read_gpio_line(*pulse);
        s.pulse_s = seconds(pulse->number("pulse_ms", {0.0, 10000.0, true})).value_or(s.pulse_s);
    }
    if (const auto edge = t.table("in", "in", "in = { chip, offset, edge }")) {
        edge->refuse_other_keys({"chip", "offset", "name", "edge", "debounce_ms", "pull"});
        s.in = read_gpio_line(*edge);
        s.edge = edge->kind<edge_kind>("edge").value_or(s.edge);
        s.debounce_s = seconds(edge->number("debounce_ms", {0.0, 10000.0})).value_or(s.debounce_s);
        s.pull = edge->kind<pull_kind>("pull").value_or(s.pull);
    }
    s.channel = t.whole("channel", bounds_of::marker_channel);
    if (const auto code = t.table("code", "code", code_hint))
        read_code(*code, s.code.emplace());
    if (const auto numbers = t.table("codes", "[sync.codes]", "[sync.codes] stimulus = 10")) {
        numbers->refuse_other_keys({"stimulus", "standard", "catch", "answer", "void"});
        if (!s.code)
            t.fail("codes", "nothing sends these numbers", code_hint);
        s.code->stimulus = read_numbering(*numbers, "stimulus");
        s.code->standard = read_numbering(*numbers, "standard");
        s.code->caught = read_numbering(*numbers, "catch");
        s.code->answer = read_numbering(*numbers, "answer");
        s.code->made_void = read_numbering(*numbers, "void");
    }
    if (s.code && s.channel && s.code->channel == s.channel)
        t.fail("channel", fmt::format("channel {} is also that of the code", *s.channel),
               "give the marker and the code different channels");
    out.sync_channel_at = t.where("channel");
    out.contents.sync = s;
}

void read_limits(const toml_table& t, located_setup& out)
{
    t.refuse_other_keys({"power_dbfs", "max_drive_s", "window_s"});
    limit_settings l;
    l.power_dbfs = t.number("power_dbfs", bounds_of::power_dbfs);
    l.max_drive_s = t.number("max_drive_s", bounds_of::drive_s);
    l.window_s = t.number("window_s", bounds_of::drive_s);
    out.contents.limits = join_limits(out.contents.limits, l);
}

// Reads [defaults] without interpreting the values.
void read_defaults(const toml_table& t, located_setup& out)
{
    for (const toml_table::key_value& e : t.entries())
        add_default(out.contents.defaults, read_value(t, e, *e.value, false));
}

// Reads [serve] without interpreting the values.
void read_serve(const toml_table& t, located_setup& out)
{
    std::vector<written_value> all;
    for (const toml_table::key_value& e : t.entries())
        if (const toml::array* list = e.value->as_array())
            for (const toml::node& n : *list)
                all.push_back(read_value(t, e, n, true));
        else
            all.push_back(read_value(t, e, *e.value, false));
    join_serve(out.contents.serve, all);
}

calibrated_tactor read_calibrated_tactor(const toml_table& t, std::vector<const toml_table*>& entries)
{
    t.refuse_other_keys({"tactor", "threshold_dbfs", "sd_db", "posterior_sd_db", "trials", "reversals_dbfs",
                         "check_right", "check_below_right", "staircases"});
    const unsigned i = t.need(t.whole("tactor", 0, static_cast<unsigned>(entries.size()) - 1), "tactor");
    record_entry(t, i, entries, "give each tactor one entry in [[calibration.tactor]]");
    for (const char* key : {"check_right", "check_below_right", "staircases"})
        t.whole(key, 0, most_whole);
    if (const toml::array* all = t.list("reversals_dbfs", "levels"))
        for (const toml::node& n : *all)
            t.to_number(n, "reversals_dbfs", limit_db);
    return {i, t.number("threshold_dbfs", limit_db), t.number("sd_db", spread_db),
            t.number("posterior_sd_db", spread_db), t.need(t.whole("trials", 0, most_whole), "trials")};
}

// Reads and checks [calibration] and [[calibration.tactor]], which describe the measurement of thresholds.
// Stores the participant and the carrier. Precondition: the array has been read.
void read_calibration(const toml_table& t, located_setup& out)
{
    if (!out.contents.array)
        t.fail("[calibration] is in a file without an array",
               "put [calibration] into an array file, as {command:calibrate} does");
    t.refuse_other_keys({"participant", "method", "rule", "carrier_hz", "interval_s", "feedback", "masker",
                         "date", "seed", "simulated", "tactor"});
    calibration_origin r;
    r.participant = t.need(t.text("participant"), "participant");
    r.method = t.need(t.choice("method", {"staircase", "adjustment", "quest"}), "method");
    r.rule = t.choice("rule", {"1up3down", "1up2down"});
    r.carrier_hz = t.need(t.number("carrier_hz", bounds_of::carrier_hz), "carrier_hz");
    r.interval_s = t.need(t.number("interval_s", bounds_of::interval_s), "interval_s");
    r.feedback = t.boolean("feedback");
    r.masker = t.text("masker");
    r.date = t.text("date");
    r.seed = t.whole("seed", 0, most_whole);
    r.simulated = t.boolean("simulated").value_or(false);
    const std::vector<toml_table> entries = t.tables("tactor");
    std::vector<const toml_table*> seen(out.contents.array->tactors.size());
    for (const toml_table& e : entries)
        r.tactors.push_back(read_calibrated_tactor(e, seen));
    out.contents.calibration = std::move(r);
}

// Reads [array] and [[tactor]]. If they include another file, also stores the other tables of that file.
void read_array(const toml_table& root, const setup_source& source, located_setup& out)
{
    if (!root.has("array") && !root.has("tactor"))
        return;
    const toml::table none;
    const toml_table table =
        root.table("array", "[array]", "[array]").value_or(toml_table(none, "[array]", source.name));
    if (table.has("tactor"))
        table.fail("tactor", "[[tactor]] is inside [array]", "write [[tactor]] at the top level of the file");
    table.refuse_other_keys({"name", "site", "up", "place", "turn", "body", "grid", "preset", "file",
                             "actuator", "mirror", "rotate_deg", "displacement_um_at_0dbfs", "max_dbfs"});
    const std::vector<toml_table> entries = root.tables("tactor");

    std::string_view base;
    if (table.has("grid") || table.has("preset") || table.has("file"))
        base = table.one_of({"grid", "preset", "file"});
    array a;
    const double max_dbfs = table.number("max_dbfs", limit_db).value_or(0.0);
    if (base.empty()) {
        if (entries.empty())
            table.fail("[array] has no tactors", "add grid, preset or file, or [[tactor]] entries");
        append_tactors(entries, max_dbfs, a);
    } else {
        a = read_base(table, base, source, out);
        for (tactor_spec& t : a.tactors)
            t.max_dbfs = std::min(t.max_dbfs, max_dbfs);
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
    out.contents.array = std::move(a);
}

located_setup read_setup(std::string_view text, const setup_source& source)
{
    const toml::table document = parse_toml(
        text, source.name,
        {.kinds = "use TOML for an array or a configuration; give points, drawings and plans as the STROKE"});
    const toml_table root(document, "the file", source.name);
    if (root.has("stroke"))
        root.fail("stroke", "this is a stroke file, not an array or configuration", "give it as the STROKE");
    root.refuse_other_keys({"array", "tactor", "output", "amplifier", "sync", "limits", "serve", "defaults",
                            "calibration", "texture"});

    located_setup out;
    read_array(root, source, out);
    constexpr std::pair<const char*, void (*)(const toml_table&, located_setup&)> tables[] = {
        {"calibration", read_calibration}, {"output", read_output},
        {"amplifier", read_amplifier},     {"sync", read_sync},
        {"limits", read_limits},           {"serve", read_serve},
        {"defaults", read_defaults}};
    for (const auto& [name, read] : tables) {
        const std::string title = fmt::format("[{}]", name);
        if (const auto t = root.table(name, title, title))
            read(*t, out);
    }
    if (const auto t = root.table("texture", "[texture]", "[texture]"))
        out.contents.texture = read_texture(*t, source.folder);

    if (out.contents.array)
        validate(*out.contents.array);
    check_channels(out);
    check_marker(out);
    check_lines(out.contents);
    return out;
}

} // namespace
} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

setup load_setup(const std::filesystem::path& file)
{
    const detail::whole_text text = detail::read_text_file(file, detail::max_setup_bytes);
    return detail::read_setup(text, {file.string(), file.parent_path()}).contents;
}

setup parse_setup(std::string_view toml, const std::string& name)
{
    return detail::read_setup(toml, {name, {}}).contents;
}

} // namespace v0
} // namespace tactor
