// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/TrackTable.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
const std::vector<TrackValue> all_values{TrackValue::frame, TrackValue::id, TrackValue::velocity,
                                         TrackValue::speed, TrackValue::dynamic};

TrackedObject car()
{
  TrackedObject object;
  object.id = 7;
  object.object_class = ObjectClass::car;
  object.box.centre = {1, 2, 0.5};
  object.box.size = {4, 1.8, 1.5};
  object.box.yaw = 0.25;
  object.velocity = {3, -4, 0};
  object.dynamic = true;
  object.score = 0.9;
  return object;
}
}  // namespace

TEST(TrackTable, IsReadAsItWasWritten)
{
  const TestFolder folder;
  const std::string row = trackTableRow(car(), 12, 1.5);
  EXPECT_EQ(row,
            "12,1.500000,7,Car,1.000,2.000,0.500,4.00,1.80,1.50,0.2500,3.000,-4.000,0.000,5.000,1,"
            "0,0.900\n");
  TrackedObject parked = car();
  parked.id = 8;
  parked.dynamic = false;
  const std::string path =
      folder.write("tracks.csv", trackTableHeader() + row + trackTableRow(parked, 13, 1.6));
  const TrackTable table = readTrackTable(path, all_values);
  EXPECT_EQ(table.missing, "");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].frame, 12);
  EXPECT_EQ(table.rows[0].id, 7);
  EXPECT_EQ(table.rows[0].velocity, Eigen::Vector3d(3, -4, 0));
  EXPECT_EQ(table.rows[0].speed, 5);
  EXPECT_TRUE(table.rows[0].dynamic);
  EXPECT_EQ(table.rows[1].id, 8);
  EXPECT_FALSE(table.rows[1].dynamic);
}

TEST(TrackTable, HasTheWantedValuesOnly)
{
  const TestFolder folder;
  const std::string path = folder.write("tracks.csv", "speed,id,frame,x\n,1,one,2\n2.5,3,,\n");
  const TrackTable table = readTrackTable(path, {TrackValue::id, TrackValue::speed});
  ASSERT_EQ(table.rows.size(), 2U) << "frames are not read";
  EXPECT_EQ(table.rows[0].id, 1);
  EXPECT_FALSE(table.rows[0].speed);
  EXPECT_EQ(table.rows[1].speed, 2.5);
  EXPECT_EQ(table.rows[1].frame, 0);
  const TrackTable lacking = readTrackTable(path, all_values);
  EXPECT_EQ(lacking.missing, "vx");
  EXPECT_TRUE(lacking.rows.empty());
  folder.write("tracks.csv", "");
  EXPECT_EQ(readTrackTable(path, all_values).missing, "frame");
}

TEST(TrackTable, NamesTheDamagedLine)
{
  const TestFolder folder;
  for (const char* line : {"1,2", "one,2,3", "1,2.5,3", "1,2,fast"})
  {
    const std::string path =
        folder.write("tracks.csv", "frame,id,speed\n0,1,2\n" + std::string(line) + "\n");
    const std::vector<TrackValue> wanted{TrackValue::frame, TrackValue::id, TrackValue::speed};
    EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)readTrackTable(path, wanted); }),
                         "tracks.csv:3: "))
        << line;
  }
  EXPECT_THROW((void)readTrackTable(folder.file("none.csv"), all_values), UserError);
}
}  // namespace dyslam
