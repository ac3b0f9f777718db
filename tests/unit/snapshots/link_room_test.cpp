// The measured budget, against links with a bottleneck, a queue, jitter, loss and black-outs, on virtual time.
#include "server/snapshots/link_room.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <random>
#include <vector>

namespace wobble::server {
namespace {

constexpr double kFrame = 1.0 / 60;
constexpr double kPacketBytes = 1000;

struct Line {
  double rate = 1e9;     // bit/s
  double queue = 0.25;   // s; what would wait longer is dropped
  double delay = 0.015;  // one way, s
  double jitter = 0;     // s
  double loss = 0;       // share
};

// A server that sends as much as it may, or as it wants, 30 times a second, and a client that acknowledges 60 times.
class Stream {
 public:
  explicit Stream(unsigned seed) : m_random(seed) {}

  void For(double seconds) {
    for (const double end = now + seconds; now < end; now += kFrame) {
      if (++m_frame % 2 == 0) SendSnapshot();
      Acknowledge();
    }
  }
  // For so long; returns the queue, s, that 95 % of the packets found less of.
  double FindQueue(double seconds) {
    m_waits.clear();
    For(seconds);
    std::sort(m_waits.begin(), m_waits.end());
    return m_waits.empty() ? 0 : m_waits[m_waits.size() * 95 / 100];
  }
  [[nodiscard]] double Rate() const { return room.Rate(ceiling); }

  Line line;
  double ceiling = 4e6;
  double wanted = 1e9;  // bit/s
  double others = 0;    // s that others' packets queue before ours
  bool isBlack = false;
  double now = 0;
  LinkRoom room;
  protocol::SentWindow sent;

 private:
  struct Flight {
    std::uint32_t sequence = 0;
    double due = 0;  // s
  };
  void SendSnapshot() {
    room.Follow(sent, Rate() < wanted, ceiling, now);
    m_credit = std::min(m_credit, 0.0) + std::min(Rate(), wanted) / 8 / 30;
    for (; m_credit > 0; m_credit -= kPacketBytes) SendPacket();
  }
  void SendPacket() {
    const std::uint32_t sequence = sent.RecordSent(now);
    room.NoteSent(kPacketBytes);
    const double wait = std::max(0.0, m_free - now);
    if (wait > line.queue || isBlack || m_chance(m_random) < line.loss) return;
    m_free = now + wait + 8 * kPacketBytes / line.rate;
    m_waits.push_back(wait);
    m_down.push_back({sequence, m_free + others + line.delay + line.jitter * m_chance(m_random)});
  }
  void Acknowledge() {
    std::erase_if(m_down, [&](const Flight& flight) {
      if (flight.due > now) return false;
      (void)m_window.Record(flight.sequence);
      return true;
    });
    if (m_window.Newest() > 0) m_up.push_back({now + line.delay, m_window.Newest(), m_window.History()});
    for (; !m_up.empty() && m_up.front().due <= now; m_up.pop_front()) {
      protocol::SentWindow::Report report;
      ASSERT_TRUE(sent.RecordAcknowledgement(m_up.front().newest, m_up.front().history, now, report));
      room.NoteAcknowledgement(report, now);
    }
  }

  struct Answer {
    double due = 0;  // s
    std::uint32_t newest = 0;
    std::uint64_t history = 0;
  };
  std::mt19937 m_random;
  std::uniform_real_distribution<double> m_chance{0, 1};
  int m_frame = 0;
  double m_credit = 0;  // bytes
  double m_free = 0;    // when the bottleneck has sent what waits, s
  std::vector<Flight> m_down;
  std::deque<Answer> m_up;
  std::vector<double> m_waits;
  protocol::ReceivedWindow m_window;
};

constexpr unsigned kSeeds = 5;

TEST(LinkRoom, ReachesTheCeilingOfAWideLinkWithinFourSeconds) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Stream stream(seed);
    stream.line.jitter = 0.03;
    EXPECT_EQ(stream.Rate(), kFirstRoom);
    stream.For(4);
    EXPECT_EQ(stream.Rate(), stream.ceiling);
    stream.For(60);
    EXPECT_EQ(stream.Rate(), stream.ceiling);
  }
}

