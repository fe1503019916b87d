// SPDX-License-Identifier: MIT
// [calibration] and [[calibration.tactor]].
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "files/setup_parts.hpp"

namespace tactor::detail {
namespace {

constexpr bounds any_level_db{min_db, 0.0};
constexpr bounds spread_db{0.0, -min_db};
constexpr unsigned any_number = std::numeric_limits<unsigned>::max();

calibrated_tactor read_tactor(const toml_table& t, std::vector<const toml_table*>& said)
{
    t.only({"tactor", "threshold_dbfs", "sd_db", "trials", "reversals_dbfs", "check_right",
            "check_below_right", "staircases"});
    const unsigned i = t.need(t.whole("tactor", 0, static_cast<unsigned>(said.size()) - 1), "tactor");
    if (said[i] != nullptr)
        t.fail("tactor", fmt::format("tactor {} has an entry already ({})", i, said[i]->where().text()),
               "it is measured once in a calibration");
    said[i] = &t;
    calibrated_tactor r{i, t.number("threshold_dbfs", any_level_db), t.number("sd_db", spread_db),
                        t.need(t.whole("trials", 0, any_number), "trials")};
    for (const char* key : {"check_right", "check_below_right", "staircases"})
        t.whole(key, 0, any_number);
    if (const toml::array* all = t.list("reversals_dbfs", "levels"))
        for (const toml::node& n : *all)
            t.number_of(n, "reversals_dbfs", any_level_db);
    return r;
}

} // namespace

void read_calibration(const toml_table& root, located_setup& said)
{
    const auto t = root.table("calibration", "[calibration]", "[calibration]");
    if (!t)
        return;
    if (!said.said.array)
        t->fail("there is no array that it is of",
                "it stands in an array file, as tactor calibrate writes it");
    t->only({"participant", "method", "rule", "carrier_hz", "interval_s", "feedback", "masker", "date",
             "seed", "simulated", "tactor"});
    calibration_origin r;
    r.participant = t->need(t->text("participant"), "participant");
    r.method = t->need(t->choice("method", {"staircase", "adjustment"}), "method");
    r.rule = t->choice("rule", {"1up3down", "1up2down"});
    r.carrier_hz = t->need(t->number("carrier_hz", bounds_of::carrier_hz), "carrier_hz");
    r.interval_s = t->need(t->number("interval_s", bounds_of::interval_s), "interval_s");
    r.feedback = t->boolean("feedback");
    r.masker = t->text("masker");
    r.date = t->text("date");
    r.seed = t->whole("seed", 0, any_number);
    r.simulated = t->boolean("simulated").value_or(false);
    const std::vector<toml_table> entries = t->tables("tactor");
    std::vector<const toml_table*> seen(said.said.array->tactors.size());
    for (const toml_table& e : entries)
        r.tactors.push_back(read_tactor(e, seen));
    said.said.calibration = std::move(r);
}

} // namespace tactor::detail
