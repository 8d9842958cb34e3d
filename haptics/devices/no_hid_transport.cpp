// Replaces hidapi_transport.cpp if palpate is built without hidapi.
#include "haptics/devices/hid_transport.hpp"

namespace palpate {
namespace {

class NoTransport final : public HidTransport {
 public:
  std::vector<HidInfo> enumerate() override { return {}; }
  HidOpening open(const std::string&) override {
    return {.connection = nullptr, .why = "palpate was built without hidapi"};
  }
};

}  // namespace

std::shared_ptr<HidTransport> hidapiTransport() { return std::make_shared<NoTransport>(); }

}  // namespace palpate
