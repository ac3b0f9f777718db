// The geometry that the page draws: each body's vertices and normals, with a revision that tells when they changed.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "client/client.h"
#include "client/wasm/layout.h"

namespace wobble::wasm {

class ShownBodies {
 public:
  // samples: by ascending body. They must live until the next Update.
  void Update(std::span<const client::BodySample> samples);
  [[nodiscard]] std::span<const BodyView> Views() const { return m_views; }
  // The blueprint of a body in Views; nullptr for any other number. Valid until the next Update.
  const BlueprintView* FindBlueprint(std::uint32_t number);

 private:
  struct Shown {
    std::vector<protocol::Vector3> vertices;
    std::vector<protocol::Vector3> normals;
    std::uint32_t blueprint = 0;
    std::uint32_t revision = 0;
    std::uint32_t round = 0;  // the last Update with this body
  };
  struct Named {
    std::shared_ptr<const client::Blueprint> blueprint;
    std::uint32_t number = 0;
    std::uint32_t round = 0;
  };

  Named& Name(const std::shared_ptr<const client::Blueprint>& blueprint);
  void Take(const client::BodySample& sample, Shown& shown, bool isOtherBlueprint);

  std::map<std::uint32_t, Shown> m_shown;
  std::map<const client::Blueprint*, Named> m_blueprints;
  std::vector<BodyView> m_views;
  BlueprintView m_blueprintView;
  std::uint32_t m_nextNumber = 1;
  std::uint32_t m_round = 0;
};

}  // namespace wobble::wasm
