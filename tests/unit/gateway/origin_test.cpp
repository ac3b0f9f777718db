#include <gtest/gtest.h>

#include "client/gateway/origin.h"

namespace wobble::gateway {
namespace {

TEST(Origin, OfTheSameHostIsAllowed) {
  EXPECT_TRUE(IsOriginAllowed("http://localhost:8080", "localhost:8080", {}));
  EXPECT_TRUE(
      IsOriginAllowed("https://Wobble.example.org", "wobble.example.org", {}));  // behind a proxy that speaks https
  EXPECT_TRUE(IsOriginAllowed("http://[::1]:8080", "[::1]:8080", {}));
  EXPECT_TRUE(IsOriginAllowed("", "localhost:8080", {}));  // not a browser
}

TEST(Origin, OfAnotherHostIsRefused) {
  for (const char* origin : {"http://example.org", "http://localhost", "http://localhost:80801", "localhost:8080",
                             "http://example.org/localhost:8080", "ftp://localhost:8080", "null", "http://"}) {
    EXPECT_FALSE(IsOriginAllowed(origin, "localhost:8080", {})) << origin;
  }
  EXPECT_FALSE(IsOriginAllowed("http://", "", {}));
  EXPECT_FALSE(IsOriginAllowed("null", "", {}));
}

TEST(Origin, ThatIsNamedIsAllowed) {
  const std::vector<std::string> allowed{"https://a.example.org", "http://b.example.org:81"};
  EXPECT_TRUE(IsOriginAllowed("https://A.example.org", "localhost:8080", allowed));
  EXPECT_TRUE(IsOriginAllowed("http://b.example.org:81", "localhost:8080", allowed));
  EXPECT_FALSE(IsOriginAllowed("http://a.example.org", "localhost:8080", allowed));
  EXPECT_FALSE(IsOriginAllowed("https://a.example.org.evil", "localhost:8080", allowed));
}

TEST(Origin, IsASchemeAndAHost) {
  EXPECT_TRUE(IsOrigin("http://a"));
  EXPECT_TRUE(IsOrigin("https://a.example.org:444"));
  for (const char* text : {"", "a", "http://", "https://a/", "http://a?b", "http://u@a", "ws://a", "*"}) {
    EXPECT_FALSE(IsOrigin(text)) << text;
  }
}

}  // namespace
}  // namespace wobble::gateway
