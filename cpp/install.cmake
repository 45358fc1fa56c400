# The core as a CMake package (component `core`): find_package(visviva) gives the target visviva::core.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/visviva)
set_target_properties(visviva_core PROPERTIES EXPORT_NAME core)
add_library(visviva::core ALIAS visviva_core)
install(TARGETS visviva_core EXPORT visvivaTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT core)
install(DIRECTORY cpp/visviva DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT core FILES_MATCHING PATTERN "*.hpp")
install(EXPORT visvivaTargets NAMESPACE visviva:: DESTINATION ${package} COMPONENT core)
configure_package_config_file(cpp/visvivaConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/visvivaConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/visvivaConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/visvivaConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/visvivaConfigVersion.cmake
        DESTINATION ${package} COMPONENT core)
