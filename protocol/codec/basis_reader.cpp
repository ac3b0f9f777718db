#include "protocol/codec/basis_reader.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace wobble::protocol {
namespace {

constexpr double kUnit = 16384;  // 2^14: a column's 1
constexpr std::size_t kRowsAtOnce = 32;

// Reads zeros past the end and then says Overran().
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {}
  std::uint8_t Read8() {
    if (m_next < m_bytes.size()) return m_bytes[m_next++];
    m_overran = true;
    return 0;
  }
  std::uint16_t Read16() {
    const std::uint16_t low = Read8();
    return static_cast<std::uint16_t>(low | Read8() << 8);
  }
  template <class Byte>
  void ReadAll(std::size_t count, std::vector<Byte>& values) {
    if (count > m_bytes.size() - m_next) {
      m_overran = true;
      return;
    }
    const auto* const begin = reinterpret_cast<const Byte*>(m_bytes.data()) + m_next;
    values.assign(begin, begin + count);
    m_next += count;
  }
  [[nodiscard]] bool IsWhole() const { return !m_overran && m_next == m_bytes.size(); }
  [[nodiscard]] bool Overran() const { return m_overran; }

 private:
  std::span<const std::uint8_t> m_bytes;
  std::size_t m_next = 0;
  bool m_overran = false;
};

std::size_t CountTurns(std::size_t rest, std::size_t blocks) {
  std::size_t count = 0;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t size = FindBlockBegin(rest, blocks, block + 1) - FindBlockBegin(rest, blocks, block);
    count += size * size;
  }
  return count;
}

bool IsPermutation(std::span<const std::uint16_t> order) {
  std::vector<std::uint8_t> seen(order.size());
  for (const std::uint16_t number : order) {
    if (number >= seen.size() || seen[number] != 0) return false;
    seen[number] = 1;
  }
  return true;
}

bool ReadModes(Reader& reader, BasisSource& source) {
  const std::size_t rows = source.CountRows();
  const std::size_t modes = reader.Read16();
  source.blocks = reader.Read8();
  if (modes >= rows || (source.kind == BasisSource::Kind::kScalar && source.blocks != 0)) return false;
  for (std::size_t i = 0; i < source.vertices && !reader.Overran(); ++i) source.order.push_back(reader.Read16());
  reader.ReadAll(modes * rows, source.modes);
  const std::size_t turns = CountTurns(rows - modes, source.blocks);
  std::vector<std::uint8_t> pairs;
  reader.ReadAll((turns + 1) / 2, pairs);
  if (reader.Overran() || !IsPermutation(source.order)) return false;
  source.turns.resize(turns);
  for (std::size_t i = 0; i < turns; ++i) {
    const int nibble = pairs[i / 2] >> (i % 2 * 4) & 15;
    source.turns[i] = static_cast<std::int8_t>(nibble < 8 ? nibble : nibble - 16);
  }
  return true;
}

bool ReadSource(std::span<const std::uint8_t> bytes, BasisSource& source) {
  Reader reader(bytes);
  const std::uint8_t kind = reader.Read8();
  if (kind > static_cast<std::uint8_t>(BasisSource::Kind::kCosine)) return false;
  source.kind = static_cast<BasisSource::Kind>(kind);
  source.vertices = reader.Read16();
  const std::size_t most = source.kind == BasisSource::Kind::kFull ? kMaxTrainedVertices : kMaxPatchVertices;
  if (source.vertices == 0 || source.vertices > most) return false;
  if (source.kind == BasisSource::Kind::kCosine) {
    std::size_t product = 1;
    for (std::uint16_t& count : source.grid) {
      count = reader.Read16();
      product *= count;
    }
    if (product != source.vertices) return false;
  } else if (!ReadModes(reader, source)) {
    return false;
  }
  reader.ReadAll(std::size_t{3} * source.vertices, source.levels);
  reader.ReadAll(std::size_t{3} * source.vertices, source.gains);
  return reader.IsWhole();
}

std::vector<std::size_t> FindRowOrder(const BasisSource& source) {
  const std::size_t axes = source.CountRows() / source.vertices;
  std::vector<std::size_t> rowOrder;
  rowOrder.reserve(source.CountRows());
  for (const std::uint16_t vertex : source.order) {
    for (std::size_t axis = 0; axis < axes; ++axis) rowOrder.push_back(vertex * axes + axis);
  }
  return rowOrder;
}

}  // namespace

BasisReader::BasisReader(std::span<const std::uint8_t> bytes, std::size_t vertices) {
  const bool isSource = bytes.size() <= kMaxBasisBytes && ReadSource(bytes, m_source) && m_source.vertices == vertices;
  if (!isSource) return;
  static std::atomic<std::uint64_t> newestSerial = 0;
  m_basis = std::make_shared<Basis>();
  m_basis->serial = ++newestSerial;
  m_basis->vertices = vertices;
  m_basis->isScalar = m_source.kind != BasisSource::Kind::kFull;
  for (const std::uint8_t level : m_source.levels)
    m_basis->levels.push_back(static_cast<std::int16_t>(level - kLevelZero));
  m_basis->gains = m_source.gains;
  m_rows = m_source.CountRows();
  m_basis->columns.resize(m_rows * m_rows);
  m_basis->pairs.resize(2 * ((m_rows + 1) / 2) * m_rows);
  m_columns.assign(m_source.modes.begin(), m_source.modes.end());
  m_modes = m_columns.size() / m_rows;
  m_stage = m_source.kind == BasisSource::Kind::kCosine ? Stage::kCosines : Stage::kGiven;
}

