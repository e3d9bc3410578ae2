// SPDX-License-Identifier: BSD-3-Clause
// A Hesai that turns ten times per second inside a sphere of 12 m, packet by packet. It knows
// nothing of the readers.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "SyntheticCapture.h"

namespace dyslam
{
enum class HesaiKind
{
  pandar40,
  pandar64,
  xt16,
  xt32,
  xt32m2x,
  qt64,
  qt128,
  pandar128,
  ot128,  //!< with three further bytes for each return
  jt128
};

struct SyntheticHesai
{
  static constexpr double turn = 0.1;  //!< [s]

  HesaiKind kind = HesaiKind::xt32;
  bool dual = false;         //!< every firing has two blocks
  double clock_zero = 1e9;   //!< UNIX time of the first firing by the sensor's clock, whole [s]
  double first_azimuth = 0;  //!< [deg]
  bool clockwise = true;
  bool fine = false;             //!< a Pandar128 or OT128 at high resolution
  bool years_from_2000 = false;  //!< in the date, of models that count from 1900 as a rule; or
                                 //!< from 1900, of those that count from 2000

  struct Shape
  {
    std::size_t lasers, blocks;
    double period;  //!< of the firings [s]
    int major, minor;
    std::size_t unit;  //!< [mm]
    double delay;      //!< of the packet's time after the begin of the firing that it is of [s]
  };
  [[nodiscard]] Shape shape() const
  {
    switch (kind)
    {
      case HesaiKind::pandar40:
        return {40, 10, 55.56e-6, 0, 0, 4, 84.14e-6};
      case HesaiKind::pandar64:
        return {64, 6, 55.56e-6, 0, 0, 4, 98.14e-6};
      case HesaiKind::xt16:
        return {16, 8, 50e-6, 6, 1, 4, -5.632e-6};
      case HesaiKind::xt32:
        return {32, 8, 50e-6, 6, 1, 4, -5.632e-6};
      case HesaiKind::xt32m2x:
        return {32, 6, 50e-6, 6, 1, 4, -5.632e-6};
      case HesaiKind::qt64:
        return {64, 4, 166.67e-6, 3, 1, 4, -25.71e-6};
      case HesaiKind::qt128:
        return {128, 2, 111.11e-6, 3, 2, 4, -9e-6};
      case HesaiKind::jt128:
        return {128, 2, 111e-6, 1, 4, 4, 1888e-6};
      default:
        return {128,
                2,
                fine ? 27.778e-6 : 55.556e-6,
                1,
                4,
                4,
                kind == HesaiKind::pandar128 ? -3.148e-6 : 0};
    }
  }

  [[nodiscard]] std::size_t returns() const { return dual ? 2 : 1; }
  [[nodiscard]] double packetTime() const
  {
    return shape().period * static_cast<double>(shape().blocks / returns());
  }
  /** Channel 3 sees nothing, the second return of channel 5 is 2 m behind the first. */
  [[nodiscard]] std::uint16_t range(std::size_t laser, std::size_t echo) const
  {
    const std::size_t mm = laser == 2 ? 0 : laser == 4 && echo == 1 ? 14000 : 12000;
    return static_cast<std::uint16_t>(mm / shape().unit);
  }
  /** Range of a return, which a QT128 does not have of the lasers that a firing leaves out. */
  [[nodiscard]] std::uint16_t rangeInFiring(std::size_t firing,
                                            std::size_t laser,
                                            std::size_t echo) const
  {
    constexpr std::size_t quarter = 32;
    const std::size_t left_out = firing % 2 == 0 ? 1 : 0;
    return kind == HesaiKind::qt128 && laser / quarter == left_out ? std::uint16_t{0}
                                                                   : range(laser, echo);
  }
  [[nodiscard]] bool isOfFlags() const { return kind == HesaiKind::qt128 || shape().major == 1; }

  /** The packet number `n` from 0 on. */
  [[nodiscard]] std::string packet(std::size_t n) const
  {
    const Shape s = shape();
    const double begin = static_cast<double>(n) * packetTime();
    std::string bytes = header(s);
    for (std::size_t block = 0; block < s.blocks; ++block)
    {
      const double seconds = begin + s.period * static_cast<double>(block / returns());
      const double stated = statesEnds() ? seconds + s.period : seconds;
      const double turned = 360 * stated / turn * (clockwise ? 1 : -1);
      const double degrees = std::fmod(std::fmod(first_azimuth + turned, 360.0) + 360, 360.0);
      bytes += kind == HesaiKind::pandar40 ? "\xff\xee" : "";
      appendBytes(bytes, static_cast<std::uint16_t>(100 * degrees));
      for (std::size_t laser = 0; laser < s.lasers; ++laser)
      {
        appendBytes(bytes, rangeInFiring(n * s.blocks / returns() + block / returns(), laser,
                                         block % returns()));
        bytes += '\x33';
        bytes += std::string(furtherBytes(), 'c');
      }
    }
    const bool stamps_first = s.major == 3;
    const double last = begin + packetTime() - s.period;
    return bytes + tail(n, clock_zero + (stamps_first ? begin : last) + s.delay);
  }

