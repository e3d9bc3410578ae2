// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>

#include "PeakMemory.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
Scan someScan(std::size_t points)
{
  Scan scan;
  for (std::size_t i = 0; i < points; ++i)
  {
    const auto value = static_cast<float>(i);
    scan.points.emplace_back(value + 0.25F, -value, 1);
    scan.intensity.push_back(static_cast<float>(i % 100) / 100.0F);
  }
  return scan;
}

bool samePoints(const Scan& a, const Scan& b)
{
  return a.size() == b.size() &&
         (a.size() == 0 ||
          std::memcmp(a.points.data(), b.points.data(), a.size() * sizeof(a.points[0])) == 0);
}

template <typename T>
std::string bytesOf(std::initializer_list<T> values, bool big_endian = false)
{
  std::string bytes;
  for (const T value : values)
  {
    std::string one(sizeof value, '\0');
    std::memcpy(one.data(), &value, sizeof value);
    bytes += big_endian ? std::string(one.rbegin(), one.rend()) : one;
  }
  return bytes;
}

const std::string pcd_header =
    "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nHEIGHT 1\n";

/** A field of a text PCD beside x y z. */
struct TextField
{
  std::string name;
  char type = 'F';
  std::function<double(std::size_t)> value;  //!< of a point
};

/** 40 points on four rings, each higher than the one before. */
std::string textPcd(const std::vector<TextField>& fields)
{
  std::string names = "FIELDS x y z";
  std::string sizes = "\nSIZE 4 4 4";
  std::string types = "\nTYPE F F F";
  for (const TextField& field : fields)
  {
    names += " " + field.name;
    sizes += " 8";
    types += std::string(" ") + field.type;
  }
  std::string text = names + sizes + types + "\nWIDTH 40\nHEIGHT 1\nPOINTS 40\nDATA ascii\n";
  for (std::size_t i = 0; i < 40; ++i)
  {
    text += "10 " + std::to_string(i) + " " + std::to_string(i % 4);
    for (const TextField& field : fields)
    {
      char number[40];
      std::snprintf(number, sizeof number, field.type == 'F' ? " %.9f" : " %.0f", field.value(i));
      text += number;
    }
    text += "\n";
  }
  return text;
}

/** Times of a scan of 0.1 s. */
double timeOf(std::size_t point)
{
  return 0.1 * static_cast<double>(point) / 40;
}
}  // namespace

class CloudFormats : public ::testing::TestWithParam<const char*>
{
};

TEST_P(CloudFormats, RoundTrip)
{
  const TestFolder folder;
  const std::string path = folder.file(std::string("a.") + GetParam());
  Scan scan = someScan(30);
  scan.points[3] = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  scan.points[4].setZero();
  for (const std::size_t size : {std::size_t{30}, std::size_t{1}})
  {
    scan.points.resize(size);
    scan.intensity.resize(size);
    writeCloud(path, scan.points, scan.intensity);
    const Scan read = readCloud(path);
    EXPECT_TRUE(samePoints(scan, read));
    EXPECT_EQ(scan.intensity, read.intensity);
    EXPECT_TRUE(read.time.empty());
    EXPECT_TRUE(read.ring.empty());
  }
  writeCloud(path, scan.points);
  const Scan read = readCloud(path);
  EXPECT_TRUE(samePoints(scan, read));
  EXPECT_EQ(std::string(GetParam()) == "bin", !read.intensity.empty());
  EXPECT_FALSE(std::filesystem::exists(path + ".tmp"));
}

TEST_P(CloudFormats, BadFiles)
{
  const TestFolder folder;
  const std::string name = std::string("a.") + GetParam();
  EXPECT_THROW((void)readCloud(folder.file(name)), UserError);
  EXPECT_THROW((void)readCloud(folder.write(name, "some text that is no cloud")), UserError);
  const Scan scan = someScan(100);
  writeCloud(folder.file(name), scan.points, scan.intensity);
  const std::string whole = folder.read(name);
  EXPECT_THROW((void)readCloud(folder.write(name, whole.substr(0, whole.size() - 103))), UserError);
  EXPECT_THROW(writeCloud(folder.file("no/such/folder/" + name), scan.points), UserError);
  EXPECT_THROW(writeCloud(folder.file(name), scan.points, {1.0F}), std::logic_error);
}
INSTANTIATE_TEST_SUITE_P(Kinds, CloudFormats, ::testing::Values("bin", "pcd", "ply"));

