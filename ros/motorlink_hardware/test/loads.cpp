// Loads the plugin as the controller manager does. Run it in an installed workspace.
#include <iostream>

#include "hardware_interface/system_interface.hpp"
#include "pluginlib/class_loader.hpp"

int main()
{
  pluginlib::ClassLoader<hardware_interface::SystemInterface> loader(
    "hardware_interface", "hardware_interface::SystemInterface");
  const auto system = loader.createUniqueInstance("motorlink_hardware/MotorLinkSystem");
  std::cout << "loaded" << std::endl;
  return system ? 0 : 1;
}
