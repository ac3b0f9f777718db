// The page in memory: which files are in it, and how they are compressed. tests/web tests that it is served.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>

#include "client/gateway/page_files.h"

namespace wobble::gateway {
namespace {

class PageFiles : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "wobble-page-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    m_folder = name;
  }
  void TearDown() override { std::filesystem::remove_all(m_folder); }

  void Write(const std::string& name, const std::string& bytes) {
    std::filesystem::create_directories((m_folder / name).parent_path());
    std::ofstream(m_folder / name, std::ios::binary) << bytes;
  }

  std::filesystem::path m_folder;
  std::string m_error;
};

TEST_F(PageFiles, AreFoundByNameAlone) {
  Write("index.html", "index");
  Write("assets/main-0aZ_-9bc.js", std::string(1000, 'x'));
  Write("assets/.secret", "no");
  Write(".git/config", "no");
  const auto page = LoadPage(m_folder, m_error);
  ASSERT_TRUE(page) << m_error;
  EXPECT_EQ(page->size(), 2U);
  ASSERT_NE(FindFile(*page, "/"), nullptr);
  EXPECT_EQ(FindFile(*page, "/?x=/none")->bytes, "index");
  for (const char* target : {"", "index.html", "/assets", "/assets/", "/assets/../index.html", "/.git/config", "//"}) {
    EXPECT_EQ(FindFile(*page, target), nullptr) << target;
  }
}

TEST_F(PageFiles, KnowTheirTypesAndWhetherTheyChange) {
  Write("index.html", "index");
  Write("assets/main-0aZ_-9bc.js", std::string(1000, 'x'));
  Write("assets/wobble-12345678.wasm", "wasm");
  Write("assets/main-short.css", "css");
  Write("other-12345678.bin", "");
  const auto page = LoadPage(m_folder, m_error);
  ASSERT_TRUE(page) << m_error;
  const auto describe = [&](const char* target) {
    const PageFile* file = FindFile(*page, target);
    return file == nullptr ? "none" : std::string(file->type) + (file->isForever ? " forever" : "");
  };
  EXPECT_EQ(describe("/index.html"), "text/html; charset=utf-8");
  EXPECT_EQ(describe("/assets/main-0aZ_-9bc.js"), "text/javascript; charset=utf-8 forever");
  EXPECT_EQ(describe("/assets/wobble-12345678.wasm"), "application/wasm forever");
  EXPECT_EQ(describe("/assets/main-short.css"), "text/css; charset=utf-8");
  EXPECT_EQ(describe("/other-12345678.bin"), "application/octet-stream");
}

TEST_F(PageFiles, AreCompressedWhereThatSavesSomething) {
  Write("index.html", std::string(1000, 'x'));
  Write("tiny.txt", "x");
  const auto page = LoadPage(m_folder, m_error);
  ASSERT_TRUE(page) << m_error;
  const std::string& compressed = FindFile(*page, "/")->gzip;
  EXPECT_LT(compressed.size(), 100U);
  EXPECT_EQ(compressed.substr(0, 2), "\x1f\x8b");
  EXPECT_TRUE(FindFile(*page, "/tiny.txt")->gzip.empty());
}

TEST_F(PageFiles, OfNoPageAreRefusedWithAReason) {
  EXPECT_FALSE(LoadPage(m_folder, m_error));
  EXPECT_THAT(m_error, testing::MatchesRegex("no page: '.*/index.html' is not there"));
  Write("index.html", "index");
  std::ofstream(m_folder / "large.bin").close();
  std::filesystem::resize_file(m_folder / "large.bin", kMaxPageBytes + 1);
  EXPECT_FALSE(LoadPage(m_folder, m_error));
  EXPECT_THAT(m_error, testing::HasSubstr("more than 64 MiB of files"));
}

TEST(AcceptEncoding, OfGzipIsUnderstood) {
  for (const char* yes : {"gzip", "br, gzip", "gzip;q=0.5, br", "deflate, gzip;q=1.0, *;q=0"}) {
    EXPECT_TRUE(AcceptsGzip(yes)) << yes;
  }
  for (const char* no : {"", "br", "identity", "gzip;q=0", "gzip;q=0.0, br;q=1"}) EXPECT_FALSE(AcceptsGzip(no)) << no;
}

}  // namespace
}  // namespace wobble::gateway
