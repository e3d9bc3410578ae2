// SPDX-License-Identifier: BSD-3-Clause
// The drives of the splits, and the tables that scripts/split_tables.sh makes from them.
#include <dyslam/base/Error.h>
#include <dyslam/train/DataSplits.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "Benchmark.h"
#include "RunProgram.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;
using sim::NamedRecording;

std::string temporary()
{
  return fs::temp_directory_path().string();
}

TEST(SplitSets, HaveSeedsOfTheirSplitAndNamesOfTheirOwn)
{
  const DataSplits splits = DataSplits::load(
      std::string(DYSLAM_SOURCE_DIR) + "/share/dyslam/config_files/splits.ini", "");
  std::set<std::string> names;
  std::set<int> seeds;
  for (const Split split : {Split::validation, Split::test})
  {
    const std::vector<NamedRecording> set = sim::splitSet("d", toString(split));
    EXPECT_EQ(set.size(), 11U);
    for (const NamedRecording& one : set)
    {
      const sim::SimulatorOptions& o = one.recording.simulator;
      EXPECT_EQ(splits.splitOfSeed(o.seed), split) << one.name;
      EXPECT_LT(o.traffic_seed, 0) << one.name;
      EXPECT_TRUE(names.insert(one.name).second) << one.name;
      EXPECT_TRUE(seeds.insert(o.seed).second) << one.name;
      EXPECT_EQ(one.name.rfind(toString(split) + "_", 0), 0U) << one.name;
      EXPECT_EQ(one.recording.output, "d/" + one.name + ".rawlog");
    }
  }
  for (const NamedRecording& one : sim::standingSet("d"))
  {
    EXPECT_EQ(splits.splitOfSeed(one.recording.simulator.seed), Split::validation) << one.name;
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
  }
  EXPECT_THROW((void)sim::splitSet("d", "training"), UserError);
}

/** Choices by validation hold for test, because the drives of both differ only in their seeds. */
TEST(SplitSets, AreOfTheSameKinds)
{
  const std::vector<NamedRecording> validation = sim::splitSet("d", "validation");
  const std::vector<NamedRecording> test = sim::splitSet("d", "test");
  ASSERT_EQ(validation.size(), test.size());
  std::map<sim::SensorKind, int> sensors;
  for (std::size_t i = 0; i < test.size(); ++i)
  {
    sim::SimulatorOptions other = validation[i].recording.simulator;
    other.seed = test[i].recording.simulator.seed;
    Config a;
    Config b;
    save(other, a, "simulator");
    save(test[i].recording.simulator, b, "simulator");
    EXPECT_EQ(a.toIni(), b.toIni()) << test[i].name;
    EXPECT_EQ(validation[i].recording.seconds, test[i].recording.seconds);
    EXPECT_EQ(validation[i].recording.one_loop, test[i].recording.one_loop);
    EXPECT_EQ(validation[i].recording.least_distance, test[i].recording.least_distance);
    EXPECT_TRUE(test[i].recording.one_loop || test[i].recording.least_distance >= 100)
        << "the shortest segment of t_rel";
    ++sensors[other.sensor];
  }
  EXPECT_EQ(sensors[sim::SensorKind::hdl64e], 9);
  EXPECT_EQ(sensors.size(), 3U);
}

std::vector<std::string> cellsOf(const std::string& row)
{
  std::vector<std::string> cells;
  std::istringstream text(row.substr(1));
  for (std::string cell; std::getline(text, cell, '|');)
  {
    cell.erase(0, cell.find_first_not_of(" *"));
    cell.erase(cell.find_last_not_of(" *") + 1);
    cells.push_back(cell);
  }
  return cells;
}

/** The rows of the table whose header row contains `heading`, by their first cell; "" is the header
 * row. */
std::map<std::string, std::vector<std::string>> tableWith(const std::string& heading,
                                                          const std::string& markdown)
{
  std::map<std::string, std::vector<std::string>> rows;
  std::istringstream text(markdown);
  for (std::string line; std::getline(text, line);)
  {
    const bool is_row = !line.empty() && line[0] == '|';
    if (!is_row && !rows.empty())
    {
      break;
    }
    if (is_row && (!rows.empty() || line.find(heading) != std::string::npos))
    {
      const std::vector<std::string> cells = cellsOf(line);
      rows[rows.empty() ? "" : cells[0]] = cells;
    }
  }
  return rows;
}

/** Expects that the row of means has the means of the rows of both drives. */
void expectMean(const std::map<std::string, std::vector<std::string>>& table, double rounding)
{
  ASSERT_EQ(table.count("mean of 2"), 1U);
  const std::vector<std::string>& mean = table.at("mean of 2");
  for (std::size_t i = 1; i < mean.size(); ++i)
  {
    const double a = std::stod(table.at("validation_07")[i]);
    const double b = std::stod(table.at("validation_09")[i]);
    EXPECT_NEAR(std::stod(mean[i]), (a + b) / 2, rounding) << table.at("")[i];
  }
}

class SplitTables : public testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder = temporary() + "/split_tables";
    fs::create_directories(folder);
    result = make("");
  }
  static Outcome make(const std::string& more)
  {
    const std::string out = folder + "/stdout.txt";
    const std::string err = folder + "/stderr.txt";
    const int status = std::system(
        ("DYSLAM_BIN='" + std::string(DYSLAM_BIN_DIR) + "' " + DYSLAM_SOURCE_DIR +
         "/scripts/split_tables.sh -k '07 09' -t 2 -l 1,2 -m 'dyslam network causal dylo "
         "icp_po2pl' -o " +
         folder + "/tables " + more + " > " + out + " 2> " + err)
            .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contentOf(out), contentOf(err)};
  }
  static inline std::string folder;
  static inline Outcome result;
};

