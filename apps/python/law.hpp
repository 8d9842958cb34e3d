// A force law given in Python.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <semaphore>
#include <string>
#include <thread>

#include "apps/python/arrays.hpp"

namespace palpate::python {

/// A force law written in Python. By path the tick calls it and waits. In a live session a thread of its own calls it,
/// and a tick waits at most kPatience; if the answer is late, the last force is held for a moment and then fades. Once
/// the law has raised an exception the force is zero.
class PythonLaw {
 public:
  static constexpr std::chrono::microseconds kPatience{300};
  static constexpr double kHeld_s = 0.01;  ///< age up to which a force is held
  static constexpr double kGone_s = 0.05;  ///< age at which it has faded to zero

  explicit PythonLaw(py::object callable);
  /// Requires Python's lock, as the functions below do.
  ~PythonLaw() { setLive(false); }
  PythonLaw(const PythonLaw&) = delete;
  PythonLaw& operator=(const PythonLaw&) = delete;

  /// Only while no tick runs.
  void setLive(bool live);
  /// Discards earlier exceptions. Only while no tick runs.
  void begin();
  /// Throws the exception that the law has raised, once. May be called from any thread.
  void raise();
  /// For the garbage collector: the function, and to have none from now on, which gives no force.
  PyObject* function() const { return callable_.ptr(); }
  void forget() { callable_ = py::none(); }
  /// Ticks of live sessions for which it was late. May be called from any thread.
  std::uint64_t late() const { return late_; }

  /// Throws palpate.Error within a call of this law: the session waits for the law, and would deadlock.
  void refuseWithin() const {
    if (under_ == this)
      throw Refusal("Error", "a force law cannot call its own session; its LawInput has the available data",
                    PP_ERROR_STATE);
  }

  /// A pp_force_law, called without Python's lock.
  static void call(void* user, const pp_pose* pose, const pp_contact* contact, double dt_s, double force_N[3]);

 private:
  struct Question {
    pp_pose pose{};
    pp_contact contact{};
    double dt_s = 0;
  };
  struct Answer {
    double t_s = 0;
    std::array<double, 3> force_N{};
  };
  Answer answerTo(const Question& question);
  void answerLive(const Question& question, double force_N[3]);
  void serve();

  static thread_local const PythonLaw* under_;  // law that this thread is calling

  py::object callable_;
  int process_;
  std::exception_ptr raised_;
  std::atomic<bool> failed_ = false;
  std::atomic<std::uint64_t> late_ = 0;
  bool live_ = false;

  // Exchanged between the tick and the thread that calls Python: only one of them uses these at a time.
  Question question_;
  Answer answer_;
  std::binary_semaphore asked_{0}, answered_{0};
  bool isAsked_ = false;  // used by the tick only
  Answer last_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// "libmine.so:law", the address of a compiled function (numba's cfunc.address), or, if allowed, a Python function.
class Law {
 public:
  Law() = default;
  /// Throws palpate.ArgumentTypeError.
  Law(const py::object& given, bool allowPython);

  const char* library() const { return library_.empty() ? nullptr : library_.c_str(); }
  pp_force_law function() const { return function_; }
  void* user() const { return python_.get(); }
  /// Null if the law is not a Python function.
  PythonLaw* python() const { return python_.get(); }
  explicit operator bool() const { return function_ || !library_.empty(); }

 private:
  std::string library_;
  pp_force_law function_ = nullptr;
  std::shared_ptr<PythonLaw> python_;
};

void bindLaws(py::module_& module);

}  // namespace palpate::python
