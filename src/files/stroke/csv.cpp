// SPDX-License-Identifier: MIT
// Timed points as comma-separated values.
#include <tactor/stroke.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/split.hpp"
#include "core/suggest.hpp"
#include "core/trajectory/recorded_points.hpp"
#include "core/trajectory/spans.hpp"
#include "core/words.hpp"
#include "files/stroke_format.hpp"
#include "files/text_file.hpp"

namespace tactor {
inline namespace v0 {
namespace {

using detail::scan_number;
using detail::split;
using detail::without_blanks;

constexpr std::string_view first_column = "t_s";
constexpr std::size_t longest_look = 4096;

struct other_separator {
    char separator;
    std::string_view name;
    std::string_view hint;
};

constexpr other_separator other_separators[] = {
    {';', "semicolons", "separate them by commas, and write numbers with a decimal point"},
    {'\t', "tabs", "separate them by commas: tr '\\t' ',' < OLD > NEW"},
    {' ', "blanks", "separate them by commas: tr -s ' ' ',' < OLD > NEW"}};

// Returns true for "nan" in any case, and for "NA".
bool is_missing(std::string_view value)
{
    return value == "NA" || (value.size() == 3 && to_lower_case(std::string(value)) == "nan");
}

bool is_number(std::string_view s)
{
    s = without_blanks(s);
    if (s.size() > 1 && s.front() == '"' && s.back() == '"')
        s = s.substr(1, s.size() - 2);
    std::size_t end = 0;
    return is_missing(s) || (scan_number(s, end) && end == s.size());
}

void refuse_lone_cr(std::string_view text, const std::string& name)
{
    // Ignores CR characters before LF or at the end of the text.
    std::string_view first = text.substr(0, text.find('\n'));
    while (!first.empty() && first.back() == '\r')
        first.remove_suffix(1);
    if (const std::size_t at = first.find('\r'); at != std::string_view::npos)
        throw error(error_kind::bad_input, detail::find_place(text, at, name), "its lines end in CR only",
                    "save it with Unix line ends, or convert it: tr '\\r' '\\n"
                    "' < OLD > NEW");
}

/// Returns the separator of a line with names or numbers, or null if it is a comma or not recognised.
const other_separator* find_other_separator(std::string_view line)
{
    if (line.find(',') != std::string_view::npos && line.find(';') == std::string_view::npos)
        return nullptr;
    for (const other_separator& s : other_separators) {
        std::size_t filled = 0;
        bool fits = false;
        for (const std::string_view part : split(line, s.separator)) {
            const std::string_view value = without_blanks(part);
            filled += value.empty() ? 0 : 1;
            // If semicolons separate the values, 0,5 is a number with a decimal comma.
            fits =
                fits || value.empty() || value == first_column || is_number(part.substr(0, part.find(',')));
        }
        if (filled > 1 && fits)
            return &s;
    }
    return nullptr;
}

// Refuses lines that end with CR alone, separators other than commas, a missing header and a header in a
// comment. Each case has its own message.
void refuse_other_columns(std::string_view text, const std::string& name)
{
    refuse_lone_cr(text, name);
    source_place comment;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        // Looks only at the line's first bytes, because a line may be as long as the file.
        const std::string_view line = without_blanks(text.substr(at, std::min(end - at, longest_look)));
        if (line.starts_with('#') && line.find(first_column) != std::string_view::npos)
            comment = detail::find_place(text, at, name);
        if (line.empty() || line.starts_with('#')) {
            at = end + 1;
            continue;
        }
        const source_place here = detail::find_place(text, at, name);
        if (const other_separator* other = find_other_separator(line))
            throw error(error_kind::bad_input, here, fmt::format("{} separate its columns", other->name),
                        other->hint);
        const std::vector<std::string_view> parts = split(line, ',');
        if (parts.size() < 2 || !std::all_of(parts.begin(), parts.end(), is_number))
            return;
        if (comment.line != 0)
            throw error(error_kind::bad_input, comment, "the line that names the columns is a comment",
                        "remove the # of this line; numpy.savetxt() accepts comments=\"\"");
        throw error(error_kind::bad_input, here, "no line names the columns", "begin with: t_s,x_mm,y_mm");
    }
}

enum column : std::size_t { t_s, x_mm, y_mm, intensity, columns };

constexpr std::array<std::string_view, columns> names{"t_s", "x_mm", "y_mm", "intensity"};
static_assert(columns == static_cast<std::size_t>(detail::recorded::row));

struct field {
    std::string_view text;
    std::size_t column = 1; ///< column of the line at which the field begins, from 1
};

class csv_reader {
public:
    csv_reader(std::string_view text, const std::string& name, double intensity_max)
        : rest_(detail::strip_byte_order_mark(text)),
          name_(name),
          points_(
              intensity_max, [this](detail::recorded value) { return find_place(value); }, "line")
    {
    }

    std::vector<stroke> read()
    {
        if (!next_line())
            fail({}, "it is empty", header_hint);
        header();
        // Reserves the exact number of points, because a growing vector briefly needs three times the memory.
        points_.reserve(std::min<std::size_t>(std::count(rest_.begin(), rest_.end(), '\n') + 1, most_lines));
        while (next_line())
            row();
        const trajectory motion = trajectory::timed(points_.take());
        return {{.name = detail::stem(name_), .motion = motion, .warnings = warnings()}};
    }

private:
    static constexpr std::size_t most_fields = 1000;
    static constexpr std::size_t most_lines = 10'000'000;
    static constexpr std::size_t most_named = 5; ///< greatest number of columns that a message names
    static constexpr std::string_view header_hint =
        "name the columns in the first line: t_s,x_mm,y_mm,intensity";

    // Reads the next non-empty line into line_. Skips lines that contain only commas, which are empty rows of
    // a spreadsheet.
    bool next_line()
    {
        while (!rest_.empty()) {
            const std::size_t end = rest_.find('\n');
            line_ = rest_.substr(0, end);
            rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
            ++line_number_;
            std::size_t at = 0;
            detail::skip_blanks(line_, at);
            if (line_.find_first_not_of(", \t\r\f") != std::string_view::npos && line_[at] != '#')
                return true;
        }
        return false;
    }

    // Splits line_ at its commas; removes quotes and blanks around fields.
    void split()
    {
        fields_.clear();
        for (std::size_t at = 0;; ++at) {
            if (fields_.size() == most_fields)
                fail(at + 1, fmt::format("the line has more than {} values", most_fields), header_hint);
            detail::skip_blanks(line_, at);
            fields_.push_back(at < line_.size() && line_[at] == '"' ? read_quoted_field(at)
                                                                    : read_plain_field(at));
            if (at == line_.size())
                return;
        }
    }

    field read_plain_field(std::size_t& at)
    {
        const std::size_t begin = at;
        at = std::min(line_.find(',', begin), line_.size());
        return {without_blanks(line_.substr(begin, at - begin)), begin + 1};
    }

    field read_quoted_field(std::size_t& at)
    {
        const std::size_t begin = at + 1;
        const std::size_t end = line_.find('"', begin);
        if (end == std::string_view::npos)
            fail(at + 1, "a quote is not closed", "leave out the quotes");
        at = end + 1;
        detail::skip_blanks(line_, at);
        if (at < line_.size() && line_[at] != ',')
            fail(at + 1, "there is text after a quote", "separate the columns by commas");
        return {line_.substr(begin, end - begin), begin + 1};
    }

    void header()
    {
        split();
        std::array<bool, columns> seen{};
        for (const field& f : fields_) {
            const auto c =
                static_cast<std::size_t>(std::find(names.begin(), names.end(), f.text) - names.begin());
            if (c < columns && seen[c])
                fail(f.column, fmt::format("the column {} occurs twice", names[c]), "name each column once");
            if (c < columns)
                seen[c] = true;
            order_.push_back(static_cast<column>(c));
        }
        std::vector<std::string_view> absent;
        for (std::size_t c = 0; c < columns; ++c)
            if (!seen[c])
                absent.push_back(names[c]);
        for (std::size_t i = 0; i < order_.size(); ++i)
            if (order_[i] == columns)
                leave_out(fields_[i], absent);
        if (!absent.empty() && absent.front() != names[intensity])
            fail({}, fmt::format("no column {}", absent.front()), header_hint);
    }

    // Ignores columns that tracking programs add. Refuses a column whose name is almost a known name.
    void leave_out(const field& f, std::span<const std::string_view> absent)
    {
        if (const std::string_view near = detail::nearest_name(f.text, absent); !near.empty())
            fail(f.column, fmt::format("unknown column {}", detail::quoted(f.text)),
                 detail::similar_name_hint(f.text, near));
        if (++left_out_ <= most_named)
            left_out_names_ += fmt::format("{}{}", left_out_ == 1 ? "" : ", ", detail::quoted(f.text));
        header_line_ = line_number_;
    }

    std::vector<std::string> warnings() const
    {
        std::vector<std::string> all = points_.warnings();
        if (left_out_ != 0)
            all.insert(all.begin(),
                       fmt::format("{}: {} left out: {}{}", source_place{name_, header_line_, 0}.text(),
                                   left_out_ == 1 ? "this column is" : "these columns are", left_out_names_,
                                   left_out_ > most_named ? ", ..." : ""));
        return all;
    }

    // Adds a point from the current line.
    void row()
    {
        split();
        if (fields_.size() != order_.size())
            fail(fields_[std::min(fields_.size(), order_.size()) - 1].column,
                 fmt::format("{}, but the header names {}", counted(fields_.size(), "value"),
                             counted(order_.size(), "column")),
                 "write a decimal point, and commas only between numbers");
        timed_point p;
        for (std::size_t i = 0; i < order_.size(); ++i)
            if (order_[i] != columns && order_[i] != t_s && is_missing(fields_[i].text))
                p.intensity = std::numeric_limits<double>::quiet_NaN(); // the tracker did not see its target
        for (std::size_t i = 0; i < order_.size() && !std::isnan(p.intensity); ++i)
            if (order_[i] != columns)
                (order_[i] == t_s    ? p.t_s
                 : order_[i] == x_mm ? p.position.x_mm
                 : order_[i] == y_mm ? p.position.y_mm
                                     : p.intensity) = value(fields_[i], order_[i]);
        points_.add(p);
    }

    source_place find_place(detail::recorded value) const
    {
        const auto at = std::find(order_.begin(), order_.end(), static_cast<column>(value));
        const auto i = static_cast<std::size_t>(at - order_.begin());
        const bool whole = value == detail::recorded::row || i >= fields_.size();
        return {name_, line_number_, whole ? 0 : static_cast<unsigned>(fields_[i].column)};
    }

    double value(const field& f, column c) const
    {
        if (f.text.empty())
            fail(f.column, fmt::format("{} is missing", names[c]), "give a number, or nan for none");
        std::size_t end = 0;
        const auto v = scan_number(f.text, end);
        if (!v || end != f.text.size())
            fail(f.column, fmt::format("{} is not a number: {}", names[c], detail::quoted(f.text)),
                 "e.g. 12.5");
        return *v;
    }

    [[noreturn]] void fail(std::optional<std::size_t> at, std::string_view why, std::string_view hint) const
    {
        const source_place place{name_, line_number_, static_cast<unsigned>(at.value_or(0))};
        throw error(error_kind::bad_input, place, why, hint);
    }

    std::string_view rest_;
    const std::string& name_;
    std::string_view line_;
    unsigned line_number_ = 0;
    std::vector<field> fields_;
    std::vector<column> order_; ///< column of each field; `columns` marks ignored ones
    std::size_t left_out_ = 0;
    std::string left_out_names_;
    unsigned header_line_ = 0;
    detail::recorded_points points_;
};

std::vector<stroke> read_csv(const detail::stroke_file_text& s)
{
    if (!without_blanks(s.text).empty())
        detail::refuse_other_form(s.text, s.name, detail::text_form::table);
    refuse_other_columns(detail::strip_byte_order_mark(s.text), s.name);
    return csv_reader(s.text, s.name, s.intensity_max).read();
}

} // namespace
} // namespace v0
} // namespace tactor

namespace tactor::detail {
namespace {

std::string format_csv(std::span<const stroke> one)
{
    std::string out = "t_s,x_mm,y_mm,intensity\n";
    for (const timed_point& p : sample_points(one.front().motion))
        fmt::format_to(std::back_inserter(out), "{},{},{},{}\n", p.t_s, p.position.x_mm, p.position.y_mm,
                       p.intensity);
    return out;
}

constexpr std::string_view csv_extensions[] = {".csv"};

} // namespace

extern const stroke_format csv_strokes{
    .name = "csv",
    .title = "CSV",
    .extensions = csv_extensions,
    .media_type = "text/csv",
    .begins = [](std::string_view text) { return find_text_form(text) == text_form::table; },
    .parse = read_csv,
    .write = format_csv,
    .only_points = true,
    .most_bytes = max_stroke_bytes,
};

} // namespace tactor::detail

namespace tactor {
inline namespace v0 {

std::vector<stroke> parse_strokes_csv(std::string_view text, const std::string& name, double intensity_max)
{
    return detail::read_stroke_text(detail::csv_strokes, {text, name, intensity_max});
}

} // namespace v0
} // namespace tactor
