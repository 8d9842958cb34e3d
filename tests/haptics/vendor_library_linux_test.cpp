// The loader's messages for missing or unusable libraries.
#include <fstream>

#include "haptics/devices/hdapi.hpp"
#include "haptics/devices/vendor_library.hpp"
#include "tests/content_of.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/says.hpp"

namespace palpate::vendor_library_test {
TEST_CASE("without a library the searched paths and the package to install are reported") {
  const VendorLibrary library(hdapi::librarySearch());
  if (library.isLoaded()) {
    MESSAGE("skipped: this machine has " << library.file());
    return;
  }
  CHECK(library.attempts().size() == 4);
  const std::string text = library.whyNot();
  CHECK(says(text, "is not on this machine (looked for libHD.so.3.4, libHD.so, libHD.so.3.0)"));
  CHECK(says(text, "install the Touch device driver and OpenHaptics"));
  CHECK(says(text, "PALPATE_HD_LIBRARY"));
}

TEST_CASE("an unusable library is distinguished from a missing one") {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "libHD.so";
  std::string bytes = contentOf(fakeDriverFile("fake_hd"));
  std::string part;
  SUBCASE("of another architecture") {
    bytes[4] = 1;  // ELFCLASS32
    part = "wrong ELF class";
  }
  SUBCASE("truncated") {
    bytes.resize(40);
    part = "file too short";
  }
  SUBCASE("no library at all") {
    bytes = "not a library, but a text that is long enough to have a header of sixty-four bytes in it";
    part = "invalid ELF header";
  }
  std::ofstream(file, std::ios::binary) << bytes;
  const Variable variable("PALPATE_HD_LIBRARY", file.string());
  const VendorLibrary library(hdapi::librarySearch());
  CHECK_FALSE(library.isLoaded());
  const std::string text = library.whyNot();
  CHECK(says(text, "was found but cannot be loaded: " + file.string()));
  CHECK(says(text, part));
  CHECK(says(text, "PALPATE_HD_LIBRARY names it; correct or unset it"));
}

}  // namespace palpate::vendor_library_test
