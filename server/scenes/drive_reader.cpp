#include "server/scenes/drive_reader.h"

#include <map>

#include "server/scenes/blueprint_reader.h"

namespace wobble::scenes {
namespace {

constexpr double kMaxForce = 1e5;        // N
constexpr double kMaxPeriod = 3600;      // s
constexpr double kMinPeriod = 1.0 / 60;  // s: a tick at the default rate

void ReadForce(TableReader& reader, DriveRule& rule) {
  using physics::Side;
  static const std::map<std::string, Side> kSides{{"all", Side::kNone}, {"x-", Side::kLowX},  {"x+", Side::kHighX},
                                                  {"y-", Side::kLowY},  {"y+", Side::kHighY}, {"z-", Side::kLowZ},
                                                  {"z+", Side::kHighZ}};
  reader.Read("force", -kMaxForce, kMaxForce, " N", rule.drive.force);
  reader.Read("side", kSides, rule.side);
  if (reader.Has("side") && !reader.Has("force")) {
    reader.RefuseAsWritten("side", "given", "left out unless there is a force");
  }
}

void ReadClock(TableReader& reader, physics::Drive& drive) {
  reader.Read("begin", 0, kMaxPeriod, " s", drive.begin);
  reader.Read("end", 0, kMaxPeriod, " s", drive.end);
  reader.Read("period", kMinPeriod, kMaxPeriod, " s", drive.period);
  if (drive.end <= drive.begin) reader.RefuseAsWritten("end", "1", "after begin");
  if (drive.period < drive.end) reader.RefuseAsWritten("period", "2", "no less than end");
}

}  // namespace

void ReadDrive(TableReader& reader, Scene& scene) {
  DriveRule rule;
  if (reader.Has("blueprint")) ReadBlueprintName(reader, scene, rule.blueprint.emplace());
  ReadForce(reader, rule);
  reader.Read("gas", 0.1, 10, "", rule.drive.gasFactor);
  reader.Read("wind", -50, 50, " m/s", rule.drive.wind);
  ReadClock(reader, rule.drive);
  for (const char* one : {"force", "gas"}) {
    if (!rule.blueprint && reader.Has(one)) {
      reader.RefuseAsWritten(one, "given", "left out where no blueprint is named: only wind acts on all");
    }
  }
  if (!reader.Has("force") && !reader.Has("gas") && !reader.Has("wind")) {
    reader.Refuse("drive", "nothing", "a force, gas or wind");
  }
  scene.drives.push_back(std::move(rule));
}

}  // namespace wobble::scenes
