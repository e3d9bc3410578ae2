// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "Browser.h"

namespace dyslam
{
/** Tests that share one browser, each with a window of the same size; skipped where there is none.
 */
class BrowserTest : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    browser_ = Browser::isInstalled() ? std::make_unique<Browser>() : nullptr;
  }
  static void TearDownTestSuite() { browser_.reset(); }

  void SetUp() override
  {
    if (browser_ == nullptr)
    {
      GTEST_SKIP() << "Chromium is not installed: apt-get install chromium chromium-driver "
                      "(124 MB) to test the page that a run leaves";
    }
    browser_->resize(800, 700);  // small, since it is drawn without a GPU
  }

  [[nodiscard]] static Browser& browser() { return *browser_; }

 private:
  static inline std::unique_ptr<Browser> browser_;
};
}  // namespace dyslam
