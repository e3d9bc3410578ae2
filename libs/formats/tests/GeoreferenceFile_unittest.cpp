// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <gtest/gtest.h>

#include <string>

#include "TestFolder.h"

namespace dyslam
{
TEST(GeoreferenceFile, IsReadAsWritten)
{
  const TestFolder folder;
  Georeference written;
  written.origin = {-33.8567844213, 151.2152967123, 12.345};
  written.T_enu_map = poseFromYpr(120.5, -3.25, 4.125, 2.1, 0.03, -0.02);
  written.epsg = 32756;
  written.fixes = 57;
  written.horizontal_rmse = 1.25;
  written.vertical_rmse = 2.5;
  written.fused = true;
  writeGeoreference(written, folder.file("georeference.ini"));
  const Georeference read = readGeoreference(folder.file("georeference.ini"));
  EXPECT_EQ(read.origin.latitude, written.origin.latitude);
  EXPECT_EQ(read.origin.longitude, written.origin.longitude);
  EXPECT_EQ(read.origin.height, written.origin.height);
  EXPECT_TRUE(read.T_enu_map.isApprox(written.T_enu_map, 1e-12));
  EXPECT_EQ(read.epsg, 32756);
  EXPECT_EQ(read.fixes, 57U);
  EXPECT_EQ(read.horizontal_rmse, 1.25);
  EXPECT_EQ(read.vertical_rmse, 2.5);
  EXPECT_TRUE(read.fused);
}

TEST(GeoreferenceFile, ErrorsNameTheKey)
{
  const TestFolder folder;
  const auto message = [&](const std::string& text)
  {
    folder.write("g.ini", text);
    try
    {
      (void)readGeoreference(folder.file("g.ini"));
    }
    catch (const UserError& error)
    {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message("[georeference]\nlatitude_deg = 49\n").find("georeference.longitude_deg"),
            std::string::npos);
  EXPECT_NE(message("[georeference]\nlatitude_deg = north\n").find("latitude_deg"),
            std::string::npos);
}
}  // namespace dyslam
