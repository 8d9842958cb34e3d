// The picture of the model in the window: drawn again only if it would differ, at a lower resolution while drawing is
// slow, and read for the depth under the cursor.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "apps/view/shown_mesh.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/render/frame.hpp"
#include "haptics/session/found_surface.hpp"

namespace palpate {

class ModelPicture {
 public:
  explicit ModelPicture(Device& sight);

  /// Called after aim(). `still`: nothing moves, draw at full resolution; else lower it if the last was slow.
  void choosePace(bool still);
  /// Sets the size for the window. `supersample`: see Frame.
  void fit(const UVec2& window_px, std::uint32_t supersample);
  /// The next picture is drawn in any case.
  void forget() { scene_.reset(); }
  bool exists() const { return frame_ != nullptr; }
  /// Whether the last picture has the size for such a window.
  bool hasSize(const UVec2& window_px) const {
    return made_ > 0 && frame_ && UVec2(frame_->width(), frame_->height()) == (window_px + (shrink_ - 1)) / shrink_;
  }

  /// What the next picture shows, and the cursor: the triangles if there are any, else the discs.
  void aim(const WindowSession& session, const ShownMesh& mesh, const Camera& camera, const FrameOptions& options,
           const DVec2& cursor_px);
  /// Draws it, unless only the cursor differs.
  void record(CommandList& list, WindowSession& session, const ShownMesh& mesh);
  /// Copies the depth under the cursor; takePick() reads it once the GPU has finished the picture.
  void recordPick(CommandList& list, const DVec2& window_px);
  void takePick();
  const Pick& picked() const { return picked_; }
  /// A picture of the same for a file: antialiased, in full resolution, through another camera. Nothing else uses the
  /// device's window queue meanwhile.
  Image forFile(WindowSession& session, const ShownMesh& mesh, const Camera& camera, const FrameOptions& options,
                const UVec2& size_px) const;
  /// The surface in the last picture, once the GPU has finished it; reads all of its depths.
  FoundSurface surface(const DVec2& window_px);

  /// Whether the next picture shows something else than the last one.
  bool hasMoved() const { return hasMoved_; }
  /// The same, or it has another size, or another cursor.
  bool differs() const { return hasMoved_ || isStale_ || asked_.place_px != cursor_px_; }
  /// Whether it was drawn in this frame.
  bool isNew() const { return isNew_; }
  /// Called after each frame, with its duration.
  void noteTime(double time_ms);
  /// Passes of the model's last picture, which `list` recorded and the GPU has finished.
  const std::vector<PassRecord>& passes(const CommandList& list);

  const Frame& frame() const { return *frame_; }
  std::uint32_t shrink() const { return shrink_; }  ///< window pixels per picture pixel, along each side
  std::uint64_t made() const { return made_; }      ///< number of pictures drawn

 private:
  // Everything that determines the picture.
  struct Scene {
    Camera camera;
    FrameOptions options;
    std::uint64_t edits = 0, attributes = 0, frames = 0, mesh = 0;  // counts; version of the mesh, 0 if discs are drawn
    bool operator==(const Scene&) const = default;
  };

  Device& sight_;
  std::array<std::unique_ptr<Frame>, 2> frames_;  // by shrink_ - 1: a motion and a rest change between them
  Frame* frame_ = nullptr;                        // one of them
  UVec2 window_px_{0};
  std::uint32_t supersample_ = 0, shrink_ = 1;
  std::optional<Scene> scene_, next_;  // of the last picture, and of the next one
  bool isStale_ = true;                // frame_ has another size than the last picture
  bool hasMoved_ = false;
  DVec2 cursor_px_{0};
  Buffer pick_;
  Pick asked_, picked_;
  std::uint64_t made_ = 0;
  bool isNew_ = false;              // drawn since the last noteTime()
  bool passesAreNew_ = false;       // not read yet
  double time_ms_ = 0;              // of the last frame in which the model was drawn
  std::vector<PassRecord> passes_;  // of the last picture read
};

}  // namespace palpate
