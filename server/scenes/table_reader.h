// Reads TOML tables field by field. A reader checks type and range of each field, notes which keys were asked for, and
// at the end reports the others: a misspelt key is a mistake, not a default.
#pragma once

#include <toml++/toml.h>
#include <array>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/physics/model/vector.h"

namespace wobble::scenes {

// Mistakes of one file, each with its line.
class ErrorList {
 public:
  // label: the file's name.
  explicit ErrorList(std::string label) : m_label(std::move(label)) {}
  void Add(const toml::source_region& where, const std::string& what);
  // In the order of the file.
  [[nodiscard]] std::vector<std::string> Take();

 private:
  std::string m_label;
  std::vector<std::pair<toml::source_index, std::string>> m_errors;
};

// A node as it would stand in a file.
[[nodiscard]] std::string FormatNode(const toml::node& node);

inline constexpr double kPlacesWithin = 4000;  // m from the origin: well inside what the protocol can show

// Every Read leaves `value` as it is when the field is not there, and when it is refused.
class TableReader {
 public:
  TableReader(const toml::table& table, ErrorList& errors) : m_table(table), m_errors(errors) {}

  [[nodiscard]] const toml::source_region& Where(std::string_view key) const;
  void Refuse(std::string_view key, const std::string& value, const std::string& range);
  // As it stands in the file, when it does; a range that others know is checked against what was meant there.
  void RefuseAsWritten(std::string_view key, const std::string& value, const std::string& range);

  // A number whose range others check; what is no number becomes a NaN, which no range holds.
  void ReadUnchecked(std::string_view key, double& value);
  void Read(std::string_view key, double low, double high, const char* unit, double& value);
  void Read(std::string_view key, int low, int high, int& value);
  void Read(std::string_view key, bool& value);
  void Read(std::string_view key, std::size_t maxLength, std::string& value);
  void Read(std::string_view key, double low, double high, const char* unit, physics::Vector3d& value);
  void Read(std::string_view key, int low, int high, std::array<int, 2>& value);
  void Read(std::string_view key, int low, int high, std::array<int, 3>& value);

  // A grid of numbers, one array a row, all rows equally long. False when there is none or it is not so.
  bool Read(std::string_view key, double low, double high, const char* unit, int most, std::vector<double>& values,
            int& columns);

  // One of a few words. False when there is none or another one.
  template <class Value>
  bool Read(std::string_view key, const std::map<std::string, Value>& words, Value& value) {
    const toml::node* node = Find(key);
    if (node == nullptr) return false;
    const auto text = node->value_exact<std::string>();
    const auto found = text ? words.find(*text) : words.end();
    if (found != words.end()) {
      value = found->second;
      return true;
    }
    std::string range;
    for (const auto& word : words) range += (range.empty() ? "one of: " : ", ") + word.first;
    Refuse(key, FormatNode(*node), range);
    return false;
  }

  // Calls read(TableReader&) for the table, or for every table of the array, under `key`.
  template <class ReadOne>
  void ReadTables(std::string_view key, ReadOne&& read) {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    if (const toml::table* table = node->as_table()) {
      TableReader reader(*table, m_errors);
      read(reader);
      reader.ReportUnknown();
    } else if (const toml::array* array = node->as_array(); array != nullptr && array->is_array_of_tables()) {
      for (const toml::node& element : *array) {
        TableReader reader(*element.as_table(), m_errors);
        read(reader);
        reader.ReportUnknown();
      }
    } else {
      Refuse(key, FormatNode(*node), "a table, [" + std::string(key) + "] or [[" + std::string(key) + "]]");
    }
  }

  [[nodiscard]] bool Has(std::string_view key);
  void Require(std::string_view key);
  // What the table may hold cannot be told, so nothing more is said of it.
  void PassOver();
  void ReportUnknown();

 private:
  const toml::node* Find(std::string_view key);
  void ReadWhole(std::string_view key, const char* count, int low, int high, std::span<int> value);

  const toml::table& m_table;
  ErrorList& m_errors;
  std::set<std::string> m_known;
};

}  // namespace wobble::scenes
