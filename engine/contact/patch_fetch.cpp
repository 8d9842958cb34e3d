#include "engine/contact/patch_fetch.hpp"

#include <algorithm>

#include "engine/contact/gather.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kMaxCells =
    shared::kCarriedCellsPerSide * shared::kCarriedCellsPerSide * shared::kCarriedCellsPerSide;

// The loops of one invocation: every round of cells with its candidates, each with a scan over up to 32 subgroups.
static_assert(kMaxCells / shared::kContactWorkgroup * (shared::kPatchRoundCandidates / shared::kContactWorkgroup + 1) *
                  (1 + 32) <
              60'000);

}  // namespace

PatchFetch::PatchFetch(Device& device, const HashGrid& grid, double radius, std::uint32_t points, const Motion& motion)
    : reach_(std::min(static_cast<double>(shared::kCarriedReach) * radius,
                      widestReach(grid, shared::kCarriedCellsPerSide))),
      pass_(device, shader_code::contact_fetch_patch,
            {.workgroupSize = shared::kContactWorkgroup,
             .pushBytes = sizeof(shared::PatchFetchArgs),
             .constants = {motion.pointsMove ? VK_TRUE : VK_FALSE, motion.normalsTurn ? VK_TRUE : VK_FALSE}}),
      centre_(Buffer::of<Vec4>(device, 1, Memory::upload, "patch centre")),
      patch_(device, sizeof(shared::CarriedHead) + 2 * sizeof(Vec4) * shared::kMaxCarriedPoints, Memory::readback,
             "carried patch"),
      near_(Buffer::of<std::uint32_t>(device, std::min(points, gatherRounds(kMaxCells) * shared::kPatchRoundCandidates),
                                      Memory::device, "points near the patch")) {
  patch_.mapped<shared::CarriedHead>()[0] = {};
}

void PatchFetch::record(CommandList& commands, const shared::CloudView& cloud, DeviceAddress velocities) const {
  commands.dispatch(pass_, shared::kContactWorkgroup,
                    shared::PatchFetchArgs{.cloud = cloud,
                                           .centre = centre_.address(),
                                           .fetched = patch_.address(),
                                           .near = near_.address(),
                                           .velocities = velocities,
                                           .reach = static_cast<float>(reach_),
                                           .mostCells = kMaxCells});
}

void PatchFetch::aimAt(const Vec3& centre, double age_s, const Vec3& now) {
  aim_ = now;
  centre_.mapped<Vec4>()[0] = Vec4(centre, static_cast<float>(age_s));
}

CarriedPatch PatchFetch::patch() const {
  const shared::CarriedHead& head = patch_.mapped<const shared::CarriedHead>()[0];
  constexpr std::size_t kHead = sizeof(shared::CarriedHead) / sizeof(Vec4);
  const std::size_t count = std::min(head.count, shared::kMaxCarriedPoints);
  return {.centre = aim_,
          .reach = reach_,
          .points = patch_.mapped<const Vec4>().subspan(kHead, 2 * count),
          .thinned = head.thinned != 0};
}

}  // namespace palpate
