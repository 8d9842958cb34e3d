// The table of brushes: what C++ and shaders ask about a brush, apart from its formula. Shaders read the traits of a
// row in the Brush, which C++ fills in.
#ifndef PALPATE_SHARED_BRUSH_TRAITS_H
#define PALPATE_SHARED_BRUSH_TRAITS_H
#include "shaders/shared/types.h"

#ifdef __cplusplus
#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace palpate {
/// The effect of a brush on the points within its reach.
enum class BrushKind { push, carve, inflate, smooth, grab, paint, flatten };
}  // namespace palpate
#endif

PALPATE_SHARED_BEGIN

// BrushKind, for the formulas.
const uint kBrushPush = 0, kBrushCarve = 1, kBrushInflate = 2, kBrushSmooth = 3, kBrushGrab = 4, kBrushPaint = 5,
           kBrushFlatten = 6;

const uint kMovesPoints = 1u << 0;
const uint kRemovesPoints = 1u << 1;  // also acts on what is not connected with the surface under the hand
const uint kPaintsPoints = 1u << 2;
const uint kHoldsPoints = 1u << 3;   // carries along what it took hold of, on both sides of a thin part
const uint kHasShaft = 1u << 4;      // its tool, and its ring: a ball before the HIP, with a shaft; else at the surface
const uint kUsesPushRate = 1u << 5;  // and its slider, in place of the strength
const uint kPressesFaces = 1u << 6;  // the faces in front of its tool
const uint kFollowsNormals = 1u << 7;  // moves points along their own normals
const uint kRaisesSurface = 1u << 8;   // by no more than the hand presses, in equal steps
const uint kUsesNeighbours = 1u << 9;  // a point moves by its neighbours: smoothed()
const uint kMeasuresFound = 1u << 10;  // distances are from where the stroke found a point; else from where it is
const uint kLooksAhead = 1u << 11;     // a point moves beyond a first step only as far as it has seen
const uint kMayResample = 1u << 12;    // points may be inserted and merged
const uint kShapesBodies = 1u << 13;   // works on soft bodies
const uint kMayBuildUp = 1u << 14;     // goes on from where a stroke has brought a point, if BrushOptions::accumulate
const uint kBuildsUp = 1u << 15;       // it does: of a Brush, not of a kind

#ifdef __cplusplus
struct BrushTraits {
  std::string_view name;
  BrushKind kind;
  uint traits;
  const char* does;  ///< for people
  std::optional<BrushKind> inverse = {};
  const char* withoutInverse = "";  ///< what to do where there is none, for people
};
constexpr std::optional<BrushKind> kNoInverse;

/// Of a brush that moves points and leaves the model whole.
constexpr uint kSculpts = kMovesPoints | kLooksAhead | kMayResample | kShapesBodies;

/// In the order of BrushKind, which is that of the window's keys.
inline constexpr auto kBrushes = std::to_array<BrushTraits>({
    {"push", BrushKind::push, kSculpts | kHasShaft | kUsesPushRate | kPressesFaces,
     "presses the surface in, by the shape of a ball", BrushKind::inflate},
    {"carve", BrushKind::carve, kMovesPoints | kRemovesPoints | kMayResample | kHasShaft,
     "cuts a ball out of the model", BrushKind::inflate},
    {"inflate", BrushKind::inflate, kSculpts | kFollowsNormals | kRaisesSurface | kMeasuresFound | kMayBuildUp,
     "raises the surface", BrushKind::push},
    {"smooth", BrushKind::smooth, kSculpts | kFollowsNormals | kUsesNeighbours, "evens out bumps", kNoInverse,
     "bumps that were evened out come back by undo"},
    {"grab", BrushKind::grab, kSculpts | kHoldsPoints | kMeasuresFound, "pulls the surface along with the hand",
     kNoInverse, "pull the other way"},
    {"paint", BrushKind::paint, kPaintsPoints, "colours the points", kNoInverse, "choose another colour"},
    {"flatten", BrushKind::flatten, kSculpts | kPressesFaces | kMeasuresFound, "levels the surface", kNoInverse,
     "it levels bumps and hollows alike"},
});
#endif

PALPATE_SHARED_END

#ifdef __cplusplus
namespace palpate {

using shared::BrushTraits;
using shared::kBrushes;

constexpr const BrushTraits& traitsOf(BrushKind kind) { return kBrushes[static_cast<std::size_t>(kind)]; }
/// Whether a brush has at least one of these traits.
constexpr bool brushHas(BrushKind kind, shared::uint traits) { return (traitsOf(kind).traits & traits) != 0; }

/// Names of the brushes, as a table of choices.
inline constexpr auto kBrushKinds = [] {
  std::array<std::pair<std::string_view, BrushKind>, kBrushes.size()> kinds;
  for (std::size_t k = 0; k < kinds.size(); ++k) kinds[k] = {kBrushes[k].name, kBrushes[k].kind};
  return kinds;
}();
static_assert([] {
  for (const BrushTraits& each : kBrushes)
    if (&traitsOf(each.kind) != &each) return false;
  return true;
}());

}  // namespace palpate
#endif

#endif
