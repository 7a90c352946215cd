# cpack runs this script before it packs a build (CPACK_PROJECT_CONFIG_FILE).
if(CPACK_VIP_NATIVE)
  message(FATAL_ERROR "This build has instructions of this machine's processor (VIP_NATIVE), so that its programs may not run "
                      "on another. Pack build/package, which `cmake --workflow --preset package` makes.")
endif()
