// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/plot/MapPicture.h>
#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <utility>

namespace dyslam
{
namespace
{
/** A vehicle drives 20 m along x with a margin of 10 m: a picture of 40 m x 20 m. */
MapPictureContent drive()
{
  MapPictureContent content;
  for (int i = 0; i <= 20; ++i)
  {
    content.path.emplace_back(i, 0, 0);
  }
  return content;
}

const MapPictureOptions options{800, 10, 0.05};

TEST(MapPicture, ShowsThePartAroundThePathAndTheHeightAsDarkness)
{
  MapPictureContent content = drive();
  std::vector<Eigen::Vector3f> points;
  for (int i = -400; i < 700; ++i)  // ground everywhere, a wall 5 m to the left
  {
    const float x = 0.05F * static_cast<float>(i);
    points.emplace_back(x, 5.5F, 0.0F);
    points.emplace_back(x, 5.0F, 4.5F);
    points.emplace_back(x, -5.0F, 0.0F);
  }
  content.points = &points;
  const cv::Mat picture = cv::imdecode(renderMapPicture(content, options), cv::IMREAD_COLOR);
  ASSERT_EQ(picture.cols, 800);
  ASSERT_EQ(picture.rows, 460);  // 20 pixels a metre, y = 10 m in the first row; 60 for the legend
  const auto grey = [&](int x, int y) { return static_cast<int>(picture.at<cv::Vec3b>(y, x)[1]); };
  EXPECT_LT(grey(500, 100), 100) << "wall";
  EXPECT_GT(grey(500, 300), 180) << "ground";
  EXPECT_LT(grey(500, 300), 240) << "ground";
  EXPECT_EQ(grey(500, 250), 255) << "nothing known";
  EXPECT_GT(picture.at<cv::Vec3b>(200, 400)[0], 150) << "the path is blue";
  EXPECT_LT(picture.at<cv::Vec3b>(200, 400)[2], 60);
}

/** A corridor 20 m long and 6 m wide under a ceiling, with walls, and a shelf of 1.5 m. */
TEST(MapPicture, ShowsTheFloorUnderACeiling)
{
  MapPictureContent content = drive();
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 200; ++i)
  {
    const float x = 0.1F * static_cast<float>(i);
    for (int k = -30; k < 30; ++k)
    {
      const float y = 0.1F * static_cast<float>(k);
      points.emplace_back(x, y, 0.0F);
      points.emplace_back(x, y, 3.0F);
    }
    for (int k = 0; k <= 30; ++k)
    {
      points.emplace_back(x, 3.0F, 0.1F * static_cast<float>(k));
      points.emplace_back(x, -3.0F, 0.1F * static_cast<float>(k));
    }
  }
  for (int k = 0; k < 15; ++k)
  {
    points.emplace_back(10.05F, 2.05F, 0.1F * static_cast<float>(k));
  }
  content.points = &points;
  const cv::Mat picture = cv::imdecode(renderMapPicture(content, options), cv::IMREAD_COLOR);
  // The margin is 5 m, as far as the points reach and two more: 30 m x 10 m.
  ASSERT_EQ(picture.cols, 600);
  const auto grey = [&](double x, double y)
  {
    return static_cast<int>(
        picture.at<cv::Vec3b>(static_cast<int>(20 * (5 - y)), static_cast<int>(20 * (5 + x)))[1]);
  };
  EXPECT_GT(grey(5, 2), 200) << "floor";
  EXPECT_GT(grey(15, -2), 200) << "floor";
  EXPECT_LT(grey(8, 3), 120) << "wall";
  EXPECT_LT(grey(8, -3), 120) << "wall";
  EXPECT_LT(grey(10.05, 2.05), 160) << "shelf";
  EXPECT_GT(grey(10.05, 2.05), 110) << "not the ceiling over it";
}

/** Of a distant wall often a single ring is seen, high up. */
TEST(MapPicture, ALineOfPointsIsNoCeiling)
{
  MapPictureContent content = drive();
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 300; ++i)
  {
    const float along = 0.05F * static_cast<float>(i);
    points.emplace_back(along, 0.3F * along + 1, 4.5F);
    points.emplace_back(along, 0.3F * along + 1, 0.0F);
    points.emplace_back(along, 9.5F, 0.0F);
  }
  content.points = &points;
  const cv::Mat picture = cv::imdecode(renderMapPicture(content, options), cv::IMREAD_COLOR);
  const int x = 400;  // 10 m
  const int y = static_cast<int>(20 * (10 - 4));
  EXPECT_LT(static_cast<int>(picture.at<cv::Vec3b>(y, x)[1]), 100);
}

