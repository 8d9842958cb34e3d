// Beginning and end of contacts in Python.
#pragma once

#include <atomic>
#include <exception>
#include <string>

#include "apps/python/arrays.hpp"

namespace palpate::python {

/// Answer to one pose.
struct PyContact {
  pp_contact contact;
  double torque_mNm[3];
};

/// A function in Python that is called at the beginning and the end of each contact, on the thread of the call that
/// delivers them. Once it has raised an exception it is called no more.
class ContactListener {
 public:
  /// Throws palpate.ArgumentTypeError. Requires Python's lock, as the functions below but hear() do.
  explicit ContactListener(py::object function);
  ContactListener(const ContactListener&) = delete;
  ContactListener& operator=(const ContactListener&) = delete;

  /// A pp_contact_function, called without Python's lock.
  static void hear(void* user, const pp_contact_event* event);
  /// Throws palpate.Error within such a function: the call that delivers the event waits for it.
  static void refuseWithin() {
    if (isWithin_)
      throw Refusal("Error", "on_contact: its function cannot call the session; its event has the data",
                    PP_ERROR_STATE);
  }
  bool hasFailed() const { return failed_; }
  /// Throws the exception that the function has raised, once.
  void raise();
  /// For the garbage collector: the function, and to have none from now on.
  PyObject* function() const { return function_.ptr(); }
  void forget() { function_ = py::none(); }
  /// What happened, and what to do.
  const std::string& sentence() const { return sentence_; }

 private:
  static thread_local bool isWithin_;

  py::object function_;
  std::exception_ptr raised_;
  std::string sentence_;
  std::atomic<bool> failed_ = false;
};

void bindContacts(py::module_& module);

}  // namespace palpate::python
