// SPDX-License-Identifier: BSD-3-Clause
// Users read the help texts one at a time, in effective.ini.
#include "HelpTexts.h"

#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/backend/RunMerger.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/io/KittiConverter.h>
#include <dyslam/io/KittiExport.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/io/ScanConverter.h>
#include <dyslam/mapexport/MapExport.h>
#include <dyslam/packets/PcapSource.h>
#include <dyslam/run/GivenSettings.h>
#include <dyslam/run/KnownSettings.h>
#include <dyslam/run/SlamRun.h>
#include <dyslam/tracking/DetectionNoise.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
const std::vector<std::string> no_lines;

/** The effective.ini of a run with default settings. */
std::string effectiveIniOfARun(const TestFolder& folder)
{
  SlamRunSettings settings;
  settings.rawlog = folder.file("drive.rawlog");  // is not opened
  settings.output_folder = folder.file("run");
  SlamRun run(settings);
  run.open();
  return folder.file("run/effective.ini");
}

TEST(HelpTexts, ThoseOfARunReadAlone)
{
  const TestFolder folder;
  const std::string effective = readWhole(effectiveIniOfARun(folder));
  for (const char* section : {"[sensor]", "[odometry]", "[dylo]", "[dyseg_network]", "[tracker]",
                              "[loop]", "[map]", "[output]", "[replay]"})
  {
    EXPECT_TRUE(contains(effective, section)) << section;
  }
  EXPECT_EQ(no_lines, unclearHelpTexts(effective));
}

TEST(Defaults, ThoseOfARunAreRoundNumbers)
{
  const TestFolder folder;
  EXPECT_EQ(no_lines, longNumbers(readWhole(effectiveIniOfARun(folder))));
}

/** dyslam-map refuses other sections in an ini. */
TEST(KnownSettings, TheSectionsOfEffectiveIniAreKnown)
{
  const TestFolder folder;
  std::vector<std::string> names = Config::fromFile(effectiveIniOfARun(folder)).sectionNames();
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, sectionsOfRun());
}

TEST(KnownSettings, NamesOfSettingsAreCheckedWithoutARecording)
{
  const TestFolder folder;
  Config config = Config::fromFile(effectiveIniOfARun(folder));
  config.set("map.voxel_size=20cm");  // requireValid() checks values
  EXPECT_NO_THROW(requireKnownNames(config));
  const auto message = [](const std::string& assignment)
  {
    Config mistyped;
    mistyped.set(assignment);
    return messageOfError<UserError>([&] { requireKnownNames(mistyped); });
  };
  EXPECT_TRUE(contains(message("map.voxel_sise=0.1"), "did you mean 'voxel_size'?"));
  EXPECT_TRUE(contains(message("mapp.voxel_size=0.1"), "unknown section 'mapp'"));
  EXPECT_TRUE(contains(message("input.keyframe_distance=1"),
                       "is a key of [backend]: --set backend.keyframe_distance=1"));
  EXPECT_EQ("--set map_export.epsg: the section [map_export] belongs to dyslam-map",
            message("map_export.epsg=1"));
  EXPECT_EQ("--set train.x: the section [train] belongs to dyslam-train", message("train.x=1"));
  for (const std::string& section : sectionsOfRun())
  {
    EXPECT_EQ("dyslam", programOfSection(section))
        << "add [" << section << "] to sections_of_dyslam in libs/base/src/Config.cpp";
  }
}

TEST(KnownSettings, ValuesOfSettingsAreCheckedWithoutARecording)
{
  const TestFolder folder;
  using Assignments = std::vector<std::string>;
  const auto check = [](const Assignments& assignments, const std::string& ini = "")
  { requireValidSettings(readGivenSettings(ini, assignments)); };
  const auto message = [&check](const Assignments& assignments, const std::string& ini = "")
  { return messageOfError<UserError>([&] { check(assignments, ini); }); };
  const Assignments levelled_by_hand = {"input.level=false", "input.pitch_deg=12"};
  EXPECT_NO_THROW(check({}));
  EXPECT_NO_THROW(check(levelled_by_hand));
  EXPECT_NO_THROW(check({}, effectiveIniOfARun(folder)));
  EXPECT_EQ("--set map.voxel_size: [map] voxel_size = abc is not a number",
            message({"map.voxel_size=abc"}));
  EXPECT_TRUE(contains(message({"map.voxel_size=-1"}), "is out of range"));
  EXPECT_TRUE(contains(message({"dyseg.method=nonsense"}), "unknown value 'nonsense'"));
  EXPECT_TRUE(contains(message({"mapp.voxel_size=1"}), "unknown section 'mapp'"));
  EXPECT_TRUE(contains(message({"input.pitch_deg=12"}), "add level = false"));
  EXPECT_TRUE(contains(message({"prior_map.file=" + folder.file("no.pcd")}), "no such file"));
  const std::string ini = folder.write("my.ini", "[tracker]\n\n[labels]\nhindsight = perhaps\n");
  EXPECT_TRUE(contains(message({}, ini), "my.ini:4: [labels] hindsight"));
}

