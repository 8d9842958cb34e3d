#include "apps/view/model_picture.hpp"

#include <utility>

#include "apps/view/session.hpp"

namespace palpate {

namespace {

constexpr std::size_t kPicked = 5;    // depths: at the cursor, and to the left, right, above and below
constexpr std::uint32_t kBeside = 4;  // distance of the other four, picture pixels

void record(Frame& frame, CommandList& list, WindowSession& session, const ShownMesh& mesh, const Camera& camera,
            const FrameOptions& options) {
  if (mesh.triangleCount() > 0)
    frame.record(list, mesh.drawn(session.bounds()), camera, options);
  else
    frame.record(list, session.drawn(), camera, options);
}

}  // namespace

ModelPicture::ModelPicture(Device& sight)
    : sight_(sight), pick_(sight, kPicked * sizeof(float), Memory::readback, "picked depths") {}

void ModelPicture::choosePace(bool still) {
  constexpr double kSlow_ms = 45;  // twenty pictures a second
  if (still)
    shrink_ = 1;
  else if (time_ms_ > kSlow_ms && shrink_ < frames_.size())
    ++shrink_;
}

void ModelPicture::fit(const UVec2& window_px, std::uint32_t supersample) {
  if (std::exchange(window_px_, window_px) != window_px || std::exchange(supersample_, supersample) != supersample) {
    frame_ = nullptr;
    frames_ = {};
  }
  std::unique_ptr<Frame>& frame = frames_[shrink_ - 1];
  if (frame && frame_ == frame.get()) return;
  isStale_ = true;
  const UVec2 size_px = (window_px + (shrink_ - 1)) / shrink_;
  if (!frame) frame = std::make_unique<Frame>(sight_, size_px.x, size_px.y, supersample);
  frame_ = frame.get();
}

void ModelPicture::aim(const WindowSession& session, const ShownMesh& mesh, const Camera& camera,
                       const FrameOptions& options, const DVec2& cursor_px) {
  next_ = {camera,           options,
           session.edits(),  session.attributeChanges(),
           session.frames(), mesh.triangleCount() > 0 ? mesh.version() : 0};
  cursor_px_ = cursor_px;
  hasMoved_ = scene_ != next_;
}

void ModelPicture::record(CommandList& list, WindowSession& session, const ShownMesh& mesh) {
  if (scene_ == next_ && !isStale_) return;
  scene_ = next_;
  isStale_ = false;
  isNew_ = true;
  ++made_;
  palpate::record(*frame_, list, session, mesh, scene_->camera, scene_->options);
}

Image ModelPicture::forFile(WindowSession& session, const ShownMesh& mesh, const Camera& camera,
                            const FrameOptions& options, const UVec2& size_px) const {
  Frame frame(sight_, size_px.x, size_px.y);
  CommandList list(sight_, sight_.window(), "picture for a file");
  list.begin();
  palpate::record(frame, list, session, mesh, camera, options);
  list.end();
  sight_.window().run(list);
  return frame.readColor();
}

void ModelPicture::recordPick(CommandList& list, const DVec2& window_px) {
  const UVec2 size_px(frame_->width(), frame_->height());
  const Buffer& depths = frame_->depthImage();
  const UVec2 at =
      glm::min(UVec2(glm::clamp(glm::floor(cursor_px_), DVec2(0), window_px - 1.0) / double(shrink_)), size_px - 1u);
  asked_ = {.place_px = cursor_px_, .beside_px = double(kBeside * shrink_)};
  const UVec2 low = at - glm::min(at, UVec2(kBeside)), high = glm::min(at + kBeside, size_px - 1u);
  const UVec2 places[kPicked] = {at, {low.x, at.y}, {high.x, at.y}, {at.x, low.y}, {at.x, high.y}};
  for (std::size_t k = 0; k < kPicked; ++k)
    list.copy(depths, pick_, sizeof(float), sizeof(float) * (std::uint64_t{places[k].y} * size_px.x + places[k].x),
              sizeof(float) * k);
}

void ModelPicture::takePick() {
  picked_ = asked_;
  const std::span<const float> depths = pick_.mapped<float>();
  picked_.depth = static_cast<double>(depths[0]);
  for (std::size_t k = 0; k < picked_.beside.size(); ++k) picked_.beside[k] = static_cast<double>(depths[1 + k]);
}

FoundSurface ModelPicture::surface(const DVec2& window_px) {
  if (!frame_ || !scene_ || isStale_) return {};
  const Buffer& depths = frame_->depthImage();
  const Buffer read(sight_, depths.bytes(), Memory::readback, "found depths");
  CommandList list(sight_, sight_.window(), "found depths");
  list.begin();
  list.copy(depths, read, depths.bytes());
  list.end();
  sight_.window().run(list);
  const std::span<const float> found = read.mapped<const float>();
  return FoundSurface({.depths = {found.begin(), found.end()},
                       .width = frame_->width(),
                       .shrink = double(shrink_),
                       .camera = scene_->camera,
                       .size_px = window_px});
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
