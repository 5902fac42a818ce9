# SPDX-License-Identifier: GPL-3.0-or-later
# What an install from source puts where, and how other projects find it: CMake and pkg-config.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set_target_properties(kestrel_shared PROPERTIES EXPORT_NAME kestrel)
set_target_properties(kestrel_cli PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
install(TARGETS kestrel_shared EXPORT kestrelTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS kestrel_oiio kestrel_cli LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES core/include/kestrel/kestrel.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kestrel)

set(KESTREL_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/kestrel)
install(EXPORT kestrelTargets NAMESPACE kestrel:: DESTINATION ${KESTREL_CMAKE_DIR})
configure_package_config_file(cmake/kestrelConfig.cmake.in generated/kestrelConfig.cmake
                              INSTALL_DESTINATION ${KESTREL_CMAKE_DIR})
write_basic_package_version_file(generated/kestrelConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/generated/kestrelConfig.cmake
              ${CMAKE_BINARY_DIR}/generated/kestrelConfigVersion.cmake
        DESTINATION ${KESTREL_CMAKE_DIR})

# The file lies in LIBDIR/pkgconfig and finds its prefix from there.
file(RELATIVE_PATH KESTREL_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" KESTREL_PC_PREFIX "${KESTREL_PC_PREFIX}")
configure_file(cmake/kestrel.pc.in generated/kestrel.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/generated/kestrel.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
