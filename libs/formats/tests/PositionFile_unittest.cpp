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
    EXPECT_EQ(PositionAxes::local, file.axes);
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
    EXPECT_EQ(PositionAxes::local, file.axes) << text;
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
  EXPECT_EQ(PositionAxes::geodetic, file.axes);
  EXPECT_EQ("", file.clock);
  ASSERT_EQ(2U, file.positions.size()) << "without a fix there is no position";
  EXPECT_NEAR(1600000001, file.positions[0].stamp, 1e-6) << "of the measurement, not the recorder";
  EXPECT_TRUE(file.positions[1].pose.translation().isApprox(Eigen::Vector3d(49.1, 8.6, 111)));
}

/** A file of RTKLIB with one line of positions. \param columns of its header \param fields of its
 * line, up to the quality */
std::string rtklib(const std::string& columns, const std::string& fields)
{
  return "% program   : RTKPOST ver.2.4.3\n% obs start : 2024/05/18 00:00:00.0 GPST "
         "(week2314 518400.0s)\n% ref pos   :  3654410.0348   1407752.4780   5017576.9176\n%\n"
         "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,5:single,ns=# of satellites)\n%  " +
         columns + "  Q  ns   sdn(m) ratio\n" + fields + "   1   8   0.0117    2.6\n";
}

TEST(PositionFile, PositionsOfRtklib)
{
  const TestFolder folder;
  struct Case
  {
    std::string columns;
    std::string fields;
    PositionAxes axes;
    Eigen::Vector3d position;
  };
  const std::vector<Case> cases{{"GPST                  latitude(deg) longitude(deg)  height(m)",
                                 "2024/05/18 00:00:01.500   52.123456789  -1.350495019    84.8600",
                                 PositionAxes::geodetic,
                                 {52.123456789, -1.350495019, 84.86}},
                                {"GPST            latitude(d'\") longitude(d'\")  height(m)",
                                 "2314 518401.500   -52 30 36.00000  -0 15 18.00000    84.8600",
                                 PositionAxes::geodetic,
                                 {-52.51, -0.255, 84.86}},
                                {"GPST      x-ecef(m)      y-ecef(m)      z-ecef(m)",
                                 "2314 518401.500   3655334.3694   1403901.2189   5018038.3221",
                                 PositionAxes::geocentric,
                                 {3655334.3694, 1403901.2189, 5018038.3221}},
                                {"GPST,e-baseline(m),n-baseline(m),u-baseline(m)",
                                 "2024/05/18 00:00:01.500,1.5,-2.5,0.25",
                                 PositionAxes::local,
                                 {1.5, -2.5, 0.25}}};
  for (const Case& given : cases)
  {
    const std::string path = folder.write("a.pos", rtklib(given.columns, given.fields));
    ASSERT_TRUE(isPositionFile(path)) << given.columns;
    const PositionFile file = readPositions(path);
    EXPECT_EQ(given.axes, file.axes) << given.columns;
    ASSERT_EQ(1U, file.positions.size()) << given.columns;
    EXPECT_LT((file.positions[0].pose.translation() - given.position).norm(), 1e-9)
        << given.columns;
    EXPECT_NEAR(1715990401.5 - 18, file.positions[0].stamp, 1e-6) << given.columns;
    EXPECT_EQ("GPS time, 18 s ahead of UTC", file.clock) << given.columns;
  }
}

TEST(PositionFile, TheHeaderOfRtklibNamesTheClock)
{
  const TestFolder folder;
  const auto read = [&](const std::string& clock, const std::string& time)
  {
    return readPositions(folder.write(
        "a.pos", rtklib(clock + "  e-baseline(m)  n-baseline(m)  u-baseline(m)", time + " 1 2 3")));
  };
  const std::string date = "2024/05/18 00:00:01.500";
  EXPECT_NEAR(1715990401.5, read("UTC ", date).positions[0].stamp, 1e-6);
  EXPECT_EQ("", read("UTC ", date).clock);
  EXPECT_NEAR(1715990401.5 - 9 * 3600, read("JST ", date).positions[0].stamp, 1e-6);
  EXPECT_EQ("Japan's time, 32400 s ahead of UTC", read("JST ", date).clock);
  // Leap seconds: the last one was at the end of 2016.
  EXPECT_NEAR(1483228800 - 1, read("GPST", "2017/01/01 00:00:16.000").positions[0].stamp, 1e-6);
  EXPECT_NEAR(1483228800, read("GPST", "2017/01/01 00:00:18.000").positions[0].stamp, 1e-6);
  EXPECT_NEAR(1136073600 - 13, read("GPST", "2006/01/01 00:00:00.000").positions[0].stamp, 1e-6);
  EXPECT_NEAR(951782400, read("UTC", "2000/02/29 00:00:00.000").positions[0].stamp, 1e-6);
}

TEST(PositionFile, ErrorsInFilesOfRtklibNameTheLine)
{
  const TestFolder folder;
  const std::string header = "GPST  latitude(deg) longitude(deg)  height(m)";
  const std::string first = "2024/05/18 00:00:01.500 52 21 84";
  const auto errorOf = [&](const std::string& second)
  {
    return messageOfError<UserError>(
        [&] { (void)readPositions(folder.write("a.pos", rtklib(header, first) + second)); });
  };
  EXPECT_TRUE(
      contains(errorOf("2024/05/18 00:00:02.500 52 21\n"), "a.pos:8: has 4 fields, needs 9"));
  EXPECT_TRUE(contains(errorOf("2024/05/18 00:00:00.500 52 21 84 1 8 0.1 2.6\n"),
                       "a.pos:8: the time is before that of the line before"));
  EXPECT_TRUE(contains(errorOf("2024/05/18 00:00:02.500 52 2x 84 1 8 0.1 2.6\n"),
                       "a.pos:8: '2x' is not a number"));
  for (const std::string time :
       {"2024/02/30 00:00:00", "2024/13/01 00:00:00", "2024/05/18 24:00:00", "2024/05/18 00:60:00",
        "2024/05/18 00:00", "2024-05-18 00:00:00", "2024/05/18 518400", "2314 604801", "2314.5 1",
        "nan 1", "2024/nan/18 00:00:00", "2024/05/1e400 00:00:00"})
  {
    EXPECT_TRUE(contains(errorOf(time + " 52 21 84 1 8 0.1 2.6\n"),
                         "a.pos:8: '" + time + "' is not a time"));
  }
  const std::string more = "% a comment\n\n2024/05/18 00:00:02.500 52 21 84 1 8 0.1 2.6\n";
  EXPECT_EQ(2U,
            readPositions(folder.write("a.pos", rtklib(header, first) + more)).positions.size());
  const std::string empty = folder.write("a.pos", "%  " + header + "  Q\n");
  EXPECT_TRUE(isPositionFile(empty));
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)readPositions(empty); }),
                       "a.pos: holds no positions"));
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
