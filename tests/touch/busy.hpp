// Work that delays the next query.
#pragma once

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"

namespace palpate {

// Keeps the latency queue busy for some time, so that the next answer is late.
class Busy {
 public:
  Busy(Device& device, int fills)
      : buffer_(device, 64 << 20, Memory::device, "busy"), list_(device, device.latencyQueue(), "busy") {
    list_.begin();
    for (int i = 0; i < fills; ++i) list_.fill(buffer_, 1, buffer_.bytes());
    list_.end();
    device.latencyQueue().submit(list_);
  }

 private:
  Buffer buffer_;
  CommandList list_;
};

}  // namespace palpate
