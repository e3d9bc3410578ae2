// SPDX-License-Identifier: BSD-3-Clause
// The commands in README and doc: the commands of the user guide run, the flags of all others
// exist.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "RunProgram.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

const std::array<const char*, 11> programs{
    "dyslam",       "dyslam-batch", "dyslam-eval",  "dyslam-graphslam", "dyslam-map",  "dyslam-sim",
    "dyslam-train", "kitti2rawlog", "scans2rawlog", "rawlog2bag",       "rawlog2kitti"};

std::string temporary()
{
  return fs::temp_directory_path().string();
}

std::string joined(std::string text)
{
  for (std::size_t at = 0; (at = text.find("\\\n", at)) != std::string::npos;)
  {
    text.replace(at, 2, " ");
  }
  return text;
}

/** Lines of the code blocks, fenced or indented; a command on several lines is joined to one. */
std::vector<std::string> codeLines(const fs::path& page)
{
  std::vector<std::string> lines;
  std::istringstream text(joined(contentOf(page)));
  bool fenced = false;
  for (std::string line; std::getline(text, line);)
  {
    if (line.rfind("```", 0) == 0)
    {
      fenced = !fenced;
    }
    else if (fenced || line.rfind("    ", 0) == 0)
    {
      lines.push_back(line);
    }
  }
  return lines;
}

/** The words of a command, from the program on; empty if the line runs no program of DySLAM. */
std::vector<std::string> commandOf(const std::string& line)
{
  std::istringstream text(line);
  std::vector<std::string> words;
  for (std::string word; text >> word && word[0] != '#' && word != "|" && word != "&&";)
  {
    if (words.empty())
    {
      word = fs::path(word).filename().string();
      const bool known = std::find(programs.begin(), programs.end(), word) != programs.end();
      if (!known && word != "$")
      {
        return {};
      }
      if (!known)
      {
        continue;
      }
    }
    words.push_back(word);
  }
  return words;
}

/** Output of `--help`, of the subcommand if there is one. */
const std::string& helpOf(const std::vector<std::string>& command,
                          std::map<std::string, std::string>& known)
{
  const bool has_subcommands = command[0] == "dyslam-eval" || command[0] == "dyslam-train";
  const std::string subcommand =
      has_subcommands && command.size() > 1 && std::isalpha(command[1][0]) != 0 ? command[1] : "";
  const auto [entry, is_new] = known.emplace(command[0] + ' ' + subcommand, "");
  if (is_new)
  {
    const Outcome outcome = runProgram(command[0], subcommand + " --help", temporary());
    EXPECT_EQ(outcome.code, 0) << entry->first << outcome.err;
    entry->second = outcome.out;
  }
  return entry->second;
}

TEST(PublishedCommands, HaveFlagsThatExist)
{
  std::vector<fs::path> pages{fs::path(DYSLAM_SOURCE_DIR) / "README.md",
                              fs::path(DYSLAM_SOURCE_DIR) / "rawlog" / "README.md"};
  for (const auto& entry : fs::directory_iterator(fs::path(DYSLAM_SOURCE_DIR) / "doc"))
  {
    if (entry.path().extension() == ".md")
    {
      pages.push_back(entry.path());
    }
  }
  std::map<std::string, std::string> helps;
  std::size_t flags = 0;
  for (const fs::path& page : pages)
  {
    for (const std::string& line : codeLines(page))
    {
      const std::vector<std::string> command = commandOf(line);
      if (command.empty() || !fs::exists(fs::path(DYSLAM_BIN_DIR) / command[0]))
      {
        continue;
      }
      for (std::size_t i = 1; i < command.size(); ++i)
      {
        std::smatch flag;
        const std::regex pattern("^(--?[a-zA-Z][a-z0-9-]*)");
        if (!std::regex_search(command[i], flag, pattern))
        {
          continue;
        }
        ++flags;
        const std::regex in_help("(^|[\\s,])" + flag.str(1) + "($|[\\s,=])");
        EXPECT_TRUE(std::regex_search(helpOf(command, helps), in_help))
            << page << ": " << line << "\n  " << flag.str(1);
      }
    }
  }
  EXPECT_GT(flags, 100U);
}

/** The code blocks of the guide that are marked to be run, in order, with the first scans of each
 * recording. */
TEST(PublishedCommands, OfTheGuideRun)
{
  const fs::path folder = fs::path(temporary()) / "guide";
  fs::create_directories(folder);
  fs::create_symlink(fs::path(DYSLAM_SOURCE_DIR) / "rawlog", folder / "rawlog");
  const std::string page = contentOf(fs::path(DYSLAM_SOURCE_DIR) / "doc" / "guide.md");
  const std::string mark = "<!-- run -->\n```\n";
  std::string script = "set -euo pipefail\ncd '" + folder.string() + "'\n";
  std::size_t blocks = 0;
  for (std::size_t at = 0; (at = page.find(mark, at)) != std::string::npos; ++blocks)
  {
    at += mark.size();
    script += page.substr(at, page.find("```", at) - at);
  }
  ASSERT_GT(blocks, 6U);
  const std::string assignment = "bin=build/release/bin";
  ASSERT_NE(script.find(assignment), std::string::npos);
  script.replace(script.find(assignment), assignment.size(),
                 "bin='" + std::string(DYSLAM_BIN_DIR) + "'");
  script = std::regex_replace(script, std::regex(R"(\$bin/dyslam (?!.*--only-first-n))"),
                              "$$bin/dyslam --only-first-n 20 ");
  std::ofstream(folder / "guide.sh") << script;
  const std::string log = (folder / "log.txt").string();
  const int status =
      std::system(("bash '" + (folder / "guide.sh").string() + "' > '" + log + "' 2>&1").c_str());
  EXPECT_EQ(status, 0) << contentOf(log);
  for (const char* made : {"out/guide/report.html", "out/guide/map.png", "out/guide/clean.pcd",
                           "out/guide/grid.png", "out/guide/grid.yaml", "out/guide/clean.simplemap",
                           "out/static/static_scans.rawlog", "out/tuned/report.json",
                           "out/simulated.rawlog", "out/batch/index.html", "out/batch/table.csv"})
  {
    EXPECT_TRUE(fs::exists(folder / made)) << made;
  }
}

