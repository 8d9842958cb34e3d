#include "apps/cli/json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace palpate {

// Wrong names and types are passed to the library, which throws the errors.
struct Json::Library {
  using Value = nlohmann::ordered_json;

  static Value from(const Json& json) {
    return std::visit([](const auto& value) { return made(value); }, json.value_);
  }

  static Json to(const Value& value) {
    switch (value.type()) {
      case Value::value_t::boolean:
        return value.get<bool>();
      case Value::value_t::number_integer:
        return static_cast<long>(value.get<std::int64_t>());
      case Value::value_t::number_unsigned:
        return static_cast<unsigned long>(value.get<std::uint64_t>());
      case Value::value_t::number_float:
        return value.get<double>();
      case Value::value_t::string:
        return value.get<std::string>();
      case Value::value_t::array: {
        Json json = array();
        for (const Value& element : value) json.push_back(to(element));
        return json;
      }
      case Value::value_t::object: {
        Json json = object();
        for (const auto& [name, member] : value.items()) json[name] = to(member);
        return json;
      }
      default:
        return nullptr;
    }
  }

 private:
  template <typename T>
  static Value made(const T& plain) {
    return plain;
  }
  static Value made(const std::vector<Json>& elements) {
    Value value = Value::array();
    for (const Json& element : elements) value.push_back(from(element));
    return value;
  }
  static Value made(const std::vector<Member>& members) {
    Value value = Value::object();
    for (const auto& [name, member] : members) value[name] = from(member);
    return value;
  }
};

Json::Json() : value_(nullptr) {}
Json::Json(std::nullptr_t) : value_(nullptr) {}
Json::Json(bool value) : value_(value) {}
Json::Json(int value) : value_(std::int64_t{value}) {}
Json::Json(unsigned value) : value_(std::uint64_t{value}) {}
Json::Json(long value) : value_(std::int64_t{value}) {}
Json::Json(unsigned long value) : value_(std::uint64_t{value}) {}
Json::Json(long long value) : value_(std::int64_t{value}) {}
Json::Json(unsigned long long value) : value_(std::uint64_t{value}) {}
Json::Json(double value) : value_(value) {}
Json::Json(const char* text) : value_(std::string(text)) {}
Json::Json(std::string text) : value_(std::move(text)) {}
Json::Json(std::string_view text) : value_(std::string(text)) {}
Json::Json(const std::vector<std::string>& values) : value_(std::vector<Json>(values.begin(), values.end())) {}
Json::Json(const std::vector<std::string_view>& values) : value_(std::vector<Json>(values.begin(), values.end())) {}

Json::Json(std::initializer_list<Json> values) {
  const bool named = std::ranges::all_of(values, [](const Json& value) {
    const auto* pair = std::get_if<std::vector<Json>>(&value.value_);
    return pair && pair->size() == 2 && std::holds_alternative<std::string>(pair->front().value_);
  });
  if (!named) {
    value_ = std::vector<Json>(values);
    return;
  }
  *this = object();
  for (const Json& value : values) (*this)[std::get<std::string>(value.at(0).value_)] = value.at(1);
}

Json::Json(const Json&) = default;
Json::Json(Json&&) noexcept = default;
Json& Json::operator=(const Json&) = default;
Json& Json::operator=(Json&&) noexcept = default;
Json::~Json() = default;

Json Json::array() {
  Json json;
  json.value_ = std::vector<Json>();
  return json;
}

Json Json::object() {
  Json json;
  json.value_ = std::vector<Member>();
  return json;
}

Json Json::parse(const std::string& text) { return Library::to(Library::Value::parse(text)); }

std::string Json::dump(int indent) const {
  return Library::from(*this).dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);  // file names
}

Json& Json::operator[](std::string_view name) {
  if (is_null()) value_ = std::vector<Member>();
  auto& members = std::get<std::vector<Member>>(value_);
  const auto found = std::ranges::find(members, name, &Member::first);
  return found != members.end() ? found->second : members.emplace_back(name, nullptr).second;
}

const Json& Json::at(std::string_view name) const {
  if (const auto* members = std::get_if<std::vector<Member>>(&value_))
    if (const auto found = std::ranges::find(*members, name, &Member::first); found != members->end())
      return found->second;
  static_cast<void>(Library::from(*this).at(std::string(name)));  // throws
  return *this;
}

const Json& Json::at(std::size_t index) const {
  if (const auto* elements = std::get_if<std::vector<Json>>(&value_); elements && index < elements->size())
    return (*elements)[index];
  static_cast<void>(Library::from(*this).at(index));  // throws
  return *this;
}

Json Json::value(std::string_view name, const Json& otherwise) const {
  const auto* members = std::get_if<std::vector<Member>>(&value_);
  return members && std::ranges::find(*members, name, &Member::first) != members->end() ? at(name) : otherwise;
}

void Json::push_back(Json value) {
  if (is_null()) value_ = std::vector<Json>();
  std::get<std::vector<Json>>(value_).push_back(std::move(value));
}

const std::vector<Json::Member>& Json::items() const { return std::get<std::vector<Member>>(value_); }
const std::vector<Json>& Json::elements() const { return std::get<std::vector<Json>>(value_); }

template <>
std::string Json::get() const {
  return Library::from(*this).get<std::string>();
}
template <>
bool Json::get() const {
  return Library::from(*this).get<bool>();
}
template <>
int Json::get() const {
  return Library::from(*this).get<int>();
}
template <>
std::int64_t Json::get() const {
  return Library::from(*this).get<std::int64_t>();
}
template <>
std::uint64_t Json::get() const {
  return Library::from(*this).get<std::uint64_t>();
}
template <>
double Json::get() const {
  return Library::from(*this).get<double>();
}

bool operator==(const Json& json, std::string_view text) {
  const auto* own = std::get_if<std::string>(&json.value_);
  return own && std::string_view(*own).compare(text) == 0;
}

}  // namespace palpate