 private:
  [[nodiscard]] bool statesEnds() const
  {
    return kind == HesaiKind::pandar40 || kind == HesaiKind::pandar64;
  }
  /** Number of bytes of a return behind range and reflectivity. */
  [[nodiscard]] std::size_t furtherBytes() const
  {
    return kind == HesaiKind::ot128 ? 3 : kind == HesaiKind::jt128 || shape().major >= 3 ? 1 : 0;
  }

  [[nodiscard]] std::string header(const Shape& s) const
  {
    if (kind == HesaiKind::pandar40)
    {
      return "";
    }
    std::string bytes = "\xee\xff";
    if (kind == HesaiKind::pandar64)
    {
      return bytes + static_cast<char>(s.lasers) + static_cast<char>(s.blocks) +
             std::string("\x00\x04\x00\x00", 4);
    }
    bytes += static_cast<char>(s.major);
    bytes += static_cast<char>(s.minor);
    bytes += kind == HesaiKind::jt128 ? '\x8a' : kind == HesaiKind::ot128 ? '\x81' : '\0';
    bytes += '\0';
    bytes += static_cast<char>(s.lasers);
    bytes += static_cast<char>(s.blocks);
    bytes += '\0';
    bytes += static_cast<char>(s.unit);
    bytes += static_cast<char>(returns());
    const char further = furtherBytes() == 3 ? '\x70' : furtherBytes() == 1 ? '\x10' : '\0';
    bytes += static_cast<char>(isOfFlags() ? further | '\x05' : '\x01');  // sequence, safety, ...
    return bytes;
  }

  /** 2001-09-09 01:46:40 UTC is the time 1e9. */
  [[nodiscard]] std::string date(double time, int year_zero) const
  {
    const auto seconds = static_cast<std::uint64_t>(std::floor(time) - 1e9 + 40);
    std::string bytes;
    for (const std::uint64_t value :
         {static_cast<std::uint64_t>(2001 - (years_from_2000 ? 3900 - year_zero : year_zero)),
          std::uint64_t{9}, std::uint64_t{9}, std::uint64_t{1}, 46 + seconds / 60, seconds % 60})
    {
      bytes += static_cast<char>(value);
    }
    return bytes;
  }

  /** \param n number of the packet. \param time that it states [s] */
  [[nodiscard]] std::string tail(std::size_t n, double time) const
  {
    std::string clock;
    appendBytes(clock, static_cast<std::uint32_t>(std::lround(1e6 * std::fmod(time, 1.0))));
    const std::string mode(1, dual ? '\x39' : '\x37');
    const std::string speed("\x58\x02", 2);
    const std::string factory("\x42");
    const std::string sequence(4, '\x07');
    const auto zeros = [](std::size_t count) { return std::string(count, '\0'); };
    if (kind == HesaiKind::pandar40 || kind == HesaiKind::pandar64)
    {
      return zeros(8) + speed + clock + mode + factory + date(time, 2000);
    }
    if (kind == HesaiKind::qt64)
    {
      return zeros(10) + speed + clock + mode + factory + date(time, 1900) + sequence;
    }
    if (isOfFlags())
    {
      // Which sequence a QT128's first firing is of, and the operational state of others.
      const std::string mode_flag(1, static_cast<char>(dual ? n % 2 : 0));
      const std::string state(1, fine ? '\0' : '\2');
      return zeros(4) + zeros(17) + zeros(5) + mode_flag + zeros(5) + state + mode + speed +
             date(time, 1900) + clock + factory + sequence + zeros(4);
    }
    return zeros(10) + mode + speed + date(time, 1900) + clock + factory + sequence;
  }
};

/** A capture of the packets of some time [s]. */
inline std::string capturedHesai(const SyntheticHesai& lidar, double duration)
{
  constexpr std::size_t port = 2368;
  std::string file = captureHeader();
  for (std::size_t n = 0; static_cast<double>(n) * lidar.packetTime() < duration; ++n)
  {
    appendFrame(file, 1000.0 + static_cast<double>(n) * lidar.packetTime(),
                ipFrame(udpDatagram(lidar.packet(n), port), 0, 0));
  }
  return file;
}
}  // namespace dyslam
