// What the window draws over the model in thin lines: the cameras that saw it, what is measured, the hands and
// cameras of others.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/view/measure.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

/// Of another hand, by its number (SeenHand), in the picture and in the panels.
std::array<std::uint8_t, 3> colorOfHand(std::uint32_t number);

class ShownLines {
 public:
  /// Another model comes.
  void forget() { *this = {}; }
  /// Once for each picture: the lines that there are now. The same list as long as they are the same.
  void follow(const WindowSession& session, const ViewSettings& view, const Measure& measure);
  const std::shared_ptr<const std::vector<SpaceLine>>& lines() const { return lines_; }
  std::size_t cameras() const { return cameras_; }  ///< that are shown

 private:
  // What the lines are made of: of the same come the same.
  struct MadeOf {
    bool cameras = false;
    std::optional<std::uint64_t> frame;  // of a depth camera
    std::uint64_t measure = 0;
    std::vector<HandPlace> others;
    std::vector<CameraPlace> onlookers;
    bool operator==(const MadeOf&) const = default;
  };
  void followCamera(const WindowSession& session);
  void addCameras(const WindowSession& session, std::vector<SpaceLine>& lines);

  std::optional<MadeOf> madeOf_;
  std::optional<PlayedView> played_;  // of a depth camera: from where its frame was seen, and
  std::vector<DVec3> way_;            // where it stood before, one place after the other
  double length_ = 0;                 // of a frustum, model units; 0: not known yet
  std::shared_ptr<const std::vector<SpaceLine>> lines_;
  std::size_t cameras_ = 0;
};

}  // namespace palpate
