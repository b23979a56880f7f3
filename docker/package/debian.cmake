# Debian packages: `cpack` in the build folder, after a build. Dependencies on libraries are read off the binaries (dpkg-shlibdeps).
set(documents ${CMAKE_CURRENT_BINARY_DIR}/documents)
file(MAKE_DIRECTORY ${documents})
execute_process(COMMAND ${GZIP} --no-name --best --stdout ${PROJECT_SOURCE_DIR}/CHANGELOG.md OUTPUT_FILE ${documents}/changelog.gz
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${GZIP} --no-name --best --stdout ${CMAKE_CURRENT_SOURCE_DIR}/changelog.Debian
  OUTPUT_FILE ${documents}/changelog.Debian.gz COMMAND_ERROR_IS_FATAL ANY)

set(packages maploc-server maploc-tools maploc-client libmaploc-dev)
foreach(package ${packages})
  set(folder ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package})
  install(FILES ${documents}/changelog.gz ${documents}/changelog.Debian.gz DESTINATION ${folder} COMPONENT ${package} EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright DESTINATION ${folder} COMPONENT ${package} EXCLUDE_FROM_ALL)
endforeach()
install(FILES server/maploc-server.service DESTINATION lib/systemd/system COMPONENT maploc-server EXCLUDE_FROM_ALL)
install(FILES server/server.toml DESTINATION /etc/maploc COMPONENT maploc-server EXCLUDE_FROM_ALL)

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${packages})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_OUTPUT_FILE_PREFIX ${PROJECT_BINARY_DIR}/packages)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "maploc maintainers <maintainers@maploc.example>")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_LIBMAPLOC-DEV_PACKAGE_SHLIBDEPS OFF)  # an archive

function(describe package section depends description)
  string(TOUPPER ${package} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${description}" PARENT_SCOPE)
endfunction()
describe(maploc-server net adduser "map localization server
Answers the features of a robot's photo with the robot's pose in a map.
The maps are in one store (SQLite), which maploc-tools makes.")
describe(maploc-tools science "" "tools for the stores of a map localization server
Makes maps of COLMAP models and posed photos; inspects, exports and backs
them up (maploc-map).")
describe(maploc-client science "" "map localization from a robot's command line
Localizes a photo, replays a recorded session, simulates robots and makes
load (maploc).")
describe(libmaploc-dev libdevel "libeigen3-dev, libgrpc++-dev, libprotobuf-dev, libutf8proc-dev, protobuf-compiler-grpc"
  "C++ client library of map localization
A client of maploc-server, and poses between its answers by odometry.
CMake finds it by find_package(maploc), other builds by pkg-config.")
set(CPACK_DEBIAN_MAPLOC-SERVER_PACKAGE_SUGGESTS maploc-tools)
set(CPACK_DEBIAN_MAPLOC-SERVER_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_SOURCE_DIR}/server/postinst
  ${CMAKE_CURRENT_SOURCE_DIR}/server/prerm ${CMAKE_CURRENT_SOURCE_DIR}/server/postrm ${CMAKE_CURRENT_SOURCE_DIR}/server/conffiles)
include(CPack)
