// Memory grows with the heights that arrive, not with the size that the welcome claims.
#include "client/grounds.h"

namespace wobble::client {

void Grounds::Expect(std::span<const wire::HeightField> fields) {
  for (const wire::HeightField& field : fields) {
    Ground ground;
    ground.corner = {field.corner().x(), field.corner().y(), field.corner().z()};
    ground.cellSize = field.cell_size();
    ground.columns = field.columns();
    ground.rows = field.rows();
    m_missing += std::size_t{field.columns()} * field.rows();
    m_grounds.push_back(std::move(ground));
    m_fields.push_back(field);
  }
}

bool Grounds::AddRows(const wire::HeightRows& rows) {
  if (rows.field() >= m_grounds.size()) return false;
  const wire::HeightField& field = m_fields[rows.field()];
  std::vector<float>& heights = m_grounds[rows.field()].heights;
  const std::size_t whole = std::size_t{field.columns()} * field.rows();
  const std::size_t count = rows.heights()->size();
  if (count % field.columns() != 0 || std::size_t{rows.first_row()} * field.columns() != heights.size() ||
      count > whole - heights.size()) {
    return false;
  }
  for (const std::uint16_t height : *rows.heights()) {
    heights.push_back(field.corner().z() + field.low() + field.step() * static_cast<float>(height));
  }
  m_missing -= count;
  return true;
}

}  // namespace wobble::client
