// The 3D mouse of a window, where there is one.
#pragma once

#include <mutex>

#include "apps/view/events.hpp"
#include "haptics/devices/hid_listener.hpp"

namespace palpate {

class SpaceMouse {
 public:
  /// Takes the first one that can be used. None is no error; one that cannot be used is a remark.
  SpaceMouse();

  /// What has changed since the last call.
  std::optional<PushEvent> changed();
  /// What a person should read, since the last call.
  std::vector<std::string> takeRemarks();

 private:
  void remark(std::string_view sentence);

  std::mutex lock_;  // of the remarks, which come from the thread that listens
  std::vector<std::string> remarks_;
  PushEvent last_;
  std::unique_ptr<HidListener> listener_;  // goes first
};

}  // namespace palpate
