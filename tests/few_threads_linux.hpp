// A limit of threads, for this whole program: to be included by one file of it.
#pragma once

#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>

namespace palpate {

/// A sanitizer has a pthread_create() of its own.
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
inline constexpr bool kThreadsCanBeFew = false;
#else
inline constexpr bool kThreadsCanBeFew = true;
#endif

/// While it lives, the system starts so many more threads.
class FewThreads {
 public:
  explicit FewThreads(int more) { left() = more; }
  ~FewThreads() { left() = kAll; }
  FewThreads(const FewThreads&) = delete;
  FewThreads& operator=(const FewThreads&) = delete;

  static constexpr int kAll = 1 << 30;
  static std::atomic<int>& left() {
    static std::atomic<int> count = kAll;
    return count;
  }
};

}  // namespace palpate

#if !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*begin)(void*), void* data) {
  static const auto next = reinterpret_cast<decltype(&pthread_create)>(dlsym(RTLD_NEXT, "pthread_create"));
  std::atomic<int>& left = palpate::FewThreads::left();
  if (left != palpate::FewThreads::kAll && left-- <= 0) return EAGAIN;
  return next(thread, attributes, begin, data);
}
#endif
