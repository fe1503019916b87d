// SPDX-License-Identifier: MIT
/// \file
/// For how long a device's channels were driven lately, kept in the user's runtime folder from one run to the
/// next: the longest drive does not begin anew with each process.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <tactor/tactor.hpp>

namespace tactor::session {

/// In the folder `tactor` there, files that are replaced as a whole: `driven-NAME` of each device has how it
/// was; `going-NAME-PID` what a process may drive as long as it lives, which counts once it was killed. A
/// torn one counts as none. What cannot be kept is warned of once, and played all the same. One thread.
class kept_drive {
public:
    /// Keeps it for this run alone.
    kept_drive() = default;
    /// Where there is no runtime folder of the user's own nothing is kept from run to run. Without a limit
    /// there is nothing to count: then it is kept until when the array was driven, not for how long in
    /// between.
    kept_drive(std::string_view device, const drive_limits& l);

    /// What the array was given until now, by this run, those before, and others meanwhile: for a stream that
    /// is about to be opened.
    drive_history until_now();
    /// To be called each second while so many channels may be driven: should this process be killed, they
    /// count as driven until 2 s after the last call at most. Seldom writes.
    void going(unsigned channels);
    /// How it was in truth, once the stream is over. Writes nothing where nothing was driven.
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
    drive_history others_; ///< what the files said that this run had not written
    drive_history ahead_;  ///< what this stream may have driven; none: a going-NAME-PID is not this run's
    std::int64_t next_ns_ = 0;
};

} // namespace tactor::session
