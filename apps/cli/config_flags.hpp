// Errors of a session's configuration as somebody reads them who has typed flags.
#pragma once

#include <string>

#include "haptics/session/session_config.hpp"

namespace palpate {

class Options;

/// What is wrong, with each field under the name of the flag that sets it, where `command` has that flag. A command
/// that has none of it reads its configuration elsewhere, as from a session log: there the fields keep their own names.
std::string inFlags(const ConfigError& error, const Options& command);

}  // namespace palpate
