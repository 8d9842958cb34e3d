// A force law as Python gives it.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <semaphore>
#include <string>
#include <thread>

#include "apps/python/arrays.hpp"

namespace palpate::python {

/// A force law in Python itself. By path the tick calls it and waits. In a live session a thread of its own calls it,
/// and a tick waits so long for it at most; where it comes late, the force that it gave last is held for a moment and
/// then fades. Once it has raised something the force is zero.
class PythonLaw {
 public:
  static constexpr std::chrono::microseconds kPatience{300};
  static constexpr double kHeld_s = 0.01;  ///< up to which a force is held
  static constexpr double kGone_s = 0.05;  ///< from which on nothing is left of it

  explicit PythonLaw(py::object callable);
  /// With Python's lock, as what follows.
  ~PythonLaw() { setLive(false); }
  PythonLaw(const PythonLaw&) = delete;
  PythonLaw& operator=(const PythonLaw&) = delete;

  /// While no tick runs.
  void setLive(bool live);
  /// What it raised before is forgotten. While no tick runs.
  void begin();
  /// Throws what the law has raised, once; from any thread.
  void raise();
  /// Ticks of live sessions that it was too late for. From any thread.
  std::uint64_t late() const { return late_; }

  /// Throws palpate.Error in a call of this law, which the session that asked would wait for.
  void refuseWithin() const {
    if (under_ == this)
      throw Refusal("Error", "a force law cannot call its own session; what it may know is in its LawInput",
                    PP_ERROR_STATE);
  }

  /// A pp_force_law, without Python's lock.
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

  static thread_local const PythonLaw* under_;  // that this thread calls now

  py::object callable_;
  int process_;
  std::exception_ptr raised_;
  std::atomic<bool> failed_ = false;
  std::atomic<std::uint64_t> late_ = 0;
  bool live_ = false;

  // Between the tick and the thread that calls Python: each has them in turn.
  Question question_;
  Answer answer_;
  std::binary_semaphore asked_{0}, answered_{0};
  bool isAsked_ = false;  // of the tick
  Answer last_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// "libmine.so:law", the address of a compiled function (numba's cfunc.address), or, where that is allowed, a function
/// of Python's.
class Law {
 public:
  Law() = default;
  /// Throws palpate.ArgumentTypeError.
  Law(const py::object& given, bool allowPython);

  const char* library() const { return library_.empty() ? nullptr : library_.c_str(); }
  pp_force_law function() const { return function_; }
  void* user() const { return python_.get(); }
  /// Null where it is none.
  PythonLaw* python() const { return python_.get(); }
  explicit operator bool() const { return function_ || !library_.empty(); }

 private:
  std::string library_;
  pp_force_law function_ = nullptr;
  std::shared_ptr<PythonLaw> python_;
};

void bindLaws(py::module_& module);

}  // namespace palpate::python
