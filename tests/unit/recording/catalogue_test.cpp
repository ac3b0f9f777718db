// What recordings there are, and how long, is found without playing them.
#include "server/recording/catalogue.h"

#include <gmock/gmock.h>

#include "tests/unit/recording/matches.h"

namespace wobble::recording {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(Catalogue, ListsWhatCanBeShownAndWhatCannot) {
  Folder folder;
  RecordMatch("pair", 200, MakeSettings(folder));
  const std::filesystem::path whole = folder.List()[0];
  const auto time = std::filesystem::last_write_time(whole);
  Bytes bytes = ReadFile(whole);
  const std::span<const std::uint8_t> all = bytes;
  WriteFile(folder.Path() / "cut.wobrec", all.first(all.size() - 60));
  bytes[20] ^= 1;
  WriteFile(folder.Path() / "damaged.wobrec", bytes);
  WriteFile(folder.Path() / "notes.txt", {});
  std::filesystem::create_directory(folder.Path() / "folder.wobrec");
  std::filesystem::last_write_time(folder.Path() / "cut.wobrec", time - std::filesystem::file_time_type::duration(1));
  std::filesystem::last_write_time(folder.Path() / "damaged.wobrec",
                                   time + std::filesystem::file_time_type::duration(1));

  const std::vector<CatalogueEntry> found = ListRecordings(folder.Path(), 9);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].file, "damaged.wobrec");
  EXPECT_THAT(found[0].fault, HasSubstr("no head"));
  EXPECT_EQ(found[1].file, whole.filename());
  EXPECT_EQ(found[1].scene, "pair");
  EXPECT_NEAR(found[1].length, 200.0 / 60, 1e-9);
  EXPECT_THAT(found[1].fault, IsEmpty());
  EXPECT_THAT(found[1].damage, IsEmpty());
  EXPECT_EQ(found[2].file, "cut.wobrec");
  EXPECT_NEAR(found[2].length, 3, 1e-9) << "without the second that was cut";
  EXPECT_THAT(found[2].fault, IsEmpty()) << "it can be shown up to there";
  EXPECT_THAT(found[2].damage, HasSubstr(": no whole block"));
  EXPECT_EQ(ListRecordings(folder.Path(), 2).size(), 2U);
  EXPECT_THAT(ListRecordings(folder.Path() / "none", 9), IsEmpty());
}

}  // namespace
}  // namespace wobble::recording
