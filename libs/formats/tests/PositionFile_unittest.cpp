// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/PositionFile.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <string>
#include <vector>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The position at the index as one text, with its stamp. */
std::string shown(const Trajectory& positions, std::size_t i)
{
  std::ostringstream text;
  const Eigen::Vector3d p = positions[i].pose.translation();
  text << positions[i].stamp << ": " << p.x() << ' ' << p.y() << ' ' << p.z();
  return text.str();
}

TEST(PositionFile, LinesOfTimeAndPosition)
{
  const TestFolder folder;
  for (const std::string text :
       {"1.5 10 -20 3\n2.5 11 -21 3.5\n", "1.5,10,-20,3\n2.5, 11, -21, 3.5\n",
        "\xEF\xBB\xBF# log of the prism\r\n\r\n1.5\t10\t-20\t3\r\n2.5 11 -21 3.5\r\n",
        "1.5;10;-20;3\n2.5;11;-21;3.5\n"})
  {
    const std::string path = folder.write("a", text);
    ASSERT_TRUE(isPositionFile(path)) << text;
    const PositionFile file = readPositions(path);
    EXPECT_FALSE(file.is_geodetic);
    ASSERT_EQ(2U, file.positions.size()) << text;
    EXPECT_EQ("1.5: 10 -20 3", shown(file.positions, 0)) << text;
    EXPECT_EQ("2.5: 11 -21 3.5", shown(file.positions, 1)) << text;
    EXPECT_TRUE(file.positions[0].pose.linear().isIdentity(0));
  }
}

TEST(PositionFile, AHeaderNamesTheColumns)
{
  const TestFolder folder;
  for (const std::string text :
       {"Easting,Northing,Height,Q,Time\n10,-20,3,1,1.5\n", "# z y x t\n3 -20 10 1.5\n",
        "timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], v [m s^-1]\n"
        "1500000000, 10, -20, 3, 7\n",
        "time (ms) x y z sigma\n1500 10 -20 3 0.1\n",
        "\"name\",\"time\",\"x\",\"y\",\"z\"\n\"a, b\",1.5,10,-20,3\n"})
  {
    const std::string path = folder.write("a", text);
    ASSERT_TRUE(isPositionFile(path)) << text;
    const PositionFile file = readPositions(path);
    EXPECT_FALSE(file.is_geodetic) << text;
    ASSERT_EQ(1U, file.positions.size()) << text;
    EXPECT_EQ("1.5: 10 -20 3", shown(file.positions, 0)) << text;
  }
}

TEST(PositionFile, LatitudeAndLongitudeAreLeftAsTheyAre)
{
  const TestFolder folder;
  const PositionFile file =
      readPositions(folder.write("fix.csv",
                                 "%time,field.header.seq,field.header.stamp,field.header.frame_id,"
                                 "field.latitude,field.longitude,field.altitude\n"
                                 "1600000001500000000,1,1600000001000000000,gps,49,8.5,110\n"
                                 "1600000002500000000,2,1600000002000000000,gps,nan,nan,nan\n"
                                 "1600000003500000000,3,1600000003000000000,gps,,,\n"
                                 "1600000004500000000,4,1600000004000000000,gps,49.1,8.6,111\n"));
  EXPECT_TRUE(file.is_geodetic);
  ASSERT_EQ(2U, file.positions.size()) << "without a fix there is no position";
  EXPECT_NEAR(1600000001, file.positions[0].stamp, 1e-6) << "of the measurement, not the recorder";
  EXPECT_TRUE(file.positions[1].pose.translation().isApprox(Eigen::Vector3d(49.1, 8.6, 111)));
}

TEST(PositionFile, FilesWithOrientationsAreOthers)
{
  const TestFolder folder;
  for (const std::string text :
       {"1 0 0 0 0 0 0 1\n", "# t x y z\n1 0 0 0 0 0 0 1\n", "1 0 0 0 0 1 0 0 0 0 1 0\n",
        "# t x y z qx qy qz qw\n1 0 0 0 0 0 0 1\n", "time,x,y,z,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n",
        "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w []\n1,2,3,4,1\n",
        "1 2 3\n", "a b c d\n", "x,y,z\n1,2,3\n", ""})
  {
    const std::string path = folder.write("a", text);
    EXPECT_FALSE(isPositionFile(path)) << text;
    EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)readPositions(path); }),
                         "a: has neither lines of t x y z nor a header"))
        << text;
  }
  EXPECT_TRUE(
      contains(messageOfError<UserError>([&] { (void)isPositionFile(folder.file("none")); }),
               "no such file"));
}

TEST(PositionFile, ErrorsNameFileAndLine)
{
  const TestFolder folder;
  const auto error = [&](const std::string& text)
  { return messageOfError<UserError>([&] { (void)readPositions(folder.write("a", text)); }); };
  const std::string good = "1 0 0 0\n";
  EXPECT_TRUE(contains(error(good + "2 0 0\n"), "a:2: has 3 fields"));
  EXPECT_TRUE(contains(error(good + "2 0 zero 0\n"), "a:2: 'zero' is not a number"));
  EXPECT_TRUE(contains(error(good + "nan 0 0 0\n"), "a:2: 'nan' is not a time"));
  EXPECT_TRUE(contains(error(good + "0 0 0 0\n"), "a:2: the time is before that of the line"));
  EXPECT_TRUE(contains(error(good + "2 0 0 1e13\n"), "a:2: the position is more than 1e12 m"));
  EXPECT_TRUE(contains(error("time x y z\n2020-01-01 0 0 0\n"), "a:2: '2020-01-01' is not a time"));
  EXPECT_TRUE(contains(error("time x y z\n"), "a: holds no positions"));
  EXPECT_TRUE(contains(error("1 nan nan nan\n"), "a: holds no positions"));
  const PositionFile twice = readPositions(folder.write("a", good + "2 5 0 0\n2 6 0 0\n"));
  ASSERT_EQ(2U, twice.positions.size());
  EXPECT_EQ("2: 5 0 0", shown(twice.positions, 1));
}

TEST(PositionFile, IsNoTrajectory)
{
  const TestFolder folder;
  const auto error = [&](const std::string& text)
  { return messageOfError<UserError>([&] { (void)readTrajectory(folder.write("a", text)); }); };
  const std::string advice = "Positions alone are read by dyslam-eval trajectory --reference";
  EXPECT_TRUE(contains(error("1 0 0 0\n"), "a:1: has 4 fields"));
  EXPECT_TRUE(contains(error("1 0 0 0\n"), advice));
  EXPECT_FALSE(contains(error("1 0 0\n"), advice));
}
}  // namespace
}  // namespace dyslam
