// SPDX-License-Identifier: MIT
// Tables of a study's folder: read, asked for each cell, and written with a line and a cell more.
#include <cmath>
#include <optional>
#include <string>

#include "holds.hpp"
#include "study/data/text_table.hpp"

using namespace tactor;
using study::text_table;

namespace {

void check_cells(const text_table& t)
{
    for (const std::string& column : t.columns())
        for (std::size_t row = 0; row < t.rows(); ++row) {
            HOLDS(fuzz::accepted([&] { return t.need(row, column); }) == t.cell(row, column).value_or(""));
            fuzz::accepted([&] { return t.truth(row, column); });
            const auto number = fuzz::accepted([&] { return t.number(row, column); });
            HOLDS(!number || std::isfinite(*number));
            const auto whole = fuzz::accepted([&] { return t.whole(row, column, 2, 9); });
            HOLDS(!whole || (number && *whole == *number && *whole >= 2 && *whole <= 9));
        }
}

/// A quote that does not end before the line does may end in what is written behind it.
bool has_open_quote(const text_table& t)
{
    const auto opens = [](std::string_view cell) { return cell.starts_with('"'); };
    for (const std::string& column : t.columns()) {
        for (std::size_t row = 0; row < t.rows(); ++row)
            if (opens(t.cell(row, column).value_or("")))
                return true;
        if (opens(column))
            return true;
    }
    return false;
}

/// `text` is `old` with this cell changed, in its last row but for the rows that are `more`.
void check_written(const text_table& old, std::string text, const std::string& cell, std::size_t more)
{
    const text_table now("again.tsv", std::move(text));
    HOLDS(now.columns() == old.columns());
    HOLDS(now.rows() == old.rows() + more);
    const std::string& changed = old.columns().front();
    for (const std::string& column : old.columns())
        for (std::size_t row = 0; row < now.rows(); ++row) {
            const bool last = row + 1 == now.rows();
            if (last && column == changed)
                HOLDS(now.need(row, column) == cell);
            else if (row < old.rows())
                HOLDS(now.cell(row, column) == old.cell(row, column));
            else
                HOLDS(!now.cell(row, column));
        }
}

void check_table(std::string_view text, study::last_line end)
{
    const auto t =
        fuzz::accepted([&] { return std::optional(text_table("fuzz.tsv", std::string(text), end)); });
    if (!t)
        return;
    HOLDS(!t->columns().empty());
    check_cells(*t);
    if (const auto at = t->cut_position()) {
        HOLDS(end == study::last_line::may_be_cut && *at < text.size() && !t->is_open());
        return;
    }
    if (has_open_quote(*t))
        return;
    const std::string& column = t->columns().front();
    const std::string cell = "\"" + t->columns().back();
    check_written(*t, t->text_with_line({{column, cell}}), cell, 1);
    if (t->rows() != 0)
        check_written(*t, t->text_with_cells(t->rows() - 1, {{column, cell}}), cell, 0);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    for (const auto end : {study::last_line::whole, study::last_line::may_be_cut})
        check_table(fuzz::as_text(data, size), end);
    return 0;
}
