// Failures as the C interface reports them: a status and a description, per thread.
#pragma once

#include <palpate/palpate.h>

#include <utility>

#include "engine/core/error.hpp"

namespace palpate::library {

class HandleError : public Error {
 public:
  using Error::Error;
};
/// Another thread is in a call that conflicts with this one.
class ThreadError : public Error {
 public:
  using Error::Error;
};
class StateError : public Error {
 public:
  using Error::Error;
};
class DeviceError : public Error {
 public:
  using Error::Error;
};
class UnsupportedError : public Error {
 public:
  using Error::Error;
};
/// The simulation of the scene has failed.
class SimulationError : public Error {
 public:
  using Error::Error;
};
/// A broken invariant of palpate, which ends a program but not the host of a library.
class BugFound : public Error {
 public:
  using Error::Error;
};

/// Stores the exception being handled as the failure of this thread, and returns its status.
pp_status noteFailure() noexcept;

/// Runs the body of a call and converts any exception to a status.
template <class Do>
pp_status guarded(Do&& act) noexcept {
  try {
    std::forward<Do>(act)();
    return PP_OK;
  } catch (...) {
    return noteFailure();
  }
}

}  // namespace palpate::library
