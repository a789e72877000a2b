#ifndef STUB__RCLCPP__RCLCPP_HPP_
#define STUB__RCLCPP__RCLCPP_HPP_

#include <cstdio>
#include <string>

namespace rclcpp
{
struct Time {};
struct Duration {};
struct Logger {};
inline Logger get_logger(const std::string &) {return {};}
}  // namespace rclcpp

#define STUB_LOG(level, logger, ...) \
  do { \
    (void)(logger); \
    std::printf(level " "); \
    std::printf(__VA_ARGS__); \
    std::printf("\n"); \
    std::fflush(stdout); \
  } while (false)
#define RCLCPP_INFO(logger, ...) STUB_LOG("info", logger, __VA_ARGS__)
#define RCLCPP_WARN(logger, ...) STUB_LOG("warn", logger, __VA_ARGS__)
#define RCLCPP_ERROR(logger, ...) STUB_LOG("error", logger, __VA_ARGS__)

#endif  // STUB__RCLCPP__RCLCPP_HPP_
