// What is kept of the bodies in all frames, each as its pose and how its shape departs from rest.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "server/export/frame.h"

namespace wobble::exporting {

// A moment of a part. Times are s since the first frame, in single precision, as glTF has them.
struct Key {
  float time = 0;
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();              // mean of all vertices, in the world, m
  Eigen::Quaternionf rotation = Eigen::Quaternionf::Identity();  // of the rest shape
  std::uint32_t shape = 0;                                       // among Part::shapes
};

// From when to when something is there, s. It goes with the frame that does not show it any more.
struct Span {
  float from = 0;
  float to = std::numeric_limits<float>::infinity();
};

// What of a part is seen until a face or spring of it tears.
struct Skin {
  Skeleton skeleton;
  bool isOpen = false;  // seen from both sides
  Span span;
};

// A body, or what it was while its vertices were the same ones.
struct Part {
  physics::BodyId body = 0;
  std::string blueprint;
  std::string player;                   // empty: of none
  double size = 0;                      // of the blueprint, m
  std::vector<std::uint16_t> vertices;  // those that are seen, ascending
  std::vector<float> rest;    // of these, three numbers each, with the mean of all the body's vertices at 0, m
  std::vector<Key> keys;      // rising times; one at either end of a stretch in which nothing changes
  std::vector<float> shapes;  // departures from rest, turned back by the pose, as many numbers each as rest
  std::vector<Skin> skins;    // by time, without gaps
  Span span;
};

class Clip {
 public:
  void Add(const Frame& frame);

  [[nodiscard]] std::uint64_t Bytes() const { return m_bytes; }  // of all shapes
  [[nodiscard]] float LastTime() const { return m_time; }
  // Whether the times have become too large to tell two frames apart.
  [[nodiscard]] bool IsTooLong() const { return m_isTooLong; }
  [[nodiscard]] std::vector<Part>& Parts() { return m_parts; }

 private:
  // What the skeleton depends on.
  struct Look {
    std::uint8_t slot = 0;
    std::uint64_t revision = 0;
    std::ptrdiff_t torn = 0;
    bool operator==(const Look&) const = default;
  };
  // A body that was in the last frame.
  struct Track {
    std::size_t part = 0;
    Look look;
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    double speed = 0;     // m/s
    float lastTime = -1;  // of a key; negative: it has none
  };

  void Follow(const Frame& frame, const physics::Body& body);
  void Redraw(const Frame& frame, const physics::Body& body, Track& track);
  // speed: of the body, m/s.
  void AddKey(const physics::Blueprint& blueprint, double speed, Track& track);
  void End(const Track& track);

  std::vector<Part> m_parts;
  std::map<physics::BodyId, Track> m_tracks;
  double m_begin = 0;  // time of the first frame, s
  float m_time = -1;
  bool m_isTooLong = false;
  std::uint64_t m_bytes = 0;
  std::vector<physics::Vector3d> m_positions;  // of the body that is added
  std::vector<float> m_shape;
};

}  // namespace wobble::exporting
