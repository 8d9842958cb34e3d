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
  struct Message {
    std::int32_t level;
    std::string line;
  };

  Heard() = default;
  /// `function`: called with level and text of each message; None: none. Throws palpate.ArgumentTypeError.
  explicit Heard(py::object function) : function_(std::move(function)) {
    if (!function_.is_none() && PyCallable_Check(function_.ptr()) == 0)
      refuseType("on_message: must be a function, not " + described(function_));
  }

  /// A pp_log_function, whose `user` is a Heard.
  static void hear(void* user, std::int32_t level, const char* line) {
    auto& heard = *static_cast<Heard*>(user);
    const std::scoped_lock lock(heard.lock_);
    heard.messages_.push_back({level, line});
  }
  std::vector<Message> messages() const {
    const std::scoped_lock lock(lock_);
    return messages_;
  }
  /// Passes new messages to the function in Python; with Python's lock. Its exceptions are reported as unraisable.
  void deliver() {
    if (function_.is_none()) return;
    const std::vector<Message> all = messages();
    while (delivered_ < all.size()) {
      const Message& next = all[delivered_++];
      try {
        function_(next.level == PP_LOG_WARNING ? "warning" : "note", textOf(next.line));
      } catch (py::error_already_set& error) {
        error.discard_as_unraisable("on_message of a palpate session");
      }
    }
  }
  /// For the garbage collector: the function, and to have none from now on.
  PyObject* function() const { return function_.ptr(); }
  void forget() { function_ = py::none(); }
  /// Delivers at the end of a call, on its thread.
  class Delivery {
   public:
    explicit Delivery(Heard& heard) : heard_(heard) {}
    ~Delivery() { heard_.deliver(); }
    Delivery(const Delivery&) = delete;
    Delivery& operator=(const Delivery&) = delete;

   private:
    Heard& heard_;
  };

 private:
  mutable std::mutex lock_;
  std::vector<Message> messages_;
  py::object function_ = py::none();
  std::size_t delivered_ = 0;  // used with Python's lock
};

inline py::list told(const Heard& heard) {
  py::list lines;
  for (const Heard::Message& message : heard.messages()) lines.append(textOf(message.line));
  return lines;
}

}  // namespace palpate::python
