// SPDX-License-Identifier: MIT
#include "study/session/run_table.hpp"

#include <algorithm>
#include <vector>

#include "study/bids/acq_time.hpp"

namespace tactor::study {

run_table::run_table(session_store& store, const run_definition& r, bool practice)
    : store_(store), run_(r), practice_(practice)
{
    const std::vector<trial_row> rows = practice ? store.practice_rows(r) : store.rows(r);
    rows_ = rows.size();
    if (rows.empty())
        return;
    first_stream_ = rows.front().stream;
    first_frame_ = rows.front().frame_1;
    if (!practice)
        if (const auto text = store.acq_time(r))
            began_ns_ = acq_time_ns(*text);
}

void run_table::add(trial_row& row, std::int64_t started_ns, unsigned rate)
{
    if (rows_++ == 0) {
        first_stream_ = row.stream;
        first_frame_ = row.frame_1;
        began_ns_ = started_ns;
    }
    // Exact within a stream; over the gap between two of them by the clock of the day.
    if (row.frame_1 && first_frame_ && row.stream == first_stream_)
        row.onset_s = static_cast<double>(*row.frame_1 - *first_frame_) / rate;
    else if (row.frame_1 && began_ns_)
        row.onset_s = std::max(0.0, static_cast<double>(started_ns - *began_ns_) * 1e-9);
    if (practice_)
        store_.append_practice(run_, row);
    else
        store_.append(run_, row, acq_time_text(began_ns_.value_or(started_ns)));
}

} // namespace tactor::study
