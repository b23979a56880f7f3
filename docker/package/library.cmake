# The C++ client library: one archive of the folders that a robot needs, with headers that include neither gRPC nor Protobuf.
include(CMakePackageConfigHelpers)

set(folders maploc_api maploc_odometry maploc_convert maploc_proto maploc_proto_grpc maploc_model maploc_geometry maploc_base)
set(objects)
foreach(folder ${folders})
  # A robot may link the archive into a shared library, as a ROS component is. Without interposition this costs no speed.
  set_target_properties(${folder} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${folder} PRIVATE -fno-semantic-interposition)
  list(APPEND objects $<TARGET_OBJECTS:${folder}>)
endforeach()

add_library(maploc_client_library STATIC ${objects})
set_target_properties(maploc_client_library PROPERTIES OUTPUT_NAME maploc EXPORT_NAME maploc)
target_compile_features(maploc_client_library INTERFACE cxx_std_20)
# Eigen's types are laid out for the baseline architecture, also in a robot that is compiled with -mavx.
target_compile_definitions(maploc_client_library INTERFACE EIGEN_MAX_ALIGN_BYTES=16)
target_link_libraries(maploc_client_library PUBLIC Eigen3::Eigen PRIVATE gRPC::grpc++ protobuf::libprotobuf PkgConfig::UTF8PROC)

target_sources(maploc_client_library PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES
  ${PROJECT_SOURCE_DIR}/client/api/client.h
  ${PROJECT_SOURCE_DIR}/client/api/credentials.h
  ${PROJECT_SOURCE_DIR}/client/odometry/decision.h
  ${PROJECT_SOURCE_DIR}/client/odometry/drift.h
  ${PROJECT_SOURCE_DIR}/client/odometry/track.h
  ${PROJECT_SOURCE_DIR}/client/odometry/tracker.h
  ${PROJECT_SOURCE_DIR}/client/odometry/uncertain_pose.h
  ${PROJECT_SOURCE_DIR}/mapstore/base/ids.h
  ${PROJECT_SOURCE_DIR}/mapstore/base/status.h
  ${PROJECT_SOURCE_DIR}/mapstore/geometry/camera.h
  ${PROJECT_SOURCE_DIR}/mapstore/geometry/gravity_reading.h
  ${PROJECT_SOURCE_DIR}/mapstore/geometry/line.h
  ${PROJECT_SOURCE_DIR}/mapstore/geometry/pixel_frame.h
  ${PROJECT_SOURCE_DIR}/mapstore/geometry/rigid3.h
  ${PROJECT_SOURCE_DIR}/mapstore/model/descriptor.h
  ${PROJECT_SOURCE_DIR}/mapstore/model/localization.h
  ${PROJECT_SOURCE_DIR}/mapstore/model/map.h
  ${PROJECT_SOURCE_DIR}/mapstore/model/matches.h
  ${PROJECT_SOURCE_DIR}/mapstore/model/query.h
  ${PROJECT_SOURCE_DIR}/mapstore/model/session.h
  ${PROJECT_SOURCE_DIR}/mapstore/model/strategy.h
  ${PROJECT_SOURCE_DIR}/mapstore/model/viewing.h)

set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/maploc)
install(TARGETS maploc_client_library EXPORT maploc
  ARCHIVE COMPONENT libmaploc-dev
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/maploc COMPONENT libmaploc-dev)
install(EXPORT maploc NAMESPACE maploc:: FILE maploc-targets.cmake DESTINATION ${config_folder} COMPONENT libmaploc-dev)
write_basic_package_version_file(maploc-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES maploc-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/maploc-config-version.cmake
  DESTINATION ${config_folder} COMPONENT libmaploc-dev)
configure_file(maploc.pc.in maploc.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/maploc.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT libmaploc-dev)
