#include "haptics/devices/hid_choice.hpp"

#include <doctest/doctest.h>

#include "engine/core/error.hpp"
#include "haptics/devices/hid_node.hpp"
#include "tests/error_of.hpp"
#include "tests/haptics/fake_hid.hpp"
#include "tests/says.hpp"

namespace palpate::hid_choice_test {
namespace {

std::string complaint(HidTransport& transport, std::string_view wanted) {
  return errorOf([&] { chooseHidSteering(transport, wanted); });
}

}  // namespace

TEST_CASE("a 3D mouse is recognised by its usage, not by its vendor") {
  CHECK(kindOf(spaceMouse()) == HidKind::spaceMouse);
  HidInfo stranger = spaceMouse();
  stranger.vendorId = 0x1234;
  CHECK(kindOf(stranger) == HidKind::spaceMouse);
  CHECK(kindOf(keyboard()) == HidKind::none);  // of the same vendor as some 3D mice
  CHECK(kindOf(dualSense()) == HidKind::dualSense);
  HidInfo sound = dualSense();
  sound.usagePage = 0x0c;  // another collection of the same controller
  CHECK(kindOf(sound) == HidKind::none);
  CHECK(kindOf({.vendorId = 0x2988, .usagePage = 0xff00, .usage = 1}) == HidKind::hapticStylus);
}

TEST_CASE("a device's name contains its numbers, and replaces a missing product name") {
  CHECK(nameOf(spaceMouse()) == "SpaceMouse Compact (256f:c635)");
  CHECK(nameOf({.vendorId = 0x046d, .productId = 0xc626, .usagePage = 1, .usage = 8}) ==
        "Logitech 3D mouse (046d:c626)");
  CHECK(nameOf({.vendorId = 1, .productId = 2}) == "device (0001:0002)");
}

TEST_CASE("without a request the first usable 3D mouse is selected, then a DualSense") {
  FakeHid hid;
  hid.plug(keyboard());
  hid.plug(dualSense());
  CHECK(chooseHidSteering(hid, "").path == "/dev/hidraw5");
  hid.plug(spaceMouse("/dev/hidraw3", "A1"));
  hid.plug(spaceMouse("/dev/hidraw4", "B2"));
  CHECK(chooseHidSteering(hid, "").path == "/dev/hidraw3");
  hid.deny("/dev/hidraw3");
  CHECK(chooseHidSteering(hid, "").path == "/dev/hidraw4");
  hid.deny("/dev/hidraw4");
  CHECK(chooseHidSteering(hid, "").path == "/dev/hidraw5");
}

TEST_CASE("a HID device is selected by path, serial number, or vendor and product") {
  FakeHid hid;
  hid.plug(spaceMouse("/dev/hidraw3", "A1"));
  hid.plug(spaceMouse("/dev/hidraw4", "B2"));
  hid.plug(dualSense());
  CHECK(chooseHidSteering(hid, "/dev/hidraw4").serial == "B2");
  CHECK(chooseHidSteering(hid, "B2").path == "/dev/hidraw4");
  CHECK(chooseHidSteering(hid, "256F:C635").path == "/dev/hidraw3");
  CHECK(chooseHidSteering(hid, "054c:0ce6").path == "/dev/hidraw5");
}

TEST_CASE("an unsuccessful search reports what was searched for and which devices exist") {
  FakeHid hid;
  CHECK(says(complaint(hid, ""), "there is no HID device at all"));
  hid.plug(keyboard());
  const std::string none = complaint(hid, "");
  CHECK(says(none, "no 3D mouse (usage 1/8) and no DualSense;"));
  CHECK(says(none, "Keyboard (046d:c31c) with usage 1/6 at /dev/hidraw0"));
  CHECK(says(complaint(hid, "046d:c31c"), "that is '046d:c31c'"));  // a keyboard cannot steer, even if it is named
  CHECK_THROWS_AS(chooseDualSense(hid), Error);
}

TEST_CASE("a device without permission is reported with the command that grants it") {
  FakeHid hid;
  hid.plug(spaceMouse());
  hid.deny("/dev/hidraw3");
  const std::string denied = complaint(hid, "");
  CHECK(says(denied, "SpaceMouse Compact (256f:c635) at /dev/hidraw3"));
  CHECK(says(denied, "Permission denied"));
  CHECK(says(denied, hidPermissionMend("/dev/hidraw3", true)));

  HidInfo stranger = spaceMouse("/dev/hidraw9");
  stranger.vendorId = 0x1234;  // no permission rule includes it
  hid.plug(stranger);
  hid.deny("/dev/hidraw9");
  CHECK(says(complaint(hid, "/dev/hidraw9"), hidPermissionMend("/dev/hidraw9", false)));
}

TEST_CASE("the doctor lists each suitable device once, as usable or with the reason and a remedy") {
  FakeHid hid;
  hid.plug(keyboard());
  hid.plug(spaceMouse());
  HidInfo again = spaceMouse();
  again.usage = 8;
  hid.plug(again);  // another collection of the same node
  HidInfo pad = dualSense();
  pad.bluetooth = true;
  hid.plug(pad);
  hid.plug({.path = "/dev/hidraw7", .vendorId = 0x2988, .productId = 0x0400, .usagePage = 0xff00, .usage = 1});
  hid.deny("/dev/hidraw7");
  const auto list = hidCandidates(hid);
  REQUIRE(list.size() == 3);
  CHECK(list[0].usable);
  CHECK(list[0].whyNot.empty());
  CHECK(list[0].mend.empty());
  CHECK(!list[1].usable);
  CHECK(says(list[1].whyNot, "Bluetooth"));
  CHECK(says(list[1].mend, "cable"));
  CHECK(list[2].kind == HidKind::hapticStylus);
  CHECK(says(list[2].whyNot, "Permission denied"));
  CHECK(list[2].mend == hidPermissionMend("/dev/hidraw7", true));
  CHECK(hid.opened() == 0);  // no device stays open
}

}  // namespace palpate::hid_choice_test
