// SPDX-License-Identifier: BSD-3-Clause
#include "ExternalScans.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>
#include <mrpt/io/lazy_load_path.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/math/CMatrixF.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>

#include "GzInput.h"
#include "RawlogObjects.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationPointCloud;

/** MRPT finds external files in one folder per process: no other thread may set it before load().
 */
std::mutex external_folder_mutex;

/** A recording must not cause arbitrary files of this machine to be read.
 * \throws UserError for a name that leads out of the folder, or to no file. */
std::string pathInside(const std::string& name, const ExternalFiles& external)
{
  const fs::path path = fs::path(name).lexically_normal();
  if (!external.anywhere && (path.is_absolute() || (!path.empty() && *path.begin() == "..")))
  {
    throw UserError(name + ": the rawlog keeps a scan in a file outside of its folder " +
                    external.folder + "; put it there, or allow it with input.external_anywhere");
  }
  const fs::path file = fs::path(external.folder) / name;
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored))
  {
    throw UserError(file.string() + ": no such file, but the rawlog keeps a scan in it");
  }
  return file.string();
}

/** Checks the one object in a file. \return its bytes, valid as long as the window.
 * \throws UserError. */
template <typename Walk>
std::string_view walked(const std::string& path,
                        GzInput& file,
                        ByteWindow& window,
                        const Walk& walk)
{
  try
  {
    ObjectLayout layout(window);
    walk(layout);
  }
  catch (const NewerMrpt& error)
  {
    if (file.checkMember())
    {
      throw UserError(path + ": is damaged: the compressed data are broken");
    }
    throw UserError(path + ": has " + error.what() + "; " + newer_mrpt_advice);
  }
  catch (const std::exception& error)
  {
    throw UserError(path + ": is damaged: " + error.what());
  }
  return window.since(0);
}

Scan readPointsMap(const std::string& path)
{
  GzInput file(path);
  ByteWindow window(file);
  const std::string_view bytes =
      walked(path, file, window, [](ObjectLayout& layout) { layout.pointsMap(); });
  const auto map = std::dynamic_pointer_cast<mrpt::maps::CPointsMap>(objectFrom(bytes));
  return map ? scanFromPointsMap(*map) : Scan();
}

/** KITTI's layout, plain or gzip. */
Scan readKittiBin(const std::string& path)
{
  GzInput file(path);
  Scan scan;
  while (!file.atEnd())
  {
    std::array<float, 4> values{};
    try
    {
      (void)file.Read(values.data(), sizeof values);
    }
    catch (const std::runtime_error&)
    {
      throw UserError(path + ": " + file.whyIncomplete() + " within a point, after " +
                      counted(scan.size(), "point") + "; copy or record it again");
    }
    if (scan.size() * sizeof values >= ByteWindow::largest)
    {
      throw UserError(path + ": is larger than any scan");
    }
    scan.points.emplace_back(values[0], values[1], values[2]);
    scan.intensity.push_back(values[3]);
  }
  if (const std::string why = file.whyIncomplete(); !why.empty())
  {
    throw UserError(path + ": " + why + " after " + counted(scan.size(), "point") +
                    "; copy or record it again");
  }
  return scan;
}

/** `x y z`, `x y z intensity` or `x y z red green blue`. */
Scan readTextRows(const std::string& path)
{
  constexpr std::size_t coloured = 6;
  TextFile file(path);
  Scan scan;
  std::size_t columns = 0;
  while (file.next())
  {
    const std::size_t count = file.fields().size();
    columns = columns == 0 ? count : columns;
    if (count != columns || (count != 3 && count != 4 && count != coloured))
    {
      file.fail("has " + counted(count, "field") + ", needs 3, 4 or 6, as all other lines");
    }
    std::array<float, coloured> values{};
    for (std::size_t i = 0; i < count; ++i)
    {
      const std::string_view text = file.fields()[i];
      const std::optional<float> value = parseNumber<float>(text);
      if (!value)
      {
        file.fail("'" + std::string(text) + "' is not a number");
      }
      values[i] = *value;
    }
    scan.points.emplace_back(values[0], values[1], values[2]);
    if (count > 3)
    {
      scan.intensity.push_back(count == 4 ? values[3] : (values[3] + values[4] + values[5]) / 3);
    }
  }
  return scan;
}

/** Only the class knows the format. */
struct Format : CObservationPointCloud
{
  static ExternalStorageFormat of(const CObservationPointCloud& observation)
  {
    return observation.*(&Format::m_externally_stored);
  }
};

bool isText(const std::string& path)
{
  return lowerExtension(path) == ".txt";
}

