#include "apps/python/gil.hpp"

#include <atomic>
#include <chrono>
#include <thread>

namespace palpate::python {

namespace {

std::atomic<bool> ends = false;
std::atomic<int> users = 0;  // threads that wait for the lock, or call Python
std::thread::id last;        // the thread on which the interpreter ends; written before `ends`

/// Whether this thread gets the lock; if so, until leave().
bool enter() {
  ++users;
  if (!ends || std::this_thread::get_id() == last) return true;
  --users;
  return false;
}
void leave() { --users; }

}  // namespace

WithoutGil::~WithoutGil() {
  while (!enter()) std::this_thread::sleep_for(std::chrono::hours(1));
  PyEval_RestoreThread(state_);
  leave();
}

WithGil::WithGil() {
  if (enter()) held_.emplace();
}

WithGil::~WithGil() {
  if (!held_) return;
  held_.reset();
  leave();
}

void endGil() {
  last = std::this_thread::get_id();
  ends = true;
  const pybind11::gil_scoped_release released;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  while (users > 0 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace palpate::python
