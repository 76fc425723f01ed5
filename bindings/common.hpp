// SPDX-License-Identifier: Apache-2.0
/// @file common.hpp
/// What every binding needs: arrays without copies, ratios from Python numbers, clear errors.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>

#include "strainwave/status.hpp"
#include "strainwave/units.hpp"

namespace strainwave::bindings {

namespace nb = nanobind;

/// Compiled capacities of the configurations that Python holds.
inline constexpr std::size_t most_orders = 32;
inline constexpr std::size_t most_gauges = 32;
inline constexpr std::size_t most_harmonics = 16;

template <class Number>
using Vector = nb::ndarray<const Number, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class Number>
using Matrix = nb::ndarray<const Number, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <class Number>
using VectorOut = nb::ndarray<nb::numpy, Number, nb::ndim<1>>;
template <class Number>
using MatrixOut = nb::ndarray<nb::numpy, Number, nb::ndim<2>>;

template <class Number>
using VectorInOut = nb::ndarray<nb::numpy, Number, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Raises strainwave.errors.InputError.
[[noreturn]] inline void raise_input_error(const std::string& message) {
  const nb::object type = nb::module_::import_("strainwave.errors").attr("InputError");
  PyErr_SetString(type.ptr(), message.c_str());
  throw nb::python_error();
}

inline void require_same_length(const char* name, std::size_t length, const char* other,
                                std::size_t expected) {
  if (length != expected) {
    raise_input_error(std::string(name) + " has " + std::to_string(length) +
                      " elements: expected " + std::to_string(expected) + " as in " + other +
                      "; give arrays of one length");
  }
}

/// A new array that then belongs to Python, or the caller's own; filled here in every element.
template <class Number>
class FilledVector {
 public:
  explicit FilledVector(std::size_t size)
      : owned_(std::make_unique_for_overwrite<Number[]>(size)), data_(owned_.get()), size_(size) {}
  explicit FilledVector(const VectorInOut<Number>& given)
      : given_(given), data_(given_.data()), size_(given_.shape(0)) {}
  [[nodiscard]] Number* data() { return data_; }
  [[nodiscard]] VectorOut<Number> give() {
    if (owned_ == nullptr) {
      return VectorOut<Number>(given_);
    }
    Number* const data = owned_.release();
    const nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<Number*>(p); });
    return VectorOut<Number>(data, {size_}, owner);
  }

 private:
  std::unique_ptr<Number[]> owned_;
  VectorInOut<Number> given_;
  Number* data_;
  std::size_t size_;
};

/// Arrays of the caller's in which results are wanted; without them new ones are made.
template <class... Numbers>
using Given = std::optional<std::tuple<VectorInOut<Numbers>...>>;

/// Result number Index of a call: in the caller's array where there is one.
template <std::size_t Index, class... Numbers>
auto result_array(const Given<Numbers...>& given, std::size_t size) {
  using Number = std::tuple_element_t<Index, std::tuple<Numbers...>>;
  if (!given) {
    return FilledVector<Number>(size);
  }
  require_same_length("an array of out", std::get<Index>(*given).shape(0), "the samples", size);
  return FilledVector<Number>(std::get<Index>(*given));
}

/// One call at a time: a long call lends the interpreter to other threads, and the object's state
/// belongs to it until it ends.  Short calls keep the interpreter, so that none can begin meanwhile
/// and waiting for the long ones costs them one comparison.
class CallLock {
 public:
  CallLock() = default;
  ~CallLock() = default;
  CallLock(const CallLock& /*other*/) {}  // a copy is another object with calls of its own
  CallLock& operator=(const CallLock&) = delete;
  CallLock(CallLock&&) = delete;
  CallLock& operator=(CallLock&&) = delete;

  /// Waits for the end of a long call; the caller has the interpreter.
  void wait() const {
    while (running_) {
      const nb::gil_scoped_release release;
      const std::scoped_lock until_end(mutex_);
    }
  }

  /// A long call, from which on the caller has the object and not the interpreter.
  class Long {
   public:
    explicit Long(const CallLock& lock) : held_(lock) {}

