// Ctrl+C, and other exceptions of Python's signal handlers, during long calls of the library.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

#include "apps/python/arrays.hpp"

namespace palpate::python {

/// For one call at a time.
class Interruption {
 public:
  /// Runs Python's pending signal handlers, which run only on its main thread. Stop function of a pp_watch or a
  /// pp_network whose `user` is an Interruption. Called without Python's lock.
  static std::int32_t isAsked(void* self);
  pp_watch watch() { return {.stop = &Interruption::isAsked, .progress = nullptr, .user = this}; }

  /// Runs an interruptible call without Python's lock. Throws the exception of a handler, if any, otherwise that of
  /// `call`.
  template <class Call>
  auto during(Call&& call) {
    try {
      if constexpr (std::is_void_v<std::invoke_result_t<Call>>) {
        call();
        throwRaised();
      } else {
        auto result = call();
        throwRaised();
        return result;
      }
    } catch (const pp::Error&) {
      throwRaised();
      throw;
    }
  }

 private:
  void throwRaised();

  std::shared_ptr<py::error_already_set> raised_;
};

}  // namespace palpate::python
