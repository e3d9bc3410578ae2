// SPDX-License-Identifier: BSD-3-Clause
// Reads the files of an occupancy grid.
#pragma once

#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdio>
#include <string>

namespace dyslam::test
{
/** The grid of a .gridmap, as MRPT reads it. */
inline mrpt::maps::COccupancyGridMap2D readGridmap(const std::string& path)
{
  mrpt::io::CFileGZInputStream file(path);
  auto archive = mrpt::serialization::archiveFrom(file);
  mrpt::maps::COccupancyGridMap2D grid;
  archive >> grid;
  return grid;
}

/** The lower left corner of the grid [m]. \param yaml text of the .yaml beside its image */
inline Eigen::Vector2d originIn(const std::string& yaml)
{
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  const std::size_t at = yaml.find("origin:");
  if (at == std::string::npos ||
      std::sscanf(yaml.c_str() + at, "origin: [%lf, %lf", &low.x(), &low.y()) != 2)
  {
    ADD_FAILURE() << "no origin in " << yaml;
  }
  return low;
}
}  // namespace dyslam::test
