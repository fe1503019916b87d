// SPDX-License-Identifier: MIT
#include "alsa/classify.hpp"

#include <cerrno>

namespace tactor::pcm {

io_status of_state(int state) noexcept
{
    if (state < 0)
        return io_status::lost;
    switch (state) {
    case SND_PCM_STATE_PREPARED:
    case SND_PCM_STATE_RUNNING:
        return io_status::ok;
    case SND_PCM_STATE_SUSPENDED:
        return io_status::suspended;
    case SND_PCM_STATE_DISCONNECTED:
        return io_status::lost;
    default:
        return io_status::xrun; // stopped for whatever reason: only prepare() helps
    }
}

io_status of_error(long code, int state) noexcept
{
    switch (-code) {
    case EAGAIN:
    case EINTR:
        return io_status::again;
    case EPIPE:
        // An ioplug turns each failure into EPIPE, that of a device which is gone too.
        return of_state(state) == io_status::lost ? io_status::lost : io_status::xrun;
    case ESTRPIPE:
        return io_status::suspended;
    case ENODEV:
    case ENOTTY:
    case ENXIO:
        return io_status::lost;
    case EBADFD: {
        const io_status s = of_state(state);
        return s == io_status::ok ? io_status::failed : s;
    }
    default:
        return io_status::failed;
    }
}

} // namespace tactor::pcm
