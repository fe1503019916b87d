// SPDX-License-Identifier: MIT
// Without libsndfile.
#include <tactor/error.hpp>

#include "files/sound_file.hpp"

namespace tactor::detail {

std::vector<float> decode_wav(const wav_parts&, std::size_t, const std::string& name)
{
    throw error(error_kind::not_available, source_place{name},
                "tactor was built without libsndfile, which reads recordings",
                "build it with -Drecordings=enabled");
}

} // namespace tactor::detail