TEST(CloudFiles, EmptyCloudsOfEachKind)
{
  const TestFolder folder;
  for (const std::string name : {"a.bin", "a.pcd", "a.ply"})
  {
    writeCloud(folder.file(name), {});
    EXPECT_EQ(0U, readCloud(folder.file(name)).size()) << name;
  }
}

TEST(CloudFiles, OtherFieldsOfPcdAndPly)
{
  const TestFolder folder;
  folder.write("a.pcd",
               "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
               "FIELDS x y z intensity ring time\nSIZE 4 4 4 4 2 8\nTYPE F F F F U F\n"
               "COUNT 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n"
               "DATA ascii\n1 2 3 40 7 1500000000.5\n4 5 6 80 9 1500000000.25\n");
  const Scan pcd = readCloud(folder.file("a.pcd"));
  ASSERT_EQ(2U, pcd.size());
  EXPECT_EQ((std::vector<std::uint16_t>{7, 9}), pcd.ring);
  EXPECT_EQ(1500000000.25, pcd.stamp);
  EXPECT_EQ((std::vector<float>{0.25F, 0.0F}), pcd.time);
  EXPECT_EQ((std::vector<float>{40, 80}), pcd.intensity);

  folder.write("b.ply",
               "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
               "property double z\nproperty uint t\nend_header\n1 2 3 0\n4 5 6 50000000\n");
  const Scan ply = readCloud(folder.file("b.ply"));
  ASSERT_EQ(2U, ply.size());
  EXPECT_EQ(Eigen::Vector3f(4, 5, 6), ply.points[1]);
  EXPECT_EQ((std::vector<float>{0.0F, 0.05F}), ply.time);
}

/** Some versions of PCL count padding with the size of the field behind it. */
TEST(CloudFiles, WrongPaddingOfPclIsCorrected)
{
  struct Layout
  {
    std::string header;
    std::size_t time = 0;  //!< offset of the time, float64 [bytes]
    std::size_t ring = 0;  //!< offset of the ring [bytes]
    std::size_t step = 0;  //!< of a point [bytes]
  };
  const std::vector<Layout> layouts{
      {"FIELDS x y z _ intensity _ timestamp _ ring _\nSIZE 4 4 4 1 4 1 8 1 2 1\n"
       "TYPE F F F U F U F U U U\nCOUNT 1 1 1 4 1 0 1 6 1 12\n",
       24, 32, 48},
      {"FIELDS x y z _ intensity tag ring _ timestamp _\nSIZE 4 4 4 1 4 1 1 1 8 1\n"
       "TYPE F F F U F U U U F U\nCOUNT 1 1 1 4 1 1 1 -5 1 7\n",
       24, 21, 32},
      {"FIELDS x y z _ intensity _ timestamp ring _\nSIZE 4 4 4 1 4 1 8 2 1\n"
       "TYPE F F F U F U F U U\nCOUNT 1 1 1 4 1 4 1 1 14\n",
       24, 32, 48}};
  const TestFolder folder;
  for (const Layout& layout : layouts)
  {
    std::string bytes(2 * layout.step, '\0');
    for (std::size_t i = 0; i < 2; ++i)
    {
      char* const point = &bytes[i * layout.step];
      const float x = 1.0F + static_cast<float>(i);
      const double time = 1500000000.0 + 0.0625 * static_cast<double>(i);
      std::memcpy(point, &x, sizeof x);
      std::memcpy(point + layout.time, &time, sizeof time);
      point[layout.ring] = static_cast<char>(3 + i);
    }
    const Scan scan =
        readCloud(folder.write("a.pcd", "VERSION 0.7\n" + layout.header +
                                            "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary\n" + bytes));
    ASSERT_EQ(2U, scan.size()) << layout.header;
    EXPECT_EQ(2.0F, scan.points[1].x()) << layout.header;
    EXPECT_EQ(1500000000.0, scan.stamp) << layout.header;
    EXPECT_EQ((std::vector<float>{0.0F, 0.0625F}), scan.time) << layout.header;
    EXPECT_EQ((std::vector<std::uint16_t>{3, 4}), scan.ring) << layout.header;
  }
  const std::string impossible =
      "FIELDS x y z _ w _ t\nSIZE 4 4 4 1 8 1 4\nTYPE F F F U F U F\nCOUNT 1 1 1 0 1 -9 1\n";
  EXPECT_TRUE(contains(
      messageOfError<UserError>(
          [&]
          {
            (void)readCloud(folder.write(
                "a.pcd", impossible + "WIDTH 1\nHEIGHT 1\nDATA binary\n" + std::string(48, '0')));
          }),
      "its header is missing or damaged"));
}

