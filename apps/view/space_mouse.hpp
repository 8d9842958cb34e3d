// The 3D mouse of a window, if there is one.
#pragma once

#include <mutex>

#include "apps/view/events.hpp"
#include "haptics/devices/hid_listener.hpp"

namespace palpate {

class SpaceMouse {
 public:
  /// Uses the first usable 3D mouse. Having none is not an error; one that cannot be used is reported in a remark.
  SpaceMouse();

  bool isThere() const { return listener_ != nullptr; }
  /// The present state, if it has changed since the last call.
  std::optional<PushEvent> changed();
  /// Remarks to the user since the last call.
  std::vector<std::string> takeRemarks();

 private:
  void remark(std::string_view sentence);

  std::mutex lock_;  // protects the remarks, which the listening thread adds
  std::vector<std::string> remarks_;
  PushEvent last_;
  std::unique_ptr<HidListener> listener_;  // destroyed first
};

}  // namespace palpate
