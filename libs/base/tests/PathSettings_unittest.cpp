// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/PathSettings.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
TEST(PathSettings, RelativePathsBecomeAbsolute)
{
  const TestFolder folder;
  folder.write("data/boxes.txt", "");
  folder.write("run/labels/000000.label", "");
  folder.write("mine.safetensors", "");
  fs::create_directories(folder.file("dyseg.safetensors"));  // a folder: the name is a shipped one
  fs::create_directories(folder.file("network"));
  const WorkingFolder within(folder.path());
  const std::string here = fs::current_path().string() + "/";
  Config config;
  config.set("boxes.file=data/../data/boxes.txt");
  config.set("boxes.calib=data/missing.txt");
  config.set("dyseg.labels=run/labels");
  config.set("dyseg.method=network");
  config.set("dyseg_network.weights=dyseg.safetensors");
  config.set("dylo.weights=mine.safetensors");
  makePathsAbsolute(config);
  const auto text = [&config](const std::string& section, const std::string& key)
  { return config.section(section).at(key).text; };
  EXPECT_EQ(text("boxes", "file"), here + "data/boxes.txt");
  EXPECT_EQ(text("boxes", "calib"), "data/missing.txt");
  EXPECT_EQ(text("dyseg", "labels"), here + "run/labels");
  EXPECT_EQ(config.section("dyseg").at("labels").origin, "--set dyseg.labels");
  EXPECT_EQ(text("dyseg", "method"), "network") << "no path";
  EXPECT_EQ(text("dyseg_network", "weights"), "dyseg.safetensors");
  EXPECT_EQ(text("dylo", "weights"), here + "mine.safetensors");

  const std::string before = config.toIni();
  config.set("dyseg.labels=");
  makePathsAbsolute(config);
  EXPECT_EQ(text("dyseg", "labels"), "");
  config.set("dyseg.labels=" + here + "run/labels");
  makePathsAbsolute(config);
  EXPECT_EQ(config.toIni(), before) << "absolute paths stay";
}

TEST(PathSettings, DotsBehindALinkAreKept)
{
  const TestFolder folder;
  folder.write("far/away/inner.txt", "");
  folder.write("far/boxes.txt", "");
  fs::create_directory_symlink(folder.file("far/away"), folder.file("link"));
  EXPECT_TRUE(
      fs::equivalent(absolutePath(folder.file("link/../boxes.txt")), folder.file("far/boxes.txt")));
}

TEST(PathSettings, TwoPathsOfOneFolderAreTheSame)
{
  const TestFolder folder;
  folder.write("run/labels/000000.label", "");
  const std::string labels = folder.file("run/labels");
  fs::create_directory_symlink(folder.file("run"), folder.file("link"));
  EXPECT_TRUE(isSameSetting("dyseg", "labels", labels, labels));
  EXPECT_TRUE(isSameSetting("dyseg", "labels", labels, folder.file("link/labels")));
  EXPECT_FALSE(isSameSetting("dyseg", "labels", labels, folder.file("other/labels")));
  EXPECT_FALSE(isSameSetting("dyseg", "labels", labels, ""));
  EXPECT_FALSE(isSameSetting("input", "sensor_label", labels, folder.file("link/labels")));
  const WorkingFolder within(folder.path());
  const std::string name = "dyseg.safetensors";
  folder.write(name, "");
  EXPECT_FALSE(isSameSetting("dyseg_network", "weights", name, folder.file(name)))
      << "the name is that of the shipped weights";
}

TEST(PathSettings, NamesFilesAndFoldersThatAreThere)
{
  const TestFolder folder;
  const std::string map = folder.write("map.pcd", "");
  const std::string labels = folder.file("run/labels");
  fs::create_directories(labels);
  folder.write("network", "");
  fs::create_directories(folder.file("dyseg.safetensors"));
  const WorkingFolder within(folder.path());
  Config config;
  EXPECT_TRUE(filesNamedIn(config).empty());
  config.set("dyseg.labels=" + labels);
  config.set("prior_map.file=map.pcd");
  config.set("boxes.file=missing.txt");
  config.set("dyseg.method=network");  // no path, although a file has that name
  config.set("dyseg_network.weights=dyseg.safetensors");
  config.set("boxes.calib=");
  EXPECT_EQ(filesNamedIn(config), (std::vector<std::string>{labels, "map.pcd"}));
}

TEST(PathSettings, MessagesAboutNamedFilesBeginWithTheSetting)
{
  for (const char* about :
       {"boxes.calib is of the boxes of boxes.file", "boxes.file: b.txt:1: has 5 fields",
        "dyseg.labels: none: no such folder", "dyseg_network.weights = none: no such file",
        "dylo.weights: x.safetensors: is damaged",
        "prior_map.file: none.pcd: no such file or folder"})
  {
    EXPECT_TRUE(isAboutNamedFile(about)) << about;
  }
  for (const char* other : {"", "prior_map.file", "prior_map.files: is unknown",
                            "prior_map.start: has 5 numbers", "a.rawlog: prior_map.file: x"})
  {
    EXPECT_FALSE(isAboutNamedFile(other)) << other;
  }
}
}  // namespace
}  // namespace dyslam
