// Ctrl+C, and whatever else a signal raises in Python, while a call of the library takes long.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

#include "apps/python/arrays.hpp"

namespace palpate::python {

/// One call at a time.
class Interruption {
 public:
  /// Asks Python's signal handlers, which run on its main thread alone; of a pp_watch or a pp_network, whose user is
  /// one of these. Without Python's lock.
  static std::int32_t isAsked(void* self);
  pp_watch watch() { return {.stop = &Interruption::isAsked, .progress = nullptr, .user = this}; }

  /// Does what may be interrupted, without Python's lock. Throws what a handler has raised, and otherwise what `call`
  /// throws.
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
