// SPDX-License-Identifier: MIT
/// \file
/// Recent drive time of a device's channels, kept in the user's runtime folder from one run to the next, so
/// that the longest drive does not begin anew with each process.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <tactor/tactor.hpp>

namespace tactor::session {

/// Drive time in the folder `tactor` there, in files that are replaced as a whole. `driven-NAME` has the
/// history of each device; `going-NAME-PID` the channels that a living process may drive, which count once it
/// was killed. A torn file counts as missing. Warns once if it cannot keep the time, and playing goes on. One
/// thread at a time. until_now() and settled() may wait for a lock of other processes.
class kept_drive {
public:
    /// Keeps drive time for this run alone.
    kept_drive() = default;
    /// Keeps drive time of a device from run to run, if the user has a runtime folder. Without a limit it
    /// keeps the time until which the array was driven, not the drive time before.
    kept_drive(std::string_view device, const drive_limits& l);

    /// Returns the drive of the array until now, by this run, those before, and others meanwhile, for a
    /// stream that opens next.
    drive_history until_now();
    /// Notes that so many channels may be driven; call it each second. If this process is killed, they count
    /// as driven until 2 s after the last call at most. Seldom writes.
    void going(unsigned channels);
    /// Writes the true history once the stream is over. Writes nothing if nothing was driven.
    void settled(const drive_history& h);

private:
    void look();
    void take_up_killed();
    void keep();
    /// Its text; no file where there is none.
    std::string write(const std::string& file, const drive_history& h);

    std::string folder_; ///< empty: nothing is kept
    std::string driven_; ///< name of the file
    std::string going_;  ///< what such names begin with
    std::string text_;   ///< of driven-NAME, as it was last seen
    bool counted_ = true;
    drive_history own_;    ///< of this run, and what its streams went on from
    drive_history others_; ///< from files that this run had not written
    drive_history ahead_;  ///< what this stream may have driven; none: a going-NAME-PID is not this run's
    std::int64_t next_ns_ = 0;
};

} // namespace tactor::session
