// SPDX-License-Identifier: MIT
/// \file
/// For how long a device's channels were driven lately, kept in the user's runtime folder from one run to the
/// next: the longest drive does not begin anew with each process.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <tactor/tactor.hpp>

namespace tactor::cli {

/// One file for each name of a device, `tactor/driven-NAME`, replaced as a whole. A torn one counts as none.
/// What cannot be kept is warned of once, and played all the same. One thread.
class kept_drive {
public:
    /// Reads what runs before left. Where there is no runtime folder nothing is kept. Without a limit there
    /// is nothing to count: then it is kept until when the array was driven, not for how long in between.
    kept_drive(std::string_view device, const drive_limits& l);

    const drive_history& before() const noexcept { return now_; }

    /// To be called each second while so many channels may be driven: should this process be killed, they
    /// count as driven until 2 s after the last call at most. Seldom writes.
    void going(unsigned channels);
    /// How it was in truth, once the stream is over. Writes nothing where nothing was driven.
    void settled(const drive_history& h);

private:
    void write(drive_history h);

    std::string file_; ///< empty: nothing is kept
    std::string text_; ///< as it was last seen
    bool counted_;
    drive_history now_;
    std::int64_t next_ns_ = 0;
};

} // namespace tactor::cli