TEST(MapPicture, ShowsObjectsWhereTheyWere)
{
  MapPictureContent content = drive();
  content.objects.push_back(
      {ObjectClass::car, {{5, -5, 0}, {15, -5, 0}}, {{15, -5, 0}, {4, 2, 1.5}, 0}});
  const cv::Mat picture = cv::imdecode(renderMapPicture(content, options), cv::IMREAD_COLOR);
  const cv::Vec3b path = picture.at<cv::Vec3b>(300, 400);
  EXPECT_GT(path[2], 150);
  EXPECT_LT(path[0], 100);
  EXPECT_EQ(picture.at<cv::Vec3b>(320, 540)[1] < 200, true) << "side of the box";
}

TEST(MapPicture, MarksStartAndEnd)
{
  const cv::Mat picture = cv::imdecode(renderMapPicture(drive(), options), cv::IMREAD_COLOR);
  const cv::Vec3b start = picture.at<cv::Vec3b>(200, 200);
  EXPECT_GT(start[1], start[2] + 60) << "green";
  const cv::Vec3b end = picture.at<cv::Vec3b>(200, 600);
  EXPECT_GT(end[2], end[1] + 60) << "red";
  // A dot and a square tell them apart without colours: 5 pixels from the centre in x and y.
  EXPECT_LT(cv::norm(picture.at<cv::Vec3b>(205, 605), end), 60) << "corner of the square";
  EXPECT_GT(cv::norm(picture.at<cv::Vec3b>(205, 195), start), 150) << "outside of the dot";
}

TEST(MapPicture, ComparisonHidesNothingOfTheMap)
{
  MapPictureContent content = drive();
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 160000; ++i)  // everywhere
  {
    points.emplace_back(0.1F * static_cast<float>(i % 400) - 9.95F,
                        0.05F * static_cast<float>(i / 400) - 9.95F, 0.0F);
  }
  content.points = &points;
  const cv::Mat picture =
      cv::imdecode(renderMapComparison({"a", content}, {"b", content}, options), cv::IMREAD_COLOR);
  ASSERT_EQ(picture.cols, 800);
  ASSERT_EQ(picture.rows, 2 * (36 + 400) + 6);
  for (const cv::Rect panel : {cv::Rect(0, 36, 800, 180), cv::Rect(0, 260, 800, 170),
                               cv::Rect(0, 480, 800, 160), cv::Rect(0, 702, 800, 176)})
  {
    double darkest = 0;
    double lightest = 0;
    cv::minMaxLoc(picture(panel).reshape(1), &darkest, &lightest);
    EXPECT_EQ(darkest, lightest) << "ground only";
  }
}

