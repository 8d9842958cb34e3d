#include "tests/apps/result.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

namespace palpate {

struct Result::Tree {
  nlohmann::json root;
};

namespace {

const nlohmann::json& valueAt(const void* value) {
  static const nlohmann::json null;
  return value ? *static_cast<const nlohmann::json*>(value) : null;
}

}  // namespace

Result Result::parse(const std::string& text) {
  const auto tree = std::make_shared<const Tree>(Tree{nlohmann::json::parse(text)});
  return {tree, &tree->root};
}

Result Result::operator[](std::string_view name) const {
  const nlohmann::json& object = valueAt(value_);
  const auto found = object.find(std::string(name));
  return found == object.end() ? Result() : Result(tree_, &*found);
}

Result Result::operator[](std::size_t index) const { return {tree_, &valueAt(value_).at(index)}; }

bool Result::contains(std::string_view name) const { return valueAt(value_).contains(std::string(name)); }
bool Result::is_null() const { return valueAt(value_).is_null(); }
bool Result::isObject() const { return valueAt(value_).is_object(); }
bool Result::isArray() const { return valueAt(value_).is_array(); }
std::vector<std::string> Result::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, value] : valueAt(value_).items()) keys.push_back(key);
  return keys;
}
std::size_t Result::size() const { return valueAt(value_).size(); }
std::string Result::dump() const { return valueAt(value_).dump(); }

bool Result::isText() const { return valueAt(value_).is_string(); }
bool Result::isLike(bool truth) const { return truth ? valueAt(value_).is_boolean() : valueAt(value_).is_number(); }
std::string Result::text() const { return valueAt(value_).get<std::string>(); }
bool Result::truth() const { return valueAt(value_).get<bool>(); }
double Result::number() const {
  if (!valueAt(value_).is_number()) throw std::invalid_argument(dump() + " is no number");
  return valueAt(value_).get<double>();
}
std::uint64_t Result::count() const { return valueAt(value_).get<std::uint64_t>(); }

std::ostream& operator<<(std::ostream& out, const Result& result) { return out << result.dump(); }

}  // namespace palpate
