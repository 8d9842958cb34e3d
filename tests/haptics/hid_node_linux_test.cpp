#include "haptics/devices/hid_node.hpp"

#include <doctest/doctest.h>

namespace palpate::hid_node_test {

TEST_CASE("a denied HID device is reported with a command that grants access") {
  CHECK(hidPermissionMend("/dev/no-such-hidraw", true) == "run: third_party/install.sh --udev");
  CHECK(hidPermissionMend("/dev/no-such-hidraw", false).starts_with("run: sudo chown $USER /dev/no-such-hidraw"));
  CHECK_FALSE(HidNode::isDenied("/dev/no-such-hidraw"));
}

}  // namespace palpate::hid_node_test
