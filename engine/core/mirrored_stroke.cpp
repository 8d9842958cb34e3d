#include "engine/core/mirrored_stroke.hpp"

#include <utility>

namespace palpate {

void MirroredStroke::setBrush(const BrushOptions& brush) {
  brush_ = brush;
  owesImage_ = false;
  hand_.setBrush(brush);
  image_.setBrush(brush);
}

void MirroredStroke::feel(const Contact& contact, const DVec3& hip, const DVec3& spring, Press press, double time_s) {
  hand_.feel(contact, hip, spring, press, time_s);
  if (!brush_.symmetry) return;
  const MirrorPlane& plane = *brush_.symmetry;
  Contact image = contact;
  image.normal = plane.imageOfDirection(contact.normal);
  image_.feel(image, plane.image(hip), plane.imageOfDirection(spring), press, time_s);
}

void MirroredStroke::end() {
  owesImage_ = false;
  hand_.end();
  image_.end();
}

void MirroredStroke::awaitRelease() {
  end();
  hand_.awaitRelease();
  image_.awaitRelease();
}

void MirroredStroke::restart() {
  owesImage_ = false;
  hand_.restart();
  image_.restart();
}

void MirroredStroke::lift() {
  hand_.lift();
  image_.lift();
}

const MirroredStroke::Tool& MirroredStroke::next(double time_s, const Backlog& backlog) {
  isImage_ = std::exchange(owesImage_, false);
  if (isImage_) return tool_ = imageTool_;
  tool_ = hand_.next(time_s, backlog);
  if (!brush_.symmetry || tool_.acts == 0) return tool_;
  const auto& [normal, height] = *brush_.symmetry;
  const bool holds = brushHas(brush_.kind, shared::kHoldsPoints);
  const double side = glm::dot(normal, holds ? tool_.touched : tool_.hand) < height ? -1 : 1;
  tool_.ownSide = side * normal;
  tool_.ownFrom = side * height;
  imageTool_ = image_.next(time_s, backlog);
  imageTool_.stroke = tool_.stroke;
  imageTool_.ownSide = -tool_.ownSide;
  imageTool_.ownFrom = -tool_.ownFrom;
  imageTool_.isImage = 1;
  owesImage_ = imageTool_.acts != 0;
  return tool_;
}

}  // namespace palpate