TEST(CloudFiles, TimesOf64Bits)
{
  const TestFolder folder;
  const std::string header =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z t\nSIZE 4 4 4 8\n"
      "TYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n"
      "DATA binary\n";
  std::string bytes(40, '\0');
  for (std::size_t i = 0; i < 2; ++i)
  {
    const float x = 1.0F + static_cast<float>(i);
    const std::uint64_t nanoseconds = 1500000000000000000U + i * 50000000U;
    std::memcpy(&bytes[20 * i], &x, sizeof x);
    std::memcpy(&bytes[20 * i + 12], &nanoseconds, sizeof nanoseconds);
  }
  const Scan scan = readCloud(folder.write("a.pcd", header + bytes));
  ASSERT_EQ(2U, scan.time.size());
  EXPECT_DOUBLE_EQ(1500000000.0, scan.stamp);
  EXPECT_NEAR(0.0F, scan.time[0], 1e-6F);
  EXPECT_NEAR(0.05F, scan.time[1], 1e-6F);
}

TEST(CloudFiles, TimesInEachUnit)
{
  const TestFolder folder;
  constexpr double date = 1600000000.25;
  for (const double zero : {0.0, date, 5000.0})
  {
    for (const double unit : {1.0, 1e-3, 1e-6, 1e-9})
    {
      for (const char type : {'F', 'U'})
      {
        if (type == 'U' && unit > 1e-6)
        {
          continue;  // whole numbers are too coarse
        }
        const TextField field{"timestamp", type,
                              [&](std::size_t i) { return (zero + timeOf(i)) / unit; }};
        FieldConventions conventions;
        const Scan scan = readCloud(folder.write("a.pcd", textPcd({field})), conventions);
        const std::string what = std::to_string(zero) + " " + std::to_string(unit) + " " + type;
        EXPECT_NEAR(zero, scan.stamp, 1e-6) << what;
        ASSERT_EQ(40U, scan.time.size()) << what;
        EXPECT_NEAR(timeOf(0), scan.time.front(), 2e-6) << what;
        EXPECT_NEAR(timeOf(39), scan.time.back(), 2e-6) << what;
        EXPECT_TRUE(conventions.warnings().empty()) << what;
      }
    }
  }
}

TEST(CloudFiles, ADamagedTimeDoesNotSpoilTheOthers)
{
  const TestFolder folder;
  for (const double zero : {0.0, 1600000000.25})
  {
    for (const double damaged : {1e30, -1e38})
    {
      const TextField field{"timestamp", 'F',
                            [&](std::size_t i) { return i == 7 ? damaged : zero + timeOf(i); }};
      FieldConventions conventions;
      const Scan scan = readCloud(folder.write("a.pcd", textPcd({field})), conventions);
      EXPECT_NEAR(zero, scan.stamp, 1e-6) << damaged;
      ASSERT_EQ(40U, scan.time.size()) << damaged;
      EXPECT_NEAR(timeOf(39), scan.time.back(), 2e-6) << damaged;
      EXPECT_TRUE(conventions.warnings().empty()) << damaged;
    }
  }
}

