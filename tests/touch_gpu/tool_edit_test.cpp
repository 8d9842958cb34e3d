// Tools of many points over a cloud that is edited.
#include "tests/touch/tool_hands.hpp"

namespace palpate::tool_edit_test {

TEST_CASE_FIXTURE(ToolFixture, "a brush has the same effect under a tool as under its HIP alone, bit by bit") {
  const Scene scene = makeScene("sphere", 10'000);
  const BrushOptions push{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 8};
  std::vector<PointCloud> sculpted;
  for (const ToolShape& tool : {ToolShape{}, makeTool(ToolKind::pad, 8, 8)}) {
    TouchSide touch(device, scene.cloud,
                    {.radius = scene.radius, .friction = kFriction, .tools = {tool}, .brush = push});
    for (int i = 0; i <= 60; ++i)
      touch.query({.time_s = kTick_s * i, .hip = {0, 0, 51 - 4 * std::min(1.0, i / 40.0)}}, 0);
    touch.finish();
    sculpted.push_back(scene.cloud);
    CHECK(touch.readBack(sculpted.back()) > 30);
  }
  CHECK(sculpted[0].positions == sculpted[1].positions);
  CHECK(sculpted[0].normals == sculpted[1].normals);
}

TEST_CASE("a tool feels the edits under it like a tool on a newly loaded cloud") {
  const Scene scene = makeScene("sphere", 10'000);
  const ToolShape pad = makeTool(ToolKind::pad, 12, 8);
  const auto options = [&](std::optional<BrushOptions> brush) {
    return CpuTouchOptions{.radius = scene.radius, .tools = {pad}, .brush = brush};
  };
  CpuHand sculptor(scene.cloud, options(BrushOptions{.yieldDepth = 0.3, .pushRate = 1, .radius = 8}));
  for (int i = 0; i <= 80; ++i) sculptor.feel({0, 0, 52 - 4 * std::min(1.0, i / 40.0)});
  sculptor.backend().finish();
  PointCloud dented = scene.cloud;
  REQUIRE(sculptor.backend().readBack(dented) > 15);
  sculptor.backend().setBrush(std::nullopt);
  CpuHand fresh(dented, options({}));
  for (double z = 60; z > 47; z -= 0.2) {
    const Felt a = sculptor.feel({0, 0, z}), b = fresh.feel({0, 0, z});
    if (z > 58) continue;  // after it has let go
    CHECK(glm::distance(a.force_N, b.force_N) < 1e-6);
  }
}

}  // namespace palpate::tool_edit_test
