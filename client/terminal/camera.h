// Where the picture is taken from: behind and above the own body, or from a circle round all of them.
#pragma once

#include <optional>
#include <span>

#include "client/terminal/view.h"

namespace wobble::terminal {

enum class CameraMode {
  kFollow,  // the own body
  kCircle,  // slowly round the middle of the scene
  kStand,   // looks there from one side
};

struct Direction {
  float x = 0;
  float y = 0;
};

class Camera {
 public:
  explicit Camera(CameraMode mode) : m_mode(mode) {}

  // Follow only with a body of one's own.
  void ChooseNextMode(bool hasBody);
  [[nodiscard]] CameraMode Mode() const { return m_mode; }

  // Radians; to the left and upwards are positive. What is asked for is reached within some tenths of a second.
  void Turn(float angle);
  void Tilt(float angle);
  // Times the distance, kept within limits.
  void Zoom(float factor);

  // seconds: since the last Update. own: centroid of the own body; bodies: of all, in metres.
  void Update(double seconds, std::optional<Vector3> own, std::span<const Vector3> bodies);

  [[nodiscard]] View MakeView() const;
  // What the camera looks at.
  [[nodiscard]] Vector3 Focus() const { return m_focus; }
  // Keys, right and forward as seen, as a direction in the world's x and y.
  [[nodiscard]] Direction ToWorld(float right, float forward) const;

 private:
  void FollowHeading(double seconds, Vector3 moved);

  CameraMode m_mode;
  bool m_placed = false;
  Vector3 m_focus;
  float m_yaw = 1.2F;  // of the direction of sight, from x towards y
  float m_pitch = 0.42F;
  float m_distance = 12;
  float m_yawAsked = 1.2F;
  float m_tilt = 0;  // added to the mode's own pitch
  float m_zoom = 1;
  double m_sinceTurn = 1e9;  // seconds since the player turned it
};

}  // namespace wobble::terminal