/** A matrix of 16 bits or, before version 9 of the class, a CMatrixF [m]. */
void loadRangeImage(const std::string& path, CObservation3DRangeScan& observation)
{
  auto& image = observation.rangeImage;
  if (isText(path))
  {
    image.loadFromTextFile(path);
    return;
  }
  constexpr std::string_view old_class = "CMatrixF";
  GzInput file(path);
  ByteWindow window(file);
  const bool old = window.ahead(1 + old_class.size()).substr(0, 1 + old_class.size()) ==
                   '\x88' + std::string(old_class);
  const std::string_view bytes =
      walked(path, file, window,
             [old](ObjectLayout& layout) { old ? layout.matrix() : layout.rangeMatrix(); });
  if (!old)
  {
    std::array<std::uint32_t, 2> size{};
    std::memcpy(size.data(), bytes.data(), sizeof size);
    image.setSize(static_cast<int>(size[0]), static_cast<int>(size[1]));
    std::memcpy(image.data(), bytes.data() + sizeof size, bytes.size() - sizeof size);
    return;
  }
  const auto matrix = std::dynamic_pointer_cast<mrpt::math::CMatrixF>(objectFrom(bytes));
  image.setSize(matrix->rows(), matrix->cols());
  for (int row = 0; row < image.rows(); ++row)
  {
    for (int column = 0; column < image.cols(); ++column)
    {
      const float units = std::round((*matrix)(row, column) / observation.rangeUnits);
      image(row, column) = units > 0 && units < 65536 ? static_cast<std::uint16_t>(units) : 0;
    }
  }
}
}  // namespace

Scan scanFromPointsMap(const mrpt::maps::CPointsMap& map)
{
  Scan scan;
  const auto& xs = map.getPointsBufferRef_x();
  const auto& ys = map.getPointsBufferRef_y();
  const auto& zs = map.getPointsBufferRef_z();
  scan.points.resize(xs.size());
  for (std::size_t i = 0; i < xs.size(); ++i)
  {
    scan.points[i] = {xs[i], ys[i], zs[i]};
  }
  if (const auto* xyzi = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(&map))
  {
    const auto& intensity = xyzi->getPointsBufferRef_intensity();
    scan.intensity.assign(intensity.begin(), intensity.end());
  }
  else if (const auto* coloured = dynamic_cast<const mrpt::maps::CColouredPointsMap*>(&map))
  {
    scan.intensity.resize(scan.size());
    for (std::size_t i = 0; i < scan.size(); ++i)
    {
      float red = 0;
      float green = 0;
      float blue = 0;
      coloured->getPointColor_fast(i, red, green, blue);
      scan.intensity[i] = (red + green + blue) / 3;
    }
  }
  return scan;
}

Scan readExternalCloud(const CObservationPointCloud& observation, const ExternalFiles& external)
{
  const std::string path = pathInside(observation.getExternalStorageFile(), external);
  if (fs::file_size(path) == 0)
  {
    return {};  // of an empty scan
  }
  using Kind = CObservationPointCloud::ExternalStorageFormat;
  switch (Format::of(observation))
  {
    case Kind::MRPT_Serialization:
      return readPointsMap(path);
    case Kind::KittiBinFile:
      return readKittiBin(path);
    case Kind::PlainTextFile:
      return readTextRows(path);
    default:
      throw UserError(path + ": the rawlog keeps a scan in it in a format that is not known");
  }
}

void loadExternalParts(CObservation3DRangeScan& observation, const ExternalFiles& external)
{
  if (observation.hasPoints3D && observation.points3D_isExternallyStored())
  {
    const std::string path = pathInside(observation.points3D_getExternalStorageFile(), external);
    if (!isText(path))
    {
      GzInput file(path);
      ByteWindow window(file);
      const auto walk = [](ObjectLayout& layout)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          (void)layout.numbers(sizeof(float));
        }
      };
      (void)walked(path, file, window, walk);
    }
  }
  if (observation.hasRangeImage && observation.rangeImage_isExternallyStored())
  {
    const std::string path =
        pathInside(observation.rangeImage_getExternalStorageFile(""), external);
    loadRangeImage(path, observation);
    observation.rangeImage_forceResetExternalStorage();
    observation.cameraParams.ncols = static_cast<std::uint32_t>(observation.rangeImage.cols());
    observation.cameraParams.nrows = static_cast<std::uint32_t>(observation.rangeImage.rows());
  }
  const std::lock_guard<std::mutex> lock(external_folder_mutex);
  mrpt::io::setLazyLoadPathBase(external.folder);
  observation.load();
}
}  // namespace dyslam
