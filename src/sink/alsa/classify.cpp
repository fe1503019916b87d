// SPDX-License-Identifier: MIT
#include "sink/alsa/classify.hpp"

#include <cerrno>

namespace tactor::pcm {

io_kind of_state(int state) noexcept
{
    if (state < 0)
        return io_kind::lost;
    switch (state) {
    case SND_PCM_STATE_PREPARED:
    case SND_PCM_STATE_RUNNING:
        return io_kind::ok;
    case SND_PCM_STATE_SUSPENDED:
        return io_kind::suspended;
    case SND_PCM_STATE_DISCONNECTED:
        return io_kind::lost;
    default:
        return io_kind::xrun; // stopped for whatever reason: only prepare() helps
    }
}

io_kind of_error(long code, int state) noexcept
{
    switch (-code) {
    case EAGAIN:
    case EINTR:
        return io_kind::again;
    case EPIPE:
        // An ioplug turns each failure into EPIPE, that of a device which is gone too.
        return of_state(state) == io_kind::lost ? io_kind::lost : io_kind::xrun;
    case ESTRPIPE:
        return io_kind::suspended;
    case ENODEV:
    case ENOTTY:
    case ENXIO:
        return io_kind::lost;
    case EBADFD: {
        const io_kind s = of_state(state);
        return s == io_kind::ok ? io_kind::failed : s;
    }
    default:
        return io_kind::failed;
    }
}

} // namespace tactor::pcm