   private:
    struct Held {
      explicit Held(const CallLock& of) : lock(of) {
        lock.wait();
        lock.running_ = true;
        lock.mutex_.lock();
      }
      ~Held() {
        lock.running_ = false;
        lock.mutex_.unlock();
      }
      Held(const Held&) = delete;
      Held& operator=(const Held&) = delete;
      Held(Held&&) = delete;
      Held& operator=(Held&&) = delete;
      const CallLock& lock;
    };
    Held held_;  // given back after the interpreter is there again
    nb::gil_scoped_release release_;
  };

 private:
  mutable bool running_ = false;  ///< changed by who has the interpreter
  mutable std::mutex mutex_;      ///< held by a long call, for others to wait on
};

/// Raises strainwave.errors.ConfigurationError where a check found something.
template <class Real>
void require(const Violation<Real>& violation) {
  if (violation.ok()) {
    return;
  }
  std::string parameter = violation.parameter;
  if (violation.index >= 0) {
    parameter += "[" + std::to_string(violation.index) + "]";
  }
  const nb::object type = nb::module_::import_("strainwave.errors").attr("ConfigurationError");
  const nb::object error =
      type(parameter, static_cast<double>(violation.value), violation.unit, violation.expected);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw nb::python_error();
}

/// Refuses arrays of the precision that the object was not built for.
template <class Real>
void require_precision(bool single_precision) {
  if (single_precision != std::is_same_v<Real, float>) {
    raise_input_error(single_precision
                          ? "float64 arrays were given: expected float32, the precision this was "
                            "built with; call process_float32"
                          : "float32 arrays were given: expected float64, the precision this was "
                            "built with; call process_float64");
  }
}

/// The ratio, or an InputError where it does not fit.
inline Rational require_representable(Rational ratio, const char* what) {
  if (!is_valid(ratio)) {
    raise_input_error(std::string(what) +
                      " has no ratio of whole numbers from 1 to 2^31 - 1: expected smaller "
                      "numbers; round them");
  }
  return ratio;
}

/// A ratio from Rational, int, fractions.Fraction or float; {0, 0} where there is none.
inline Rational to_rational(const nb::handle& value) {
  Rational ratio;
  if (nb::try_cast(value, ratio)) {
    return ratio;
  }
  std::uint64_t numerator = 0;
  std::uint64_t denominator = 0;
  if (nb::hasattr(value, "numerator") && nb::hasattr(value, "denominator")) {
    const bool whole = nb::try_cast(nb::object(value.attr("numerator")), numerator) &&
                       nb::try_cast(nb::object(value.attr("denominator")), denominator);
    return whole ? reduced(numerator, denominator) : Rational{0, 0};
  }
  double real = 0.0;
  return nb::try_cast(value, real) ? rational_from(real) : Rational{0, 0};
}

/// A ratio that is valid, or a ConfigurationError naming the parameter.
inline Rational to_valid_rational(const nb::handle& value, const char* parameter,
                                  const char* unit) {
  const Rational ratio = to_rational(value);
  if (!is_valid(ratio)) {
    const nb::object type = nb::module_::import_("strainwave.errors").attr("ConfigurationError");
    const nb::object error =
        type(parameter, nb::borrow(value), "",
             std::string("a positive ratio of whole numbers below 2^31, such as 100, 120.5 or "
                         "Fraction(1, 100)") +
                 (unit[0] == '\0' ? "" : std::string(", in ") + unit));
    PyErr_SetObject(type.ptr(), error.ptr());
    throw nb::python_error();
  }
  return ratio;
}

/// A member of an enumeration, or its name.
template <class Enum>
Enum to_enum(const nb::handle& value, const char* parameter) {
  Enum member{};
  if (nb::try_cast(value, member)) {
    return member;
  }
  std::string names;
  for (const nb::handle each : nb::borrow(nb::type<Enum>())) {
    const nb::object name = each.attr("name");
    if (nb::isinstance<nb::str>(value) && name.equal(value)) {
      return nb::cast<Enum>(each);
    }
    names += (names.empty() ? "" : " or ") + nb::cast<std::string>(name);
  }
  const nb::object type = nb::module_::import_("strainwave.errors").attr("ConfigurationError");
  const nb::object error = type(parameter, nb::borrow(value), "", names);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw nb::python_error();
}

