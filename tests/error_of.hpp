#pragma once

#include <string>

#include "engine/core/error.hpp"

namespace palpate {

/// The message of the error that `action` throws; empty if it throws none. Errors of other kinds are not caught.
template <class Kind = Error, class Action>
std::string errorOf(Action&& action) {
  try {
    action();
  } catch (const Kind& error) {
    return error.what();
  }
  return {};
}

}  // namespace palpate
