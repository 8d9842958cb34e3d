// How a hand moves a camera: each function gives the camera after one motion. Places on screen are pixels from the top
// left corner; places in space as in Camera.
#pragma once

#include "engine/render/camera.hpp"

namespace palpate {

/// Turns the view about `pivot`, which stays where it is on screen: about Camera::up by the way to the right, and up
/// and down until the view is almost along that. A way as long as the picture is high turns by half a turn.
Camera orbited(const Camera& camera, const DVec3& pivot, const DVec2& way_px, const DVec2& size_px);

/// Moves along with what is seen at `depth`, which follows the hand.
Camera panned(const Camera& camera, double depth, const DVec2& way_px, const DVec2& size_px);

/// Goes towards `point`, which stays where it is on screen; `factor` times its distance is left. Never nearer than
/// `nearest`, nor farther than `farthest`.
Camera zoomed(const Camera& camera, const DVec3& point, double factor, double nearest, double farthest);

/// Looks at `point` from the same direction and distance.
Camera recentred(const Camera& camera, const DVec3& point);

/// Looks at the target from the side where `axis` (0, 1, 2: x, y, z) grows, or falls, from the same distance. `up` is
/// upwards in the picture; from above, the front is at the bottom.
Camera alongAxis(const Camera& camera, int axis, bool fromAbove, UpAxis up = UpAxis::y);

/// From where a model is looked at, about its up: right is at the right of whoever looks at its front.
enum class ModelSide : std::uint8_t { front, back, left, right, top, bottom, iso };
inline constexpr std::array<std::pair<std::string_view, ModelSide>, 7> kModelSides{{{"front", ModelSide::front},
                                                                                    {"back", ModelSide::back},
                                                                                    {"left", ModelSide::left},
                                                                                    {"right", ModelSide::right},
                                                                                    {"top", ModelSide::top},
                                                                                    {"bottom", ModelSide::bottom},
                                                                                    {"iso", ModelSide::iso}}};
/// Looks at the target from there, from the same distance.
Camera fromSide(const Camera& camera, ModelSide side, UpAxis up);

}  // namespace palpate
