// The makers behind makeShape(). `size` is the longest side, model units.
#pragma once

#include <memory>

#include "engine/cloud/analytic_shape.hpp"

namespace palpate {

std::unique_ptr<AnalyticShape> makePlane(double size, const DVec3& center);
std::unique_ptr<AnalyticShape> makeCube(double size, const DVec3& center);
std::unique_ptr<AnalyticShape> makeSphere(double size, const DVec3& center);
std::unique_ptr<AnalyticShape> makeTorus(double size, const DVec3& center);
std::unique_ptr<AnalyticShape> makeBumpySphere(double size, const DVec3& center);
std::unique_ptr<AnalyticShape> makeSculpture(double size, const DVec3& center);

}  // namespace palpate