std::size_t BasisReader::Step() {
  switch (m_stage) {
    case Stage::kCosines:
      PutColumns(MakeCosines(m_source.grid[0], m_source.grid[1], m_source.grid[2]));
      m_stage = Stage::kDone;
      return m_rows * m_rows;
    case Stage::kGiven:
      return OrthonormaliseGiven();
    case Stage::kReflections:
      if (!m_completion->MakeReflection()) BeginBlock();
      return 2 * m_rows * m_modes + 1;
    case Stage::kTurn:
      return OrthonormaliseTurn();
    case Stage::kPanels:
      return MakePanel();
    case Stage::kTurning:
      return TurnPanel();
    case Stage::kDone:
    case Stage::kRefused:
      return 0;
  }
  return 0;
}

std::shared_ptr<const Basis> BasisReader::Take() {
  while (Step() > 0) continue;
  return m_stage == Stage::kDone ? std::move(m_basis) : nullptr;
}

void BasisReader::PutColumns(std::span<const double> columns) {
  for (std::size_t mode = 0; mode < columns.size() / m_rows; ++mode) {
    for (std::size_t row = 0; row < m_rows; ++row) Put(mode, row, columns[mode * m_rows + row]);
  }
}

void BasisReader::Put(std::size_t mode, std::size_t row, double entry) {
  const auto quantised = static_cast<std::int16_t>(std::nearbyint(std::clamp(entry, -1.0, 1.0) * kUnit));
  m_basis->columns[mode * m_rows + row] = quantised;
  m_basis->pairs[2 * (mode / 2 * m_rows + row) + mode % 2] = quantised;
}

std::size_t BasisReader::OrthonormaliseGiven() {
  if (m_next < m_columns.size()) {
    if (!OrthonormaliseNext(m_columns, m_rows, m_next)) m_stage = Stage::kRefused;
    m_next += m_rows;
    return 2 * m_next;
  }
  PutColumns(m_columns);
  m_rowOrder = FindRowOrder(m_source);
  m_completion.emplace(m_columns, m_rows, m_rowOrder);
  m_stage = Stage::kReflections;
  return 2 * m_columns.size() + 1;
}

// Without matrices a block is a panel, whose modes stay as they are.
void BasisReader::BeginBlock() {
  const std::size_t rest = m_rows - m_modes;
  m_begin += m_size;
  if (m_begin == rest) {
    m_stage = Stage::kDone;
    return;
  }
  m_size = m_source.blocks == 0 ? std::min(kPanel, rest - m_begin)
                                : FindBlockBegin(rest, m_source.blocks, m_block + 1) - m_begin;
  ++m_block;
  m_next = 0;
  m_stride = (m_size + kPanel - 1) / kPanel * kPanel;
  m_panels.resize(m_rows * m_stride);
  if (m_source.blocks == 0) {
    m_stage = Stage::kPanels;
    return;
  }
  const auto turns = m_source.turns.begin() + static_cast<std::ptrdiff_t>(m_nextTurn);
  m_nextTurn += m_size * m_size;
  m_turn.assign(turns, turns + static_cast<std::ptrdiff_t>(m_size * m_size));
  m_stage = Stage::kTurn;
}

std::size_t BasisReader::OrthonormaliseTurn() {
  if (m_next < m_turn.size()) {
    if (!OrthonormaliseNext(m_turn, m_size, m_next)) m_stage = Stage::kRefused;
    m_next += m_size;
    return 2 * m_next;
  }
  m_next = 0;
  m_stage = Stage::kPanels;
  return 1;
}

std::size_t BasisReader::MakePanel() {
  if (m_next < m_size) {
    double* const panel = m_panels.data() + m_next;
    if (m_part == 0) m_completion->BeginPanel(m_begin + m_next, m_stride, panel);
    if (m_part < m_modes) m_completion->ReflectPanel(m_modes - 1 - m_part++, m_stride, panel);
    if (m_part == m_modes) {
      m_part = 0;
      m_next += kPanel;
    }
    return 2 * m_rows * kPanel;
  }
  m_next = 0;
  if (m_source.blocks > 0) {
    m_stage = Stage::kTurning;
    return 1;
  }
  for (std::size_t j = 0; j < m_size; ++j) {
    for (std::size_t i = 0; i < m_rows; ++i) Put(m_modes + m_begin + j, m_rowOrder[i], m_panels[i * m_stride + j]);
  }
  BeginBlock();
  return m_rows * m_size;
}

// Sums run over the modes of the block in ascending order; several of them side by side.
std::size_t BasisReader::TurnPanel() {
  if (m_next >= m_size) {
    BeginBlock();
    return 1;
  }
  const std::size_t columns = std::min(kPanel, m_size - m_next);
  if (m_part == 0) {
    m_entries.assign(m_size * kPanel, 0.0);
    for (std::size_t c = 0; c < columns; ++c) {
      for (std::size_t j = 0; j < m_size; ++j) m_entries[j * kPanel + c] = m_turn[(m_next + c) * m_size + j];
    }
  }
  const std::size_t end = std::min(m_part + kRowsAtOnce, m_rows), rows = end - m_part;
  for (; m_part < end; ++m_part) {
    const auto entries = MultiplyPanel(std::span(m_panels).subspan(m_part * m_stride, m_size), m_entries);
    for (std::size_t c = 0; c < columns; ++c) Put(m_modes + m_begin + m_next + c, m_rowOrder[m_part], entries[c]);
  }
  if (m_part == m_rows) {
    m_part = 0;
    m_next += kPanel;
  }
  return rows * m_size * kPanel;
}

std::shared_ptr<const Basis> ReadBasis(std::span<const std::uint8_t> bytes, std::size_t vertices) {
  return BasisReader(bytes, vertices).Take();
}

}  // namespace wobble::protocol
