// A force law of the program, as a C function or loaded from a library.
#pragma once

#include <palpate/palpate.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "haptics/force_law.hpp"

namespace palpate::library {

class ForceFunction {
 public:
  ForceFunction() = default;
  /// `library`: "libmine.so:function", instead of `law`; empty: none. Throws UsageError, and Error with the loader's
  /// message.
  ForceFunction(pp_force_law law, void* user, const std::string& library, double mm_per_unit);

  /// How often the law has given a force that is not a finite number since the last call, in words.
  std::optional<std::string> takeFault();

  /// Valid while this object is not moved; empty if the program has no law.
  CustomForce custom() { return law_ ? CustomForce{&call, this} : CustomForce{}; }

 private:
  static DVec3 call(void* user, const Contact& contact, const Pose& pose, double dt_s, const DVec3& usual_N) noexcept;

  pp_force_law law_ = nullptr;
  void* user_ = nullptr;
  double mm_per_unit_ = 1;
  struct Faults {
    std::atomic<std::uint64_t> count = 0;
    std::atomic<double> first_s = 0;  // of those since the last call
  };
  std::unique_ptr<Faults> faults_ = std::make_unique<Faults>();
};

/// The answer to a pose, as the program receives it.
pp_contact contactOf(const Contact& contact, const Pose& pose, const DVec3& force_N, double mm_per_unit);

}  // namespace palpate::library
