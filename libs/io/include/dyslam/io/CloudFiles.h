// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dyslam
{
/** KITTI's scan: little-endian float32 x y z intensity a point, every point kept. A file of the
 * same name ending in `.ring` (one byte a point) fills Scan::ring. \throws UserError. */
[[nodiscard]] Scan readBin(const std::string& path);
void writeBin(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity = {});

/** Reads `.bin`, `.pcd` or `.ply` by its ending. Of PCD and PLY the fields x y z, `intensity` (or
 * `reflectivity`), `ring` and `time` (or `t`, `timestamp`: seconds, or nanoseconds for whole
 * numbers) are taken. Times since 1970 (above an hour) are counted from the earliest, which becomes
 * the stamp; smaller ones are as in the file, and so are intensities. \throws UserError. */
[[nodiscard]] Scan readCloud(const std::string& path);

/** True for the endings that readCloud() knows. */
[[nodiscard]] bool isCloudFile(const std::string& path);

/** Binary PCD and PLY of float32 x y z and, unless empty, intensity. Written under a temporary name
 * first. \throws UserError. */
void writePcd(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity = {});
void writePly(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity = {});
/** By the ending: `.pcd`, `.ply` or `.bin`. */
void writeCloud(const std::string& path,
                const std::vector<Eigen::Vector3f>& points,
                const std::vector<float>& intensity = {});

/** Files of a folder with an ending that readCloud() knows, sorted by name (numbers by value). Only
 * one ending may occur. \throws UserError if there is none. */
[[nodiscard]] std::vector<std::string> listCloudFiles(const std::string& folder);
}  // namespace dyslam
