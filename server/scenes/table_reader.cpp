// Errors show values as they stand in the file, not as they were converted, so that a person finds them by searching.
#include "server/scenes/table_reader.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <sstream>

namespace wobble::scenes {
namespace {

std::string FormatNumber(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

// Bytes of an error's line; the longest honest ones list the known fields of a table.
constexpr std::size_t kMaxLineBytes = 1000;
// Of a value in it.
constexpr std::size_t kMaxValueBytes = 300;

// Replaces control characters, C1 too: keys and values are shown as they are read, and may hold any character.
std::string MakePlain(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool isC1 = byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (isC1) text.erase(i + 1, 1);
    if (isC1 || byte < 0x20 || byte == 0x7F) text[i] = '?';
  }
  return text;
}

}  // namespace

std::string Abbreviate(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0) == 0x80) --most;  // not inside a character
  return text.substr(0, most) + "...";
}

void ErrorList::Add(const toml::source_region& where, const std::string& what) {
  const std::string line = m_label + ":" + std::to_string(where.begin.line) + ": " + what;
  m_errors.emplace_back(where.begin.line, MakePlain(Abbreviate(line, kMaxLineBytes)));
}

std::vector<std::string> ErrorList::Take() {
  std::stable_sort(m_errors.begin(), m_errors.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> lines;
  for (auto& error : m_errors) lines.push_back(std::move(error.second));
  return lines;
}

std::string FormatNode(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_table<decltype(value)>) {
      text << "{...}";
    } else if constexpr (toml::is_floating_point<decltype(value)>) {
      char digits[32];  // the fewest that mean this number: 0.4, where a stream has 0.40000000000000002
      text << std::string_view(digits, std::to_chars(digits, digits + sizeof digits, *value).ptr);
    } else {
      text << value;
    }
  });
  return text.str();
}

const toml::source_region& TableReader::Where(std::string_view key) const {
  const toml::node* node = m_table.get(key);
  return node != nullptr ? node->source() : m_table.source();
}

void TableReader::Refuse(std::string_view key, const std::string& value, const std::string& range) {
  m_errors.Add(Where(key), std::string(key) + " = " + Abbreviate(value, kMaxValueBytes) + ": must be " + range);
}

void TableReader::RefuseAsWritten(std::string_view key, const std::string& value, const std::string& range) {
  const toml::node* node = m_table.get(key);
  if (node == nullptr) return Refuse(key, value, range);
  const bool meantNumber = value.empty() || value == "nan";  // ReadUnchecked reads anything but a number as NaN
  Refuse(key, FormatNode(*node), meantNumber && !node->is_number() ? "a number, " + range : range);
}

void TableReader::ReadUnchecked(std::string_view key, double& value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  value = node->value<double>().value_or(std::numeric_limits<double>::quiet_NaN());
}

void TableReader::Read(std::string_view key, double low, double high, const char* unit, double& value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  const std::string range = FormatNumber(low) + " to " + FormatNumber(high) + unit;
  const auto number = node->value<double>();
  if (!number || !(*number >= low && *number <= high)) return RefuseAsWritten(key, "", range);
  value = *number;
}

void TableReader::Read(std::string_view key, int low, int high, int& value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  const auto number = node->value_exact<std::int64_t>();
  if (!number || *number < low || *number > high) {
    return Refuse(key, FormatNode(*node), "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  value = static_cast<int>(*number);
}

void TableReader::Read(std::string_view key, bool& value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  const auto answer = node->value_exact<bool>();
  if (!answer) return Refuse(key, FormatNode(*node), "true or false");
  value = *answer;
}

void TableReader::Read(std::string_view key, std::size_t maxLength, std::string& value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  const auto text = node->value_exact<std::string>();
  if (!text || text->empty() || text->size() > maxLength) {
    return Refuse(key, FormatNode(*node), "a text of 1 to " + std::to_string(maxLength) + " bytes");
  }
  value = *text;
}

void TableReader::Read(std::string_view key, double low, double high, const char* unit, physics::Vector3d& value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  const std::string range = "three numbers from " + FormatNumber(low) + " to " + FormatNumber(high) + unit;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 3) return Refuse(key, FormatNode(*node), range);
  physics::Vector3d read;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = (*array)[i].value<double>();
    if (!number || !(*number >= low && *number <= high)) return Refuse(key, FormatNode(*node), range);
    read[static_cast<Eigen::Index>(i)] = *number;
  }
  value = read;
}

void TableReader::Read(std::string_view key, int low, int high, std::array<int, 2>& value) {
  ReadWhole(key, "two", low, high, value);
}

void TableReader::Read(std::string_view key, int low, int high, std::array<int, 3>& value) {
  ReadWhole(key, "three", low, high, value);
}

// count: the number of elements, in words for the message.
void TableReader::ReadWhole(std::string_view key, const char* count, int low, int high, std::span<int> value) {
  const toml::node* node = Find(key);
  if (node == nullptr) return;
  std::vector<int> read;
  const toml::array* array = node->as_array();
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    const auto number = (*array)[i].value<std::int64_t>();
    if (!number || *number < low || *number > high) break;
    read.push_back(static_cast<int>(*number));
  }
  if (array == nullptr || array->size() != value.size() || read.size() != value.size()) {
    return Refuse(key, FormatNode(*node),
                  std::string(count) + " whole numbers from " + std::to_string(low) + " to " + std::to_string(high));
  }
  std::ranges::copy(read, value.begin());
}

bool TableReader::Read(std::string_view key, double low, double high, const char* unit, int most,
                       std::vector<double>& values, int& columns) {
  const toml::node* node = Find(key);
  if (node == nullptr) return false;
  const std::string range = "2 to " + std::to_string(most) + " rows of as many numbers each, 2 to " +
                            std::to_string(most) + ", from " + FormatNumber(low) + " to " + FormatNumber(high) + unit;
  const toml::array* rows = node->as_array();
  const auto fits = [most](const toml::array* array) {
    return array != nullptr && array->size() >= 2 && array->size() <= static_cast<std::size_t>(most);
  };
  if (!fits(rows)) return Refuse(key, Abbreviate(FormatNode(*node)), range), false;
  std::vector<double> read;
  for (const toml::node& row : *rows) {
    const toml::array* numbers = row.as_array();
    if (!fits(numbers) || numbers->size() != rows->front().as_array()->size()) {
      return Refuse(key, Abbreviate(FormatNode(row)), range), false;
    }
    for (const toml::node& one : *numbers) {
      const auto number = one.value<double>();
      if (!number || !(*number >= low && *number <= high)) return Refuse(key, FormatNode(one), range), false;
      read.push_back(*number);
    }
  }
  columns = static_cast<int>(rows->front().as_array()->size());
  values = std::move(read);
  return true;
}

bool TableReader::Has(std::string_view key) {
  m_known.emplace(key);
  return m_table.contains(key);
}

void TableReader::Require(std::string_view key) {
  if (!Has(key)) m_errors.Add(m_table.source(), std::string(key) + " is missing");
}

void TableReader::PassOver() {
  for (const auto& [key, node] : m_table) m_known.emplace(key.str());
}

void TableReader::ReportUnknown() {
  for (const auto& [key, node] : m_table) {
    if (m_known.contains(std::string(key.str()))) continue;
    std::string known;
    for (const std::string& name : m_known) known += (known.empty() ? "" : ", ") + name;
    m_errors.Add(key.source(), Abbreviate(std::string(key.str())) + " is no field here; known: " + known);
  }
}

const toml::node* TableReader::Find(std::string_view key) {
  m_known.emplace(key);
  return m_table.get(key);
}

}  // namespace wobble::scenes