/** The column of the entropies in the table of `map --self`. */
std::vector<double> entropiesIn(const fs::path& csv)
{
  std::istringstream rows(contentOf(csv));
  std::string row;
  std::getline(rows, row);
  std::vector<double> entropies;
  while (std::getline(rows, row))
  {
    for (int comma = 0; comma < 3; ++comma)
    {
      row.erase(0, row.find(',') + 1);
    }
    entropies.push_back(std::stod(row));
  }
  return entropies;
}

/** `map --self`: the ground truth gives a sharper map than noisy poses. */
TEST(MapSelf, TellsAGoodTrajectoryFromABadOne)
{
  const std::string street = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/street64";
  const fs::path folder = temporary();
  std::istringstream truth(contentOf(street + ".gt/poses_tum.txt"));
  std::ofstream shaken(folder / "shaken.txt");
  std::size_t number = 0;
  for (std::string line; std::getline(truth, line);)
  {
    std::istringstream fields(line);
    std::string stamp;
    double x = 0;
    if (line[0] != '#' && fields >> stamp >> x)
    {
      std::string rest;
      std::getline(fields, rest);
      shaken << stamp << ' ' << x + (++number % 2 == 0 ? 0.1 : -0.1) << rest << '\n';
    }
  }
  shaken.close();
  const Outcome outcome =
      runProgram("dyslam-eval",
                 "map --self " + street + ".rawlog --only-first-n 20 --points 3000 --estimate " +
                     street + ".gt/poses_tum.txt " + (folder / "shaken.txt").string() + " --csv " +
                     (folder / "self.csv").string(),
                 folder.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<double> entropy = entropiesIn(folder / "self.csv");
  ASSERT_EQ(entropy.size(), 2U);
  EXPECT_LT(entropy[0] + 0.1, entropy[1]);
}

TEST(MapSelf, ATrajectoryMayHaveAnotherClock)
{
  const std::string street = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/street64";
  const fs::path folder = temporary();
  std::istringstream truth(contentOf(street + ".gt/poses_tum.txt"));
  std::ofstream from_start(folder / "from_start.txt");
  const std::string start = "1700000000";
  for (std::string line; std::getline(truth, line);)
  {
    if (line.rfind(start, 0) == 0)
    {
      from_start << '0' << line.substr(start.size()) << '\n';
    }
  }
  from_start.close();
  const std::string both = street + ".gt/poses_tum.txt " + (folder / "from_start.txt").string();
  const std::string self =
      "map --self " + street + ".rawlog --only-first-n 5 --points 500 --estimate ";
  const Outcome outcome = runProgram(
      "dyslam-eval",
      self + both + " --time-offset 0 " + start + " --csv " + (folder / "clocks.csv").string(),
      folder.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<double> entropy = entropiesIn(folder / "clocks.csv");
  ASSERT_EQ(entropy.size(), 2U);
  EXPECT_NEAR(entropy[0], entropy[1], 1e-3);
  const Outcome without = runProgram("dyslam-eval", self + both, folder.string());
  EXPECT_EQ(without.code, 1);
  EXPECT_NE(without.err.find("another clock: --time-offset"), std::string::npos) << without.err;
}

TEST(MapSelf, SaysWhatCannotBeCompared)
{
  const std::string street = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/street64";
  const fs::path folder = temporary();
  const std::string elsewhen = (folder / "elsewhen.txt").string();
  std::ofstream(elsewhen) << "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n";
  const Outcome other = runProgram(
      "dyslam-eval", "map --self " + street + ".rawlog --only-first-n 3 --estimate " + elsewhen,
      folder.string());
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.err.find("has a pose in every trajectory"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("elsewhen.txt: 1.000 to 2.000 s"), std::string::npos) << other.err;

  std::ofstream(folder / "kitti.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const Outcome kitti = runProgram("dyslam-eval",
                                   "map --self " + street + ".rawlog --only-first-n 3 --estimate " +
                                       (folder / "kitti.txt").string(),
                                   folder.string());
  EXPECT_EQ(kitti.code, 1);
  EXPECT_NE(kitti.err.find("has 1 pose, but 3 scans"), std::string::npos) << kitti.err;
  const Outcome clock = runProgram(
      "dyslam-eval",
      "map --self x.rawlog --time-offset 1 --estimate " + (folder / "kitti.txt").string(),
      folder.string());
  EXPECT_EQ(clock.code, 1);
  EXPECT_NE(clock.err.find("kitti.txt: has no time stamps; --time-offset"), std::string::npos)
      << clock.err;

  const Outcome neither = runProgram("dyslam-eval", "map --estimate " + elsewhen, folder.string());
  EXPECT_EQ(neither.code, 1);
  EXPECT_NE(neither.err.find("--self RAWLOG"), std::string::npos) << neither.err;
}
}  // namespace
}  // namespace dyslam
