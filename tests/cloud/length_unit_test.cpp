#include "engine/cloud/length_unit.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <vector>

#include "engine/cloud/length_text.hpp"
#include "tests/near.hpp"

namespace palpate::length_unit_test {

TEST_CASE("the unit is read from a comment of the file") {
  const auto said = [](const char* comment) {
    return unitSaidIn(std::vector<std::string>{"comment made by a scanner in a museum", comment});
  };
  CHECK(said("comment units: mm") == LengthUnit::mm);
  CHECK(said("obj_info Unit = Metres") == LengthUnit::m);
  CHECK(said("comment unit cm") == LengthUnit::cm);
  CHECK(said("comment UNITS inches") == LengthUnit::inch);
  CHECK(said("comment units=ft") == LengthUnit::foot);
  CHECK(said("comment united m") == LengthUnit::unknown);
  CHECK(said("comment seen from 3 m") == LengthUnit::unknown);
  CHECK(said("comment units are unknown") == LengthUnit::unknown);
  CHECK(said("") == LengthUnit::unknown);
  CHECK(unitSaidIn({}) == LengthUnit::unknown);
  CHECK(nameOf(LengthUnit::inch) == "in");
  CHECK(nameOf(LengthUnit::unknown) == "units");
}

TEST_CASE("a scale of 1 mm is mm, of 1000 m and of 25.4 inches, unless a comment says another unit") {
  const auto said = [](std::vector<std::string> comments) { return unitSaidIn(comments); };
  CHECK(said({"comment mm_per_unit: 1"}) == LengthUnit::mm);
  CHECK(said({"comment mm_per_unit: 10"}) == LengthUnit::cm);
  CHECK(said({"comment mm_per_unit: 1000"}) == LengthUnit::m);
  CHECK(said({"comment mm_per_unit: 25.4"}) == LengthUnit::inch);
  CHECK(said({"comment mm_per_unit: 304.8"}) == LengthUnit::foot);
  CHECK(said({"comment mm_per_unit: 137.2"}) == LengthUnit::unknown);
  CHECK(said({"comment mm_per_unit: 1", "comment units: m"}) == LengthUnit::m);
  std::vector<std::string> comments{"comment mm_per_unit: 1", "comment made by a scanner"};
  sayUnit(comments, LengthUnit::m);  // of a format: the scale is that in the hand
  CHECK(unitSaidIn(comments) == LengthUnit::m);
  setUnit(comments, LengthUnit::foot);
  CHECK(comments ==
        std::vector<std::string>{"comment mm_per_unit: 1", "comment made by a scanner", "comment units: ft"});
}

TEST_CASE("the scale is read from a comment, and a given one overrides it") {
  const auto said = [](const std::string& comment) {
    return scaleSaidIn(std::vector<std::string>{"comment units: m", comment});
  };
  CHECK(said("comment mm_per_unit: 137.25") == 137.25);
  CHECK(said("comment mm_per_unit: 1e-05") == 1e-5);
  for (const char* none : {"comment mm_per_unit: ", "comment mm_per_unit: 0", "comment mm_per_unit: -3",
                           "comment mm_per_unit: nan", "comment mm_per_unit: inf", "comment mm_per_unit: 3 or 4",
                           "comment mm_per_unit 3", "obj_info mm_per_unit: 3", ""})
    CHECK_FALSE(said(none));
  CHECK_FALSE(scaleSaidIn({}));
  std::vector<std::string> comments{"comment mm_per_unit: 5", "comment made by a scanner"};
  sayScale(comments, 0.1 + 0.2);
  CHECK(comments.size() == 2);
  CHECK(scaleSaidIn(comments) == 0.1 + 0.2);
  CHECK(unitSaidIn(comments) == LengthUnit::unknown);
}

TEST_CASE("a round length is 1, 2 or 5 times a power of ten, and not larger than requested") {
  CHECK(roundLength(1) == near(1, 1e-6));
  CHECK(roundLength(1.99) == near(1, 1e-6));
  CHECK(roundLength(2) == near(2, 1e-6));
  CHECK(roundLength(4.9) == near(2, 1e-6));
  CHECK(roundLength(73) == near(50, 1e-6));
  CHECK(roundLength(0.00314) == near(0.002, 1e-6));
  CHECK(roundLength(0) == 0);
  CHECK(roundLength(-3) == 0);
  CHECK(roundLength(std::numeric_limits<double>::infinity()) == 0);
}

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

}  // namespace palpate::length_unit_test
