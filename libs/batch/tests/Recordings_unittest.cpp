// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/batch/Recordings.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam::batch
{
namespace
{
std::vector<std::string> namesOf(const std::vector<Recording>& recordings)
{
  std::vector<std::string> names;
  for (const Recording& r : recordings)
  {
    names.push_back(r.name);
  }
  return names;
}
}  // namespace

TEST(Recordings, AreFilesFoldersPatternsAndLists)
{
  const TestFolder folder;
  folder.write("one/b.rawlog", "12");
  folder.write("one/a.rawlog", "1");
  folder.write("one/deep/c.rawlog", "");
  folder.write("one/a.gt/poses_tum.txt", "");
  folder.write("two/x1.rawlog", "");
  folder.write("two/x2.rawlog", "");
  folder.write("two/y.rawlog", "");
  folder.write("list.txt", "# all\n\n  two/x?.rawlog # two\none\ninner.txt\r\n");
  folder.write("inner.txt", "two/y.rawlog\ntwo/x1.rawlog\n");

  const auto listed = listRecordings({folder.file("list.txt"), folder.file("one/a.rawlog")});
  EXPECT_EQ(namesOf(listed), (std::vector<std::string>{"x1", "x2", "a", "b", "c", "y"}));
  EXPECT_EQ(listed[3].bytes, 2U);
  EXPECT_EQ(listed[0].path, folder.file("two/x1.rawlog"));
  folder.write("windows.txt", "\xEF\xBB\xBFone/b.rawlog\r\n");
  EXPECT_EQ(namesOf(listRecordings({folder.file("windows.txt")})), std::vector<std::string>{"b"});
}

TEST(Recordings, AreOnADiskWithLostAndFound)
{
  const TestFolder folder;
  folder.write("disk/lost+found/a.rawlog", "");
  folder.write("disk/b.rawlog", "");
  folder.write("elsewhere/c.rawlog", "");
  std::filesystem::create_directory_symlink(folder.file("elsewhere"), folder.file("disk/link"));
  EXPECT_EQ(namesOf(listRecordings({folder.file("disk")})), std::vector<std::string>{"b"});
}

TEST(Recordings, AreAllThatDyslamConverts)
{
  const TestFolder folder;
  folder.write("all/a.rawlog", "");
  folder.write("all/a_Images/0.bin", "");  // external file of the rawlog
  folder.write("all/a.gt/flow/000000.bin", "");
  folder.write("all/b.bag", "123");
  folder.write("all/._b.bag", "of macOS");
  folder.write("all/c/c_0.mcap", "12");
  folder.write("all/c/metadata.yaml", "345");
  folder.write("all/d.pcap", "");
  folder.write("all/e/one.mcap", "");  // no bag of ROS 2: a folder of bags
  folder.write("all/day/2011_drive_sync/velodyne_points/data/0000000000.bin", "");
  folder.write("all/map/map.pcd", "");
  folder.write("all/notes.txt", "");
  const auto listed = listRecordings({folder.file("all")});
  EXPECT_EQ(namesOf(listed),
            (std::vector<std::string>{"a", "b", "c", "d", "2011_drive_sync", "one"}));
  EXPECT_EQ(listed[1].bytes, 3U);
  EXPECT_EQ(listed[2].bytes, 5U) << "all files of the folder";
  EXPECT_EQ(listed[2].path, folder.file("all/c"));
  // A folder with one point cloud is a recording only if it is named.
  EXPECT_EQ(namesOf(listRecordings({folder.file("all/map/")})), std::vector<std::string>{"map"});
  folder.write("clouds/one/0.pcd", "");
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { (void)listRecordings({folder.file("clouds")}); }),
               "any other folder of point clouds must be named itself"));
  folder.write("all/map.ply", "");
  EXPECT_EQ(listRecordings({folder.file("all")}).size(), listed.size()) << "a cloud beside them";
}

TEST(Recordings, AreFoldersOfSeveralCloudsDirectlyInAFolder)
{
  const TestFolder folder;
  std::vector<std::string> notes;
  const auto listed = [&](const std::string& name)
  {
    notes.clear();
    return namesOf(listRecordings({folder.file(name)},
                                  [&notes](const std::string& note) { notes.push_back(note); }));
  };
  for (const std::string name : {"all/scans/0.bin", "all/scans/1.bin", "all/ply/0.ply",
                                 "all/ply/1.ply", "all/b.bag", "all/a.rawlog"})
  {
    folder.write(name, "");
  }
  EXPECT_EQ(listed("all"), (std::vector<std::string>{"a", "b", "ply", "scans"}));
  EXPECT_TRUE(notes.empty());

  for (const std::string name :
       {"all/a_Images/0.bin", "all/a_Images/1.bin", "all/a.gt/flow/0.bin", "all/a.gt/flow/1.bin",
        "all/map/map.pcd", "all/day/scans/0.pcd", "all/day/scans/1.pcd", "all/mixed/0.ply",
        "all/mixed/1.ply", "all/mixed/c.bag", "all/run/report.json"})
  {
    folder.write(name, "");
  }
  EXPECT_EQ(listed("all"), (std::vector<std::string>{"a", "b", "c", "ply", "scans"}));
  ASSERT_EQ(1U, notes.size());
  EXPECT_TRUE(contains(notes[0], "all: left out: 3 folders of point clouds (")) << notes[0];
  EXPECT_TRUE(contains(notes[0], "name those that are recordings), 1 output folder of runs"));

  // A folder of scans is one recording, whatever folders of clouds are in it.
  folder.write("all/scans/more/0.bin", "");
  folder.write("all/scans/more/1.bin", "");
  EXPECT_EQ(listed("all/scans"), std::vector<std::string>{"scans"});
  EXPECT_TRUE(notes.empty());
}

