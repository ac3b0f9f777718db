// A door and its callers in virtual time, datagram by datagram.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "protocol/transport/vestibule/caller.h"
#include "protocol/transport/vestibule/door.h"
#include "tests/unit/vestibule/deterministic.h"

namespace wobble::transport::vestibule {

inline const NetAddress kHome = MakeAddress(192, 0, 2, 1, 5000);

class DoorTest : public testing::Test {
 protected:
  DoorTest() { EXPECT_TRUE(InitialiseSodium()); }

  Door& Open(Door::Settings settings = {}) {
    settings.identity = MakeIdentity();
    settings.random = MakeRandom(++m_seed);
    m_door = std::make_unique<Door>(std::move(settings));
    return *m_door;
  }
  Caller MakeCaller(Caller::Settings settings = {}) {
    settings.random = MakeRandom(++m_seed);
    return Caller(std::move(settings));
  }
  // The door's result for one datagram; its answer goes to the caller.
  struct Taken {
    VisitorId visitor = 0;
    bool isNew = false;
    bool isOffence = false;
    Bytes plain, answer;
  };
  Taken Knock(const NetAddress& from, const Bytes& datagram) {
    const Door::Result result = m_door->TakeDatagram(from, datagram, now);
    return {result.visitor,
            result.isNew,
            result.isOffence,
            {result.plain.begin(), result.plain.end()},
            {result.answer.begin(), result.answer.end()}};
  }
  // The caller's request and the door's answer to it.
  void Ask(Caller& caller, const NetAddress& from = kHome) {
    Bytes datagram;
    caller.FindDue(now, datagram);
    ASSERT_FALSE(datagram.empty());
    static_cast<void>(caller.TakeDatagram(Knock(from, datagram).answer, now));
  }
  static Bytes Seal(Caller& caller, const Bytes& plain, double time) {
    const std::span<const std::uint8_t> part = plain;
    Bytes datagram;
    caller.Seal({&part, 1}, time, datagram);
    return datagram;
  }
  // Lets a caller in; its response is left in `response`.
  Taken Enter(Caller& caller, const NetAddress& from = kHome, std::uint32_t connection = 9) {
    Ask(caller, from);
    EXPECT_TRUE(caller.CanSeal());
    response = Seal(caller, MakeConnect(connection), now);
    Taken taken = Knock(from, response);
    static_cast<void>(caller.TakeDatagram(taken.answer, now));
    return taken;
  }
  VisitorId EnterAnew(const NetAddress& from) {
    Caller caller = MakeCaller();
    return Enter(caller, from).visitor;
  }

  double now = 100;
  Bytes response;
  std::unique_ptr<Door> m_door;
  std::uint64_t m_seed = 0;
};

}  // namespace wobble::transport::vestibule
