// SPDX-License-Identifier: MIT
#include "core/suggest.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/words.hpp"

namespace tactor::detail {
namespace {

constexpr std::size_t longest = 32; // longer than any name of tactor

// Converts a letter to lower case, and '-' and ' ' to '_'. Names that differ only in these characters are
// equal.
char fold_character(char c) noexcept
{
    if (c == '-' || c == ' ')
        return '_';
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// Returns the number of edits that change a into b. A swap of neighbours counts once (restricted
// Damerau-Levenshtein distance).
std::size_t edits(std::string_view a, std::string_view b)
{
    std::array<std::array<std::size_t, longest + 1>, longest + 1> d{};
    for (std::size_t i = 0; i <= a.size(); ++i)
        d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j)
        d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = fold_character(a[i - 1]) == fold_character(b[j - 1]);
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0 : 1)});
            if (i > 1 && j > 1 && fold_character(a[i - 1]) == fold_character(b[j - 2]) &&
                fold_character(a[i - 2]) == fold_character(b[j - 1]))
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    }
    return d[a.size()][b.size()];
}

// Returns true if one name begins with the other and goes on with '_', such as "gain" and "gain_db", or if
// the shorter one has at least four letters.
bool has_same_stem(std::string_view a, std::string_view b)
{
    const std::size_t n = std::min(a.size(), b.size());
    if (n == 0)
        return false;
    const bool agree = std::equal(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(n), b.begin(),
                                  [](char x, char y) { return fold_character(x) == fold_character(y); });
    const std::string_view rest = a.size() > b.size() ? a : b;
    return agree && (rest.size() == n || fold_character(rest[n]) == '_' || n >= 4);
}

/// A unit at the end of a name.
struct name_unit {
    std::string_view name;
    char kind;   ///< 't' for time, 'l' for length, 'p' for pixels
    double size; ///< in s or mm
};

constexpr std::array<name_unit, 10> units{{{"ns", 't', 1e-9},
                                           {"us", 't', 1e-6},
                                           {"ms", 't', 1e-3},
                                           {"s", 't', 1.0},
                                           {"min", 't', 60.0},
                                           {"um", 'l', 1e-3},
                                           {"mm", 'l', 1.0},
                                           {"cm", 'l', 10.0},
                                           {"m", 'l', 1000.0},
                                           {"px", 'p', 1.0}}};

// Returns the unit at the end of a name, or null if there is none.
const name_unit* find_unit(std::string_view name)
{
    const std::string_view last = name.substr(name.rfind('_') + 1);
    const auto found = std::find_if(units.begin(), units.end(), [last](const name_unit& u) {
        return std::equal(last.begin(), last.end(), u.name.begin(), u.name.end(),
                          [](char a, char b) { return fold_character(a) == b; });
    });
    return found == units.end() ? nullptr : &*found;
}

} // namespace

std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known)
{
    if (name.empty() || name.size() > longest)
        return {};
    std::string_view best;
    std::size_t best_edits = std::max<std::size_t>(1, name.size() / 3) + 1;
    for (const std::string_view k : known) {
        if (k.size() > longest)
            continue;
        const std::size_t e = std::min<std::size_t>(edits(name, k), has_same_stem(name, k) ? 1 : longest);
        // Skip a name that differs in every letter: any one-letter name is one edit from any other.
        if (e < best_edits && e < std::max(name.size(), k.size())) {
            best = k;
            best_edits = e;
        }
    }
    return best;
}

std::string similar_name_hint(std::string_view name, std::string_view near)
{
    const name_unit* from = find_unit(name);
    const name_unit* to = find_unit(near);
    if (from == nullptr || to == nullptr || from == to)
        return fmt::format("did you mean '{}'?", near);
    const std::string_view sign = from->size < to->size ? "divide" : "multiply";
    const double ratio = std::max(to->size / from->size, from->size / to->size);
    return fmt::format("'{}' is in {}, not {}{}", near, to->name, from->name,
                       from->kind == to->kind ? fmt::format(": {} by {:.9g}", sign, ratio) : "");
}

std::string suggestion(std::string_view name, std::span<const std::string_view> known, std::string_view kind)
{
    if (const std::string_view n = nearest_name(name, known); !n.empty())
        return similar_name_hint(name, n);
    return fmt::format("known {}: {}", kind, fmt::join(known, ", "));
}

error unknown_key(const source_place& at, std::string_view key, std::string_view title,
                  std::span<const std::string_view> known)
{
    return error(error_kind::bad_input, at, fmt::format("unknown key {} in {}", quoted(key), title),
                 suggestion(key, known, "keys"))
        .with_field(key);
}

std::string preset_hint(std::string_view name, const std::vector<std::string>& presets)
{
    const std::vector<std::string_view> known(presets.begin(), presets.end());
    const std::string_view near = nearest_name(name, known);
    return fmt::format("{}presets: {}", near.empty() ? "" : fmt::format("did you mean '{}'? ", near),
                       fmt::join(presets, ", "));
}

std::string choice_hint(std::string_view name, std::span<const std::string_view> known)
{
    const std::string_view near = nearest_name(name, known);
    return fmt::format("{} one of {}", near.empty() ? "use" : fmt::format("did you mean '{}'? Use", near),
                       fmt::join(known, ", "));
}

std::string quoted(std::string_view name)
{
    constexpr std::size_t shown = 40;
    std::string t(first_characters(name, shown));
    std::replace_if(
        t.begin(), t.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    return fmt::format("'{}{}'", t, t.size() < name.size() ? "..." : "");
}

} // namespace tactor::detail
