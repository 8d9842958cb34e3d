#pragma once

#include <map>
#include <string>

#include "haptics/session/session_config.hpp"

namespace palpate {

/// The configuration for command-line options, which earlier session logs carried in place of it: by their names with
/// dashes, and values as given. Options without effect on a session were not among them. Throws Error for an unknown
/// option or an invalid value.
SessionConfig migrateFlags(const std::map<std::string, std::string>& flags);

}  // namespace palpate
