// The room server/recording stores worlds: recordings, their replay and proof, and checkpoints. It knows no session and
// no packet.
//
// This file turns plain data into bytes and back. One function, Describe (fields.h), lists the fields of a type for
// both directions. Numbers are little-endian, as on every processor that wobble runs on; a list is its count and its
// elements, an optional a flag and its value, a variant its index and its value.
#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace wobble::recording {

static_assert(std::endian::native == std::endian::little);

using Bytes = std::vector<std::uint8_t>;

// The last value of an enumeration that is stored; to be specialised for each.
template <class Enum>
inline constexpr auto kLast = std::numeric_limits<Enum>::max();

class Writer {
 public:
  template <class... Fields>
  void operator()(const Fields&... fields) {
    (Put(fields), ...);
  }

  [[nodiscard]] const Bytes& Read() const { return m_bytes; }
  [[nodiscard]] Bytes Take() { return std::exchange(m_bytes, {}); }
  [[nodiscard]] bool IsGood() const { return true; }

 private:
  void PutBytes(const void* from, std::size_t count) {
    const auto* bytes = static_cast<const std::uint8_t*>(from);
    m_bytes.insert(m_bytes.end(), bytes, bytes + count);
  }
  void PutCount(std::size_t count) { Put(static_cast<std::uint32_t>(count)); }

  template <class Value>
  void Put(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::is_enum_v<Value>) {
      PutBytes(&value, sizeof value);
    } else {
      Describe(*this, value);
    }
  }
  void Put(const std::string& text) {
    PutCount(text.size());
    PutBytes(text.data(), text.size());
  }
  template <class Real, int size>
  void Put(const Eigen::Matrix<Real, size, 1>& vector) {
    PutBytes(vector.data(), sizeof(Real) * size);
  }
  template <class Value, std::size_t count>
  void Put(const std::array<Value, count>& values) {
    for (const Value& value : values) Put(value);
  }
  template <class Value>
  void Put(const std::vector<Value>& values) {
    PutCount(values.size());
    if constexpr (std::is_arithmetic_v<Value>) {
      PutBytes(values.data(), values.size() * sizeof(Value));
    } else {
      for (const Value& value : values) Put(value);
    }
  }
  template <class Key, class Value>
  void Put(const std::map<Key, Value>& values) {
    PutCount(values.size());
    for (const auto& [key, value] : values) (*this)(key, value);
  }
  template <class Value>
  void Put(const std::optional<Value>& value) {
    Put(value.has_value());
    if (value) Put(*value);
  }
  template <class... Values>
  void Put(const std::variant<Values...>& value) {
    Put(static_cast<std::uint8_t>(value.index()));
    std::visit([this](const auto& each) { this->Put(each); }, value);
  }

  Bytes m_bytes;
};

// Takes any bytes: what is cut short or impossible makes IsGood false, and all that is read from there on is left as it
// was.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {}

  template <class... Fields>
  void operator()(Fields&... fields) {
    (Get(fields), ...);
  }

  [[nodiscard]] bool IsGood() const { return m_isGood; }
  // Whether all bytes have been read, and well.
  [[nodiscard]] bool IsDone() const { return m_isGood && m_bytes.empty(); }

 private:
  void GetBytes(void* to, std::size_t count) {
    m_isGood = m_isGood && count <= m_bytes.size();
    if (!m_isGood || count == 0) return;
    std::memcpy(to, m_bytes.data(), count);
    m_bytes = m_bytes.subspan(count);
  }
  // Of elements of at least `least` bytes each.
  std::size_t GetCount(std::size_t least) {
    std::uint32_t count = 0;
    Get(count);
    m_isGood = m_isGood && count <= m_bytes.size() / least;
    return m_isGood ? count : 0;
  }

  template <class Value>
  void Get(Value& value) {
    if constexpr (std::is_enum_v<Value>) {
      std::underlying_type_t<Value> number{};
      GetBytes(&number, sizeof number);
      m_isGood = m_isGood && number >= 0 && number <= static_cast<std::underlying_type_t<Value>>(kLast<Value>);
      if (m_isGood) value = static_cast<Value>(number);
    } else if constexpr (std::is_arithmetic_v<Value>) {
      GetBytes(&value, sizeof value);
    } else {
      Describe(*this, value);
    }
  }
  void Get(bool& value) {
    std::uint8_t byte = 0;
    Get(byte);
    m_isGood = m_isGood && byte <= 1;
    if (m_isGood) value = byte == 1;
  }
  void Get(std::string& text) {
    text.resize(GetCount(1));
    GetBytes(text.data(), text.size());
  }
  template <class Real, int size>
  void Get(Eigen::Matrix<Real, size, 1>& vector) {
    GetBytes(vector.data(), sizeof(Real) * size);
  }
  template <class Value, std::size_t count>
  void Get(std::array<Value, count>& values) {
    for (Value& value : values) Get(value);
  }
  template <class Value>
  void Get(std::vector<Value>& values) {
    values.clear();
    if constexpr (std::is_arithmetic_v<Value>) {
      values.resize(GetCount(sizeof(Value)));
      GetBytes(values.data(), values.size() * sizeof(Value));
    } else {
      for (std::size_t left = GetCount(1); left > 0 && m_isGood; --left) Get(values.emplace_back());
    }
  }
  template <class Key, class Value>
  void Get(std::map<Key, Value>& values) {
    values.clear();
    for (std::size_t left = GetCount(1); left > 0 && m_isGood; --left) {
      std::pair<Key, Value> each{};
      (*this)(each.first, each.second);
      values.insert(std::move(each));
    }
  }
  template <class Value>
  void Get(std::optional<Value>& value) {
    bool has = false;
    Get(has);
    value.reset();
    if (has) Get(value.emplace());
  }
  template <class... Values>
  void Get(std::variant<Values...>& value) {
    std::uint8_t index = 0;
    Get(index);
    m_isGood = m_isGood && index < sizeof...(Values);
    if (m_isGood) GetAlternative(value, index, std::index_sequence_for<Values...>());
  }
  template <class Variant, std::size_t... indices>
  void GetAlternative(Variant& value, std::size_t index, std::index_sequence<indices...> /*all*/) {
    ((index == indices ? Get(value.template emplace<indices>()) : void()), ...);
  }

  std::span<const std::uint8_t> m_bytes;
  bool m_isGood = true;
};

}  // namespace wobble::recording
