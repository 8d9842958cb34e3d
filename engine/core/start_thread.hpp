#pragma once

#include <system_error>
#include <thread>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

/// Starts a thread, which may take a std::stop_token. Throws Error where the system starts no more of them.
template <class Work>
std::jthread startThread(Work&& work) {
  try {
    return std::jthread(std::forward<Work>(work));
  } catch (const std::system_error& error) {
    throw Error(
        "the system does not start another thread ({}); raise the limit of threads (ulimit -u) or of memory, or use "
        "fewer threads",
        error.code().message());
  }
}

}  // namespace palpate
