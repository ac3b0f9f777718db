// The limits on what one browser may send, on how often an address may come, and on the number of browsers.
#include <gtest/gtest.h>

#include "client/gateway/places.h"
#include "client/gateway/rate_limit.h"

namespace wobble::gateway {
namespace {

// How many messages of so many bytes are allowed at one moment.
int CountAllowed(RateLimit& limit, std::size_t bytes, double now) {
  int count = 0;
  while (limit.Allow(bytes, now) && count < 100000) ++count;
  return count;
}

TEST(RateLimit, AllowsInputsForEver) {
  RateLimit limit;
  for (int i = 0; i < 60 * 600; ++i) ASSERT_TRUE(limit.Allow(200, 1000 + i / 60.0)) << i;
}

TEST(RateLimit, AllowsASilenceToBeMadeUpForOnce) {
  RateLimit limit;
  EXPECT_EQ(CountAllowed(limit, 10, 5), kBurstSeconds * kMessagesPerSecond);
  EXPECT_NEAR(CountAllowed(limit, 10, 6), kMessagesPerSecond, 2);  // refused messages count too
  EXPECT_EQ(CountAllowed(limit, 10, 1000), kBurstSeconds * kMessagesPerSecond);
}

TEST(RateLimit, HoldsForBytesToo) {
  RateLimit limit;
  EXPECT_EQ(CountAllowed(limit, 4096, 5), kBurstSeconds * kBytesPerSecond / 4096);
  EXPECT_NEAR(CountAllowed(limit, 4096, 6), kBytesPerSecond / 4096, 2);
}

TEST(RateLimit, EndsWhatGoesOnForTooLong) {
  RateLimit limit;
  double now = 0;
  while (limit.Allow(10, now)) now += 1 / (1.5 * kMessagesPerSecond);
  EXPECT_NEAR(now, 2 * kBurstSeconds, 0.1);
}

int CountAllowed(AddressRates& rates, const std::string& address, double now) {
  int count = 0;
  while (rates.Allow(address, now) && count < 100000) ++count;
  return count;
}

TEST(AddressRates, HoldForEachAddress) {
  AddressRates rates(4, 10);
  EXPECT_EQ(CountAllowed(rates, "a", 5), 10);
  EXPECT_EQ(CountAllowed(rates, "b", 5), 10);
  EXPECT_EQ(CountAllowed(rates, "a", 6), 4) << "who tries in vain loses nothing by it";
  EXPECT_EQ(CountAllowed(rates, "a", 100), 10);
}

TEST(AddressRates, RememberSomeOfMany) {
  AddressRates rates(4, 10);
  EXPECT_EQ(CountAllowed(rates, "a", 5), 10);
  for (int i = 0; i < 4000; ++i) ASSERT_TRUE(rates.Allow(std::to_string(i), 5)) << i;
  EXPECT_FALSE(rates.Allow("a", 5));
  for (int i = 0; i < 100'000; ++i) ASSERT_TRUE(rates.Allow(std::to_string(i), 5 + i / 1000.0)) << i;
}

TEST(Places, AreLimitedInAllAndByAddress) {
  Places places(3, 2);
  Place first = places.Take("a");
  const Place second = places.Take("a");
  EXPECT_NE(first, nullptr);
  EXPECT_NE(second, nullptr);
  EXPECT_EQ(places.Take("a"), nullptr);
  const Place third = places.Take("b");
  EXPECT_NE(third, nullptr);
  EXPECT_EQ(places.Take("c"), nullptr);
  EXPECT_EQ(places.CountTaken(), 3U);
  Place same = std::move(first);
  EXPECT_EQ(places.Take("a"), nullptr);
  same = nullptr;
  EXPECT_EQ(places.CountTaken(), 2U);
  EXPECT_NE(places.Take("a"), nullptr);  // and given back at once
  EXPECT_EQ(places.CountTaken(), 2U);
}

}  // namespace
}  // namespace wobble::gateway