TEST(CloudFiles, TheFirstFileShowsTheUnitOfAll)
{
  const TestFolder folder;
  FieldConventions conventions;
  double factor = 1e6;
  const TextField field{"t", 'U', [&](std::size_t i) { return factor * timeOf(i); }};
  (void)readCloud(folder.write("a.pcd", textPcd({field})), conventions);
  EXPECT_EQ(std::vector<std::string>{"per-point time: field t, microseconds from the time stamp"},
            conventions.notes());
  factor = 1e4;  // a hundredth of a scan
  const Scan part = readCloud(folder.write("b.pcd", textPcd({field})), conventions);
  EXPECT_NEAR(0.01 * timeOf(39), part.time.back(), 2e-6);
  EXPECT_EQ(1U, conventions.notes().size());
  // In no unit does the scan last as long as one.
  factor = 1e4 / 1e6;
  FieldConventions other;
  const TextField seconds{"t", 'F', field.value};
  EXPECT_NEAR(0.01 * timeOf(39),
              readCloud(folder.write("c.pcd", textPcd({seconds})), other).time.back(), 1e-7);
  EXPECT_TRUE(contains(other.warnings().at(0), "seconds are assumed"));
}

TEST(CloudFiles, AbsoluteTimesInSinglePrecisionAreLeftOut)
{
  const TestFolder folder;
  std::string bytes;
  for (const float time : {1.6e9F, 1.6e9F + 128.0F})
  {
    bytes += bytesOf<float>({1, 2, 3, time});
  }
  FieldConventions conventions;
  const Scan scan =
      readCloud(folder.write("a.pcd",
                             "FIELDS x y z t\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\n"
                             "POINTS 2\nDATA binary\n" +
                                 bytes),
                conventions);
  EXPECT_TRUE(scan.time.empty());
  EXPECT_EQ(0, scan.stamp);
  EXPECT_TRUE(contains(conventions.warnings().at(0), "too coarse"));
}

/** A float32 since 1970 has steps of 128 s: all points of a scan have the same. */
TEST(CloudFiles, EqualTimesInSinglePrecisionAreReported)
{
  const TestFolder folder;
  const std::string path =
      folder.write("a.pcd",
                   "FIELDS x y z timestamp\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\n"
                   "POINTS 2\nDATA binary\n" +
                       bytesOf<float>({1, 2, 3, 1.7e9F, 2, 2, 3, 1.7e9F}));
  FieldConventions conventions;
  for (int scan = 0; scan < 2; ++scan)
  {
    EXPECT_TRUE(readCloud(path, conventions).time.empty());
  }
  ASSERT_EQ(1U, conventions.warnings().size());
  EXPECT_TRUE(contains(conventions.warnings()[0],
                       "field timestamp is the same for all points and not taken"));
}

TEST(CloudFiles, NamesThatDriversGiveToFields)
{
  const TestFolder folder;
  const auto ring = [](std::size_t i) { return static_cast<double>(i % 4); };
  for (const char* ring_name : {"ring", "line", "channel", "laser_id"})
  {
    for (const char* time_name :
         {"t", "time", "timestamp", "offset_time", "time_offset", "time_stamp"})
    {
      for (const char* intensity_name :
           {"intensity", "Intensity", "scalar_Intensity", "reflectivity", "i", "reflectance"})
      {
        const Scan scan =
            readCloud(folder.write("a.pcd", textPcd({{"other", 'F', ring},
                                                     {ring_name, 'U', ring},
                                                     {time_name, 'F', timeOf},
                                                     {intensity_name, 'F', [](std::size_t i) {
                                                        return static_cast<double>(i);
                                                      }}})));
        ASSERT_EQ(40U, scan.ring.size()) << ring_name;
        EXPECT_EQ(3, scan.ring[39]) << ring_name;
        ASSERT_EQ(40U, scan.time.size()) << time_name;
        EXPECT_NEAR(timeOf(39), scan.time[39], 1e-7) << time_name;
        ASSERT_EQ(40U, scan.intensity.size()) << intensity_name;
        EXPECT_EQ(39, scan.intensity[39]) << intensity_name;
      }
    }
  }
}

TEST(CloudFiles, RingsAreCountedFromTheLowest)
{
  const TestFolder folder;
  FieldConventions conventions;
  const TextField from_highest{"ring", 'U',
                               [](std::size_t i) { return static_cast<double>(3 - i % 4); }};
  const Scan scan = readCloud(folder.write("a.pcd", textPcd({from_highest})), conventions);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    EXPECT_EQ(i % 4, scan.ring[i]);
  }
  EXPECT_TRUE(contains(conventions.notes().at(0), "reversed"));
}

