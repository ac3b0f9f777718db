// The action of each key.
#pragma once

#include <vector>

#include "client/client.h"
#include "client/terminal/camera.h"
#include "client/terminal/held_keys.h"
#include "client/terminal/keys.h"

namespace wobble::terminal {

class Controls {
 public:
  // Applies a key event at the time `now` (seconds). hasBody: there is a body for the camera to follow.
  void Take(const KeyEvent& event, double now, bool hasBody, Camera& camera);
  void ReleaseAll() { m_held.ReleaseAll(); }

  // The player's input. The keys' right and forward are as the camera sees them; the input is in world x and y.
  [[nodiscard]] client::Input MakeInput(double now, const Camera& camera) const;

  // Keys pressed since the last call that have no action here; Hands may have one.
  [[nodiscard]] std::vector<char32_t> TakeOthers();

  [[nodiscard]] bool IsQuitAsked() const { return m_quit; }
  [[nodiscard]] bool ShowsKeys() const { return m_showsKeys; }
  // True once after each Ctrl-Z.
  [[nodiscard]] bool TakePause();

 private:
  void TakeCommand(char32_t key, bool hasBody, Camera& camera);

  HeldKeys m_held;
  std::vector<char32_t> m_others;
  bool m_quit = false;
  bool m_pause = false;
  bool m_showsKeys = false;
};

}  // namespace wobble::terminal
