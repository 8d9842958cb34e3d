// The picture of the model in the window: made again only where it would differ, smaller while making it is slow, and
// asked what is under the cursor.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "apps/view/shown_mesh.hpp"
#include "apps/view/stylus_hand.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/render/frame.hpp"

namespace palpate {

class ModelPicture {
 public:
  explicit ModelPicture(Device& sight);

  /// Before each picture. `still`: nothing moves, and it is drawn in full; else smaller, if the last one was slow.
  void choosePace(bool still);
  /// As large as the window asks for. `supersample`: Frame.
  void fit(const UVec2& window_px, std::uint32_t supersample);
  /// The next picture is made in any case.
  void forget() { scene_.reset(); }
  bool exists() const { return frame_ != nullptr; }

  /// Draws the triangles where there are some, else the discs.
  void record(CommandList& list, WindowSession& session, const ShownMesh& mesh, const Camera& camera,
              const FrameOptions& options);
  /// While it is on, picks go by the picture as it was before the next one: a stroke goes by the surface as it found
  /// it.
  void keepFound(bool on) { keepsFound_ = on; }
  /// Copies the depth under the cursor; takePick() reads it once the picture is done.
  void recordPick(CommandList& list, const DVec2& cursor_px, const DVec2& window_px);
  void takePick();
  const Pick& picked() const { return picked_; }

  /// After each picture of the window, and how long that took.
  void noteTime(double time_ms);
  /// Of the last picture of the model, which `list` recorded and which is done.
  const std::vector<PassRecord>& passes(const CommandList& list);

  const Frame& frame() const { return *frame_; }
  std::uint32_t shrink() const { return shrink_; }  ///< pixels of the window for one of it, along each side
  std::uint64_t made() const { return made_; }      ///< how often it was

 private:
  // What it is made of: of the same comes the same picture.
  struct Scene {
    Camera camera;
    FrameOptions options;
    std::uint64_t edits = 0, frames = 0, mesh = 0;  // how many, of a model that moves; which one, where it is drawn
    bool operator==(const Scene&) const = default;
  };

  // The depths of the picture that a stroke has found.
  struct Found {
    Buffer depths;
    UVec2 size_px{0};
    std::uint32_t shrink = 1;
    Camera camera;
  };
  void followFound(CommandList& list, const Camera& camera);

  Device& sight_;
  std::unique_ptr<Frame> frame_;
  std::uint32_t supersample_ = 0, shrink_ = 1;
  std::optional<Scene> scene_;  // of the picture that the frame has
  std::optional<Found> found_;
  bool keepsFound_ = false;
  Buffer pick_;
  Pick asked_, picked_;
  std::uint64_t made_ = 0;
  bool isNew_ = false;              // made since the last noteTime()
  bool passesAreNew_ = false;       // not looked at yet
  double time_ms_ = 0;              // of the last picture that it was made for
  std::vector<PassRecord> passes_;  // of that
};

}  // namespace palpate
