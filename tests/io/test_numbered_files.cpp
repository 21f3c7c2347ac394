/// @file test_numbered_files.cpp
/// Patterns of names, lists of files, and hashes of files.
#include <gtest/gtest.h>

#include <fstream>
#include <span>
#include <string>
#include <tetwarp/error.hpp>
#include <vector>

#include "io/files/numbered_files.hpp"
#include "io/files/sha256.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
TEST(NumberedFiles, AreInOrderOfTheirNumbers) {
  const ScratchFolder folder;
  for (const char* name : {"s_10.vtu", "s_9.vtu", "s_009.vtu", "s_b.vtu", ".s_1.vtu", "t_1.vtu"}) {
    std::ofstream(folder / name) << "x";
  }
  const std::string pattern = folder / "s_*.vtu";

  EXPECT_TRUE(is_pattern(pattern));
  EXPECT_FALSE(is_pattern(folder / "s_9.vtu"));
  EXPECT_EQ(numbered_files(pattern),
            (std::vector<std::string>{folder / "s_009.vtu", folder / "s_9.vtu", folder / "s_10.vtu",
                                      folder / "s_b.vtu"}));
  EXPECT_EQ(bytes_of_files(pattern), 4);
  EXPECT_THROW(numbered_files(folder / "u_*.vtu"), IoError);
}

TEST(NumberedFiles, AreThoseThatAListNames) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.vtu") << "x";
  std::ofstream(folder / "b.vtu") << "y";
  std::ofstream(folder / "b.vtm") << "<DataSet file='b.vtu'/>";
  std::ofstream(folder / "c.pvd") << R"(<DataSet file="a.vtu"/><DataSet file = "b.vtm"/>)"
                                     R"(<DataSet file="none.vtu"/>)";
  std::ofstream(folder / "d.vtu.series") << R"({"files": [{"name" : "a.vtu"}]})";

  EXPECT_EQ(files_of(folder / "c.pvd"),
            (std::vector<std::string>{folder / "c.pvd", folder / "a.vtu", folder / "b.vtm",
                                      folder / "b.vtu"}));
  EXPECT_EQ(files_of(folder / "d.vtu.series"),
            (std::vector<std::string>{folder / "d.vtu.series", folder / "a.vtu"}));
  EXPECT_EQ(files_of(folder / "a.vtu"), std::vector<std::string>{folder / "a.vtu"});
}

/// Without a newline at the end, with blanks, before samples and far beyond any stack.
TEST(NumberedFiles, AreTheSamplesThatAHeaderNamesHoweverItEnds) {
  const ScratchFolder folder;
  std::ofstream(folder / "x.raw") << "x";
  const std::string meta = "NDims = 3\nElementDataFile = x.raw",
                    nrrd = "NRRD0004\ndata file: x.raw";
  for (const auto& [name, head] : {std::pair{"a.mhd", meta}, {"a.nhdr", nrrd}}) {
    for (const std::string& end :
         {std::string(), std::string("\n"), std::string(" \t\r\n"), std::string(" "),
          std::string(100'000, '\0'), std::string(100'000, ' ')}) {
      std::ofstream(folder / name, std::ios::binary) << head << end;

      EXPECT_EQ(files_of(folder / name),
                (std::vector<std::string>{folder / name, folder / "x.raw"}))
          << name << " and " << end.size() << " letters";
    }
    std::ofstream(folder / name, std::ios::binary) << head << std::string(1 << 20, 'y');
    EXPECT_EQ(files_of(folder / name), std::vector<std::string>{folder / name});
  }
}

TEST(NumberedFiles, OfListsWithEndlessTextsAreThoseBefore) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.vtu") << "x";
  const std::string list = "<DataSet file" + std::string(1 << 20, ' ') + "= 'a.vtu'/>";
  for (const std::string& end : {std::string(), "file='" + std::string(1 << 20, 'y'),
                                 "file='" + std::string(1 << 20, 'y') + "'"}) {
    std::ofstream(folder / "c.pvd") << list << end;

    EXPECT_EQ(files_of(folder / "c.pvd"),
              (std::vector<std::string>{folder / "c.pvd", folder / "a.vtu"}));
  }
}

/// The examples of FIPS 180-4, and a million letters.
TEST(Sha256OfBytes, IsThatOfTheStandard) {
  const auto hash_of = [](const std::string& text, std::size_t part) {
    Sha256 hash;
    for (std::size_t at = 0; at < text.size(); at += part) {
      hash.add(std::as_bytes(std::span(text).subspan(at, std::min(part, text.size() - at))));
    }
    return hash.text();
  };
  EXPECT_EQ(hash_of("", 1), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hash_of("abc", 1), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hash_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 5),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hash_of(std::string(1000000, 'a'), 997),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}
}  // namespace
}  // namespace tetwarp::test
