/* format.h - what LAMMPS's installed headers name of the formatting library that it was built with. Debian's
   liblammps-dev lacks this file. The templates that use these names are never called here, so
   declarations are enough. */
#ifndef RIDDLE_FMT_FORMAT_H
#define RIDDLE_FMT_FORMAT_H

#include <string>

namespace fmt {
class string_view {
  public:
    string_view(const char *) {}
    string_view(const std::string &) {}
};
class format_args {};
template <typename... Args> format_args make_args_checked(string_view, const Args &...) { return format_args(); }
} // namespace fmt

#endif
