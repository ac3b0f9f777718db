// Bounds how many connections wait for something, in all and for each address. There is always room for one more: at
// the bound, who has waited longest goes, of the same address if that has its share. What is honest waits for
// milliseconds; so who opens many, or is slow on each, puts out itself.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace wobble::gateway {

class Lobby {
 public:
  // A connection. It must leave before it is destroyed.
  struct Guest {
    std::string address;             // ""; counts in all alone, as a proxy's do
    std::function<void()> end = {};  // ends the connection when it has to go; called by Enter and EndOldest
    bool isWaiting = true;           // the others go only when none waits
    double since = 0;                // s, when it began to wait
  };

  Lobby(std::size_t inAll, std::size_t perAddress) : m_most(inAll), m_mostPerAddress(perAddress) {}

  // Takes in a guest, who begins to wait now, s.
  void Enter(Guest& guest, double now) {
    guest.since = now;
    const auto isOfAddress = [&](const Guest* each) { return each->address == guest.address; };
    const auto ofAddress = std::count_if(m_guests.begin(), m_guests.end(), isOfAddress);
    if (!guest.address.empty() && static_cast<std::size_t>(ofAddress) >= m_mostPerAddress) {
      EndFirst(isOfAddress);
    } else if (m_guests.size() >= m_most) {
      EndFirst([](const Guest*) { return true; });
    }
    m_guests.push_back(&guest);
  }

  // Does nothing for a guest who has left.
  void Leave(const Guest& guest) { std::erase(m_guests, &guest); }

  // Whether from now on, s, a guest waits again or is being answered.
  void SetWaiting(Guest& guest, bool isWaiting, double now) {
    guest.isWaiting = isWaiting;
    guest.since = now;
    const auto found = std::find(m_guests.begin(), m_guests.end(), &guest);
    if (found != m_guests.end()) std::rotate(found, found + 1, m_guests.end());
  }

  // Ends the guest who has waited longest, if any waits since before this time, s.
  void EndOldest(double before) {
    EndFirst([&](const Guest* each) { return each->since < before; });
  }

  [[nodiscard]] std::size_t Count() const { return m_guests.size(); }
  // Guests who had to go so far.
  [[nodiscard]] std::size_t CountEnded() const { return m_ended; }

 private:
  template <typename Filter>
  void EndFirst(Filter mayGo) {
    const auto isWaiting = [&](const Guest* each) { return each->isWaiting && mayGo(each); };
    auto found = std::find_if(m_guests.begin(), m_guests.end(), isWaiting);
    if (found == m_guests.end()) found = std::find_if(m_guests.begin(), m_guests.end(), mayGo);
    if (found == m_guests.end()) return;
    const Guest* guest = *found;
    m_guests.erase(found);
    ++m_ended;
    guest->end();
  }

  std::size_t m_most;
  std::size_t m_mostPerAddress;
  std::size_t m_ended = 0;
  std::vector<Guest*> m_guests;  // who has waited longest first
};

}  // namespace wobble::gateway
