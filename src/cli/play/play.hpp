// SPDX-License-Identifier: MIT
/// \file
/// Parts of `play`: its options, the lines that move a live stroke, the picture of the array while it plays,
/// and the report of a run, for people and for programs.
#pragma once

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <tactor/tactor.hpp>

#include "cli/input.hpp"
#include "session/play_session.hpp"

namespace tactor::cli {

struct play_options {
    std::optional<std::string> socket = {}; ///< socket of a server; none: plays here
    std::string format = "text";
    std::uint64_t rounds = 1; ///< 0: until a signal comes
    double pause_s = 0.0;     ///< between two strokes, if there are several rounds

    bool json() const { return format == "json"; }
};

/// Time-out of live strokes, s: only the end of the pipe ends them.
inline constexpr double live_timeout_s = 86400.0;

/// Reader of points in lines on standard input, which never waits.
class live_lines {
public:
    /// An intensity of `intensity_max` means 1.
    explicit live_lines(double intensity_max) : intensity_max_(intensity_max) {}

    /// Returns the next available place, mm, and its intensity; nothing if there is none yet, and at the end.
    /// Skips empty lines and those that begin with #. A line with nan gives the last place at intensity 0.
    /// \throws error (bad_input) with the line.
    std::optional<timed_point> next();
    /// Warns of how the newest point is played.
    void warn(const std::string& remark) const;
    /// Returns true once the input has ended and all points were returned.
    bool over() const noexcept { return end_ && buffer_.empty(); }
    double intensity_max() const noexcept { return intensity_max_; }
    /// Returns the descriptor that is readable when input is available; after the end -1.
    int descriptor() const noexcept;

private:
    bool fill();
    std::optional<timed_point> parse(std::string_view line);

    double intensity_max_;
    std::string buffer_;
    std::size_t line_ = 0;
    std::optional<point> last_ = {}; ///< newest place
    bool end_ = false;
};

/// State of a piece at one time.
struct instant {
    std::vector<double> levels; ///< by tactor, linear; 1: the intensity of the stroke
    std::vector<point> targets; ///< places of the touches
};

/// Returns true if standard output is a terminal on which lines can be drawn again.
bool can_draw();

class terminal;

/// Picture that draws over itself, and erases itself when destroyed and before Ctrl-Z stops the program.
/// Draws nothing in the background, and if standard output is no terminal. Changes no mode of the terminal
/// (the cursor stays visible), so that nothing has to be restored, however the program ends.
class live_picture {
public:
    explicit live_picture(const array& a);
    ~live_picture();
    live_picture(const live_picture&) = delete;
    live_picture& operator=(const live_picture&) = delete;

    /// Draws, unless the terminal has not taken the previous picture yet.
    void draw(const instant& now, double t_s, double total_s);

private:
    void erase();
    void stop_where_asked();

    const array& array_;
    std::unique_ptr<terminal> terminal_; ///< none: draws nothing
    std::size_t drawn_lines_ = 0;
    struct sigaction before_ = {}; ///< previous action of SIGTSTP
};

/// Follows the submitted score of a piece to its end. Draws it on a terminal if that is `wanted`.
stroke_report follow_drawn(session::play_session& session, const array& a, const piece& p, const score& s,
                           bool wanted);

/// A STROKE argument and the joint report of all its rounds; no report: it was not played.
struct stroke_outcome {
    std::string name;
    std::uint64_t length_frames = 0; ///< of one round
    std::optional<stroke_report> report = {};
    weakening weakened = {};
    std::optional<std::uint64_t> rounds = {}; ///< that have ended, if known
};

struct play_report : session::run_facts {
    std::vector<stroke_outcome> strokes = {};
};

/// Adds the report of another stroke or round: keeps the first start and the worst end, and adds up the rest.
void add_report(std::optional<stroke_report>& sum, stroke_report r);

/// Returns "played 1.4 s", "interrupted after 0.2 s: reason".
std::string fate(const stroke_outcome& s, unsigned rate);

/// Returns fate() after "name: ".
std::string describe(const stroke_outcome& s, unsigned rate);

/// Returns "hw:Tactor: 9 of 16 channels, 48000 Hz, s32, period 96 of 288 frames, latency 6.0 ms"
std::string describe(const stream_setup& d);

/// Returns the final error about strokes that did not finish, if any.
std::optional<error> unfinished(const play_report& r);

/// Prints the end of a stroke on standard output, unless that is JSON.
void tell(const stroke_outcome& s, unsigned rate, bool as_json);

/// Prints the end of a run: an object of schema tactor-play/1, or a short table of the counters.
void print_json(const play_report& r);
void print_table(const play_report& r);
/// Returns true if nothing disturbed or limited the strokes.
bool is_clean(const play_report& r);
/// Returns the schema tactor-play/1.
nlohmann::ordered_json play_schema();

/// Returns the exit status of a run. `signal`: the signal that ended it, or 0. \throws error for a run that
/// ended early or has strokes that did not finish.
int judge_run(const play_report& r, int signal, const std::optional<error>& broken);

/// Plays all STROKEs through a server, one after the other. Returns the exit status. \throws error, also for
/// options that only the server's owner may set.
int play_remote(const settings& s, const play_options& o);

} // namespace tactor::cli
