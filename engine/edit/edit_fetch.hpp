#pragma once

#include "engine/edit/edit_log.hpp"
#include "engine/gpu/command_list.hpp"

namespace palpate {

/// Brings what is unread in an edit log to the host, on the throughput queue: for the thread that uses that queue.
class EditFetch {
 public:
  /// From now on the log keeps entries for it. Throws OutOfGpuMemory.
  EditFetch(Device& device, EditLog& log);

  /// Appends everything that is unread, waits for it, and consumes it.
  void take(EditBatch& batch);

 private:
  Device& device_;
  Buffer staging_;
  CommandList list_;
  EditLog::Reader reader_;
};

}  // namespace palpate