TEST(LinkRoom, FillsABottleneckAndKeepsItsQueueShort) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    for (const double rate : {0.5e6, 1e6, 2e6}) {
      Stream stream(seed);
      stream.line.rate = rate;
      stream.For(10);
      double sum = 0;
      for (int i = 0; i < 120; ++i) {
        stream.For(0.25);
        sum += stream.Rate() / 120;
      }
      EXPECT_GT(sum, 0.8 * rate);
      EXPECT_LT(sum, 1.05 * rate);
      EXPECT_LT(stream.FindQueue(30), 0.11) << rate;  // of which one snapshot's own packets are a frame
    }
  }
}

TEST(LinkRoom, YieldsWithinTwoSecondsWhenTheLinkShrinks) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Stream stream(seed);
    stream.line.rate = 3e6;
    stream.For(20);
    stream.line.rate = 0.6e6;
    stream.For(2);
    EXPECT_LT(stream.Rate(), 0.6e6);
    EXPECT_LT(stream.FindQueue(10), 0.1);
  }
}

TEST(LinkRoom, AFewPerCentOfLossAreNoFullLink) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Stream stream(seed);
    stream.line.loss = 0.03;
    stream.line.jitter = 0.02;
    stream.For(30);
    EXPECT_EQ(stream.Rate(), stream.ceiling);
  }
}

TEST(LinkRoom, MuchLossTakesTheRateDownToTheLeast) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Stream stream(seed);
    stream.line.loss = 0.25;
    stream.For(10);
    EXPECT_EQ(stream.Rate(), kLeastRoom);
  }
}

// A bottleneck that drops and does not queue.
TEST(LinkRoom, LossAloneTellsOfABottleneckWithoutAQueue) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Stream stream(seed);
    stream.line.rate = 1e6;
    stream.line.queue = 0.012;
    stream.For(60);
    EXPECT_LT(stream.Rate(), 1.3e6);
    EXPECT_GE(stream.Rate(), kLeastRoom);
  }
}

TEST(LinkRoom, ABlackoutSaysNothing) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Stream stream(seed);
    stream.For(10);
    for (int i = 0; i < 5; ++i) {
      stream.isBlack = true;
      stream.For(0.5);
      stream.isBlack = false;
      stream.For(5);
      EXPECT_EQ(stream.Rate(), stream.ceiling);
    }
  }
}

TEST(LinkRoom, ALongerWayIsLearnedAndTheRateComesBack) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Stream stream(seed);
    stream.For(5);
    stream.line.delay += 0.06;
    stream.For(30);
    EXPECT_EQ(stream.Rate(), stream.ceiling);
  }
}

TEST(LinkRoom, WhatOthersQueueDoesNotSilenceIt) {
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Stream stream(seed);
    stream.For(5);
    stream.others = 0.2;
    stream.For(30);
    EXPECT_GT(stream.Rate(), kLeastRoom);
  }
}

TEST(LinkRoom, DoesNotGrowWithoutNeedOrWithoutUse) {
  Stream stream(1);
  stream.wanted = 300e3;
  stream.For(20);
  EXPECT_EQ(stream.Rate(), kFirstRoom);
}

TEST(LinkRoom, TheCeilingHoldsBelowTheFirstRateAndBelowTheLeast) {
  for (const double ceiling : {32e3, 250e3}) {
    Stream stream(1);
    stream.ceiling = ceiling;
    stream.line.loss = 0.25;
    stream.For(10);
    EXPECT_LE(stream.Rate(), ceiling);
    EXPECT_GE(stream.Rate(), std::min(ceiling, kLeastRoom));
  }
}

TEST(LinkRoom, WhoNeverAcknowledgesKeepsTheFirstRate) {
  Stream stream(1);
  stream.isBlack = true;
  stream.For(20);
  EXPECT_EQ(stream.Rate(), kFirstRoom);
}

}  // namespace
}  // namespace wobble::server
