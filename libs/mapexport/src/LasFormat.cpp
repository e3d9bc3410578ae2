// SPDX-License-Identifier: BSD-3-Clause
// LAS 1.2 (ASPRS), point data record format 0, which every reader supports. Debian 12 has no
// library for it.
#include <dyslam/base/Bytes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <optional>

#include "CloudFormat.h"

namespace dyslam
{
namespace
{
constexpr double scale = 0.001;  // coordinates are whole millimetres from the offset
constexpr std::uint16_t header_size = 227;
constexpr std::uint16_t vlr_header_size = 54;
constexpr std::uint16_t extra_bytes_size = 192;  // of one description
constexpr std::uint16_t geo_keys_size = 4 * 4 * 2;
constexpr std::uint16_t record_size = 20;

void appendText(std::string& out, const std::string& text, std::size_t size)
{
  out += text.substr(0, size);
  out.append(size - std::min(size, text.size()), '\0');
}

/** Day of the year and year in UTC: of the recording, since the time of writing would give each
 * file of one map other bytes; zeros if it is not known, as of a clock that counts from its start.
 */
void appendDate(std::string& out, const std::optional<double>& stamp)
{
  constexpr double first = 631152000;    // 1 January 1990: earlier stamps are no UNIX times
  constexpr double last = 253402300799;  // 31 December 9999
  std::tm date{};
  const bool known = stamp && *stamp >= first && *stamp <= last;
  const auto seconds = static_cast<std::time_t>(known ? *stamp : 0);
  const bool valid = known && ::gmtime_r(&seconds, &date) != nullptr;
  appendBytes(out, static_cast<std::uint16_t>(valid ? date.tm_yday + 1 : 0));
  appendBytes(out, static_cast<std::uint16_t>(valid ? date.tm_year + 1900 : 0));
}

/** Describes one float32 behind the record, as LAS 1.4 specifies (table 24) and readers of older
 * versions understand. */
void appendExtraBytes(std::string& out, const std::string& name, const std::string& description)
{
  constexpr char float32 = 9;
  constexpr std::size_t text_size = 32;  // of the name, and of the description at the end
  const std::size_t begin = out.size();
  out.append(2, '\0');  // reserved
  out.push_back(float32);
  out.push_back('\0');  // options: no_data, min, max, scale and offset are not stated
  appendText(out, name, text_size);
  out.resize(begin + extra_bytes_size - text_size, '\0');
  appendText(out, description, text_size);
}

class LasFormat : public CloudFormat
{
 public:
  explicit LasFormat(const CloudDescription& layout) : layout_(layout) {}

  /** The header counts with 32 bits. */
  [[nodiscard]] std::uint64_t maxPoints() const override
  {
    return std::numeric_limits<std::uint32_t>::max();
  }

  /** Whole steps have 32 bits. */
  [[nodiscard]] double maxCoordinate() const override
  {
    return scale * std::numeric_limits<std::int32_t>::max();
  }

  [[nodiscard]] std::string header(const CloudSummary& summary) const override
  {
    const bool projected = layout_.epsg > 0;
    const std::uint32_t vlrs = (layout_.normals ? 1 : 0) + (projected ? 1 : 0);
    const std::uint32_t data_at = header_size +
                                  (layout_.normals ? vlr_header_size + 3U * extra_bytes_size : 0U) +
                                  (projected ? vlr_header_size + geo_keys_size : 0U);
    const auto count = static_cast<std::uint32_t>(summary.count);
    std::string out("LASF");
    out.append(4 + 16, '\0');  // source, encoding, GUID
    out.push_back(1);
    out.push_back(2);
    appendText(out, "EXTRACTION", 32);
    appendText(out, "DySLAM", 32);
    appendDate(out, layout_.recorded);
    appendBytes<std::uint16_t>(out, header_size);
    appendBytes<std::uint32_t>(out, data_at);
    appendBytes<std::uint32_t>(out, vlrs);
    out.push_back(0);  // point data record format
    appendBytes<std::uint16_t>(
        out, static_cast<std::uint16_t>(record_size + (layout_.normals ? 12 : 0)));
    appendBytes<std::uint32_t>(out, count);
    appendBytes<std::uint32_t>(out, count);  // of first returns
    out.append(4 * sizeof(std::uint32_t), '\0');
    appendBounds(out, summary);
    if (layout_.normals)
    {
      appendNormalsRecord(out);
    }
    if (projected)
    {
      appendGeoKeys(out);
    }
    return out;
  }

