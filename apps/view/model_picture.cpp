#include "apps/view/model_picture.hpp"

#include <utility>

#include "apps/view/session.hpp"

namespace palpate {

ModelPicture::ModelPicture(Device& sight)
    : sight_(sight), pick_(sight, sizeof(float), Memory::readback, "picked depth") {}

void ModelPicture::choosePace(bool still) {
  constexpr double kSlow_ms = 90;
  constexpr std::uint32_t kMostShrunk = 3;
  if (still)
    shrink_ = 1;
  else if (time_ms_ > kSlow_ms && shrink_ < kMostShrunk)
    ++shrink_;
}

void ModelPicture::fit(const UVec2& window_px, std::uint32_t supersample) {
  const UVec2 size_px = (window_px + (shrink_ - 1)) / shrink_;
  if (frame_ && frame_->width() == size_px.x && frame_->height() == size_px.y && supersample_ == supersample) return;
  frame_.reset();
  forget();
  frame_ = std::make_unique<Frame>(sight_, size_px.x, size_px.y, supersample);
  supersample_ = supersample;
}

void ModelPicture::record(CommandList& list, WindowSession& session, const ShownMesh& mesh, const Camera& camera,
                          const FrameOptions& options) {
  const bool drawsMesh = mesh.triangleCount() > 0;
  const Scene scene{camera, options, session.edits(), session.frames(), drawsMesh ? mesh.version() : 0};
  if (scene_ == scene) return;
  scene_ = scene;
  isNew_ = true;
  ++made_;
  if (drawsMesh)
    frame_->record(list, mesh.drawn(session.bounds()), camera, options);
  else
    frame_->record(list, session.drawn(), camera, options);
}

void ModelPicture::recordPick(CommandList& list, const DVec2& cursor_px, const DVec2& window_px) {
  const UVec2 at(glm::clamp(glm::floor(cursor_px), DVec2(0), window_px - 1.0) / double(shrink_));
  asked_ = {.place_px = cursor_px};
  list.copy(frame_->depthImage(), pick_, sizeof(float), sizeof(float) * (std::uint64_t{at.y} * frame_->width() + at.x));
}

void ModelPicture::takePick() {
  picked_ = asked_;
  picked_.depth = static_cast<double>(pick_.mapped<float>()[0]);
}

void ModelPicture::noteTime(double time_ms) {
  if (!std::exchange(isNew_, false)) return;
  time_ms_ = time_ms;
  passesAreNew_ = true;
}

const std::vector<PassRecord>& ModelPicture::passes(const CommandList& list) {
  if (std::exchange(passesAreNew_, false)) passes_ = list.passes();
  return passes_;
}

}  // namespace palpate
