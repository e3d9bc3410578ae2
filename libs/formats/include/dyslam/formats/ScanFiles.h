// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/formats/FieldConventions.h>

#include <functional>
#include <string>
#include <vector>

namespace dyslam
{
/** Columns of a .bin file, little-endian float32, a letter for each: x, y, z [m], i intensity, r
 * number of the ring, t time of the point (unit and zero as of a PCD's field), _ another number. */
inline constexpr const char* kitti_layout = "xyzi";
inline constexpr const char* nuscenes_layout = "xyzir";
/** \throws UserError for a layout with other letters, with one twice, or without x, y and z. */
void requireBinLayout(const std::string& layout);
/** Names of the columns: "x y z intensity ring". */
[[nodiscard]] std::string columnsOf(const std::string& layout);

/** Reads a scan from a .bin file, with every point. Without a ring column, a file of the same name
 * ending in `.ring` (one byte per point) fills Scan::ring. \throws UserError. */
[[nodiscard]] Scan readBin(const std::string& path, const std::string& layout = kitti_layout);
/** readBin() for one scan of a recording, see readCloud(). */
[[nodiscard]] Scan readBin(const std::string& path,
                           const std::string& layout,
                           FieldConventions& conventions);
/** Layout of a .bin file, recognised by its content: xyzir if every fifth number is an integer in
 * [0, 255] and takes 4 values or more, as ring numbers do, and some coordinate is not an integer;
 * xyzi for all others, and for files of fewer than 100 points. \throws UserError if it cannot be
 * read. */
[[nodiscard]] std::string binLayoutOf(const std::string& path);
/** Writes a .bin file. \param intensity one per point; empty: 0 is written \throws UserError. */
void writeBin(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity = {});

/** Writes binary PCD or PLY of float32 x y z and, unless empty, intensity; first under a temporary
 * name. \throws UserError. */
void writePcd(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity = {});
void writePly(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity = {});
/** Writes a cloud in the format of the ending: `.pcd`, `.ply` or `.bin`. */
void writeCloud(const std::string& path,
                const std::vector<Eigen::Vector3f>& points,
                const std::vector<float>& intensity = {});

/** Reads `.bin`, `.pcd` or `.ply` by its ending. Of PCD (ascii, binary, binary_compressed) and PLY
 * (ascii, binary) the fields x y z are taken, and those of intensity, ring and time by the names
 * and units of drivers (FieldConventions). Absolute times (above 2 s) are counted from the
 * earliest, which becomes the stamp; smaller ones are counted as in the file, and intensities are
 * as in the file. Counts in headers are checked against the size of the file. \throws UserError. */
[[nodiscard]] Scan readCloud(const std::string& path);
/** readCloud() for one scan of a recording, in metres. \param conventions conventions of the
 * recording, used for all of its files \throws UserError. */
[[nodiscard]] Scan readCloud(const std::string& path, FieldConventions& conventions);

/** Ending of a file name with its dot, in lower case: ".bin". */
[[nodiscard]] std::string lowerExtension(const std::string& path);
/** True for the endings of point clouds: .bin, .pcd, .ply. */
[[nodiscard]] bool isCloudFile(const std::string& path);

/** Files of a folder, without hidden ones, for which `wanted` is true, sorted by name (numbers by
 * value). \throws UserError if there is no such folder. */
[[nodiscard]] std::vector<std::string> listFiles(
    const std::string& folder, const std::function<bool(const std::string&)>& wanted);
/** Point clouds of a folder, sorted by name (numbers by value). Only one ending may occur.
 * \throws UserError if there is none. */
[[nodiscard]] std::vector<std::string> listCloudFiles(const std::string& folder);
/** The .bin files of a folder, sorted by name (numbers by value); other files are ignored.
 * \throws UserError if there is none. */
[[nodiscard]] std::vector<std::string> listBinFiles(const std::string& folder);
}  // namespace dyslam