TEST(MapPicture, ComparisonShowsThePartAroundThePathsOfBoth)
{
  const MapPictureContent before = drive();
  MapPictureContent merged = before;
  merged.path.emplace_back(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (int i = 20; i <= 60; ++i)
  {
    merged.path.emplace_back(i, 0, 0);
  }
  for (const bool first : {true, false})
  {
    const auto& a = first ? merged : before;
    const auto& b = first ? before : merged;
    const cv::Mat picture =
        cv::imdecode(renderMapComparison({"a", a}, {"b", b}, options), cv::IMREAD_COLOR);
    ASSERT_EQ(picture.cols, 800) << "80 m";
    ASSERT_EQ(picture.rows, 2 * (36 + 200) + 6);
    const int above = 36 + 100;  // y = 0
    const int below = above + 36 + 200 + 6;
    const cv::Vec3b shown = picture.at<cv::Vec3b>(first ? above : below, 600);  // x = 50 m
    EXPECT_GT(shown[0], 150) << "the path is blue";
    EXPECT_LT(shown[2], 60);
    EXPECT_EQ(picture.at<cv::Vec3b>(first ? below : above, 600), cv::Vec3b(255, 255, 255));
  }
}

/** Two runs 10 m apart, the second from right to left. */
TEST(MapPicture, EachRunHasItsColourItsEndsAndALegend)
{
  MapPictureContent content;
  content.runs = {{"monday", {}}, {"tuesday", {}}};
  for (int i = 0; i <= 20; ++i)
  {
    content.runs[0].path.emplace_back(i, 5, 0);
    content.runs[1].path.emplace_back(20 - i, -5, 0);
  }
  const cv::Mat picture = cv::imdecode(renderMapPicture(content, options), cv::IMREAD_COLOR);
  const cv::Mat both =
      cv::imdecode(renderMapComparison({"a", content}, {"b", content}, options), cv::IMREAD_COLOR);
  ASSERT_EQ(800, picture.cols);  // 20 pixels a metre, 30 m high
  ASSERT_EQ(600 + 3 * 24 + 12, picture.rows);
  ASSERT_EQ(2 * (36 + 600) + 6 + 2 * 24 + 12, both.rows);
  for (const bool alone : {true, false})
  {
    const cv::Mat& image = alone ? picture : both;
    const int top = alone ? 0 : 36;
    const int legend = alone ? 600 : 2 * (36 + 600) + 6;
    const auto at = [&](int x, int y) { return image.at<cv::Vec3b>(y, x); };
    const auto distance = [](const cv::Vec3b& a, const cv::Vec3b& b)
    { return cv::norm(cv::Vec3i(a) - cv::Vec3i(b)); };
    const cv::Vec3b monday = at(400, top + 200);
    const cv::Vec3b tuesday = at(400, top + 400);
    EXPECT_GT(monday[0], monday[2] + 100) << "blue";
    EXPECT_GT(tuesday[2], tuesday[0] + 100) << "orange";
    EXPECT_LT(distance(monday, at(30, legend + 18)), 60) << "the sample in the legend";
    EXPECT_LT(distance(tuesday, at(30, legend + 42)), 60);
    for (const auto& [start, end] : {std::pair(at(200, top + 200), at(600, top + 200)),
                                     {at(600, top + 400), at(200, top + 400)}})
    {
      EXPECT_GT(start[1], start[2] + 60) << "green";
      EXPECT_GT(end[2], end[1] + 60) << "red";
    }
  }
}

/** The fonts have ASCII only. */
TEST(MapPicture, NamesThatAreNotAsciiAreReadable)
{
  const auto pictureOf = [](const std::string& name)
  {
    MapPictureContent content;
    content.runs = {{"monday", drive().path}, {name, drive().path}};
    return renderMapPicture(content, options);
  };
  EXPECT_EQ(pictureOf("Zürich_Straße"), pictureOf("Zurich_Strasse"));
  EXPECT_EQ(pictureOf("Łódź čáp"), pictureOf("Lodz cap"));
  EXPECT_EQ(pictureOf("Mu\xCC\x88nchen"), pictureOf("Munchen")) << "u and a combining accent";
  EXPECT_EQ(pictureOf("東京"), pictureOf("??")) << "one a character";
  EXPECT_EQ(pictureOf("a\xFF\x80"), pictureOf("a?")) << "no UTF-8";
}

TEST(MapPicture, OfNothingIsNone)
{
  EXPECT_TRUE(renderMapPicture({}).empty());
  EXPECT_TRUE(renderMapComparison({"a", {}}, {"b", {}}).empty());
  EXPECT_THROW((void)renderMapPicture(drive(), {0, 10, 0.1}), std::invalid_argument);
}
}  // namespace
}  // namespace dyslam
