// Plays the controller manager without ROS: two wheels, the second one mirrored, at 100 Hz.
//
// drive SOCKET. It reads commands from its standard input, a line each, and prints one line for each:
//
//   activate | deactivate | shutdown   calls the plugin
//   set SPEED SPEED                    the commands, in rad/s
//   switch                             the controller stops, and leaves its commands
//   state                              position, velocity and temperature of both wheels
//
// As the controller manager does, it calls on_error after an error of read or write, and configures again at `configure`.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <sstream>
#include <string>
#include <thread>

#include "motorlink_hardware/motorlink_system.hpp"

using hardware_interface::CallbackReturn;
using hardware_interface::return_type;

namespace
{

hardware_interface::ComponentInfo joint(
  const std::string & name, const std::string & id, const std::string & mirrored)
{
  hardware_interface::ComponentInfo info;
  info.name = name;
  info.parameters = {{"id", id}, {"mirrored", mirrored}, {"max_rpm", "150"}};
  info.command_interfaces = {{"velocity"}};
  info.state_interfaces = {{"position"}, {"velocity"}, {"temperature"}};
  return info;
}

CallbackReturn init(
  motorlink_hardware::MotorLinkSystem & system, const hardware_interface::HardwareInfo & info)
{
#if __has_include("hardware_interface/types/hardware_component_interface_params.hpp")
  hardware_interface::HardwareComponentInterfaceParams parameters;
  parameters.hardware_info = info;
  return system.on_init(parameters);
#else
  return system.on_init(info);
#endif
}

const char * word(CallbackReturn result)
{
  return result == CallbackReturn::SUCCESS ? "success" : "failed";
}

// A line of the standard input, if there is one.
bool next_line(std::string & line)
{
  static std::string pending;
  pollfd waits{STDIN_FILENO, POLLIN, 0};
  if (pending.find('\n') == std::string::npos && poll(&waits, 1, 0) > 0) {
    char bytes[256];
    const ssize_t got = ::read(STDIN_FILENO, bytes, sizeof(bytes));
    if (got <= 0) {
      line = "shutdown";
      return true;
    }
    pending.append(bytes, static_cast<std::size_t>(got));
  }
  const std::size_t end = pending.find('\n');
  if (end == std::string::npos) {
    return false;
  }
  line = pending.substr(0, end);
  pending.erase(0, end + 1);
  return true;
}

}  // namespace

int main(int count, char ** arguments)
{
  if (count != 2) {
    return 2;
  }
  motorlink_hardware::MotorLinkSystem system;
  hardware_interface::HardwareInfo info;
  info.name = "hub_motors";
  // A busy machine is slow. The lease of 100 ms is that of the server.
  info.hardware_parameters = {{"socket", arguments[1]}, {"stale_after_ms", "400"}};
  info.joints = {joint("left", "1", "false"), joint("right", "2", "true")};
  const rclcpp_lifecycle::State previous;
  if (init(system, info) != CallbackReturn::SUCCESS) {
    return 1;
  }
  const auto states = system.export_state_interfaces();
  const auto commands = system.export_command_interfaces();
  bool is_configured = system.on_configure(previous) == CallbackReturn::SUCCESS;
  std::cout << (is_configured ? "configured" : "not configured") << std::endl;
  std::cout.precision(12);
  bool is_active = false;
  auto next = std::chrono::steady_clock::now();
  for (;;) {
    std::string line;
    // One in each turn, so that the motors are read between two commands.
    if (next_line(line)) {
      std::istringstream words(line);
      std::string command;
      words >> command;
      if (command == "configure") {
        is_configured = system.on_configure(previous) == CallbackReturn::SUCCESS;
        std::cout << (is_configured ? "configured" : "not configured") << std::endl;
      } else if (command == "activate") {
        const auto result = system.on_activate(previous);
        is_active = result == CallbackReturn::SUCCESS;
        std::cout << "activate " << word(result) << std::endl;
      } else if (command == "deactivate") {
        is_active = false;
        const auto result = system.on_deactivate(previous);
        std::cout << "deactivate " << word(result) << std::endl;
      } else if (command == "set") {
        words >> *commands[0].value >> *commands[1].value;
        std::cout << "set" << std::endl;
      } else if (command == "switch") {
        system.perform_command_mode_switch({}, {"left/velocity", "right/velocity"});
        std::cout << "switched" << std::endl;
      } else if (command == "state") {
        std::cout << "state";
        for (const auto & state : states) {
          std::cout << " " << state.name << "=" << *state.value;
        }
        std::cout << std::endl;
      } else {
        const auto result = system.on_shutdown(previous);
        std::cout << "shutdown " << word(result) << std::endl;
        return 0;
      }
    }
    if (is_configured) {
      const bool is_read = system.read({}, {}) == return_type::OK;
      if (!is_read || (is_active && system.write({}, {}) != return_type::OK)) {
        is_active = false;
        is_configured = false;
        const auto result = system.on_error(previous);
        std::cout << "on_error " << word(result) << std::endl;
      }
    }
    next += std::chrono::milliseconds(10);
    // After a pause it does not make up for the turns that it has missed.
    next = std::max(next, std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
}
