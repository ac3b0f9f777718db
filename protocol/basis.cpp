#include "protocol/basis.h"

#include <algorithm>
#include <cmath>

#include "protocol/basis_completion.h"

namespace wobble::protocol {
namespace {

constexpr double kUnit = 16384;  // 2^14: a column's 1

class Writer {
 public:
  void Add8(std::uint8_t value) { bytes.push_back(value); }
  void Add16(std::uint16_t value) {
    bytes.push_back(static_cast<std::uint8_t>(value));
    bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  }
  template <class Byte>
  void AddAll(const std::vector<Byte>& values) {
    for (const Byte value : values) Add8(static_cast<std::uint8_t>(value));
  }
  std::vector<std::uint8_t> bytes;
};

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
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<Byte>(m_bytes[m_next++]));
  }
  [[nodiscard]] bool IsWhole() const { return !m_overran && m_next == m_bytes.size(); }
  [[nodiscard]] bool Overran() const { return m_overran; }

 private:
  std::span<const std::uint8_t> m_bytes;
  std::size_t m_next = 0;
  bool m_overran = false;
};

std::size_t CountRows(const BasisSource& source) {
  return source.kind == BasisSource::Kind::kFull ? std::size_t{3} * source.vertices : source.vertices;
}

std::size_t CountTurns(std::size_t rest, std::size_t blocks) {
  std::size_t count = 0;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t size = FindBlockBegin(rest, blocks, block + 1) - FindBlockBegin(rest, blocks, block);
    count += size * size;
  }
  return count;
}

bool IsPermutation(std::vector<std::uint16_t> order) {
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (order[i] != i) return false;
  }
  return true;
}

void WriteModes(const BasisSource& source, Writer& writer) {
  writer.Add16(static_cast<std::uint16_t>(source.modes.size() / CountRows(source)));
  writer.Add8(source.blocks);
  for (const std::uint16_t vertex : source.order) writer.Add16(vertex);
  writer.AddAll(source.modes);
  for (std::size_t i = 0; i < source.turns.size(); i += 2) {
    const int high = i + 1 < source.turns.size() ? source.turns[i + 1] : 0;
    writer.Add8(static_cast<std::uint8_t>((source.turns[i] & 15) | (high & 15) << 4));
  }
}

bool ReadModes(Reader& reader, BasisSource& source) {
  const std::size_t rows = CountRows(source);
  const std::size_t modes = reader.Read16();
  source.blocks = reader.Read8();
  if (modes >= rows || (source.kind == BasisSource::Kind::kScalar && source.blocks != 0)) return false;
  for (std::size_t i = 0; i < source.vertices && !reader.Overran(); ++i) source.order.push_back(reader.Read16());
  reader.ReadAll(modes * rows, source.modes);
  const std::size_t turns = CountTurns(rows - modes, source.blocks);
  std::vector<std::uint8_t> pairs;
  reader.ReadAll((turns + 1) / 2, pairs);
  if (reader.Overran() || !IsPermutation(source.order)) return false;
  for (std::size_t i = 0; i < turns; ++i) {
    const int nibble = pairs[i / 2] >> (i % 2 * 4) & 15;
    source.turns.push_back(static_cast<std::int8_t>(nibble < 8 ? nibble : nibble - 16));
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

// Appends the completed modes, each block rotated by its matrix, with rows in the order of the vertices again.
bool AppendRest(const BasisSource& source, const std::vector<double>& completed,
                const std::vector<std::size_t>& rowOrder, std::vector<double>& columns) {
  const std::size_t rows = rowOrder.size(), rest = completed.size() / rows;
  const std::size_t blocks = source.blocks > 0 ? source.blocks : rest;  // without matrices a block a mode
  std::size_t nextTurn = 0;
  std::vector<double> turn;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t begin = FindBlockBegin(rest, blocks, block);
    const std::size_t size = FindBlockBegin(rest, blocks, block + 1) - begin;
    turn.assign(size * size, 1.0);
    if (source.blocks > 0) {
      for (double& entry : turn) entry = source.turns[nextTurn++];
      if (!Orthonormalise(turn, size)) return false;
    }
    for (std::size_t c = 0; c < size; ++c) {
      const std::size_t column = columns.size();
      columns.resize(column + rows);
      for (std::size_t i = 0; i < rows; ++i) {
        double sum = 0;
        for (std::size_t j = 0; j < size; ++j) sum += completed[i * rest + begin + j] * turn[c * size + j];
        columns[column + rowOrder[i]] = sum;
      }
    }
  }
  return true;
}

bool MakeColumns(const BasisSource& source, std::vector<double>& columns) {
  if (source.kind == BasisSource::Kind::kCosine) {
    columns = MakeCosines(source.grid[0], source.grid[1], source.grid[2]);
    return true;
  }
  const std::size_t rows = CountRows(source), axes = rows / source.vertices;
  std::vector<std::size_t> rowOrder;
  for (const std::uint16_t vertex : source.order) {
    for (std::size_t axis = 0; axis < axes; ++axis) rowOrder.push_back(vertex * axes + axis);
  }
  columns.reserve(rows * rows);
  columns.assign(source.modes.begin(), source.modes.end());
  if (!Orthonormalise(columns, rows)) return false;
  return AppendRest(source, CompleteBasis(columns, rows, rowOrder), rowOrder, columns);
}

}  // namespace

std::vector<std::uint8_t> WriteBasis(const BasisSource& source) {
  Writer writer;
  writer.Add8(static_cast<std::uint8_t>(source.kind));
  writer.Add16(source.vertices);
  if (source.kind == BasisSource::Kind::kCosine) {
    for (const std::uint16_t count : source.grid) writer.Add16(count);
  } else {
    WriteModes(source, writer);
  }
  writer.AddAll(source.levels);
  writer.AddAll(source.gains);
  return std::move(writer.bytes);
}

std::shared_ptr<const Basis> ReadBasis(std::span<const std::uint8_t> bytes, std::size_t vertices) {
  BasisSource source;
  std::vector<double> columns;
  if (bytes.size() > kMaxBasisBytes || !ReadSource(bytes, source) || source.vertices != vertices) return nullptr;
  if (!MakeColumns(source, columns)) return nullptr;
  auto basis = std::make_shared<Basis>();
  basis->vertices = vertices;
  basis->isScalar = source.kind != BasisSource::Kind::kFull;
  basis->columns.reserve(columns.size());
  for (const double entry : columns) {
    basis->columns.push_back(static_cast<std::int16_t>(std::nearbyint(std::clamp(entry, -1.0, 1.0) * kUnit)));
  }
  for (const std::uint8_t level : source.levels) basis->levels.push_back(static_cast<std::int16_t>(level - kLevelZero));
  basis->gains = std::move(source.gains);
  return basis;
}

}  // namespace wobble::protocol
