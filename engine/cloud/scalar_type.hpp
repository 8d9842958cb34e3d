// The number types of PLY and 64-bit integers, and dispatch from a type known at run time to one known at compile time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

namespace palpate {

enum class ScalarType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64, i64, u64 };

/// Calls f(std::type_identity<T>{}) with the C++ type that stands for `type`.
template <class F>
decltype(auto) visitScalar(ScalarType type, F&& f) {
  switch (type) {
    case ScalarType::i8:
      return f(std::type_identity<std::int8_t>{});
    case ScalarType::u8:
      return f(std::type_identity<std::uint8_t>{});
    case ScalarType::i16:
      return f(std::type_identity<std::int16_t>{});
    case ScalarType::u16:
      return f(std::type_identity<std::uint16_t>{});
    case ScalarType::i32:
      return f(std::type_identity<std::int32_t>{});
    case ScalarType::u32:
      return f(std::type_identity<std::uint32_t>{});
    case ScalarType::f32:
      return f(std::type_identity<float>{});
    case ScalarType::i64:
      return f(std::type_identity<std::int64_t>{});
    case ScalarType::u64:
      return f(std::type_identity<std::uint64_t>{});
    case ScalarType::f64:
      break;
  }
  return f(std::type_identity<double>{});
}

/// Bytes of one value.
inline std::size_t sizeOf(ScalarType type) {
  return visitScalar(type, []<class T>(std::type_identity<T>) { return sizeof(T); });
}
inline bool isFloating(ScalarType type) { return type == ScalarType::f32 || type == ScalarType::f64; }

/// The classic PLY spelling: char uchar short ushort int uint float double; and int64 uint64, which have none.
inline std::string_view plyName(ScalarType type) {
  constexpr std::array<std::string_view, 10> kNames{"char", "uchar", "short",  "ushort", "int",
                                                    "uint", "float", "double", "int64",  "uint64"};
  return kNames[static_cast<std::size_t>(type)];
}

/// Both spellings, `uchar` and `uint8`; empty for any other word.
inline std::optional<ScalarType> scalarTypeFromPly(std::string_view name) {
  constexpr std::array<std::string_view, 10> kSized{"int8",   "uint8",   "int16",   "uint16", "int32",
                                                    "uint32", "float32", "float64", "int64",  "uint64"};
  for (std::size_t k = 0; k < kSized.size(); ++k) {
    const auto type = static_cast<ScalarType>(k);
    if (name == kSized[k] || name == plyName(type)) return type;
  }
  return std::nullopt;
}

/// A value from memory of any alignment, with its bytes reversed first if `kSwap`.
template <class T, bool kSwap = false>
T loadScalar(const std::byte* from) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if constexpr (kSwap) std::reverse(bytes.begin(), bytes.end());
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}
template <class T>
T loadScalar(std::span<const std::byte> bytes, std::size_t at) {
  return loadScalar<T>(bytes.data() + at);
}

}  // namespace palpate
