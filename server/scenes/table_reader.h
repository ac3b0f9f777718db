// Reads TOML tables field by field. A reader checks type and range of each field, notes which keys were asked for, and
// at the end reports all other keys: a misspelt key is a mistake and does not silently leave a default.
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

// The mistakes of one file, each with its line.
class ErrorList {
 public:
  // label: the file's name.
  explicit ErrorList(std::string label) : m_label(std::move(label)) {}
  void Add(const toml::source_region& where, const std::string& what);
  // Returns all mistakes in the order of the file, and empties the list.
  [[nodiscard]] std::vector<std::string> Take();

 private:
  std::string m_label;
  std::vector<std::pair<toml::source_index, std::string>> m_errors;
};

// The text, or its beginning and "..." when it has more than `most` bytes.
[[nodiscard]] std::string Abbreviate(const std::string& text, std::size_t most = 40);

// Writes a node as it would stand in a file.
[[nodiscard]] std::string FormatNode(const toml::node& node);

inline constexpr double kPlacesWithin = 4000;  // bound of all coordinates, m: well inside what the protocol can show

// Each Read leaves `value` unchanged when the field is missing, and when it is refused and reported. low, high:
// inclusive. unit: appended to the range in the message, such as " m".
class TableReader {
 public:
  TableReader(const toml::table& table, ErrorList& errors) : m_table(table), m_errors(errors) {}

  // Where the field stands, or the table when there is no such field.
  [[nodiscard]] const toml::source_region& Where(std::string_view key) const;
  // Reports a field with its value and the range that it must have.
  void Refuse(std::string_view key, const std::string& value, const std::string& range);
  // As Refuse, but shows the value as it stands in the file if it is there; `value` is then what was read, and empty or
  // "nan" when it was to be a number.
  void RefuseAsWritten(std::string_view key, const std::string& value, const std::string& range);

  // Reads a number whose range the caller checks; anything but a number becomes NaN, which no range contains.
  void ReadUnchecked(std::string_view key, double& value);
  void Read(std::string_view key, double low, double high, const char* unit, double& value);
  void Read(std::string_view key, int low, int high, int& value);
  void Read(std::string_view key, bool& value);
  void Read(std::string_view key, std::size_t maxLength, std::string& value);
  void Read(std::string_view key, double low, double high, const char* unit, physics::Vector3d& value);
  void Read(std::string_view key, int low, int high, std::array<int, 2>& value);
  void Read(std::string_view key, int low, int high, std::array<int, 3>& value);

  // Reads a grid of numbers: an array of 2 to `most` rows with equally many numbers, 2 to `most`. Returns false when
  // the field is missing or refused.
  bool Read(std::string_view key, double low, double high, const char* unit, int most, std::vector<double>& values,
            int& columns);

  // Reads one of a few words. Returns false when the field is missing or refused.
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

  // Whether the field is there; marks its key as known.
  [[nodiscard]] bool Has(std::string_view key);
  // Reports the field when it is missing.
  void Require(std::string_view key);
  // Marks all keys as known: for a table whose possible fields are unknown because its kind is.
  void PassOver();
  // Reports all keys that were never asked for.
  void ReportUnknown();

 private:
  const toml::node* Find(std::string_view key);
  void ReadWhole(std::string_view key, const char* count, int low, int high, std::span<int> value);

  const toml::table& m_table;
  ErrorList& m_errors;
  std::set<std::string> m_known;
};

}  // namespace wobble::scenes
