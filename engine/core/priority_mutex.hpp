#pragma once

#include <pthread.h>

#include "engine/core/check.hpp"

namespace palpate {

/// A mutex for short holds between a real-time thread and an ordinary one: while the former waits, the latter runs at
/// its priority (priority inheritance), so no thread of a priority in between can delay the release. Windows has no
/// priority inheritance for mutexes; it boosts threads that have waited for a core for long.
class PriorityMutex {
 public:
  PriorityMutex() {
    pthread_mutexattr_t attributes;
    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    PALPATE_CHECK_EQ(pthread_mutex_init(&mutex_, &attributes), 0);
    pthread_mutexattr_destroy(&attributes);
  }
  ~PriorityMutex() { pthread_mutex_destroy(&mutex_); }
  PriorityMutex(const PriorityMutex&) = delete;
  PriorityMutex& operator=(const PriorityMutex&) = delete;

  void lock() { PALPATE_CHECK_EQ(pthread_mutex_lock(&mutex_), 0); }
  void unlock() { PALPATE_CHECK_EQ(pthread_mutex_unlock(&mutex_), 0); }

 private:
  pthread_mutex_t mutex_;
};

}  // namespace palpate
