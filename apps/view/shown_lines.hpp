// Thin lines that the window draws over the model: the cameras that saw it, the measure, and the hands and cameras of
// the other participants.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/view/measure.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

/// Colour of another participant's hand by its number (SeenHand), in the picture and in the panels.
std::array<std::uint8_t, 3> colorOfHand(std::uint32_t number);

class ShownLines {
 public:
  /// Called when another model is opened.
  void forget() { *this = {}; }
  /// Called once per frame: updates the lines. lines() stays the same list while nothing changes.
  void follow(const WindowSession& session, const ViewSettings& view, const Measure& measure);
  const std::shared_ptr<const std::vector<SpaceLine>>& lines() const { return lines_; }
  std::size_t cameras() const { return cameras_; }  ///< number of shown cameras

 private:
  // Everything that determines the lines.
  struct MadeOf {
    bool cameras = false;
    std::optional<std::uint64_t> frame;  // of a depth camera
    std::uint64_t measure = 0;
    bool measures = false;
    std::string symmetry;
    std::vector<HandPlace> others;
    std::vector<CameraPlace> onlookers;
    bool operator==(const MadeOf&) const = default;
  };
  void followCamera(const WindowSession& session);
  void addCameras(const WindowSession& session, std::vector<SpaceLine>& lines);

  std::optional<MadeOf> madeOf_;
  std::optional<PlayedView> played_;  // view of a depth camera's present frame
  std::vector<DVec3> way_;            // path of that camera: its positions so far
  double length_ = 0;                 // of a frustum, model units; 0: not known yet
  std::shared_ptr<const std::vector<SpaceLine>> lines_;
  std::size_t cameras_ = 0;
};

}  // namespace palpate
