// Errors of a session's configuration in terms of flags.
#pragma once

#include <string>

#include "haptics/session/session_config.hpp"

namespace palpate {

class Options;

/// The error's text, with each field replaced by the flag that sets it, if `command` has that flag. A command without
/// it reads its configuration elsewhere, as from a session log: there the fields keep their names.
std::string inFlags(const ConfigError& error, const Options& command);

}  // namespace palpate
