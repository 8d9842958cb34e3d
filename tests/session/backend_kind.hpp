// The back end of this test program: the CPU in tests_session, the GPU in tests_session_gpu, which runs the cases of
// the same files (tests/rooms.cmake).
#pragma once

#include <memory>

#include "haptics/session/backends.hpp"
#include "tests/on_gpu.hpp"

namespace palpate {

std::unique_ptr<BackendKind> backendKind();

/// Kinds of back ends that a replay chooses from: this one.
inline Backends theBackends() {
  std::vector<std::unique_ptr<BackendKind>> kinds;
  kinds.push_back(backendKind());
  return Backends(std::move(kinds));
}

}  // namespace palpate
