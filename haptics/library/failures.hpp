// What went wrong, as the C interface tells it: a status, and words for each thread.
#pragma once

#include <palpate/palpate.h>

#include <utility>

#include "engine/core/error.hpp"

namespace palpate::library {

class HandleError : public Error {
 public:
  using Error::Error;
};
/// Another thread is in a call that does not go with this one.
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
/// What moves by itself goes on no more.
class SimulationError : public Error {
 public:
  using Error::Error;
};
/// A broken invariant of ours, which stops a program and not the host of a library.
class BugFound : public Error {
 public:
  using Error::Error;
};

/// Keeps the exception that is being handled as the failure of this thread, and says what it is.
pp_status noteFailure() noexcept;

/// Does what a call is for; whatever is thrown becomes its status.
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
