// The loader's messages for missing or unusable libraries.
#include <fstream>

#include "haptics/devices/dhd.hpp"
#include "haptics/devices/hdapi.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/says.hpp"

namespace palpate::vendor_library_test {

TEST_CASE("without a library the searched paths and the package to install are reported") {
  const VendorLibrary library(hdapi::librarySearch());
  CHECK_FALSE(library.isLoaded());
  CHECK(says(library.whyNot(), "is not on this machine (looked for HD.dll)"));
  CHECK(says(VendorLibrary(dhd::librarySearch()).whyNot(), "is not on this machine (looked for dhd64.dll, drd64.dll)"));
}

TEST_CASE("an unusable library is distinguished from a missing one") {
  const ScratchFolder folder;
  const std::string file = (folder / "HD.dll").string();
  std::ofstream(file) << "not a library, but a text that is long enough to have a header of sixty-four bytes in it";
  const Variable variable("PALPATE_HD_LIBRARY", file);
  const VendorLibrary library(hdapi::librarySearch());
  CHECK_FALSE(library.isLoaded());
  CHECK(says(library.whyNot(), "was found but cannot be loaded: " + file));
}

}  // namespace palpate::vendor_library_test
