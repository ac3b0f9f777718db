// Finds out what a gateway with a key tells its host when servers refuse browsers. Servers do not say that the gateway
// is what they do not know, so one refusal alone looks like a wrong password.
#pragma once

#include <map>
#include <set>
#include <string>

namespace wobble::gateway {

class KeyDoubts {
 public:
  enum class Cause {
    kPerhapsBrowser,  // it showed something, or showed nothing where something is asked for
    kGateway,         // it showed nothing to a server that asks for nothing
  };

  void NoteLetIn(const std::string& world) { m_known.insert(world); }

  // A server did not take what it was shown. Returns a line for the host, without an end; empty: there is nothing to
  // say, or it was said for this world in the last ten seconds. now: s.
  [[nodiscard]] std::string NoteRefused(const std::string& world, Cause cause, double now) {
    // A server that has let somebody in knows this gateway, until it is started with another key.
    if (cause == Cause::kPerhapsBrowser && m_known.contains(world)) return "";
    const auto next = m_next.find(world);
    if (next != m_next.end() && now < next->second) return "";
    m_next[world] = now + kEvery;
    const std::string server = world.empty() ? "the server" : "the server of " + world;
    if (cause == Cause::kGateway) {
      return server + " does not know this gateway: its --gateway-key is another than this one, or their clocks differ";
    }
    return server + " has refused a browser, and has let in none: what it showed does not hold, or the server has " +
           "another --gateway-key, or their clocks differ";
  }

 private:
  static constexpr double kEvery = 10;  // s
  std::set<std::string> m_known;
  std::map<std::string, double> m_next;  // s, not before it comes the next line
};

}  // namespace wobble::gateway
