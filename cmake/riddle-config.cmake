# find_package(riddle): the targets riddle::riddle, riddle::openmp for those who want threads too (the results are the same), and
# riddle::headers for those who choose all compiler flags themselves.
# Beside CMakeLists.txt, which includes this file with RIDDLE_INCLUDE_DIR set to the folder of the headers.
if(NOT DEFINED RIDDLE_INCLUDE_DIR)
  find_path(RIDDLE_INCLUDE_DIR dem.h HINTS "${CMAKE_CURRENT_LIST_DIR}/../../../include/riddle" "${CMAKE_CURRENT_LIST_DIR}/../../../../include/riddle"
            NO_DEFAULT_PATH NO_CACHE)
endif()
if(NOT RIDDLE_INCLUDE_DIR)
  set(riddle_FOUND FALSE)
  set(riddle_NOT_FOUND_MESSAGE "dem.h is not where this package was installed")
  return()
endif()

if(NOT TARGET riddle::riddle)
  add_library(riddle::headers INTERFACE IMPORTED GLOBAL)
  if(EXISTS "${RIDDLE_INCLUDE_DIR}/include/riddle") # for #include <riddle/dem.h>
    set(riddle_parent "${RIDDLE_INCLUDE_DIR}/include")
  else()
    get_filename_component(riddle_parent "${RIDDLE_INCLUDE_DIR}" DIRECTORY)
  endif()
  target_include_directories(riddle::headers INTERFACE "${RIDDLE_INCLUDE_DIR}" "${riddle_parent}")
  if(UNIX OR MINGW)
    target_link_libraries(riddle::headers INTERFACE m)
  endif()
  add_library(riddle::riddle INTERFACE IMPORTED GLOBAL)
  target_link_libraries(riddle::riddle INTERFACE riddle::headers)
  # docs/README.md says why. Without -ffp-contract=off the results depend on the machine.
  target_compile_options(
    riddle::riddle INTERFACE $<$<OR:$<C_COMPILER_ID:GNU,Clang,AppleClang>,$<CXX_COMPILER_ID:GNU,Clang,AppleClang>>:-ffp-contract=off
                             -fno-math-errno -fno-trapping-math>)
endif()

if(NOT TARGET riddle::openmp)
  find_package(OpenMP QUIET)
  if(TARGET OpenMP::OpenMP_C OR TARGET OpenMP::OpenMP_CXX)
    add_library(riddle::openmp INTERFACE IMPORTED GLOBAL)
    target_link_libraries(riddle::openmp INTERFACE riddle::riddle)
    foreach(language C CXX)
      if(TARGET OpenMP::OpenMP_${language})
        target_link_libraries(riddle::openmp INTERFACE OpenMP::OpenMP_${language})
      endif()
    endforeach()
  endif()
endif()
