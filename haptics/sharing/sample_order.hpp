// Which sample of a stream its receiver expects next. Independent of DDS.
#pragma once

#include <cstdint>

namespace palpate::sharing {

enum class Heard {
  taken,
  old,  ///< of an earlier epoch, or received before
  gap   ///< samples are missing: the stream has to begin again
};

/// Samples are numbered from 1 in each epoch; a new epoch begins the stream again.
class SampleOrder {
 public:
  std::uint32_t begin() {
    taken_ = 0;
    return ++epoch_;
  }
  std::uint32_t epoch() const { return epoch_; }
  /// Samples received in this epoch.
  std::uint64_t taken() const { return taken_; }
  Heard judge(std::uint32_t epoch, std::uint64_t sample) const {
    if (epoch != epoch_ || sample <= taken_) return Heard::old;
    return sample == taken_ + 1 ? Heard::taken : Heard::gap;
  }
  /// The sample that judge() has accepted is valid.
  void take() { ++taken_; }

 private:
  std::uint32_t epoch_ = 0;
  std::uint64_t taken_ = 0;
};

}  // namespace palpate::sharing
