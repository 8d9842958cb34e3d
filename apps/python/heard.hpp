// Messages of palpate, one line each.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "apps/python/arrays.hpp"

namespace palpate::python {

/// Filled by threads that do not hold Python's lock.
class Heard {
 public:
  /// A pp_log_function, whose `user` is a Heard.
  static void hear(void* user, const char* line) {
    auto& heard = *static_cast<Heard*>(user);
    const std::scoped_lock lock(heard.lock_);
    heard.lines_.emplace_back(line);
  }
  std::vector<std::string> lines() const {
    const std::scoped_lock lock(lock_);
    return lines_;
  }

 private:
  mutable std::mutex lock_;
  std::vector<std::string> lines_;
};

inline py::list told(const Heard& heard) {
  py::list lines;
  for (const std::string& line : heard.lines()) lines.append(textOf(line));
  return lines;
}

}  // namespace palpate::python
