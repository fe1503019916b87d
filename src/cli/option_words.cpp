// SPDX-License-Identifier: MIT
#include "cli/option_words.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

namespace tactor::cli {
namespace {

struct translation {
    std::string_view field;
    std::string_view option;
};

// What can only mean a field, in advice too.
constexpr std::array<translation, 29> in_advice{
    {{"measure its detection threshold", "run tactor calibrate"},
     {"soa_s", "--soa"},
     {"duration_s", "--duration"},
     {"burst_s", "--burst"},
     {"carrier_hz", "--carrier"},
     {"ramp_s", "--ramp"},
     {"sl_db", "--sl"},
     {"level_dbfs", "--level-dbfs"},
     {"sample_format = ", "--sample-format "},
     {"sample_format", "--sample-format"},
     {"timing = ", "--timing "},
     {"outside = ", "--outside "},
     {"algorithm = ", "--algorithm "},
     {"faces = ", "--faces "},
     {"phantom = ", "--phantom "},
     {"force = true", "--force"},
     {"snap = true", "--snap"},
     {"drop_points = true", "--drop-points"},
     {"array = ", "--array "},
     {"config = FILE", "--config FILE"},
     {"wider = true leaves", "without a number of channels it leaves"},
     {"margin_mm", "--fit-margin"},
     {"leave array out", "say no --array"},
     {"fit_strokes()", "--fit"},
     {"texture_mm", "--texture-mm"},
     {"attack_s", "--attack"},
     {"release_s", "--release"},
     {"sigma_mm", "--sigma-mm"},
     {"sigma_v_mm_s", "--sigma-v-mm-s"}}};

// Words of every day.
constexpr std::array<translation, 9> as_subject{{{"rate", "--rate"},
                                                 {"shape", "--shape"},
                                                 {"channels", "--channels"},
                                                 {"phantom", "--phantom"},
                                                 {"faces", "--faces"},
                                                 {"simulate", "--simulate"},
                                                 {"waveform", "--waveform"},
                                                 {"am", "--am"},
                                                 {"spread", "--spread"}}};

// Those that files have as keys, too.
constexpr std::array<std::string_view, 8> keys{"duration_s", "soa_s",        "burst_s",  "carrier_hz",
                                               "texture_mm", "algorithm = ", "faces = ", "phantom = "};

bool is_key(std::string_view field)
{
    return std::find(keys.begin(), keys.end(), field) != keys.end();
}

bool in_a_word(char c)
{
    return c == '_' || c == '-' || c == '.' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
           (c >= 'A' && c <= 'Z');
}

std::string replaced(std::string text, bool but_keys = false)
{
    for (const translation& t : in_advice) {
        if (but_keys && is_key(t.field))
            continue;
        for (std::size_t at = text.find(t.field); at != std::string::npos; at = text.find(t.field, at + 1)) {
            const std::size_t end = at + t.field.size();
            const bool begins = at == 0 || !in_a_word(text[at - 1]);
            const bool ends = t.field.back() == ' ' || end == text.size() || !in_a_word(text[end]);
            if (begins && ends)
                text.replace(at, t.field.size(), t.option);
        }
    }
    return text;
}

std::string subject(std::string_view what)
{
    for (const translation& t : as_subject)
        if (what == t.field)
            return std::string(t.option);
    // A file's name and its keys stay as they are.
    for (const translation& t : in_advice)
        if (what.substr(0, t.field.size()) == t.field)
            return replaced(std::string(what));
    return std::string(what);
}

} // namespace

error in_options(const error& e)
{
    return e.reworded(subject(e.subject()), e.why(), replaced(std::string(e.hint()), e.place().line != 0));
}

} // namespace tactor::cli
