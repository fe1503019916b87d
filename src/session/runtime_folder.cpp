// SPDX-License-Identifier: MIT
#include "session/runtime_folder.hpp"

#include "session/variable.hpp"

namespace tactor::session {

std::string service_folder()
{
    const std::string all = variable("RUNTIME_DIRECTORY");
    return all.substr(0, all.find(':'));
}

std::string runtime_folder()
{
    const std::string given = service_folder();
    return given.empty() ? variable("XDG_RUNTIME_DIR") : given;
}

} // namespace tactor::session
