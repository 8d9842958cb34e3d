// A JSON value, whose members keep their order. Only json.cpp includes the library that reads and writes the text,
// because each file that includes it takes seconds longer to compile.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

class Json {
 public:
  using Member = std::pair<std::string, Json>;

  Json();  ///< null
  Json(std::nullptr_t);
  Json(bool value);
  Json(int value);
  Json(unsigned value);
  Json(long value);
  Json(unsigned long value);
  Json(long long value);
  Json(unsigned long long value);
  Json(double value);
  Json(const char* text);
  Json(std::string text);
  Json(std::string_view text);
  Json(const std::vector<std::string>& values);
  Json(const std::vector<std::string_view>& values);
  /// An object, if each value is an array of two that begins with a string; else an array.
  Json(std::initializer_list<Json> values);
  Json(const Json&);
  Json(Json&&) noexcept;
  Json& operator=(const Json&);
  Json& operator=(Json&&) noexcept;
  ~Json();

  static Json array();
  static Json object();
  /// Throws std::exception that names the invalid text and its position.
  static Json parse(const std::string& text);
  /// On several lines if `indent` is not negative.
  std::string dump(int indent = -1) const;

  /// The member of an object; a new one, null, if there is none. A null value becomes an object.
  Json& operator[](std::string_view name);
  /// The same for an existing member. Throws std::exception that names a missing one.
  const Json& operator[](std::string_view name) const { return at(name); }
  const Json& at(std::string_view name) const;
  const Json& at(std::size_t index) const;
  /// The member of that name, or `otherwise`.
  Json value(std::string_view name, const Json& otherwise) const;
  void push_back(Json value);

  const std::vector<Member>& items() const;  ///< of an object
  // For an array.
  std::size_t size() const { return elements().size(); }
  const Json* begin() const { return elements().data(); }
  const Json* end() const { return elements().data() + size(); }

  bool is_null() const { return std::holds_alternative<std::nullptr_t>(value_); }
  bool isReal() const { return std::holds_alternative<double>(value_); }
  bool isText() const { return std::holds_alternative<std::string>(value_); }
  bool isArray() const { return std::holds_alternative<std::vector<Json>>(value_); }
  bool isObject() const { return std::holds_alternative<std::vector<Member>>(value_); }
  /// Throws std::exception if the type differs. For std::string, bool, int, std::int64_t, std::uint64_t and double.
  template <typename T>
  T get() const;

  friend bool operator==(const Json& json, std::string_view text);

 private:
  struct Library;  // converts to the library's value type and back
  const std::vector<Json>& elements() const;

  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, std::vector<Json>,
               std::vector<Member>>
      value_;
};

inline Json vectorJson(const DVec3& v) { return {v.x, v.y, v.z}; }

template <>
std::string Json::get() const;
template <>
bool Json::get() const;
template <>
int Json::get() const;
template <>
std::int64_t Json::get() const;
template <>
std::uint64_t Json::get() const;
template <>
double Json::get() const;

}  // namespace palpate
