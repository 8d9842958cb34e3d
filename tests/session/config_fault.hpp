#pragma once

#include <string>

#include "haptics/session/session_config.hpp"

namespace palpate {

/// The field that validate() names in its error; empty if the configuration is valid.
inline std::string faultOf(const SessionConfig& config) {
  try {
    validate(config);
  } catch (const ConfigError& error) {
    return error.field();
  }
  return {};
}

}  // namespace palpate
