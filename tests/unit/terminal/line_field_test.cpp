// A line as it is typed.
#include "client/terminal/line_field.h"

#include <gtest/gtest.h>

namespace wobble::terminal {
namespace {

TEST(LineField, KeysMakeALineThatEnterEndsAndEscapeGivesUp) {
  LineField field;
  EXPECT_FALSE(field.Take({U'a'})) << "closed";
  field.Open();
  for (const char32_t key : {U'h', U'o', kKeyBackspace, U'i', kKeyUp, char32_t{3}}) EXPECT_FALSE(field.Take({key}));
  EXPECT_FALSE(field.Take({U'x', true})) << "a release";
  EXPECT_EQ(field.Text(), "hi");
  EXPECT_EQ(field.Take({kKeyEnter}), "hi");
  EXPECT_FALSE(field.IsOpen());
  field.Open();
  EXPECT_FALSE(field.Take({kKeyBackspace}));
  EXPECT_FALSE(field.Take({U'a'}));
  EXPECT_FALSE(field.Take({kKeyEscape}));
  EXPECT_FALSE(field.IsOpen());
  field.Open();
  for (int i = 0; i < 500; ++i) EXPECT_FALSE(field.Take({U'a'}));
  EXPECT_EQ(field.Text().size(), protocol::kMaxSaidBytes);
}

}  // namespace
}  // namespace wobble::terminal
