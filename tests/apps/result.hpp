// Output of --json, as a test reads it. The JSON library is hidden in result.cpp, because each file that includes it
// takes twice as long to compile.
#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace palpate {

template <class T>
concept PlainValue = std::is_arithmetic_v<T> || std::same_as<T, std::string>;

/// A JSON value; copies share the document. Access to a missing element or as another type throws an exception, which
/// fails the test; a missing member of an object is null.
class Result {
 public:
  Result() = default;  ///< null
  static Result parse(const std::string& text);

  Result operator[](std::string_view name) const;
  Result operator[](std::size_t index) const;
  Result at(std::string_view name) const { return (*this)[name]; }
  Result at(std::size_t index) const { return (*this)[index]; }
  Result front() const { return (*this)[std::size_t{0}]; }
  Result back() const { return (*this)[size() - 1]; }
  bool contains(std::string_view name) const;
  bool is_null() const;
  bool isObject() const;
  bool isArray() const;
  std::vector<std::string> keys() const;  ///< of an object
  std::size_t size() const;
  bool empty() const { return size() == 0; }
  std::string dump() const;

  template <PlainValue T>
  T get() const {
    if constexpr (std::same_as<T, std::string>)
      return text();
    else if constexpr (std::same_as<T, bool>)
      return truth();
    else if constexpr (std::unsigned_integral<T>)
      return static_cast<T>(count());
    else
      return static_cast<T>(number());
  }
  template <PlainValue T>
  operator T() const {
    return get<T>();
  }

  class Iterator;
  Iterator begin() const;
  Iterator end() const;

  friend bool operator==(const Result& a, const Result& b) { return a.dump() == b.dump(); }
  friend std::partial_ordering operator<=>(const Result& a, const Result& b) { return a.number() <=> b.number(); }
  template <class T>
  requires std::is_arithmetic_v<T>
  friend bool operator==(const Result& a, T b) {
    return a.isLike(std::same_as<T, bool>) && a.get<std::conditional_t<std::same_as<T, bool>, bool, double>>() == b;
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  friend std::partial_ordering operator<=>(const Result& a, T b) { return a.number() <=> static_cast<double>(b); }
  friend bool operator==(const Result& a, std::string_view b) { return a.isText() && a.text() == b; }
  template <class T>
  friend bool operator==(const Result& a, const std::vector<T>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < b.size(); ++i)
      if (!(a[i] == b[i])) return false;
    return true;
  }
  friend std::ostream& operator<<(std::ostream& out, const Result& result);

 private:
  struct Tree;  // of the library
  Result(std::shared_ptr<const Tree> tree, const void* value) : tree_(std::move(tree)), value_(value) {}
  bool isText() const;
  bool isLike(bool truth) const;  ///< a boolean, or a number
  std::string text() const;
  bool truth() const;
  double number() const;
  std::uint64_t count() const;

  std::shared_ptr<const Tree> tree_;
  const void* value_ = nullptr;  // in the tree
};

/// Over the elements of an array.
class Result::Iterator {
 public:
  using value_type = Result;
  using difference_type = std::ptrdiff_t;

  Iterator() = default;
  Iterator(Result array, std::size_t index) : array_(std::move(array)), index_(index) {}
  Result operator*() const { return array_[index_]; }
  Iterator& operator++() {
    ++index_;
    return *this;
  }
  Iterator operator++(int) {
    Iterator before = *this;
    ++index_;
    return before;
  }
  friend bool operator==(const Iterator& a, const Iterator& b) { return a.index_ == b.index_; }

 private:
  Result array_;
  std::size_t index_ = 0;
};

inline Result::Iterator Result::begin() const { return {*this, 0}; }
inline Result::Iterator Result::end() const { return {*this, size()}; }

}  // namespace palpate