  void append(const MapPoints& points, std::size_t i, std::string& out) const override
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      appendBytes(out, wholeSteps(static_cast<double>(points.points[i][axis])));
    }
    constexpr float brightest = 65535;
    const float intensity = std::clamp(points.intensity[i], 0.0F, 1.0F);
    appendBytes(out, static_cast<std::uint16_t>(std::lround(brightest * intensity)));
    constexpr char only_return = 1 | 1 << 3;
    out.push_back(only_return);
    out.push_back(1);     // class: unclassified
    out.append(4, '\0');  // scan angle, user data, point source
    for (int axis = 0; axis < 3 && layout_.normals; ++axis)
    {
      appendBytes(out, points.normals[i][axis]);
    }
  }

 private:
  static std::int32_t wholeSteps(double metres)
  {
    return static_cast<std::int32_t>(std::lround(metres / scale));
  }

  void appendBounds(std::string& out, const CloudSummary& summary) const
  {
    for (int k = 0; k < 3; ++k)
    {
      appendBytes<double>(out, scale);
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      appendBytes<double>(out, layout_.origin[axis]);
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      // As a reader computes them from the whole steps.
      const auto bound = [&](double v)
      { return summary.count == 0 ? 0.0 : wholeSteps(v) * scale + layout_.origin[axis]; };
      appendBytes<double>(out, bound(summary.high[axis]));
      appendBytes<double>(out, bound(summary.low[axis]));
    }
  }

  static void appendNormalsRecord(std::string& out)
  {
    appendBytes<std::uint16_t>(out, 0);  // reserved
    appendText(out, "LASF_Spec", 16);
    appendBytes<std::uint16_t>(out, 4);  // record ID: extra bytes
    appendBytes<std::uint16_t>(out, 3 * extra_bytes_size);
    appendText(out, "normals", 32);
    appendExtraBytes(out, "NormalX", "towards the sensor");
    appendExtraBytes(out, "NormalY", "towards the sensor");
    appendExtraBytes(out, "NormalZ", "towards the sensor");
  }

  /** The coordinate reference system as keys of GeoTIFF. */
  void appendGeoKeys(std::string& out) const
  {
    appendBytes<std::uint16_t>(out, 0);  // reserved
    appendText(out, "LASF_Projection", 16);
    appendBytes<std::uint16_t>(out, 34735);  // record ID: directory of keys
    appendBytes<std::uint16_t>(out, geo_keys_size);
    appendText(out, "coordinate system", 32);
    constexpr std::uint16_t projected_model = 1;
    constexpr std::uint16_t metre = 9001;
    const std::array<std::array<std::uint16_t, 4>, 4> keys{
        {{1, 1, 0, 3},  // version, revisions, number of keys
         {1024, 0, 1, projected_model},
         {3072, 0, 1, static_cast<std::uint16_t>(layout_.epsg)},
         {3076, 0, 1, metre}}};
    for (const auto& key : keys)
    {
      for (const std::uint16_t value : key)
      {
        appendBytes(out, value);
      }
    }
  }

  CloudDescription layout_;
};
}  // namespace

std::unique_ptr<CloudFormat> makeLasFormat(const CloudDescription& layout)
{
  return std::make_unique<LasFormat>(layout);
}
}  // namespace dyslam
