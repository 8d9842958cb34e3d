#include "engine/select/expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/core/bare_vector.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"
#include "engine/select/point_bits.hpp"

namespace palpate {

namespace {

using Operation = Expression::Operation;
using Kind = Expression::Kind;

// Points of a register: its loops cost more than finding the step, and a dozen registers stay in the fastest cache.
constexpr std::size_t kBlock = 256;
constexpr std::size_t kAtOnce = 64 * kBlock;  // taken by a thread at a time

void requireNoOverflow(bool overflows) {
  if (overflows) throw Error("a whole number is beyond 128 bits; multiply by 1.0, and the result is rounded");
}
Whole sum(Whole a, Whole b) {
  Whole result = 0;
  requireNoOverflow(__builtin_add_overflow(a, b, &result));
  return result;
}
Whole difference(Whole a, Whole b) {
  Whole result = 0;
  requireNoOverflow(__builtin_sub_overflow(a, b, &result));
  return result;
}
Whole product(Whole a, Whole b) {
  Whole result = 0;
  requireNoOverflow(__builtin_mul_overflow(a, b, &result));
  return result;
}
double sum(double a, double b) { return a + b; }
double difference(double a, double b) { return a - b; }
double product(double a, double b) { return a * b; }

// The remainder has the sign of the divisor, as in Python.
double remainder(double a, double b) {
  const double rest = std::fmod(a, b);
  return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}
Whole remainder(Whole a, Whole b) {
  const Whole rest = a % b;
  return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
}

/// Runs an expression over blocks; for one thread.
class BlockMachine {
 public:
  BlockMachine(const Expression& expression, const CloudFields& fields) : expression_(expression), fields_(fields) {
    numbers_.resize(expression.registers[std::size_t(Kind::number)] * kBlock);
    wholes_.resize(expression.registers[std::size_t(Kind::whole)] * kBlock);
    truths_.resize(expression.registers[std::size_t(Kind::truth)] * kBlock);
    for (std::size_t k = 0; k < expression.numbers.size(); ++k)
      std::fill_n(numbers_.data() + k * kBlock, kBlock, expression.numbers[k]);
    for (std::size_t k = 0; k < expression.wholes.size(); ++k)
      std::fill_n(wholes_.data() + k * kBlock, kBlock, expression.wholes[k]);
  }

  void run(std::size_t begin, std::size_t count) {
    count_ = count;
    for (const Expression::Read& read : expression_.reads)
      if (read.kind == Kind::whole)
        fields_.read(read.field, begin, {&wholes_[read.to * kBlock], count});
      else
        fields_.read(read.field, begin, {&numbers_[read.to * kBlock], count});
    for (const Expression::Step& step : expression_.steps)
      if (step.kind == Kind::number)
        calculate(step, numbers_);
      else if (step.kind == Kind::whole)
        calculate(step, wholes_);
      else
        combine(step);
  }

  const double* numbers() const { return &numbers_[expression_.result * kBlock]; }
  const Whole* wholes() const { return &wholes_[expression_.result * kBlock]; }
  const std::uint8_t* truths() const { return &truths_[expression_.result * kBlock]; }

 private:
  template <class To, class From, class Of>
  void each(To* to, const From* a, const From* b, Of&& of) {
    for (std::size_t i = 0; i < count_; ++i) to[i] = static_cast<To>(of(a[i], b[i]));
  }

