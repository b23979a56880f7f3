# Manual pages, made of --help: help2man runs the binaries.
find_program(HELP2MAN help2man REQUIRED)
find_program(GZIP gzip REQUIRED)

# manual_page(BINARY SECTION "one line" COMPONENT)
function(manual_page binary section name component)
  set(page ${CMAKE_CURRENT_BINARY_DIR}/${binary}.${section}.gz)
  add_custom_command(OUTPUT ${page}
    COMMAND ${HELP2MAN} --no-info --section=${section} --name=${name} --output=${binary}.${section} $<TARGET_FILE:${binary}>
    COMMAND sed -i "/^.SH EXAMPLES/a .nf" ${binary}.${section}  # an example a line
    COMMAND ${GZIP} --force --no-name --best ${binary}.${section}
    DEPENDS ${binary} VERBATIM)
  add_custom_target(manual_of_${binary} ALL DEPENDS ${page})
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section} COMPONENT ${component})
endfunction()

manual_page(maploc-server 8 "serves the maps of a store to robots" maploc-server)
manual_page(maploc-map 1 "makes, inspects and looks after stores of maps" maploc-tools)
manual_page(maploc 1 "the robot's side of map localization" maploc-client)
