#include <windows.h>

#include "tests/fake_devices/fake_device.hpp"

namespace palpate {

FakeNote* mappedNote(const std::filesystem::path& file) {
  const HANDLE handle = ::CreateFileW(file.c_str(), GENERIC_READ | GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE,
                                      nullptr, OPEN_ALWAYS, 0, nullptr);
  if (handle == INVALID_HANDLE_VALUE) return nullptr;
  const HANDLE mapping = ::CreateFileMappingW(handle, nullptr, PAGE_READWRITE, 0, sizeof(FakeNote), nullptr);
  ::CloseHandle(handle);
  if (!mapping) return nullptr;
  void* memory = ::MapViewOfFile(mapping, FILE_MAP_WRITE, 0, 0, sizeof(FakeNote));
  ::CloseHandle(mapping);
  return static_cast<FakeNote*>(memory);
}

}  // namespace palpate
