// SPDX-License-Identifier: BSD-3-Clause
#include "Browser.h"

#include <arpa/inet.h>
#include <dyslam/base/Files.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <thread>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
using Json = nlohmann::json;

const char* const chromium = "/usr/bin/chromium";
const char* const chromedriver = "/usr/bin/chromedriver";

/** Whether a response is complete: its head and as much body as the head states. The connection
 * stays open. */
bool isWhole(const std::string& answer)
{
  const std::string field = "content-length:";
  std::string lower = answer.substr(0, answer.find("\r\n\r\n"));
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto at = lower.find(field);
  return lower.size() < answer.size() && at != std::string::npos &&
         answer.size() >= lower.size() + 4 + std::stoul(lower.substr(at + field.size()));
}

/** Sends an HTTP request. \return the response */
std::string request(int port, const std::string& text)
{
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval patience{180, 0};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string answer;
  if (::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
      ::send(socket, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()))
  {
    char buffer[65536];
    ssize_t n = 1;
    while (n > 0 && !isWhole(answer))
    {
      n = ::recv(socket, buffer, sizeof buffer, 0);
      answer.append(buffer, n > 0 ? static_cast<std::size_t>(n) : 0);
    }
  }
  ::close(socket);
  return answer;
}
}  // namespace

/** The running chromedriver. */
struct Browser::Driver
{
  Driver()
  {
    const std::string command = std::string("echo $$; exec ") + chromedriver + " --port=0 2>&1";
    pipe = ::popen(command.c_str(), "r");
    char line[512];
    while (port == 0 && pipe != nullptr && std::fgets(line, sizeof line, pipe) != nullptr)
    {
      if (pid == 0)
      {
        pid = std::atoi(line);
      }
      (void)std::sscanf(line, "ChromeDriver was started successfully on port %d", &port);
    }
    if (port == 0)
    {
      throw std::runtime_error("chromedriver does not start");
    }
    profile = fs::temp_directory_path() / ("dyslam_browser_" + std::to_string(::getpid()));
  }
  ~Driver()
  {
    ::kill(pid, SIGTERM);
    ::pclose(pipe);
    std::error_code ignored;
    fs::remove_all(profile, ignored);
  }

  FILE* pipe = nullptr;
  int pid = 0;
  int port = 0;
  fs::path profile;
};

bool Browser::isInstalled()
{
  return fs::exists(chromium) && fs::exists(chromedriver);
}

Browser::Browser() : driver_(std::make_unique<Driver>())
{
  Json arguments = {"--headless",
                    "--no-sandbox",
                    "--disable-quic",
                    "--no-first-run",
                    "--disable-background-networking",
                    "--disable-component-update",
                    "--disable-sync",
                    "--use-gl=angle",
                    "--use-angle=swiftshader",
                    "--enable-unsafe-swiftshader",
                    "--user-data-dir=" + driver_->profile.string()};
  const Json options = {{"binary", chromium}, {"args", arguments}};
  const Json wanted = {{"goog:chromeOptions", options},
                       {"goog:loggingPrefs", {{"browser", "SEVERE"}}}};
  session_ =
      "/session/" + command("POST", "/session", {{"capabilities", {{"alwaysMatch", wanted}}}})
                        .at("sessionId")
                        .get<std::string>();
}

Browser::~Browser()
{
  try
  {
    (void)command("DELETE", session_, nullptr);
  }
  catch (const std::exception&)
  {
    // chromedriver has ended already
  }
}

Json Browser::command(const std::string& method, const std::string& path, const Json& body)
{
  const std::string content = body.is_null() ? "" : body.dump();
  const std::string answer =
      request(driver_->port, method + ' ' + path +
                                 " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n"
                                 "Content-Type: application/json\r\nContent-Length: " +
                                 std::to_string(content.size()) + "\r\n\r\n" + content);
  const auto begin = answer.find("\r\n\r\n");
  if (begin == std::string::npos)
  {
    throw std::runtime_error("chromedriver does not answer " + path);
  }
  Json value = Json::parse(answer.substr(begin + 4)).at("value");
  if (value.is_object() && value.contains("error"))
  {
    throw std::runtime_error(path + ": " + value.at("message").get<std::string>());
  }
  return value;
}

std::string Browser::elementPath(const std::string& id)
{
  const Json found =
      command("POST", session_ + "/element", {{"using", "css selector"}, {"value", '#' + id}});
  return session_ + "/element/" + found.begin().value().get<std::string>();
}

void Browser::scrollTo(const std::string& id)
{
  (void)run("document.getElementById('" + id + "').scrollIntoView({block: 'center'})");
}

void Browser::resize(int width, int height)
{
  (void)command("POST", session_ + "/window/rect", {{"width", width}, {"height", height}});
}

void Browser::open(const std::string& file)
{
  (void)command("POST", session_ + "/url", {{"url", "file://" + fs::absolute(file).string()}});
}

Json Browser::run(const std::string& script)
{
  return command("POST", session_ + "/execute/sync", {{"script", script}, {"args", Json::array()}});
}

bool Browser::waitFor(const std::string& script, double seconds)
{
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  while (run(script) != true)
  {
    if (std::chrono::duration<double>(Clock::now() - start).count() > seconds)
    {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return true;
}

void Browser::click(const std::string& id)
{
  scrollTo(id);  // the driver's own scrolling leaves elements under the bar at the top
  (void)command("POST", elementPath(id) + "/click", Json::object());
}

void Browser::type(const std::string& id, const std::string& keys)
{
  (void)command("POST", elementPath(id) + "/value", {{"text", keys}});
}

std::string Browser::screenshot(const std::string& id)
{
  scrollTo(id);  // only what the window shows is in the picture
  return command("GET", elementPath(id) + "/screenshot", nullptr).get<std::string>();
}

std::string Browser::errors()
{
  std::string text;
  for (const Json& entry : command("POST", session_ + "/se/log", {{"type", "browser"}}))
  {
    text += entry.at("message").get<std::string>() + '\n';
  }
  return text;
}
}  // namespace dyslam