  template <class T>
  void calculate(const Expression::Step& step, BareVector<T>& registers) {
    const T *const a = &registers[step.a * kBlock], *const b = &registers[step.b * kBlock];
    const bool compares = step.operation >= Operation::less && step.operation <= Operation::notEqual;
    T* const to = compares || step.operation == Operation::toNumber ? nullptr : &registers[step.to * kBlock];
    std::uint8_t* const truth = compares ? &truths_[step.to * kBlock] : nullptr;
    switch (step.operation) {
      case Operation::add:
        return each(to, a, b, [](T x, T y) { return sum(x, y); });
      case Operation::subtract:
        return each(to, a, b, [](T x, T y) { return difference(x, y); });
      case Operation::multiply:
        return each(to, a, b, [](T x, T y) { return product(x, y); });
      case Operation::modulo:
        return each(to, a, b, [](T x, T y) { return remainder(x, y); });
      // Both are NaN if one is.
      case Operation::min:
        return each(to, a, b, [](T x, T y) { return (x < y) | (x != x) ? x : y; });
      case Operation::max:
        return each(to, a, b, [](T x, T y) { return (x > y) | (x != x) ? x : y; });
      case Operation::negate:
        return each(to, a, a, [](T x, T) { return -x; });
      case Operation::abs:
        return each(to, a, a, [](T x, T) { return x < 0 ? -x : x; });
      case Operation::less:
        return each(truth, a, b, [](T x, T y) { return x < y; });
      case Operation::lessOrEqual:
        return each(truth, a, b, [](T x, T y) { return x <= y; });
      case Operation::equal:
        return each(truth, a, b, [](T x, T y) { return x == y; });
      case Operation::notEqual:
        return each(truth, a, b, [](T x, T y) { return (x < y) | (x > y); });
      default:
        break;
    }
    if constexpr (std::is_same_v<T, double>) {
      if (step.operation == Operation::divide) return each(to, a, b, [](T x, T y) { return x / y; });
      if (step.operation == Operation::sqrt) return each(to, a, a, [](T x, T) { return std::sqrt(x); });
      if (step.operation == Operation::floor) return each(to, a, a, [](T x, T) { return std::floor(x); });
    } else if (step.operation == Operation::toNumber) {
      return each(&numbers_[step.to * kBlock], a, a, [](T x, T) { return static_cast<double>(x); });
    }
    PALPATE_CHECK(!"an operation of another kind");
  }

  void combine(const Expression::Step& step) {
    const std::uint8_t *const a = &truths_[step.a * kBlock], *const b = &truths_[step.b * kBlock];
    std::uint8_t* const to = &truths_[step.to * kBlock];
    if (step.operation == Operation::both) return each(to, a, b, [](auto x, auto y) { return x & y; });
    if (step.operation == Operation::either) return each(to, a, b, [](auto x, auto y) { return x | y; });
    each(to, a, a, [](auto x, auto) { return x ^ 1; });
  }

  const Expression& expression_;
  const CloudFields& fields_;
  std::size_t count_ = 0;
  BareVector<double> numbers_;
  BareVector<Whole> wholes_;
  BareVector<std::uint8_t> truths_;
};

/// Calls use(machine, begin, count) after each block.
void overBlocks(const Expression& expression, const CloudFields& fields, auto&& use) {
  parallelBlocks(fields.size(), kAtOnce, fields.threads(), [&](std::size_t begin, std::size_t end) {
    BlockMachine machine(expression, fields);
    for (; begin < end; begin += kBlock) {
      const std::size_t count = std::min(kBlock, end - begin);
      machine.run(begin, count);
      use(machine, begin, count);
    }
  });
}

}  // namespace

PointSet pointsWhere(const Expression& condition, const CloudFields& fields) {
  PALPATE_CHECK(condition.kind == Kind::truth);
  PointBits points(fields.size());
  overBlocks(condition, fields, [&](const BlockMachine& machine, std::size_t begin, std::size_t count) {
    points.put(begin, {machine.truths(), count});
  });
  return points.set();
}

std::vector<double> valuesOf(const Expression& number, const CloudFields& fields) {
  PALPATE_CHECK(number.kind == Kind::number);
  std::vector<double> values(fields.size());
  overBlocks(number, fields, [&](const BlockMachine& machine, std::size_t begin, std::size_t count) {
    std::copy_n(machine.numbers(), count, values.data() + begin);
  });
  return values;
}

std::vector<Whole> wholesOf(const Expression& whole, const CloudFields& fields) {
  PALPATE_CHECK(whole.kind == Kind::whole);
  std::vector<Whole> values(fields.size());
  overBlocks(whole, fields, [&](const BlockMachine& machine, std::size_t begin, std::size_t count) {
    std::copy_n(machine.wholes(), count, values.data() + begin);
  });
  return values;
}

PointSet pointsWhere(std::string_view name, std::string_view condition, CloudFields& fields) {
  return pointsWhere(parseExpression(name, condition, 0, true, fields).expression, fields);
}

std::vector<double> valuesOf(std::string_view name, std::string_view number, CloudFields& fields) {
  const Expression parsed = parseExpression(name, number, 0, false, fields).expression;
  if (parsed.kind == Kind::number) return valuesOf(parsed, fields);
  const std::vector<Whole> wholes = wholesOf(parsed, fields);
  return {wholes.begin(), wholes.end()};
}

}  // namespace palpate