TEST(CloudFiles, RowsOfAnOrderedPcdAreRings)
{
  const TestFolder folder;
  const auto ordered = [&folder](std::string text, FieldConventions& conventions)
  {
    const std::string one_row = "WIDTH 40\nHEIGHT 1\n";
    text.replace(text.find(one_row), one_row.size(), "WIDTH 10\nHEIGHT 4\n");
    return readCloud(folder.write("a.pcd", text), conventions);
  };
  FieldConventions of_rows;
  const Scan scan = ordered(textPcd({}), of_rows);
  ASSERT_EQ(40U, scan.ring.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    EXPECT_EQ(i / 10, scan.ring[i]);
  }
  EXPECT_EQ("ring: rows of the cloud", of_rows.notes().back());
  const TextField ring{"ring", 'U', [](std::size_t i) { return static_cast<double>(i % 4); }};
  FieldConventions of_field;
  EXPECT_EQ(3, ordered(textPcd({ring}), of_field).ring.at(7));
}

TEST(CloudFiles, ReflectivityWhereTheIntensityCountsPhotons)
{
  const TestFolder folder;
  double scale = 100;
  const TextField intensity{"intensity", 'F',
                            [&](std::size_t i) { return scale * static_cast<double>(i); }};
  const TextField reflectivity{"reflectivity", 'U',
                               [](std::size_t i) { return static_cast<double>(i + 1); }};
  FieldConventions conventions;
  const auto last = [&](const std::vector<TextField>& fields)
  { return readCloud(folder.write("a.pcd", textPcd(fields)), conventions).intensity.at(39); };
  EXPECT_EQ(40, last({intensity, reflectivity}));
  scale = 1;  // a dim scan of the same recording
  EXPECT_EQ(40, last({intensity, reflectivity}));
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)last({intensity}); }),
                       "a.pcd: lacks the field reflectivity"));
  conventions = FieldConventions();
  EXPECT_EQ(39, last({reflectivity, intensity}));
}

TEST(CloudFiles, RealPly)
{
  DYSLAM_REQUIRE_DATA();
  const Scan scan = readCloud(*realDataFolder() + "/registration_pairs/small_gicp_source.ply");
  EXPECT_EQ(69792U, scan.size());
  EXPECT_EQ(69792U, scan.intensity.size());
}

TEST(CloudFiles, ListsAndOtherElementsOfPlyAreSkipped)
{
  const TestFolder folder;
  const std::string header =
      " 1.0\ncomment of somebody\nelement camera 1\nproperty float view\n"
      "property list uchar int seen\nelement vertex 2\nproperty list uchar ushort near\n"
      "property float x\nproperty float y\nproperty float z\nproperty uchar ring\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  folder.write("ascii.ply",
               "ply\nformat ascii" + header + "0.5 2 7 8\n1 9 1 2 3 4\n0 5 6 7 8\n3 0 1 1\n");
  for (const bool big : {false, true})
  {
    folder.write(big ? "big.ply" : "little.ply",
                 std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian" +
                     header + bytesOf<float>({0.5F}, big) + "\x02" + bytesOf<int>({7, 8}, big) +
                     "\x01" + bytesOf<std::uint16_t>({9}, big) + bytesOf<float>({1, 2, 3}, big) +
                     "\x04" + std::string(1, '\0') + bytesOf<float>({5, 6, 7}, big) + "\x08" +
                     "\x03" + bytesOf<int>({0, 1, 1}, big));
  }
  for (const char* name : {"ascii.ply", "little.ply", "big.ply"})
  {
    const Scan scan = readCloud(folder.file(name));
    ASSERT_EQ(2U, scan.size()) << name;
    EXPECT_EQ(Eigen::Vector3f(1, 2, 3), scan.points[0]) << name;
    EXPECT_EQ(Eigen::Vector3f(5, 6, 7), scan.points[1]) << name;
    EXPECT_EQ((std::vector<std::uint16_t>{4, 8}), scan.ring) << name;
  }
}

