// SPDX-License-Identifier: MIT
/// \file
/// Parts of the command `play`: its options, the lines that move a live stroke, the picture of the array
/// during playback, and the report of a run as text and as JSON.
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
    std::optional<std::string> socket = {}; ///< socket of a server; not set to play without one
    std::string format = "text";
    std::uint64_t rounds = 1; ///< number of rounds; 0 to repeat until a signal arrives
    double pause_s = 0.0;     ///< pause between two strokes if there are several rounds

    bool json() const { return format == "json"; }
};

/// Time-out of live strokes, s. It is so long that only the end of the input ends them.
inline constexpr double live_timeout_s = 86400.0;

/// Reader of points from lines on standard input. It never waits.
class live_lines {
public:
    /// Constructs a reader. The intensity `intensity_max` in a line means 1.
    explicit live_lines(double intensity_max) : intensity_max_(intensity_max) {}

    /// Returns the next point: its place, mm, and its intensity. Returns nothing if no complete line is
    /// available, or at the end of the input. Skips empty lines and lines that begin with #. For a line with
    /// nan, returns the last place with intensity 0.
    /// \throws error (bad_input) with the line.
    std::optional<timed_point> next();
    /// Prints a warning about how the newest point is played.
    void warn(const std::string& remark) const;
    /// Returns true if the input has ended and all points have been returned.
    bool over() const noexcept { return end_ && buffer_.empty(); }
    double intensity_max() const noexcept { return intensity_max_; }
    /// Returns a descriptor that is readable when input is available, or -1 after the end of the input.
    int descriptor() const noexcept;

private:
    bool fill();
    std::optional<timed_point> parse(std::string_view line);

    double intensity_max_;
    std::string buffer_;
    std::size_t line_ = 0;
    std::optional<point> last_ = {}; ///< last place that was read
    bool end_ = false;
};

/// State of a piece at a particular time.
struct instant {
    std::vector<double> levels; ///< by tactor, linear; 1 means the intensity of the stroke
    std::vector<point> targets; ///< places of the touches
};

/// Returns true if standard output is a terminal on which lines can be overwritten.
bool can_draw();

class terminal;

/// A picture that overwrites itself. It is erased by the destructor, and before Ctrl-Z stops the program. It
/// draws nothing if the program is in the background or if standard output is not a terminal. It does not
/// change modes of the terminal, and the cursor stays visible. Therefore nothing has to be restored, however
/// the program ends.
class live_picture {
public:
    explicit live_picture(const array& a);
    ~live_picture();
    live_picture(const live_picture&) = delete;
    live_picture& operator=(const live_picture&) = delete;

    /// Draws the picture, unless the terminal has not yet accepted the previous one.
    void draw(const instant& now, double t_s, double total_s);

private:
    void erase();
    void handle_stop_request();

    const array& array_;
    std::unique_ptr<terminal> terminal_; ///< null if nothing is drawn
    std::size_t drawn_lines_ = 0;
    struct sigaction before_ = {}; ///< previous action for SIGTSTP
};

/// Waits for the end of a piece whose score has been submitted. If `wanted` is true, draws a picture on the
/// terminal meanwhile.
stroke_report follow_and_draw(session::play_session& session, const array& a, const piece& p, const score& s,
                              bool wanted);

/// A STROKE argument, and the combined report of all its rounds. There is no report if it was not played.
struct stroke_outcome {
    std::string name;
    std::uint64_t length_frames = 0; ///< length of one round
    std::optional<stroke_report> report = {};
    weakening weakened = {};
    std::optional<std::uint64_t> rounds = {}; ///< rounds that have ended, if known
};

struct play_report : session::run_facts {
    std::vector<stroke_outcome> strokes = {};
};

/// Adds the frames of another stroke or round to `sum`. The sum keeps the first start, the first end that is
/// not `finished`, and the greatest delay. Its other values are those of `r`.
void add_report(std::optional<stroke_report>& sum, stroke_report r);

/// Returns how a stroke ended: "played 1.4 s", "interrupted after 0.2 s: reason".
std::string outcome_text(const stroke_outcome& s, unsigned rate);

/// Returns the name, a colon and outcome_text().
std::string describe(const stroke_outcome& s, unsigned rate);

/// Returns a description such as "hw:Tactor: 9 of 16 channels, 48000 Hz, s32, period 96 of 288 frames,
/// latency 6.0 ms".
std::string describe(const stream_setup& d);

/// Returns the final error about strokes that did not finish, if there are any.
std::optional<error> find_final_error(const play_report& r);

/// Prints to standard output how a stroke ended, unless standard output is JSON.
void print_outcome(const stroke_outcome& s, unsigned rate, bool as_json);

/// Print the report of a run: as an object of schema tactor-play/1, or as a short table of counters.
void print_json(const play_report& r);
void print_table(const play_report& r);
/// Returns true if nothing has disturbed or limited the strokes.
bool is_undisturbed(const play_report& r);
/// Returns the JSON Schema tactor-play/1.
nlohmann::ordered_json play_schema();

/// Returns the exit status of a run. `signal` is the signal that ended it, or 0.
/// \throws error if the run ended early, or if strokes did not finish.
int find_run_status(const play_report& r, int signal, const std::optional<error>& broken);

/// Plays all STROKEs through a server, one after the other. Returns the exit status.
/// \throws error, also for options that only the server's owner may set.
int play_remote(const settings& s, const play_options& o);

} // namespace tactor::cli
