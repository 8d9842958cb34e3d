#pragma once

#include "haptics/session/remembered_lines.hpp"

namespace palpate {

/// 99th percentiles of a tick, us.
struct BackendPair {
  double gpu_us = 0, cpu_us = 0;
};

/// Times of back ends that programs have measured.
class MeasuredBackends : public RememberedLines {
 public:
  explicit MeasuredBackends(std::filesystem::path file = usualFile("backends"));

  std::optional<BackendPair> recall(std::string_view key, const std::function<void(std::string_view)>& damaged) const;
  void remember(std::string_view key, const BackendPair& times) const;
};

}  // namespace palpate
