// SPDX-License-Identifier: MIT
#include "plot/paint/output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>

#include <boost/crc.hpp>
#include <fmt/format.h>

#include <tactor/error.hpp>

#include "core/words.hpp"
#include "files/output_file.hpp"

namespace tactor::plot {
namespace {

namespace fs = std::filesystem;

// Fonts for programs that do not have the typeface. Verdana has the same width.
constexpr std::string_view other_fonts = "Verdana, sans-serif";

std::string escape_xml(std::string_view text)
{
    constexpr std::array<std::pair<char, std::string_view>, 4> names{
        {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}}};
    std::string out;
    for (const char c : clean(text)) {
        const auto known = std::ranges::find(names, c, &std::pair<char, std::string_view>::first);
        if (known == names.end())
            out += c;
        else
            out += known->second;
    }
    return out;
}

// Formats a coordinate in thousandths of a point, which is more precise than any printer.
std::string coordinate(double v)
{
    std::string s = fmt::format("{:.3f}", std::isfinite(v) ? v : 0.0);
    s.erase(s.find_last_not_of('0') + 1);
    if (s.back() == '.')
        s.pop_back();
    return s == "-0" ? "0" : s;
}

class writer {
public:
    std::string write(const canvas& c)
    {
        add("<?xml version=\"1.0\" encoding=\"UTF-8\"{}xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" "
            "height=\"{}mm\" viewBox=\"0 0 {} {}\" "
            "role=\"img\" aria-labelledby=\"title desc\" font-family=\"'{}', {}\">\n",
            svg_mark, coordinate(c.width / pt_per_mm), coordinate(c.height / pt_per_mm), coordinate(c.width),
            coordinate(c.height), typeface, other_fonts);
        add("<title id=\"title\">{}</title>\n<desc id=\"desc\">{}</desc>\n", escape_xml(c.title),
            escape_xml(c.description));
        add("<rect width=\"{}\" height=\"{}\" fill=\"#fff\"/>\n", coordinate(c.width), coordinate(c.height));
        loop_s_ = c.loop_s;
        for (const canvas::element& e : c.elements)
            std::visit(*this, e);
        return out_ + "</svg>\n";
    }

    void operator()(const item::group_begin& g) { add("<g{}>{}\n", marks(g.m), title(g.m)); }
    void operator()(const item::group_end&) { out_ += "</g>\n"; }
    void operator()(const item::line& l)
    {
        add("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}{}", coordinate(l.from.x), coordinate(l.from.y),
            coordinate(l.to.x), coordinate(l.to.y), paint(l.s), marks(l.m));
        close("line", l.m);
    }
    void operator()(const item::poly& p)
    {
        add("<{} points=\"", name(p));
        for (std::size_t i = 0; i < p.points.size(); ++i)
            add("{}{},{}", i == 0 ? "" : " ", coordinate(p.points[i].x), coordinate(p.points[i].y));
        add("\"{}{}", paint(p.s), marks(p.m));
        close(name(p), p.m);
    }
    void operator()(const item::rect& r)
    {
        add("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}{}", coordinate(r.b.x), coordinate(r.b.y),
            coordinate(r.b.width), coordinate(r.b.height), paint(r.s), marks(r.m));
        close("rect", r.m);
    }
    void operator()(const item::circle& o)
    {
        add("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}{}", coordinate(o.centre.x), coordinate(o.centre.y),
            coordinate(o.radius), paint(o.s), marks(o.m));
        if (o.moves)
            add(" opacity=\"0\">{}{}</circle>\n", title(o.m), format_animation(*o.moves));
        else
            close("circle", o.m);
    }
    void operator()(const item::text& t)
    {
        add("<text x=\"{}\" y=\"{}\" font-size=\"{}\"", coordinate(t.at.x), coordinate(t.at.y),
            coordinate(t.s.size));
        if (t.s.upwards)
            add(" transform=\"rotate(-90 {} {})\"", coordinate(t.at.x), coordinate(t.at.y));
        if (t.s.anchor != align::start)
            add(" text-anchor=\"{}\"", t.s.anchor == align::middle ? "middle" : "end");
        if (t.s.bold)
            out_ += " font-weight=\"bold\"";
        if (t.s.halo)
            out_ += " stroke=\"#fff\" stroke-width=\"1.6\" stroke-linejoin=\"round\" paint-order=\"stroke\"";
        add("{}{}>{}</text>\n", attributes("fill", t.s.ink), marks(t.m), escape_xml(t.string));
    }

private:
    template <class... Args>
    void add(fmt::format_string<Args...> text, Args&&... args)
    {
        fmt::format_to(std::back_inserter(out_), text, std::forward<Args>(args)...);
    }

    // Returns an animation. Times are fractions of the loop. The loop starts again with the first value.
    std::string animate(std::string_view attribute, std::string_view how, const std::string& times,
                        const std::string& values) const
    {
        return fmt::format("<animate attributeName=\"{}\" dur=\"{:.6g}s\" repeatCount=\"indefinite\"{} "
                           "keyTimes=\"{}\" values=\"{}\"/>",
                           attribute, loop_s_, how, times, values);
    }

