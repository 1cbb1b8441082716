#include "base/error.h"
#include "formats/csv.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

using namespace faceta;

namespace {

class Csv : public testing::Test {
protected:
  Csv()
      : folder_(std::filesystem::temp_directory_path() /
                ("faceta-csv-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~Csv() override { std::filesystem::remove_all(folder_); }

  /// Doubles the column x; the text of the Error, or of the table that comes out.
  std::string run(const std::string& table) {
    std::filesystem::remove(folder_ / "out.csv");
    std::ofstream(folder_ / "in.csv") << table;
    try {
      transform_csv((folder_ / "in.csv").string(), (folder_ / "out.csv").string(), {{"x", {}}},
                    {{"y", {}}}, [](CsvRows& rows) {
                      for (size_t i = 0; i < rows.input[0].size(); ++i)
                        rows.output[0][i] = 2 * rows.input[0][i];
                    });
    } catch (const Error& error) {
      EXPECT_FALSE(std::filesystem::exists(folder_ / "out.csv"));
      return error.what();
    }
    std::ifstream file(folder_ / "out.csv");
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::filesystem::path folder_;
};

} // namespace

TEST_F(Csv, AddsColumnsAndKeepsTheOthers) {
  EXPECT_EQ(run("name,x\n\"a, \"\"b\"\"\", 1.5\n\nc,+2\n"),
            "name,x,y\n\"a, \"\"b\"\"\", 1.5,3\nc,+2,4\n");
}

// Blocks go through in parallel; whichever fails first, the error nearest to the beginning counts.
TEST_F(Csv, TheFirstErrorOfTheFileIsReported) {
  std::string rows;
  for (int i = 0; i < 150000; ++i)
    rows += "1\n";
  const std::string endless(size_t(3) << 20, '1');
  for (int repeat = 0; repeat < 5; ++repeat) {
    EXPECT_NE(run("x\n" + rows + "bad\n" + rows + "worse\n" + endless).find("in.csv:150002:1: "),
              std::string::npos);
    ASSERT_NE(run("x\n" + rows + endless).find("longer than 1 MiB"), std::string::npos);
  }
}

TEST_F(Csv, HeadersMayHoldManyColumns) {
  std::string header = "x", row = "1";
  for (int i = 0; i < 150000; ++i) {
    header += "," + std::to_string(i);
    row += ",";
  }
  const std::string out = run(header + "\n" + row + "\n");
  EXPECT_EQ(out.substr(out.size() - 4), ",,2\n");
  EXPECT_NE(run(header + ",7\n").find("'7' is there twice"), std::string::npos);
}