TEST_F(SplitTables, OfTwoShortDrivesOfValidation)
{
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, contentOf(folder + "/tables/tables.md"));
  EXPECT_EQ(result.out.rfind("Split: validation.", 0), 0U) << result.out;

  const auto drives = tableWith("| seed |", result.out);
  ASSERT_EQ(drives.size(), 4U) << result.out;  // heading, line, two drives
  EXPECT_EQ(drives.at("validation_07")[4], "900000008");
  EXPECT_EQ(drives.at("validation_09")[1], "campus");
  EXPECT_EQ(drives.at("validation_09")[5], "20");

  const auto odometry = tableWith("DyLO t_rel", result.out);
  const std::vector<std::string> columns{"drive",          "DySLAM t_rel", "DySLAM r_rel",
                                         "DyLO t_rel",     "DyLO r_rel",   "ICP-po2pl t_rel",
                                         "ICP-po2pl r_rel"};
  EXPECT_EQ(odometry.at(""), columns);
  EXPECT_EQ(odometry.size(), 5U) << "heading, line, two drives and their mean: none of the paper";
  const auto paper = tableWith("| method, in the paper |", result.out);
  ASSERT_EQ(paper.size(), 4U) << "heading, line, DyLO and ICP-po2pl";
  EXPECT_EQ(paper.at("DyLO")[1], "1.27");
  EXPECT_EQ(paper.at("ICP-po2pl")[2], "1.93");
  expectMean(odometry, 0.0101);
  EXPECT_LT(std::stod(odometry.at("mean of 2")[1]), 5);

  expectMean(tableWith("odometry ATE", result.out), 0.00101);
  const auto moving = tableWith("hindsight IoU", result.out);
  expectMean(moving, 0.00101);
  EXPECT_EQ(moving.at("").size(), 10U);
  EXPECT_GT(std::stod(moving.at("all points")[7]), 0.1);

  const auto times = tableWith("pose estimation", result.out);
  EXPECT_EQ(times.at("DyLO").back(), "40");
  EXPECT_GT(std::stod(times.at("DyLO")[3]), 0);
  EXPECT_EQ(times.at("the paper: DyLO")[5], "86");
}

TEST_F(SplitTables, WhatIsThereIsNotMadeAgain)
{
  ASSERT_EQ(result.code, 0) << result.err;
  const fs::path run = folder + "/tables/runs/validation_07/dylo/report.json";
  const fs::path rawlog = folder + "/tables/drives/validation_07.rawlog";
  const auto run_time = fs::last_write_time(run);
  const auto rawlog_time = fs::last_write_time(rawlog);
  const Outcome again = make("");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out, result.out);
  EXPECT_EQ(fs::last_write_time(run), run_time);
  EXPECT_EQ(fs::last_write_time(rawlog), rawlog_time);
}

TEST_F(SplitTables, StateTheSegmentLengthsAsGiven)
{
  ASSERT_EQ(result.code, 0) << result.err;
  const Outcome tables =
      runProgram("dyslam-eval", "tables " + folder + "/tables/runs --lengths 1.5,2", folder);
  EXPECT_NE(tables.out.find("segments of 1.5, 2 m"), std::string::npos) << tables.out;
}

TEST_F(SplitTables, NameTheSplitOfARun)
{
  ASSERT_EQ(result.code, 0) << result.err;
  const Outcome run =
      runProgram("dyslam-eval", "run " + folder + "/tables/runs/validation_09/dyslam", folder);
  EXPECT_NE(run.out.find("dyslam: seed 900000010 of the simulator, validation"), std::string::npos)
      << run.out;
}

TEST_F(SplitTables, AreWithoutARunThatCannotBeRead)
{
  ASSERT_EQ(result.code, 0) << result.err;
  const std::string runs = folder + "/tables/runs";
  fs::create_directories(runs + "/validation_09/gicp");
  const Outcome tables = runProgram("dyslam-eval", "tables " + runs + " --lengths 1,2", folder);
  EXPECT_EQ(tables.code, 1);
  EXPECT_EQ(tables.out, result.out);
  EXPECT_NE(tables.err.find("note: " + runs + "/validation_09/gicp: not evaluated: "),
            std::string::npos)
      << tables.err;
  EXPECT_NE(tables.err.find("the tables are without 1 run that cannot be read: " + runs +
                            "/validation_09/gicp\n"),
            std::string::npos)
      << tables.err;
  fs::remove(runs + "/validation_09/gicp");
}

TEST_F(SplitTables, SayWhatIsWrong)
{
  const Outcome split = make("-s training");
  EXPECT_NE(split.code, 0);
  EXPECT_NE(split.err.find("unknown split 'training' (one of: validation, test)"),
            std::string::npos)
      << split.err;
  fs::create_directories(folder + "/empty/a");
  const Outcome empty = runProgram("dyslam-eval", "tables " + folder + "/empty", folder);
  EXPECT_EQ(empty.code, 1);
  EXPECT_NE(empty.err.find("split_tables.sh"), std::string::npos) << empty.err;
  const Outcome heading =
      runProgram("dyslam-eval", "tables " + folder + " --odometry DyLO", folder);
  EXPECT_EQ(heading.code, 1);
  EXPECT_NE(heading.err.find("HEADING=FOLDER"), std::string::npos) << heading.err;
}
}  // namespace
}  // namespace dyslam