TEST(Recordings, HaveNoNamesOfTheBatchsOwnFiles)
{
  const TestFolder folder;
  folder.write("monday/index.html.rawlog", "");
  folder.write("monday/batch.json.bag", "");
  folder.write("monday/drive.rawlog", "");
  std::vector<std::string> notes;
  EXPECT_EQ(namesOf(listRecordings({folder.file("monday")},
                                   [&notes](const std::string& note) { notes.push_back(note); })),
            (std::vector<std::string>{"monday_batch.json", "drive", "monday_index.html"}));
  ASSERT_EQ(2U, notes.size());
  EXPECT_EQ(folder.file("monday/index.html.rawlog") +
                ": its results are in monday_index.html, as index.html is a name that the batch "
                "uses itself",
            notes[1]);
}

TEST(Recordings, ResultsOfRunsAreNone)
{
  const TestFolder folder;
  folder.write("drives/a.rawlog", "");
  folder.write("drives/out/a/report.json", "{}");
  folder.write("drives/out/a/replay.rawlog", "");
  folder.write("drives/out/b/manifest.json", "{}");
  folder.write("drives/out/b/static_scans.rawlog", "");
  EXPECT_EQ(namesOf(listRecordings({folder.file("drives")})), std::vector<std::string>{"a"});
  EXPECT_THROW((void)listRecordings({folder.file("drives/out/a")}), UserError);
  folder.write("drives/out/a/map_static.ply", "");
  EXPECT_THROW((void)listRecordings({folder.file("drives/out/a")}), UserError) << "its map";
  EXPECT_EQ(listRecordings({folder.file("drives/out/a/replay.rawlog")}).size(), 1U) << "if named";
}

TEST(Recordings, OfOneNameAreToldApartByTheirFolders)
{
  const TestFolder folder;
  const std::vector<std::string> files{
      folder.write("mon/drive.rawlog", ""), folder.write("tue/drive.rawlog", ""),
      folder.write("a/tue/drive.rawlog", ""), folder.write("b/other.rawlog", "")};
  const auto names = namesOf(listRecordings(files));
  EXPECT_EQ(names[0], "mon_drive");
  EXPECT_NE(names[1], names[2]);
  EXPECT_EQ(names[2], "a_tue_drive");
  EXPECT_EQ(names[3], "other");
}

TEST(Recordings, SayWhatIsMissing)
{
  const TestFolder folder;
  folder.write("empty/readme.md", "");
  folder.write("circle.txt", "circle.txt\n");
  const auto message = [](const std::string& entry)
  { return messageOfError<UserError>([&] { (void)listRecordings({entry}); }); };
  EXPECT_TRUE(contains(message(folder.file("none.rawlog")), "none.rawlog: no such file"));
  const std::string poses = folder.write("poses.txt", std::string(300, '1') + "\n");
  EXPECT_TRUE(contains(message(poses),
                       poses + ": " + folder.file(std::string(300, '1')) + ": no such file"));
  EXPECT_TRUE(contains(message(folder.file("empty")), "has no recordings"));
  EXPECT_TRUE(contains(message(folder.file("*.rawlog")), "no file matches"));
  EXPECT_TRUE(contains(message(folder.file("circle.txt")), "lists within lists"));
  EXPECT_TRUE(contains(message(folder.write("nothing.txt", "# none\n")), "has no recordings"));
}

TEST(Recordings, ThoseThatRunsHaveConvertedHaveTheNameOfTheFolder)
{
  const TestFolder folder;
  std::vector<std::string> files;
  for (const char* name : {"out/00/recording.rawlog", "out/01/recording.rawlog", "a/drive.rawlog",
                           "more/01/recording.rawlog"})
  {
    files.push_back(folder.write(name, ""));
  }
  EXPECT_EQ(namesOf(listRecordings(files)),
            (std::vector<std::string>{"00", "out_01", "drive", "more_01"}));
}
}  // namespace dyslam::batch
