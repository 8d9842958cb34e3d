// The process in which an object was opened.
#pragma once

#include <unistd.h>

#include "apps/python/arrays.hpp"

namespace palpate::python {

/// After a fork, threads, locks and a GPU remain in the parent process.
class Home {
 public:
  bool isHere() const { return process_ == ::getpid(); }
  /// Throws palpate.Error in another process.
  void require() const {
    if (!isHere())
      throw Refusal("Error",
                    "this was opened in the parent process before fork(), and works only there; open it here, or start "
                    "processes by \"spawn\" (multiprocessing.set_start_method)",
                    PP_ERROR_STATE);
  }

 private:
  int process_ = ::getpid();
};

}  // namespace palpate::python
