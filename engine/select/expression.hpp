// Expressions over the fields of a cloud, as in "classification == 2 && z > 3". The grammar is in README.md.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "engine/core/point_set.hpp"
#include "engine/core/setting.hpp"
#include "engine/select/fields.hpp"

namespace palpate {

/// An expression as steps over registers, each of which holds a block of points: a step is a loop over the block.
class Expression {
 public:
  enum class Kind : std::uint8_t { number, whole, truth };
  enum class Operation : std::uint8_t {
    add,
    subtract,
    multiply,
    divide,
    modulo,
    min,
    max,
    negate,
    abs,
    sqrt,
    floor,  // numbers
    less,
    lessOrEqual,
    equal,
    notEqual,  // of numbers: truths
    both,
    either,
    invert,    // truths
    toNumber,  // of a whole number
  };
  /// Sets register `to` from `a` and `b`; all three are of `kind`, unless the operation changes it.
  struct Step {
    Operation operation;
    Kind kind;
    std::uint32_t to, a, b;
  };
  struct Read {
    std::size_t field;
    Kind kind;
    std::uint32_t to;
  };

  Kind kind = Kind::number;  ///< of the result
  std::uint32_t result = 0;  ///< its register
  std::vector<double> numbers;
  std::vector<Whole> wholes;  ///< constants, in the first registers of their kind
  std::vector<Read> reads;
  std::vector<Step> steps;
  std::array<std::uint32_t, 3> registers{};  ///< number of them, by kind
};

/// What is wrong with a text that is not an expression, and what was expected; names its setting or argument.
class ExpressionError : public ConfigError {
 public:
  using ConfigError::ConfigError;
};

/// An expression that begins at `begin` of a text.
struct ParsedExpression {
  Expression expression;
  std::size_t end;  ///< one past its last character: the end of the text, or the word "if" after it
};
/// `truth`: whether it is a condition; otherwise it is a number, whole if all of it is. `name`: of the option or
/// argument, with which errors begin. Throws ExpressionError with the column in `text`. The fields that it names are
/// computed.
ParsedExpression parseExpression(std::string_view name, std::string_view text, std::size_t begin, bool truth,
                                 CloudFields& fields);

/// The points for which a condition holds; a comparison with NaN never does. Throws ExpressionError, Error for a
/// product beyond the range of Whole, and Stopped.
PointSet pointsWhere(std::string_view name, std::string_view condition, CloudFields& fields);
PointSet pointsWhere(const Expression& condition, const CloudFields& fields);
/// The value of each point.
std::vector<double> valuesOf(std::string_view name, std::string_view number, CloudFields& fields);
std::vector<double> valuesOf(const Expression& number, const CloudFields& fields);
/// Those of an expression of whole numbers, exactly.
std::vector<Whole> wholesOf(const Expression& whole, const CloudFields& fields);

}  // namespace palpate
