#pragma once

#include <map>
#include <string>

#include "haptics/session/session_config.hpp"

namespace palpate {

/// The configuration that options of the command line stood for when session logs carried those, by their names with
/// dashes, and values as they were given. Options that had no say in how a session runs were not among them. Throws
/// Error for one that is not known, and for a value that it never had.
SessionConfig migrateFlags(const std::map<std::string, std::string>& flags);

}  // namespace palpate
