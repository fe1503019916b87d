// SPDX-License-Identifier: MIT
#include "study/report/markdown.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace tactor::study {

std::string plain(std::string_view text)
{
    constexpr std::string_view own = "\\`*_{}[]<>#|$~";
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '\n' || c == '\t' || c == '\r')
            out += ' ';
        else if (byte < 0x20 || byte == 0x7f)
            out += fmt::format("\\\\x{:02x}", byte);
        else {
            if (own.find(c) != std::string_view::npos)
                out += '\\';
            out += c;
        }
    }
    return out;
}

std::string plain_list(const std::vector<std::string>& names)
{
    std::string all;
    for (const std::string& n : names)
        all += (all.empty() ? "" : ", ") + plain(n);
    return all;
}

std::string digits(double v)
{
    return fmt::format("{:.6g}", v);
}

std::string subjects(std::span<const std::string> codes)
{
    std::string all;
    for (const std::string& c : codes)
        all += (all.empty() ? "sub-" : ", sub-") + c;
    return all;
}

std::string table_row(const std::vector<std::string>& cells)
{
    std::string line = "|";
    for (const std::string& c : cells)
        line += fmt::format(" {} |", c);
    return line + "\n";
}

std::string table_head(const std::vector<std::string>& cells)
{
    return table_row(cells) + table_row(std::vector<std::string>(cells.size(), "---"));
}

void add_saying(sayings& all, std::string text, const std::string& who)
{
    auto at = std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.first == text; });
    if (at == all.end())
        at = all.emplace(at, std::move(text), std::vector<std::string>());
    at->second.push_back(who);
}

std::string told(const study_facts& f, const std::function<std::string(const session_facts&)>& say)
{
    sayings said;
    for (const session_facts& s : f.sessions) {
        std::string text = say(s);
        add_saying(said, text.empty() ? not_recorded : std::move(text), s.code);
    }
    if (said.size() == 1)
        return said.front().first;
    std::string all;
    for (const auto& [text, codes] : said)
        all += fmt::format("{}{} ({})", all.empty() ? "" : "; ", text, subjects(codes));
    return all;
}

std::string range_text(const std::vector<double>& values)
{
    if (values.empty())
        return not_recorded;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const std::string from = digits(*low);
    const std::string to = digits(*high);
    return from == to ? from : fmt::format("{} to {}", from, to);
}

} // namespace tactor::study
