#include "engine/cloud/length_text.hpp"

#include <doctest/doctest.h>

namespace palpate::length_text_test {

TEST_CASE("a length is shown with its unit, and with all digits before the decimal point") {
  CHECK(lengthText(2.31, LengthUnit::m) == "2.31 m");
  CHECK(lengthText(0.0123456789, LengthUnit::unknown) == "0.0123457 units");
  CHECK(lengthText(4877754.178, LengthUnit::foot) == "4877754 ft");
  CHECK(lengthText(1234.5678, LengthUnit::mm, kFewLengthDigits) == "1235 mm");
  CHECK(lengthText(0.069314, LengthUnit::m, kFewLengthDigits) == "0.0693 m");
  CHECK(lengthText(-1e7) == "-10000000");
  CHECK(lengthText(0) == "0");
}

TEST_CASE("a coordinate is shown with exactly its known digits") {
  CHECK(coordinateText(4877754.178, 0) == "4877754.178");
  CHECK(coordinateText(637177.98, 0) == "637177.98");
  CHECK(coordinateText(-0.5, 0) == "-0.5");
  // The resolution of float32 within a box of 300 around the origin.
  const double resolution = resolutionOf({DVec3(-150), DVec3(150)});
  CHECK(coordinateText(4877754.178, resolution) == "4877754.178");
  CHECK(coordinateText(4877754.1780001, resolution) == "4877754.178");
  CHECK(coordinateText(static_cast<double>(0.1f), resolutionOf({DVec3(-1), DVec3(1)})) == "0.1");
  CHECK(coordinateText(120.0, resolution) == "120");
  CHECK(coordinateText(static_cast<double>(406.26f), resolutionOf({DVec3(0), DVec3(520)})) == "406.26");
  CHECK(coordinateText(-1e-9, resolution) == "0");
  CHECK(coordinateText(1.5e-5, resolutionOf({DVec3(0), DVec3(2e-5)})) == "0.000015");
  CHECK(coordinateText(DVec3(1, 2.5, -3), 0, ",") == "1,2.5,-3");
}

TEST_CASE("the touch scale shows the size of the model in the hand once") {
  CHECK(touchScaleText({100 / 2.31}, 2.31, LengthUnit::m) == "100 mm in the hand for 2.31 m");
  CHECK(touchScaleText({2}, 0, LengthUnit::unknown) == "2 mm in the hand for 1 units");
}

}  // namespace palpate::length_text_test
