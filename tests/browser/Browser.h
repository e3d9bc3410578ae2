// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace dyslam
{
/** Headless Chromium, controlled by chromedriver (the WebDriver protocol of the W3C). Every
 * function throws std::runtime_error if chromedriver fails. */
class Browser
{
 public:
  /** Whether Chromium and chromedriver are installed. */
  [[nodiscard]] static bool isInstalled();

  /** Starts chromedriver and Chromium. */
  Browser();
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  void resize(int width, int height);
  void open(const std::string& file);
  /** Result of a JavaScript function. \param script body of the function */
  [[nodiscard]] nlohmann::json run(const std::string& script);
  /** Runs the body of a JavaScript function repeatedly until it returns true. \return false after
   * `seconds` [s] */
  [[nodiscard]] bool waitFor(const std::string& script, double seconds = 60);
  /** Clicks on an element as a user does. \param id of the element */
  void click(const std::string& id);
  void type(const std::string& id, const std::string& keys);
  /** PNG of an element in base64. */
  [[nodiscard]] std::string screenshot(const std::string& id);
  /** Errors that the page has caused since the last call, one a line. */
  [[nodiscard]] std::string errors();

 private:
  [[nodiscard]] nlohmann::json command(const std::string& method,
                                       const std::string& path,
                                       const nlohmann::json& body);
  void scrollTo(const std::string& id);
  [[nodiscard]] std::string elementPath(const std::string& id);

  struct Driver;
  std::unique_ptr<Driver> driver_;
  std::string session_;
};
}  // namespace dyslam
