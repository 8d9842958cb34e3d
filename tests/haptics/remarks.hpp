// Sentences that devices tell their user, from any thread.
#pragma once

#include <algorithm>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

class Remarks {
 public:
  auto sink() {
    return [this](std::string_view sentence) {
      const std::scoped_lock lock(lock_);
      all_.emplace_back(sentence);
    };
  }
  /// Number of sentences with that part.
  std::size_t count(std::string_view part) {
    const std::scoped_lock lock(lock_);
    return static_cast<std::size_t>(
        std::ranges::count_if(all_, [&](const std::string& one) { return one.find(part) != std::string::npos; }));
  }
  std::size_t size() {
    const std::scoped_lock lock(lock_);
    return all_.size();
  }
  /// A line each.
  std::string text() {
    const std::scoped_lock lock(lock_);
    std::string lines;
    for (const std::string& sentence : all_) lines += sentence + "\n";
    return lines;
  }

 private:
  std::mutex lock_;
  std::vector<std::string> all_;
};

}  // namespace palpate
