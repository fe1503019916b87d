// SPDX-License-Identifier: MIT
/// \file
/// JSON Schema of the messages between the service and its clients.
#pragma once

#include <nlohmann/json.hpp>

namespace tactor::cli {

/// Returns the schema of a message in either direction, or of a batch.
nlohmann::ordered_json protocol_schema();

} // namespace tactor::cli
