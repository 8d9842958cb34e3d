// Python's lock, for threads that the interpreter does not wait for: at its end they are parked instead of unwound
// through C++, which would abort the program.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

namespace palpate::python {

/// Without Python's lock while it lives. The end does not return where the interpreter ends.
class WithoutGil {
 public:
  WithoutGil() : state_(PyEval_SaveThread()) {}
  ~WithoutGil();
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* state_;
};

/// With Python's lock while it lives, on a thread of palpate or within WithoutGil; false where the interpreter ends:
/// then nothing of Python may be used.
class WithGil {
 public:
  WithGil();
  ~WithGil();
  WithGil(const WithGil&) = delete;
  WithGil& operator=(const WithGil&) = delete;

  explicit operator bool() const { return held_.has_value(); }

 private:
  std::optional<pybind11::gil_scoped_acquire> held_;
};

/// The interpreter ends on this thread: from now on other threads do not get its lock in palpate. Waits, for a second
/// at most, for those that are about to get it.
void endGil();

}  // namespace palpate::python