TEST(CloudFiles, CompressedPcd)
{
  const TestFolder folder;
  // Two points: the x as they are, the y as a copy of them, the z as one byte over and over.
  const std::string xs = bytesOf<float>({1.5F, 2.5F});
  const std::string packed =
      "\x07" + xs + "\xC0\x07" + std::string(2, '\0') + "\xA0" + std::string(1, '\0');
  const auto file = [&](const std::string& data, std::uint32_t unpacked)
  {
    return folder.write(
        "a.pcd", pcd_header + "WIDTH 2\nPOINTS 2\nDATA binary_compressed\n" +
                     bytesOf<std::uint32_t>({static_cast<std::uint32_t>(data.size()), unpacked}) +
                     data);
  };
  const Scan scan = readCloud(file(packed, 24));
  ASSERT_EQ(2U, scan.size());
  EXPECT_EQ(Eigen::Vector3f(1.5F, 1.5F, 0), scan.points[0]);
  EXPECT_EQ(Eigen::Vector3f(2.5F, 2.5F, 0), scan.points[1]);
  for (std::size_t size = 0; size < packed.size(); ++size)
  {
    EXPECT_THROW((void)readCloud(file(packed.substr(0, size), 24)), UserError) << size;
  }
  EXPECT_THROW((void)readCloud(file(packed, 25)), UserError);
  EXPECT_THROW((void)readCloud(file("\xC0\x07" + packed, 24)), UserError);  // copies from nowhere
}

TEST(CloudFiles, NumbersOutsideOfTheRangeOfDouble)
{
  const TestFolder folder;
  const std::string path = folder.write(
      "a.pcd", pcd_header + "WIDTH 2\nPOINTS 2\nDATA ascii\n1e-999 -1e999 +1.5\nnan 2 3\n");
  const Scan scan = readCloud(path);
  ASSERT_EQ(scan.size(), 2U);
  EXPECT_EQ(scan.points[0].x(), 0.0F);
  EXPECT_EQ(scan.points[0].y(), -std::numeric_limits<float>::infinity()) << "not a point at 0";
  EXPECT_EQ(scan.points[0].z(), 1.5F);
  EXPECT_TRUE(std::isnan(scan.points[1].x()));
}

TEST(CloudFiles, NoCountTakesMemoryThatTheFileHasNot)
{
  const TestFolder folder;
  const long before = peakMegabytes();
  const std::string many = "4000000000";
  const std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string floats = "property float x\nproperty float y\nproperty float z\nend_header\n";
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.pcd", pcd_header + "WIDTH " + many + "\nPOINTS " + many + "\nDATA binary\nabc"},
      {"a.pcd", pcd_header + "WIDTH " + many + "\nPOINTS " + many + "\nDATA ascii\n1 2 3\n"},
      {"a.pcd", pcd_header + "WIDTH " + many + "\nPOINTS " + many + "\nDATA binary_compressed\n" +
                    bytesOf<std::uint32_t>({4, 0xFFFFFFF0U}) + "abcd"},
      {"a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT " + many + " 0 1\nWIDTH " + many +
                    "\nHEIGHT " + many + "\nDATA binary\nabc"},
      {"a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 0 0 0\nWIDTH " + many +
                    "\nHEIGHT 1\nDATA ascii\nabc"},
      {"a.pcd", "DATA binary_comp"},
      {"a.ply", ply + many + "\n" + floats + "abc"},
      {"a.ply", ply + "1\nproperty list uint double all\n" + floats + bytesOf({0xFFFFFFF0U})},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex " + many + "\n" + floats + "1 2 3\n"},
      {"a.ply", "ply\nformat ascii 1.0\nelement other " + many + "\nelement vertex " + many +
                    "\nend_header\n"}};
  for (const auto& [name, content] : files)
  {
    const std::string said = messageOfError<UserError>([&, n = name, c = content]
                                                       { (void)readCloud(folder.write(n, c)); });
    EXPECT_TRUE(contains(said, "/a.p")) << said;
  }
  EXPECT_LT(peakMegabytes() - before, 200);
}
}  // namespace dyslam
