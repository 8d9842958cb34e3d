#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/fake_devices/fake_device.hpp"

namespace palpate {

FakeNote* mappedNote(const std::filesystem::path& file) {
  const int handle = ::open(file.c_str(), O_RDWR | O_CREAT, 0600);
  if (handle < 0) return nullptr;
  const bool large = ::ftruncate(handle, sizeof(FakeNote)) == 0;
  void* memory = ::mmap(nullptr, sizeof(FakeNote), PROT_READ | PROT_WRITE, MAP_SHARED, handle, 0);
  ::close(handle);
  return large && memory != MAP_FAILED ? static_cast<FakeNote*>(memory) : nullptr;
}

}  // namespace palpate