/** solid_state.ini has no network: a run with it does not read the file. */
TEST(KnownSettings, ValuesThatARunWithSomeSensorAcceptsAreValid)
{
  const auto check = [](const std::vector<std::string>& assignments)
  { requireValidSettings(readGivenSettings("", assignments)); };
  EXPECT_NO_THROW(check({"dyseg_network.weights=missing"}));
  EXPECT_THROW(check({"dyseg_network.weights=missing", "dyseg.method=network"}), UserError);
}

TEST(KnownSettings, SectionsOfTheTrainingInisBelongToTheirProgram)
{
  for (const std::string name : {"dylo", "dylo_simulated", "dyseg", "dyseg_simulated"})
  {
    const Config ini = Config::fromFile(
        findGivenOrShared("train_" + name + ".ini", "config_files", ".ini", "", "dyslam-train"));
    for (const std::string& section : ini.sectionNames())
    {
      EXPECT_EQ(0U, programOfSection(section).rfind("dyslam-train", 0)) << name << ": " << section;
    }
  }
}

/** The options of the other programs, with their defaults. */
std::string effectiveIniOfOtherPrograms()
{
  Config config;
  save(MapExportOptions(), config, "map_export");
  save(RunMergerOptions(), config, "merge");
  save(PoseGraphSolverOptions(), config, "solver");
  save(DetectionNoiseOptions(), config, "detection_noise");
  save(KittiConverterOptions(), config, "kitti_converter");
  save(ScanConverterOptions(), config, "scan_converter");
  save(KittiExportOptions(), config, "kitti_export");
  save(PcapSourceOptions(), config, "pcap");
  save(RawlogWriterOptions(), config, "rawlog_writer");
  return config.toIni();
}

TEST(HelpTexts, ThoseOfOtherProgramsReadAlone)
{
  EXPECT_EQ(no_lines, unclearHelpTexts(effectiveIniOfOtherPrograms()));
}

TEST(Defaults, ThoseOfOtherProgramsAreRoundNumbers)
{
  EXPECT_EQ(no_lines, longNumbers(effectiveIniOfOtherPrograms()));
}

TEST(Defaults, LongNumbersAreFound)
{
  EXPECT_EQ(no_lines,
            longNumbers("[a]\nx = 0.0012  // size\ny = 1073741823  // seed\nz = 1e-06  // bound\n"
                        "w = 12345_run  // name\nv =   // name\nu = true  // switch\n"
                        "t = 1.234\n"));
  for (const char* line : {"x = 0.300000702  // size [deg]", "x = 57.295779513",
                           "x = -1234.5  // n", "x = 1.2345e-07  // bound"})
  {
    EXPECT_EQ(std::vector<std::string>{std::string("[a] ") + line},
              longNumbers(std::string("[a]\n") + line + "\n"));
  }
}

TEST(HelpTexts, UnclearOnesAreFound)
{
  EXPECT_EQ(no_lines,
            unclearHelpTexts("[a]\nx = 1  // size of a cell [m]\n\n[b]\n"
                             "x = 1  // size of a cell [m]\ny = no  // cells: use (yes, no)\n"));
  const std::vector<std::string> bad{
      "x = 1",
      "x = 1  // ",
      "x = 1  //  (yes, no)",
      "x = 1  // ... and of its rotation",
      "x = 1  // its increase",
      "x = 1  // their rmse",
      "x = 1  // the same of rotations",
      "x = 1  // of the prior [m]",
      "x = 1  // vehicles: its increase",
      "y = 2  // size of a cell [m]",
  };
  for (const std::string& line : bad)
  {
    const std::vector<std::string> found =
        unclearHelpTexts("[a]\nx = 1  // size of a cell [m]\n" + line + "\n");
    EXPECT_EQ(std::vector<std::string>{"[a] " + line}, found);
  }
}
}  // namespace
}  // namespace dyslam
