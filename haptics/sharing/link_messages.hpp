#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/log.hpp"

namespace palpate::sharing {

/// Messages of the thread of a joined session, which are added under the session's lock and logged without it.
/// Thread-safe.
class LinkMessages {
 public:
  explicit LinkMessages(Log* log) : log_(log) {}

  void add(std::string message) {
    constexpr std::size_t kMaxUnread = 8;
    const std::scoped_lock hold(lock_);
    if (unread_.size() < kMaxUnread) unread_.push_back(message);
    unlogged_.push_back(std::move(message));
  }

  /// Messages since the last call, the first eight of them.
  std::vector<std::string> take() {
    const std::scoped_lock hold(lock_);
    return std::exchange(unread_, {});
  }

  /// Writes the messages since the last call to the log, which may take long. Exceptions of its listeners are ignored,
  /// since they would end this hand's part in the session (LogListener).
  void log() {
    std::vector<std::string> messages;
    {
      const std::scoped_lock hold(lock_);
      messages.swap(unlogged_);
    }
    if (!log_) return;
    try {
      for (const std::string& message : messages) log_->say("{}", message);
    } catch (...) {
    }
  }

 private:
  Log* log_;
  std::mutex lock_;
  std::vector<std::string> unread_, unlogged_;
};

}  // namespace palpate::sharing
