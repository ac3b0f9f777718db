// Boxes leave out most pairs: those of bodies first, then those of triangles, sorted along the axis in which they
// spread most and compared with the ones that begin before they end. Boxes hold their triangles in spite of rounding.
#include "tests/bench/intersections/skins.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wobble::bench {

using namespace physics;

namespace {

struct SkinBox {
  std::array<double, 3> low{};
  std::array<double, 3> high{};

  [[nodiscard]] bool Meets(const SkinBox& other) const {
    for (std::size_t i = 0; i < 3; ++i) {
      if (low[i] > other.high[i] || other.low[i] > high[i]) return false;
    }
    return true;
  }
};

SkinBox MakeEmptyBox() {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  return {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
}

// `rest` is at most half of the distance to the next double.
void Include(const ExactPoint& p, SkinBox& box) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const bool isRounded = p.rest[i] != 0;
    box.low[i] = std::min(box.low[i], isRounded ? std::nextafter(p.near[i], -kFar) : p.near[i]);
    box.high[i] = std::max(box.high[i], isRounded ? std::nextafter(p.near[i], kFar) : p.near[i]);
  }
}

SkinBox FindBox(const TriangleSkin& skin, const Face& face) {
  SkinBox box = MakeEmptyBox();
  for (const std::uint16_t corner : face) Include(skin.points[corner], box);
  return box;
}

SkinBox FindBox(const TriangleSkin& skin) {
  SkinBox box = MakeEmptyBox();
  for (const ExactPoint& p : skin.points) Include(p, box);
  return box;
}

struct BoxedFace {
  SkinBox box;
  Triangle corners{};
  bool ofSecond = false;  // of the two skins
};

void AddFaces(const TriangleSkin& skin, const SkinBox& within, bool ofSecond, std::vector<BoxedFace>& faces) {
  for (const Face& face : skin.faces) {
    const SkinBox box = FindBox(skin, face);
    if (!box.Meets(within)) continue;
    faces.push_back({box, {&skin.points[face[0]], &skin.points[face[1]], &skin.points[face[2]]}, ofSecond});
  }
}

std::size_t FindWidestAxis(const std::vector<BoxedFace>& faces) {
  SkinBox all = MakeEmptyBox();
  for (const BoxedFace& face : faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      all.low[i] = std::min(all.low[i], face.box.low[i]);
      all.high[i] = std::max(all.high[i], face.box.high[i]);
    }
  }
  std::size_t widest = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (all.high[i] - all.low[i] > all.high[widest] - all.low[widest]) widest = i;
  }
  return widest;
}

// Calls visit(a, b) once for each two faces whose boxes meet.
template <class Visit>
void VisitMeeting(std::vector<BoxedFace>& faces, const Visit& visit) {
  if (faces.size() < 2) return;
  const std::size_t axis = FindWidestAxis(faces);
  std::sort(faces.begin(), faces.end(),
            [axis](const BoxedFace& a, const BoxedFace& b) { return a.box.low[axis] < b.box.low[axis]; });
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t j = i + 1; j < faces.size() && faces[j].box.low[axis] <= faces[i].box.high[axis]; ++j) {
      if (faces[i].box.Meets(faces[j].box)) visit(faces[i], faces[j]);
    }
  }
}

}  // namespace

TriangleSkin MakeTriangleSkin(std::span<const Face> faces, const Vector3d& origin, std::span<const Vector3d> local,
                              bool isPlanar) {
  TriangleSkin skin{.points = {}, .faces = faces, .isPlanar = isPlanar};
  for (const Vector3d& x : local) {
    skin.points.push_back(AddExactly(origin, x));
    if (!skin.points.back().IsFinite()) return {};
  }
  return skin;
}

TriangleSkin MakeTriangleSkin(const World& world, const Body& body) {
  const Coefficients<double>& full = world.BlueprintOf(body).full;
  return std::visit(
      [&](const auto& state) {
        std::vector<Vector3d> local;
        for (const auto& x : state.positions) local.emplace_back(x.template cast<double>());
        return MakeTriangleSkin(full.faces, state.origin, local, full.planar);
      },
      body.state);
}

std::size_t CountBetween(const TriangleSkin& a, const TriangleSkin& b, SignCounts& counts) {
  const SkinBox boxOfA = FindBox(a);
  const SkinBox boxOfB = FindBox(b);
  if (!boxOfA.Meets(boxOfB)) return 0;
  std::vector<BoxedFace> faces;
  AddFaces(a, boxOfB, false, faces);
  AddFaces(b, boxOfA, true, faces);
  std::size_t found = 0;
  VisitMeeting(faces, [&](const BoxedFace& one, const BoxedFace& other) {
    if (one.ofSecond == other.ofSecond) return;
    const Crossing crossing = FindCrossing(one.corners, other.corners, counts);
    const bool counted = crossing == Crossing::kThrough || (crossing == Crossing::kInPlane && a.isPlanar && b.isPlanar);
    found += counted ? 1 : 0;
  });
  return found;
}

std::size_t CountWithin(const TriangleSkin& skin, SignCounts& counts) {
  std::vector<BoxedFace> faces;
  AddFaces(skin, FindBox(skin), false, faces);
  std::size_t found = 0;
  VisitMeeting(faces, [&](const BoxedFace& one, const BoxedFace& other) {
    found += FindCrossing(one.corners, other.corners, counts) == Crossing::kNone ? 0 : 1;
  });
  return found;
}

Intersections CountIntersections(const World& world) {
  Intersections found;
  std::vector<TriangleSkin> skins;
  std::vector<SkinBox> boxes;
  for (const Body& body : world.Bodies()) {
    TriangleSkin skin = MakeTriangleSkin(world, body);
    if (skin.faces.empty()) continue;
    found.vertices += skin.points.size();
    if (skin.points.size() >= kFineVertices) found.fineVertices += skin.points.size();
    boxes.push_back(FindBox(skin));
    skins.push_back(std::move(skin));
  }
  for (std::size_t i = 0; i < skins.size(); ++i) {
    found.within += CountWithin(skins[i], found.signs);
    for (std::size_t j = i + 1; j < skins.size(); ++j) {
      if (!boxes[i].Meets(boxes[j])) continue;
      const bool fine = std::min(skins[i].points.size(), skins[j].points.size()) >= kFineVertices;
      (fine ? found.betweenFine : found.betweenOthers) += CountBetween(skins[i], skins[j], found.signs);
    }
  }
  return found;
}

}  // namespace wobble::bench
