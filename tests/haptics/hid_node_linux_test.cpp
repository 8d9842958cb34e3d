#include "haptics/devices/hid_node.hpp"

#include <doctest/doctest.h>

namespace palpate::hid_node_test {

TEST_CASE("who may not open a device is told a command that mends it") {
  CHECK(hidPermissionMend("/dev/no-such-hidraw", true) == "run: third_party/install.sh --udev");
  CHECK(hidPermissionMend("/dev/no-such-hidraw", false).starts_with("run: sudo chown $USER /dev/no-such-hidraw"));
  CHECK_FALSE(HidNode::isDenied("/dev/no-such-hidraw"));
}

}  // namespace palpate::hid_node_test
