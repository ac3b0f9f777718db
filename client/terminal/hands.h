// Keys that act on other bodies and on the world: grab, push, cut, and tune the world's parameters.
//
// A terminal has no pointer, so hands reach for the vertex nearest to the player's body on the side that the camera
// looks to.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/terminal/camera.h"

namespace wobble::terminal {

class Hands {
 public:
  // Performs the action of `key`, if it has one here. samples: all bodies as they are shown.
  void Take(char32_t key, const Camera& camera, std::span<const client::BodySample> samples, client::Client& client);
  // Moves the held body with the player's body. Call once per picture.
  void Update(const Camera& camera, std::span<const client::BodySample> samples, client::Client& client);

  [[nodiscard]] bool HoldsSomething() const { return m_held.body != 0; }

 private:
  void LetGo(client::Client& client);
  void Tune(char32_t key, client::Client& client);

  client::Hand m_held;  // body 0: holds nothing
};

// One line for each key that this server lets the player use.
[[nodiscard]] std::vector<std::string> DescribeHandKeys(const client::Client& client);

}  // namespace wobble::terminal
