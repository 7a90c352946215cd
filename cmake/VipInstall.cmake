# share/vip-lab contains the files that the programs read at run time. base::resource() finds this folder next
# to the programs' bin/.
set(_share share/vip-lab)
install(DIRECTORY data/scenes data/meshes data/paper DESTINATION ${_share}/data)
install(FILES data/peers.csv DESTINATION ${_share}/data)
install(DIRECTORY shaders protocols docs DESTINATION ${_share})
install(DIRECTORY libstudy/store/sql DESTINATION ${_share}/libstudy/store)

# Licences: the project's, the GPL-3 (GSL's licence, which applies to programs that are linked with GSL), and
# those of the libraries that are compiled into the programs.
set(_doc share/doc/vip-lab)
install(FILES LICENSE DESTINATION ${_doc} RENAME copyright)
install(FILES CHANGELOG.md DESTINATION ${_doc})
if(EXISTS /usr/share/common-licenses/GPL-3)
  install(FILES /usr/share/common-licenses/GPL-3 DESTINATION ${_doc}/licences RENAME GPL-3.txt)
endif()
foreach(package libcli11-dev libimgui-dev libopenxr-dev libtomlplusplus-dev nlohmann-json3-dev)
  if(EXISTS /usr/share/doc/${package}/copyright)
    install(FILES /usr/share/doc/${package}/copyright DESTINATION ${_doc}/licences RENAME ${package}.txt)
  endif()
endforeach()

foreach(program study stats bench view)
  install(FILES cmake/package/completion.bash DESTINATION share/bash-completion/completions RENAME vip-${program})
endforeach()
install(CODE "execute_process(COMMAND ${PROJECT_SOURCE_DIR}/cmake/package/man_pages.sh ${CMAKE_BINARY_DIR}/bin
                              \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share/man/man1 COMMAND_ERROR_IS_FATAL ANY)")

# cpack -G DEB makes vip-lab_VERSION_ARCHITECTURE.deb from programs that are already built; it builds nothing.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME vip-lab)
set(CPACK_PACKAGE_CONTACT "The ViP-Lab authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/package/check.cmake)
set(CPACK_VIP_NATIVE ${VIP_NATIVE})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# libepoxy opens libEGL and libGL at run time, and the programs open libpq, so that dpkg-shlibdeps does not find them.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libegl1, libgl1")
if(PostgreSQL_FOUND)
  string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", libpq5")
endif()
# Recommended packages: software OpenGL for machines without a GPU driver, the font of a participant's pages,
# and the loader for OpenXR headsets.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libgl1-mesa-dri, fonts-dejavu-core, libopenxr-loader1")
include(CPack)
