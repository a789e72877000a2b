#ifndef STUB__PLUGINLIB__CLASS_LIST_MACROS_HPP_
#define STUB__PLUGINLIB__CLASS_LIST_MACROS_HPP_

#include <type_traits>

// The test links the class.
#define PLUGINLIB_EXPORT_CLASS(derived, base) \
  static_assert(std::is_base_of<base, derived>::value, "a plugin of this base");

#endif  // STUB__PLUGINLIB__CLASS_LIST_MACROS_HPP_
