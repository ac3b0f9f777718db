// What the keys do to other bodies and to the world: grab, push, cut, and tune what everybody feels.
//
// A terminal has no pointer, so hands reach for what is nearest to the own body on the side that the camera looks to.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/terminal/camera.h"

namespace wobble::terminal {

class Hands {
 public:
  // Does what a key says, if it is one of these. samples: all bodies as they are shown.
  void Take(char32_t key, const Camera& camera, std::span<const client::BodySample> samples, client::Client& client);
  // What is held follows the own body. Once a picture.
  void Update(const Camera& camera, std::span<const client::BodySample> samples, client::Client& client);

  [[nodiscard]] bool HoldsSomething() const { return m_held.body != 0; }

 private:
  void LetGo(client::Client& client);
  void Tune(char32_t key, client::Client& client);

  client::Hand m_held;  // body 0: nothing
};

// The keys of Take that this server lets the player use, a line each.
[[nodiscard]] std::vector<std::string> DescribeHandKeys(const client::Client& client);

}  // namespace wobble::terminal
