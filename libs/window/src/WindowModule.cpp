// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/base/Version.h>
#include <dyslam/window/SceneWindow.h>
#include <mrpt/gui/CDisplayWindow3D.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <utility>

namespace dyslam
{
namespace
{
/** MRPT's window, seen from behind and above a vehicle that drives along x. */
class MrptWindow : public SceneWindow
{
 public:
  explicit MrptWindow(const std::string& title)
      : window_(mrpt::gui::CDisplayWindow3D::Create(title, width, height))
  {
    window_->setCameraAzimuthDeg(180);
    window_->setCameraElevationDeg(35);
    window_->setCameraZoom(50);
    window_->setMaxRange(2000);
  }

  [[nodiscard]] bool isOpen() const override { return window_->isOpen(); }

  void show(const mrpt::opengl::COpenGLScene::Ptr& scene, const Eigen::Vector3d& centre) override
  {
    if (!isOpen())
    {
      return;
    }
    follow(centre);
    window_->get3DSceneAndLock() = scene;
    window_->unlockAccess3DScene();
    window_->forceRepaint();
  }

 private:
  static constexpr int width = 1280;
  static constexpr int height = 800;

  void follow(const Eigen::Vector3d& centre)
  {
    Eigen::Vector3f at;
    window_->getCameraPointingToPoint(at.x(), at.y(), at.z());
    at += (centre - centre_).cast<float>();
    window_->setCameraPointingToPoint(at.x(), at.y(), at.z());
    centre_ = centre;
  }

  mrpt::gui::CDisplayWindow3D::Ptr window_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
};
}  // namespace
}  // namespace dyslam

// The functions of the module `window`.
extern "C"
{
  dyslam::RuntimeModuleVersion dyslam_module_version;
  dyslam::OpenSceneWindow dyslam_open_window;

  const char* dyslam_module_version()
  {
    return DYSLAM_VERSION;
  }

  dyslam::SceneWindow* dyslam_open_window(const std::string& title)
  {
    auto window = std::make_unique<dyslam::MrptWindow>(title);
    return window->isOpen() ? window.release() : nullptr;
  }
}
