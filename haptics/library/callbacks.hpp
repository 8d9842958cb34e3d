// Functions of the program that palpate calls.
#pragma once

namespace palpate::library {

/// This thread is in a log or contact function of the program: calls from there could wait for the caller, and are
/// refused.
inline thread_local bool isInCallback = false;

/// For the duration of such a call.
struct InCallback {
  InCallback() { isInCallback = true; }
  ~InCallback() { isInCallback = false; }
  InCallback(const InCallback&) = delete;
  InCallback& operator=(const InCallback&) = delete;
};

}  // namespace palpate::library
