#include "haptics/sharing/security.hpp"

namespace palpate {

namespace {

[[noreturn]] void refuse() {
  throw Error(
      "this palpate was built without what encrypts sessions; install cyclonedds-dev, libssl-dev and libpugixml-dev, "
      "and "
      "build it again");
}

}  // namespace

MadeKeys makeKeys(const KeyRequest&) { refuse(); }
SecurityProfile readSecurityProfile(const std::filesystem::path&) { refuse(); }

}  // namespace palpate
