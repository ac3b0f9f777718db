#include "server/play/sumo.h"

namespace wobble::server {
namespace {

constexpr double kBlame = 6;  // how long after a touch a fall scores for the toucher, s

}  // namespace

void Sumo::NoteTouch(const Match& match, ClientId a, ClientId b) {
  if (match.Find(a) == nullptr || match.Find(b) == nullptr) return;
  touches[a] = {b, match.Read().now};
  touches[b] = {a, match.Read().now};
}

ClientId Sumo::NoteFall(Match& match, ClientId fallen) {
  const auto found = touches.find(fallen);
  if (found == touches.end() || match.Find(fallen) == nullptr || !match.IsCounting()) return 0;
  const Touch touch = found->second;
  touches.erase(found);
  if (match.Find(touch.by) == nullptr || match.Read().now - touch.at > kBlame) return 0;
  match.Score(touch.by);
  return touch.by;
}

}  // namespace wobble::server
