// Height fields of the welcome on their way in, and those that are here.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "client/client.h"

namespace wobble::client {

class Grounds {
 public:
  // As the welcome has them; once.
  void Expect(std::span<const wire::HeightField> fields);
  // Takes rows that ParseServerMessage has passed. False when they do not belong: no such field, no whole rows, a gap,
  // or more than there are.
  [[nodiscard]] bool AddRows(const wire::HeightRows& rows);

  [[nodiscard]] bool Complete() const { return m_missing == 0; }
  [[nodiscard]] const std::vector<Ground>& All() const { return m_grounds; }

 private:
  std::vector<Ground> m_grounds;
  std::vector<wire::HeightField> m_fields;  // what each is made from
  std::size_t m_missing = 0;                // heights
};

}  // namespace wobble::client