    std::string format_animation(const animation& a) const
    {
        const bool first = a.from <= 0.0;
        std::string all =
            animate("opacity", " calcMode=\"discrete\"",
                    fmt::format("{}{:.6g}", first ? "0;" : fmt::format("0;{:.6g};", a.from), a.to),
                    first ? "1;0" : "0;1;0");
        if (a.places.size() < 2)
            return all;
        std::string times = first ? "" : "0;";
        std::string x = first ? "" : coordinate(a.places.front().x) + ";";
        std::string y = first ? "" : coordinate(a.places.front().y) + ";";
        for (std::size_t i = 0; i < a.places.size(); ++i) {
            const double u = static_cast<double>(i) / static_cast<double>(a.places.size() - 1);
            times += fmt::format("{:.6g};", a.from + u * (a.to - a.from));
            x += coordinate(a.places[i].x) + ";";
            y += coordinate(a.places[i].y) + ";";
        }
        return all + animate("cx", "", times + "1", x + coordinate(a.places.back().x)) +
               animate("cy", "", times + "1", y + coordinate(a.places.back().y));
    }

    void close(std::string_view element, const mark& m)
    {
        if (m.title.empty())
            out_ += "/>\n";
        else
            add(">{}</{}>\n", title(m), element);
    }

    static std::string_view name(const item::poly& p) { return p.closed ? "polygon" : "polyline"; }

    static std::string title(const mark& m)
    {
        return m.title.empty() ? "" : fmt::format("<title>{}</title>", escape_xml(m.title));
    }

    static std::string marks(const mark& m)
    {
        std::string s;
        if (!m.id.empty())
            s += fmt::format(" id=\"{}\"", escape_xml(m.id));
        if (!m.kind.empty())
            s += fmt::format(" class=\"{}\"", escape_xml(m.kind));
        for (const auto& [key, value] : m.data)
            s += fmt::format(" data-{}=\"{}\"", key, escape_xml(value));
        return s;
    }

    static std::string attributes(std::string_view what, colour c)
    {
        std::string s = fmt::format(" {}=\"#{:02x}{:02x}{:02x}\"", what, c.r, c.g, c.b);
        return c.alpha < 1.0 ? s + fmt::format(" {}-opacity=\"{}\"", what, coordinate(c.alpha)) : s;
    }

    static std::string paint(const style& s)
    {
        std::string p = s.fill ? attributes("fill", *s.fill) : " fill=\"none\"";
        if (!s.stroke)
            return p;
        p += attributes("stroke", *s.stroke) + fmt::format(" stroke-width=\"{}\"", coordinate(s.width));
        p += " stroke-linejoin=\"round\"";
        if (s.dash > 0.0)
            p += fmt::format(" stroke-dasharray=\"{}\"", coordinate(s.dash));
        return p;
    }

    std::string out_;
    double loop_s_ = 0.0;
};

// Returns the function that formats the note with a SHA-256 for a format.
detail::hash_note make_hash_formatter(file_format format)
{
    return [format](std::string_view digits) {
        return format == file_format::svg   ? fmt::format("<!-- sha256 {} -->\n", digits)
               : format == file_format::png ? make_chunk(fmt::format("tEXtsha256{}{}", '\0', digits))
                                            : fmt::format("% sha256 {}\n", digits);
    };
}

// Adds the SHA-256 by which check_output() recognises the picture. In SVG it is at the end. In PNG it is in a
// chunk before the last chunk, which has 12 bytes. In PDF it is before the mark, so that offsets in the file
// stay valid.
std::string insert_hash(std::string bytes, file_format format)
{
    const std::size_t at = format == file_format::svg   ? bytes.size()
                           : format == file_format::png ? bytes.size() - 12
                                                        : bytes.rfind(pdf_mark) + 1;
    return detail::insert_hash(std::move(bytes), at, make_hash_formatter(format));
}

} // namespace

void add_big_endian(std::string& s, std::uint32_t v)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        s += static_cast<char>((v >> shift) & 0xFFU);
}

std::string make_chunk(const std::string& name_and_content)
{
    constexpr std::size_t name_bytes = 4;
    std::string chunk;
    add_big_endian(chunk, static_cast<std::uint32_t>(name_and_content.size() - name_bytes));
    chunk += name_and_content;
    boost::crc_32_type crc;
    crc.process_bytes(name_and_content.data(), name_and_content.size());
    add_big_endian(chunk, crc.checksum());
    return chunk;
}

std::string to_svg(const canvas& c)
{
    return writer().write(c);
}

std::string to_bytes(const canvas& c, file_format format, unsigned dpi)
{
    return insert_hash(format == file_format::svg   ? to_svg(c)
                       : format == file_format::png ? to_png(c, dpi)
                                                    : to_pdf(c),
                       format);
}

file_format find_format(const fs::path& file)
{
    const std::string e = to_lower_case(file.extension().string());
    if (e == ".svg")
        return file_format::svg;
    if (e == ".png")
        return file_format::png;
    if (e == ".pdf")
        return file_format::pdf;
    throw error(error_kind::bad_input, file.string(),
                e.empty() ? "the name has no extension, so the format of the picture is unknown"
                          : fmt::format("\"{}\" is not a picture format", e),
                e.empty() && file.string().starts_with("/dev/") ? "write to FILE.svg, .png or .pdf instead"
                                                                : "end the name in .svg, .png or .pdf");
}

void check_output(const fs::path& file, bool force)
{
    const file_format format = find_format(file);
    const auto is_ours = [format](std::string_view begin, std::string_view end) {
        return format == file_format::pdf   ? end.find(pdf_mark) != end.npos
               : format == file_format::png ? begin.find(png_mark) != begin.npos
                                            : begin.find(svg_mark) != begin.npos;
    };
    detail::check_overwrite(file, force, is_ours, make_hash_formatter(format));
}

void save(const canvas& c, const fs::path& file, unsigned dpi, bool force)
{
    check_output(file, force);
    const file_format format = find_format(file);
    detail::write_file(file, to_bytes(c, format, dpi));
}

} // namespace tactor::plot
