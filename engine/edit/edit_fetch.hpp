#pragma once

#include "engine/edit/edit_log.hpp"
#include "engine/gpu/command_list.hpp"

namespace palpate {

/// Copies the unread entries of an edit log to the host, on the throughput queue: for the thread that uses that queue.
class EditFetch {
 public:
  /// From construction on the log keeps entries for it. Throws OutOfGpuMemory.
  EditFetch(Device& device, EditLog& log);

  /// Appends all unread entries, waits for the copy, and consumes them.
  void take(EditBatch& batch);

 private:
  Device& device_;
  Buffer staging_;
  CommandList list_;
  EditLog::Reader reader_;
};

}  // namespace palpate
