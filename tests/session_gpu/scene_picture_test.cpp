// Masks and fields of a session, in its pictures.
#include <cmath>

#include "engine/gpu/transfer.hpp"
#include "engine/render/frame.hpp"
#include "haptics/session/drawn_follower.hpp"
#include "haptics/session/picture.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/session/backend_kind.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::scene_picture_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr std::uint32_t kSide_px = 64;

std::size_t coveredPixels(const Image& image, const std::array<std::uint8_t, 4>& background) {
  return static_cast<std::size_t>(
      std::ranges::count_if(image.rgba, [&](const auto& pixel) { return pixel != background; }));
}

// Makes a follower that `made` points to.
FollowerMaker drawnFollower(Device& device, DrawnFollower*& made) {
  return [&](const Model& model, TouchBackend& backend) {
    auto follower = std::make_unique<DrawnFollower>(device, model, backend);
    made = follower.get();
    return follower;
  };
}

}  // namespace

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "both pictures of a session show its masks and fields, whenever they begin to follow") {
  const auto cpu = cpuBackend();
  DrawnFollower* follower = nullptr;
  SessionPicture early(device);
  class Early final : public EditFollower {
   public:
    explicit Early(SessionPicture& picture) : picture_(picture) {}
    void catchUp(const EditBatch& batch) override { picture_.follow(batch); }

   private:
    SessionPicture& picture_;
  };
  Session session({.backend = {.name = "cpu"}, .hands = std::vector<HandConfig>(1)}, sphereModel(2000),
                  {.backend = *cpu,
                   .keepsPoints = true,
                   .undo = {1 << 24},
                   .followers = {drawnFollower(device, follower),
                                 [&](const Model&, TouchBackend&) { return std::make_unique<Early>(early); }}});
  const Layer& layer = session.scene().layers[0];
  const PictureRequest request{.width = kSide_px, .height = kSide_px, .samples = 1, .background = {{0, 0, 0}}};
  const auto seen = [&](SessionPicture& picture) { return picture.draw(layer, session.history(), request); };
  const Image before = seen(early);
  const std::array<std::uint8_t, 4> black = before.rgba.front();
  REQUIRE(coveredPixels(before, black) > 500);

  session.setMask(MaskRole::hidden, PointSet::range(0, layer.model->cloud.size()));
  CHECK(coveredPixels(seen(early), black) == 0);
  SessionPicture late(device);
  CHECK(coveredPixels(seen(late), black) == 0);
  CHECK(follower->drawn().attributes().mask(MaskRole::hidden));
  session.undo(1, 0);
  CHECK(seen(early).rgba == before.rgba);
  CHECK_FALSE(follower->drawn().attributes().mask(MaskRole::hidden));
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "points that are removed at once are drawn no more, and again after undo, also near strokes") {
  const auto kinds = {backendKind(), cpuBackend()};
  for (const auto& kind : kinds) {
    CAPTURE(kind->name());
    DrawnFollower* follower = nullptr;
    Session session(
        {.backend = {.name = std::string(kind->name())}, .brush = BrushConfig(), .hands = std::vector<HandConfig>(1)},
        sphereModel(3000),
        {.backend = *kind, .keepsPoints = true, .undo = {1 << 24}, .followers = {drawnFollower(device, follower)}});
    const auto check = [&] {
      session.catchUp();
      const auto drawn = download<Vec4>(device, device.throughputQueue(), follower->drawn().positions(),
                                        session.history()->points().size());
      std::size_t wrong = 0;
      for (const PointState& state : session.history()->points()) {
        const Vec3 at(drawn[state.number]);
        wrong += state.gone ? !std::isnan(at.x) : at != state.position;
      }
      CHECK(wrong == 0);
    };
    runAlone(session, strokeFrom({0, 0, 1}, 1));
    session.finish();
    check();
    const std::size_t before = session.history()->points().present();
    session.changePoints(PointSet::range(0, 1500), RemovePoints());
    CHECK(session.history()->points().present() < before - 1000);
    check();
    session.changePoints(PointSet::range(1500, 1520), RemovePoints());
    runAlone(session, strokeFrom({0, 0, -1}, 1));
    session.finish();
    check();
    while (session.undo(1, 0).undone > 0) check();
    CHECK(session.history()->points().present() == 3000);
    CHECK(session.undo(0, 3).redone == 3);
    check();
  }
}

TEST_SUITE_END();

}  // namespace palpate::scene_picture_test
