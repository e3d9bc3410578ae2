// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/SceneExport.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloudColoured.h>

#include <memory>

#include "FullDisk.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
mrpt::img::TColor colourOf(mrpt::opengl::COpenGLScene& scene, const std::string& name)
{
  const auto object = scene.getByName(name);
  EXPECT_TRUE(object) << name;
  return object ? object->getColor_u8() : mrpt::img::TColor();
}

bool same(const mrpt::img::TColor& a, const mrpt::img::TColor& b)
{
  return a.R == b.R && a.G == b.G && a.B == b.B;
}
}  // namespace

TEST(SceneExport, BoxAndPathOfAnObjectHaveOneColour)
{
  const TestFolder folder;
  SceneContent content;
  for (const int id : {4, 7})
  {
    LabelledBox box;
    box.id = id;
    box.box.size = {4, 2, 1.5};
    content.boxes.push_back(box);
    content.object_paths[id] = {{0, 0, 0}, {1, static_cast<double>(id), 0}};
  }
  writeScene(content, folder.file("a.3Dscene"));
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(folder.file("a.3Dscene")));
  for (const std::string id : {"4", "7"})
  {
    EXPECT_TRUE(same(colourOf(scene, "object " + id), colourOf(scene, "object path " + id))) << id;
  }
  EXPECT_FALSE(same(colourOf(scene, "object 4"), colourOf(scene, "object 7")));
}

/** A floor of 10 m by 10 m; the ceiling over it would hide it. */
TEST(SceneExport, CeilingsAreAnObjectThatIsNotVisible)
{
  const TestFolder folder;
  SceneContent content;
  const auto add = [&](float height)
  {
    for (int i = 0; i < 2500; ++i)
    {
      content.points.emplace_back(0.2F * static_cast<float>(i % 50),
                                  0.2F * static_cast<float>(i / 50), height);
      content.intensity.push_back(0.5F);
    }
  };
  add(0);
  writeScene(content, folder.file("open.3Dscene"));
  add(3);
  writeScene(content, folder.file("room.3Dscene"));
  const auto load = [&](const char* name)
  {
    mrpt::opengl::COpenGLScene scene;
    EXPECT_TRUE(scene.loadFromFile(folder.file(name)));
    return scene;
  };
  auto open = load("open.3Dscene");
  ASSERT_TRUE(open.getByName("map"));
  EXPECT_FALSE(open.getByName("ceilings"));
  auto room = load("room.3Dscene");
  const auto map =
      std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(room.getByName("map"));
  const auto ceilings =
      std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(room.getByName("ceilings"));
  ASSERT_TRUE(map && ceilings);
  EXPECT_TRUE(map->isVisible());
  EXPECT_FALSE(ceilings->isVisible());
  EXPECT_EQ(map->size() + ceilings->size(), content.points.size());
  EXPECT_GT(ceilings->size(), 2000U);
  EXPECT_FLOAT_EQ(ceilings->getPoint3Df(0).z, 3);
}

TEST(SceneExport, AFullDiskLeavesTheEarlierFile)
{
  const TestFolder folder;
  folder.write("a.3Dscene", "an earlier one");
  const test::FullDisk full_disk;
  EXPECT_THROW(writeScene({}, folder.file("a.3Dscene")), UserError);
  EXPECT_EQ("an earlier one", folder.read("a.3Dscene"));
  EXPECT_THROW(writeScene({}, folder.path()), UserError);
}
}  // namespace dyslam
