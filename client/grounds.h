// The height fields of the welcome: collects their heights as they arrive.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "client/client.h"

namespace wobble::client {

class Grounds {
 public:
  // The fields of the welcome; to be called once.
  void Expect(std::span<const wire::HeightField> fields);
  // Takes rows that ParseServerMessage has passed. False when they are out of place: an unknown field, no whole rows, a
  // gap, or more rows than the field has.
  [[nodiscard]] bool AddRows(const wire::HeightRows& rows);

  [[nodiscard]] bool Complete() const { return m_missing == 0; }
  [[nodiscard]] const std::vector<Ground>& All() const { return m_grounds; }

 private:
  std::vector<Ground> m_grounds;
  std::vector<wire::HeightField> m_fields;  // of each ground
  std::size_t m_missing = 0;                // heights still to come
};

}  // namespace wobble::client
