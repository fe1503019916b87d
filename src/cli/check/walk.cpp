// SPDX-License-Identifier: MIT
#include "cli/check/check.hpp"

#include <cerrno>
#include <cstdio>
#include <utility>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>

#include "cli/play/play.hpp"
#include "cli/say.hpp"
#include "core/split.hpp"
#include "session/process.hpp"

namespace tactor::cli {
namespace {

struct walk_interrupted {};

// Reader of lines from standard input. While waiting, it also handles signals.
class line_reader {
public:
    explicit line_reader(session::play_session& s) : session_(s) {}

    /// Returns the next line, or nothing at the end of the input. \throws walk_interrupted if a signal
    /// arrives.
    std::optional<std::string> next()
    {
        for (;;) {
            if (const auto end = buffer_.find('\n'); end != buffer_.npos) {
                std::string line = buffer_.substr(0, end);
                buffer_.erase(0, end + 1);
                return line;
            }
            if (!session_.wait_for(STDIN_FILENO))
                throw walk_interrupted{};
            char bytes[256];
            const ssize_t n = ::read(STDIN_FILENO, bytes, sizeof bytes);
            if (n < 0 && errno != EINTR && errno != EAGAIN)
                session::refuse_standard_input(errno);
            if (n == 0)
                return std::nullopt;
            if (n > 0)
                buffer_.append(bytes, static_cast<std::size_t>(n));
        }
    }

private:
    session::play_session& session_;
    std::string buffer_;
};

std::string without_blanks(std::string s)
{
    std::erase_if(s, [](char c) { return c == ' ' || c == '\t' || c == '\r'; });
    return s;
}

// Returns a piece with three bursts on one tactor.
piece make_walk_piece(const array& a, unsigned tactor, double carrier_hz)
{
    plan p = session::walk_plan(a, tactor, carrier_hz);
    const point there = a.tactors[tactor].position;
    stroke stays{"", trajectory::timed({{0.0, there}, {p.total_s, there}})};
    return {fmt::format("tactor {}", tactor), {std::move(stays)}, {{std::move(p)}}};
}

class walker {
public:
    walker(session::play_session& session, const settings& s, const environment& e, const render_options& r,
           const check_options& o)
        : session_(session),
          settings_(s),
          environment_(e),
          render_(r),
          options_(o),
          input_(session),
          to_(o.json() ? stderr : stdout)
    {
    }

    session::walk_answers walk_all()
    {
        const std::size_t n = tactors().size();
        if (n > 1)
            say(fmt::format("\n{}\n", session::tactor_map_text(environment_.tactors)));
        session::walk_answers felt;
        unfinished_.resize(n);
        while (felt.size() < n) {
            const auto i = static_cast<unsigned>(felt.size());
            play_bursts(i);
            if (options_.no_questions) {
                say(describe_tactor(i) + "\n");
                felt.emplace_back();
            } else if (const auto got = ask(i)) {
                felt.push_back(got->felt);
            } else {
                felt.pop_back(); // the previous tactor will be driven again
            }
        }
        for (std::size_t i = 0; i < n; ++i)
            if (!unfinished_[i].empty())
                throw error(error_kind::runtime, fmt::format("tactor {}", i), unfinished_[i], "walk again");
        return felt;
    }

private:
    const std::vector<tactor_spec>& tactors() const { return environment_.tactors.tactors; }

    void say(const std::string& text) const
    {
        say_text(to_, text);
        std::fflush(to_);
    }

    std::string describe_tactor(unsigned i) const
    {
        const tactor_spec& t = tactors()[i];
        return fmt::format("tactor {}: channel {}, at {:.4g}, {:.4g} mm", i, t.channel, t.position.x_mm,
                           t.position.y_mm);
    }

    void play_bursts(unsigned i)
    {
        const piece p = make_walk_piece(environment_.tactors, i, settings_.plan.carrier_hz);
        const score samples = make_score(p, environment_, render_);
        const auto ended = session_.submit(samples);
        const stroke_report r = ended ? *ended
                                      : follow_and_draw(session_, environment_.tactors, p, samples,
                                                        !options_.json() && !settings_.stream.verbose);
        session_.log_end(p.name, r);
        if (session_.signal() != 0)
            throw walk_interrupted{};
        if (r.state == state_kind::interrupted && session_.lost())
            throw error(error_kind::runtime, p.name, r.why, "walk again when the device is back");
        unfinished_[i] = r.state == state_kind::finished ? "" : "interrupted: " + r.why;
        if (!unfinished_[i].empty())
            say(fmt::format("tactor {}: {}\n", i, unfinished_[i]));
    }

    struct answer {
        std::optional<unsigned> felt; // number of the tactor that was felt; not set if none
    };

    // Asks until the user gives a valid answer. Returns nothing if the walk should go back to the previous
    // tactor.
    std::optional<answer> ask(unsigned i)
    {
        const std::size_t last = tactors().size() - 1;
        for (;;) {
            say(fmt::format(
                "tactor {} (channel {}): which did you feel? 0 to {}, n none, r repeat, {}q quit: ", i,
                tactors()[i].channel, last, i > 0 ? "b back, " : ""));
            const auto line = input_.next();
            if (!line)
                throw error(error_kind::runtime, "walk", fmt::format("no answer for tactor {}", i),
                            "answer with a number, n, r, b or q, or use --auto");
            const std::string said = without_blanks(*line);
            if (const auto number = detail::parse_number_text<unsigned>(said); number && *number <= last)
                return answer{number};
            if (said == "n")
                return answer{};
            if (said == "b" && i > 0)
                return std::nullopt;
            if (said == "q")
                throw error(error_kind::runtime, "walk",
                            fmt::format("stopped after {} of {} tactors", i, last + 1),
                            "answer for all tactors to get a map");
            if (said == "r")
                play_bursts(i);
            else
                say(said == "b" ? "This is the first tactor.\n"
                                : fmt::format("\"{}\" is not one of these.\n", said));
        }
    }

    session::play_session& session_;
    const settings& settings_;
    const environment& environment_;
    const render_options& render_;
    const check_options& options_;
    line_reader input_;
    std::FILE* to_;
    std::vector<std::string> unfinished_; // reason for each tactor; empty if it was not interrupted
};

} // namespace

walk_result walk(const alsa_options& device, const settings& s, const environment& e,
                 const render_options& render, const check_options& o, const session::stream_source& source)
{
    if (!o.no_questions)
        session::check_standard_input();
    session::play_session session(device, s.stream, e, source);
    walk_result result;
    try {
        result.felt = walker(session, s, e, render, o).walk_all();
    } catch (const walk_interrupted&) {
        result.signal = session.signal();
    } catch (const error&) {
        session.finish().check_amplifier();
        throw;
    }
    session.finish().check_amplifier();
    return result;
}

} // namespace tactor::cli
