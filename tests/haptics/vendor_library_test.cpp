#include "haptics/devices/vendor_library.hpp"

#include "engine/core/error.hpp"
#include "haptics/devices/dhd.hpp"
#include "haptics/devices/hdapi.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/says.hpp"

namespace palpate::vendor_library_test {

TEST_CASE("a library is found by its variable, and stays loaded") {
  const std::string file = fakeDriverFile("fake_hd").string();
  const Variable variable("PALPATE_HD_LIBRARY", file);
  const VendorLibrary library(hdapi::librarySearch());
  CHECK(library.isLoaded());
  CHECK(library.file() == file);
  CHECK(library.attempts().empty());
  CHECK(library.whyNot().empty());
  CHECK(hdapi::Api::missingFrom(library).empty());
  CHECK(library.symbol("hdInitDevice") == VendorLibrary(hdapi::librarySearch()).symbol("hdInitDevice"));
  CHECK(library.symbol("hdNoSuchFunction") == nullptr);
}

TEST_CASE("a library that is too old is reported with its missing function") {
  SUBCASE("OpenHaptics") {
    const Variable variable("PALPATE_HD_LIBRARY", fakeDriverFile("fake_hd_old").string());
    const VendorLibrary library(hdapi::librarySearch());
    REQUIRE(library.isLoaded());
    CHECK(hdapi::Api::missingFrom(library) == std::vector<std::string>{"hdGetErrorString"});
    CHECK_THROWS_WITH_AS(hdapi::Api{library}, doctest::Contains("has no hdGetErrorString; it is too old"), Error);
  }
  SUBCASE("Force Dimension") {
    const Variable variable("PALPATE_DHD_LIBRARY", fakeDriverFile("fake_dhd_old").string());
    const VendorLibrary library(dhd::librarySearch());
    REQUIRE(library.isLoaded());
    CHECK_THROWS_WITH_AS(dhd::Api{library}, doctest::Contains("has no dhdSetWatchdog; it is too old"), Error);
  }
  SUBCASE("another one") {
    const Variable variable("PALPATE_HD_LIBRARY", fakeDriverFile("fake_dhd").string());
    CHECK(says(VendorLibrary(hdapi::librarySearch()).whyNot(), "has no hdInitDevice"));
  }
}

}  // namespace palpate::vendor_library_test