/// Raises about a value that is not even of the right type: in one line, whatever was given.
[[noreturn]] inline void raise_wrong_type(const char* parameter, const nb::handle& value,
                                          const char* expected) {
  const nb::object words = nb::steal(PyObject_Repr(value.ptr()));
  PyErr_Clear();  // Python refuses to write out whole numbers of thousands of digits
  const bool plain = value.is_none() || nb::isinstance<nb::str>(value) ||
                     (PyNumber_Check(value.ptr()) != 0 && !nb::hasattr(value, "__len__"));
  if (!plain || !words.is_valid() || nb::len(words) > 40) {
    raise_input_error(std::string(parameter) + " is of type " +
                      nb::cast<std::string>(value.type().attr("__name__")) + ": expected " +
                      expected + "; give one");
  }
  const nb::object type = nb::module_::import_("strainwave.errors").attr("ConfigurationError");
  const nb::object error = type(parameter, nb::borrow(value), "", expected);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw nb::python_error();
}

/// A real number of Python's or numpy's, or an InputError naming the parameter.
inline double to_real_number(const nb::handle& value, const char* parameter) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    raise_wrong_type(parameter, value, "a number");
  }
  return number;
}

/// A whole number that the type holds, or an InputError naming the parameter.
template <class Whole>
Whole to_whole_number(const nb::handle& value, const char* parameter, const char* expected) {
  Whole number{};
  if (PyIndex_Check(value.ptr()) != 0) {
    const nb::object whole = nb::steal(PyNumber_Index(value.ptr()));
    PyErr_Clear();
    if (whole.is_valid() && nb::try_cast(whole, number)) {
      return number;
    }
  }
  raise_wrong_type(parameter, value, expected);
}

/// An array-like in the form the core takes, by strainwave.arrays.contiguous: the caller's own
/// memory where it has that form, a copy where it does not, an InputError where there is none.
template <class Number, std::size_t Dimensions>
auto to_array(const nb::handle& values, const char* name) {
  static_assert(std::is_same_v<Number, double> || std::is_same_v<Number, std::int32_t>);
  using Array = nb::ndarray<const Number, nb::ndim<Dimensions>, nb::c_contig, nb::device::cpu>;
  const char* const precision = std::is_same_v<Number, double> ? "float64" : "int32";
  return nb::cast<Array>(nb::module_::import_("strainwave.arrays")
                             .attr("contiguous")(name, nb::borrow(values),
                                                 nb::module_::import_("numpy").attr(precision),
                                                 nb::arg("dimensions") = Dimensions));
}

template <class Number>
Vector<Number> to_vector(const nb::handle& values, const char* name) {
  return to_array<Number, 1>(values, name);
}

template <class Number>
Matrix<Number> to_matrix(const nb::handle& values, const char* name) {
  return to_array<Number, 2>(values, name);
}

/// Name and properties of a configuration, as a call that would make it.
inline std::string repr_of(const nb::handle& self, std::initializer_list<const char*> names) {
  std::string text = nb::cast<std::string>(self.type().attr("__name__")) + "(";
  const char* separator = "";
  for (const char* const name : names) {
    text += separator + std::string(name) + "=" + nb::cast<std::string>(nb::repr(self.attr(name)));
    separator = ", ";
  }
  return text + ")";
}

void bind_units(nb::module_& m);
void bind_status(nb::module_& m);
void bind_gear(nb::module_& m);
void bind_fluctuation(nb::module_& m);
void bind_bridge(nb::module_& m);
void bind_gains(nb::module_& m);
void bind_gauge_monitor(nb::module_& m);
void bind_calibration(nb::module_& m);
void bind_oscillator_filter(nb::module_& m);
void bind_batch(nb::module_& m);
void bind_batch_ripple(nb::module_& m);
void bind_ripple_config(nb::module_& m);
void bind_ripple_filter(nb::module_& m);
void bind_ripple_smoother(nb::module_& m);
void bind_torque_sensor(nb::module_& m);
void bind_tracking_notch(nb::module_& m);
void bind_empty_step(nb::module_& m);

}  // namespace strainwave::bindings
