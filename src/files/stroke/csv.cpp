// SPDX-License-Identifier: MIT
// Timed points as comma-separated values.
#include <tactor/stroke.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/limits.hpp"
#include "core/path/number.hpp"
#include "core/suggest.hpp"
#include "core/words.hpp"
#include "files/stroke/parts.hpp"
#include "files/text_file.hpp"

namespace tactor {
inline namespace v0 {
namespace {

enum column : std::size_t { t_s, x_mm, y_mm, intensity, columns };

constexpr std::array<std::string_view, columns> names{"t_s", "x_mm", "y_mm", "intensity"};

struct field {
    std::string_view text;
    std::size_t column = 1; ///< where it begins, from 1
};

class csv_reader {
public:
    csv_reader(std::string_view text, const std::string& name)
        : rest_(detail::without_mark(text)), name_(name)
    {
    }

    std::vector<stroke> read()
    {
        if (!next_line())
            fail({}, "is empty", header_hint);
        header();
        // Exactly: a vector that grows needs three times as much for a moment.
        points_.reserve(std::min<std::size_t>(std::count(rest_.begin(), rest_.end(), '\n') + 1, most_points));
        while (next_line())
            if (const std::optional<timed_point> p = row())
                add_behind_gap(*p);
        if (points_.size() < 2)
            fail({},
                 fmt::format("{} of at least 2 points{}", points_.size(),
                             repeated_ != 0 ? " with times of their own" : ""),
                 "give where the stroke starts and where it ends");
        return {{.name = detail::stem(name_),
                 .motion = trajectory::timed(std::move(points_)),
                 .warnings = warnings()}};
    }

private:
    /// Seconds since 1970 are 1.8e9; farther from zero a time does not hold microseconds.
    static constexpr double farthest_time_s = 1e10;
    static constexpr std::size_t most_fields = 1000;
    static constexpr std::size_t most_points = 10'000'000;
    static constexpr std::string_view header_hint =
        "the first line names the columns: t_s,x_mm,y_mm,intensity";

    // Reads the next line with something on it into line_.
    bool next_line()
    {
        while (!rest_.empty()) {
            const std::size_t end = rest_.find('\n');
            line_ = rest_.substr(0, end);
            rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
            ++line_number_;
            std::size_t at = 0;
            detail::skip_blanks(line_, at);
            if (at < line_.size() && line_[at] != '#')
                return true;
        }
        return false;
    }

    // Splits line_ at its commas; quotes and blanks round a field go.
    void split()
    {
        fields_.clear();
        for (std::size_t at = 0;; ++at) {
            if (fields_.size() == most_fields)
                fail(at + 1, fmt::format("more than {} values in a line", most_fields), header_hint);
            detail::skip_blanks(line_, at);
            fields_.push_back(at < line_.size() && line_[at] == '"' ? quoted_field(at) : plain_field(at));
            if (at == line_.size())
                return;
        }
    }

    field plain_field(std::size_t& at)
    {
        const std::size_t begin = at;
        at = std::min(line_.find(',', begin), line_.size());
        std::size_t end = at;
        while (end > begin && detail::blank(line_[end - 1]))
            --end;
        return {line_.substr(begin, end - begin), begin + 1};
    }

    field quoted_field(std::size_t& at)
    {
        const std::size_t begin = at + 1;
        const std::size_t end = line_.find('"', begin);
        if (end == std::string_view::npos)
            fail(at + 1, "a quote that does not end", "quotes are not needed");
        at = end + 1;
        detail::skip_blanks(line_, at);
        if (at < line_.size() && line_[at] != ',')
            fail(at + 1, "text behind a quote", "separate the columns by commas");
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
                fail(f.column, fmt::format("column {} twice", names[c]), "name each column once");
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

    // Ignores columns that a tracker adds; refuses one whose name is a slip of a known name.
    void leave_out(const field& f, std::span<const std::string_view> absent)
    {
        if (const std::string_view near = detail::nearest_name(f.text, absent); !near.empty())
            fail(f.column, fmt::format("unknown column {}", detail::quoted(f.text)),
                 fmt::format("did you mean {}?", detail::quoted(near)));
        constexpr std::size_t most_named = 5;
        if (++left_out_ <= most_named)
            left_out_names_ += fmt::format("{}{}", left_out_ == 1 ? "" : ", ", detail::quoted(f.text));
        header_line_ = line_number_;
    }

    // Adds a point. Touch screens give several places the time of one report: the last is where the finger
    // is.
    void add(const timed_point& p)
    {
        if (points_.empty() || p.t_s != points_.back().t_s) {
            if (points_.size() == most_points)
                fail({}, fmt::format("more than {} points", most_points), "thin them out, or cut it in two");
            points_.push_back(p);
            return;
        }
        points_.back() = p;
        if (repeated_++ == 0)
            first_repeated_ = line_number_;
    }

    // Adds a point. Behind a gap the touch is lifted from the last place to this one.
    void add_behind_gap(const timed_point& p)
    {
        constexpr double at_once_s = 1e-6;
        if (std::exchange(in_gap_, false) && !points_.empty() && p.t_s > points_.back().t_s) {
            const timed_point last = points_.back();
            const double edge_s = std::min(at_once_s, (p.t_s - last.t_s) / 4.0);
            add({last.t_s + edge_s, last.position, 0.0});
            add({p.t_s - edge_s, p.position, 0.0});
        }
        add(p);
    }

    std::vector<std::string> warnings() const
    {
        std::vector<std::string> all;
        const auto warn = [&](unsigned line, const std::string& text) {
            all.push_back(fmt::format("{}: {}", source_place{name_, line, 0}.text(), text));
        };
        if (left_out_ != 0)
            warn(header_line_,
                 fmt::format("{} left out: {}{}", left_out_ == 1 ? "this column is" : "these columns are",
                             left_out_names_, left_out_ > 5 ? ", ..." : ""));
        if (gaps_ != 0)
            warn(first_gap_,
                 fmt::format("no place (nan) in {}: the touch is lifted there",
                             gaps_ == 1 ? "this line"
                                        : fmt::format("{} from here on", counted(gaps_, "line"))));
        if (repeated_ == 1)
            warn(first_repeated_, "repeats the time of the line before, which does not count");
        if (repeated_ > 1)
            warn(first_repeated_, fmt::format("repeats the time of the line before, as {} lines do in all; "
                                              "the last of equal times counts",
                                              repeated_));
        return all;
    }

    // Returns none for a line in which a tracker had lost its target.
    std::optional<timed_point> row()
    {
        split();
        if (fields_.size() != order_.size())
            fail(fields_[std::min(fields_.size(), order_.size()) - 1].column,
                 fmt::format("{} where the header names {}", counted(fields_.size(), "value"),
                             counted(order_.size(), "column")),
                 "numbers have a decimal point, and a comma stands only between them");
        for (std::size_t i = 0; i < order_.size(); ++i)
            if (order_[i] != columns && order_[i] != t_s && detail::is_missing(fields_[i].text)) {
                in_gap_ = true;
                if (gaps_++ == 0)
                    first_gap_ = line_number_;
                return std::nullopt;
            }
        timed_point p;
        for (std::size_t i = 0; i < order_.size(); ++i) {
            if (order_[i] == columns)
                continue;
            double v = value(fields_[i], order_[i]);
            if (order_[i] == t_s)
                v = since_first(fields_[i], v);
            (order_[i] == t_s    ? p.t_s
             : order_[i] == x_mm ? p.position.x_mm
             : order_[i] == y_mm ? p.position.y_mm
                                 : p.intensity) = v;
        }
        return p;
    }

    // Recorders count from any moment, so the first line is the stroke's zero. Order is that of the
    // differences: two times far from zero may have the same.
    double since_first(const field& f, double time)
    {
        if (points_.empty())
            first_time_ = time;
        const double t = time - first_time_;
        if (!points_.empty() && t < points_.back().t_s)
            fail(f.column, fmt::format("time {} s is before {} s of the line before", time, last_time_),
                 "times ascend");
        if (t > detail::longest_stroke_s)
            fail(f.column, fmt::format("time {} s is {} s after the first line", time, t),
                 fmt::format("a stroke lasts at most {:g} s", detail::longest_stroke_s));
        last_time_ = time;
        return t;
    }

    double value(const field& f, column c) const
    {
        if (f.text.empty())
            fail(f.column, fmt::format("{} is missing", names[c]),
                 "give a number, or nan where there is none");
        std::size_t end = 0;
        const auto v = detail::scan_number(f.text, end);
        if (!v || end != f.text.size())
            fail(f.column, fmt::format("{} is not a number: {}", names[c], detail::quoted(f.text)),
                 "e.g. 12.5");
        const bool place = c == x_mm || c == y_mm;
        const double high = place ? detail::max_mm : c == t_s ? farthest_time_s : detail::max_intensity;
        const double low = c == intensity ? 0.0 : -high;
        if (!(*v >= low && *v <= high))
            fail(f.column,
                 fmt::format("{} {}", names[c], f.text.size() > 40 ? detail::quoted(f.text) : f.text),
                 fmt::format("it is between {:g} and {:g}", low, high));
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
    std::vector<column> order_; ///< `columns`: left out
    std::size_t left_out_ = 0;
    std::string left_out_names_;
    unsigned header_line_ = 0;
    std::vector<timed_point> points_;
    double first_time_ = 0.0;
    double last_time_ = 0.0;
    std::size_t repeated_ = 0; ///< lines that replaced the one before
    unsigned first_repeated_ = 0;
    bool in_gap_ = false;
    std::size_t gaps_ = 0; ///< lines without a place
    unsigned first_gap_ = 0;
};

} // namespace

std::vector<stroke> parse_strokes_csv(std::string_view text, const std::string& name)
{
    detail::check_size(text, name, detail::max_stroke_bytes, "is it the right file?");
    if (!detail::without_blanks(text).empty())
        detail::refuse_other_form(text, name, "csv");
    detail::refuse_other_columns(detail::without_mark(text), name);
    return csv_reader(text, name).read();
}

} // namespace v0
} // namespace tactor
