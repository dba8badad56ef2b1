# SPDX-License-Identifier: BSD-3-Clause
# Installs the program, the Python package, the scripts for users, jobs, documentation, manual page and
# bash completion. share/shearwake has the layout of the source tree, so that scripts find their files.
include(GNUInstallDirs)
set(data ${CMAKE_INSTALL_DATADIR}/shearwake)
install(TARGETS shearwake)
install(DIRECTORY jobs DESTINATION ${data} USE_SOURCE_PERMISSIONS)
install(DIRECTORY analysis DESTINATION ${data} PATTERN __pycache__ EXCLUDE PATTERN *.egg-info EXCLUDE
    PATTERN build EXCLUDE)
install(DIRECTORY tests/baselines DESTINATION ${data}/tests)
install(PROGRAMS scripts/kspaceFirstOrder-elastic DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES scripts/common.sh scripts/make_map.py DESTINATION ${data}/scripts)
install(PROGRAMS scripts/update-baseline DESTINATION ${data}/scripts)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN conf.py EXCLUDE)
install(FILES README.md LICENSE CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})

file(RELATIVE_PATH to_data ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_DATADIR}/shearwake)
foreach(tool IN ITEMS import-kwave make-map submit nightly)
    set(arguments "")
    if(tool STREQUAL "nightly")
        set(arguments "--out out/nightly ") # the installed folder is not writable
    endif()
    configure_file(cmake/tool.in generated/shearwake-${tool} @ONLY)
    install(PROGRAMS scripts/${tool} DESTINATION ${data}/scripts)
    install(PROGRAMS ${CMAKE_BINARY_DIR}/generated/shearwake-${tool} DESTINATION ${CMAKE_INSTALL_BINDIR})
endforeach()

# The Python package lies in share/shearwake/analysis, from which the program runs modules. A link makes it importable by the
# system's Python: in /usr/local, and in ~/.local for its owner. The folder depends on the prefix of the installation.
install(CODE "set(shearwake_source \"${CMAKE_CURRENT_SOURCE_DIR}\")")
install(CODE [[
    execute_process(COMMAND python3 -c "import site, sys
prefix = sys.argv[1] + '/lib/python'
version = '%d.%d/' % sys.version_info[:2]
known = site.getsitepackages() + [site.getusersitepackages()]
folders = [prefix + last for last in ('3/dist-packages', version + 'dist-packages', version + 'site-packages')]
print(next((folder for folder in folders if folder in known), folders[2]), end='')" ${CMAKE_INSTALL_PREFIX}
        OUTPUT_VARIABLE folder RESULT_VARIABLE code)
    if(code EQUAL 0)
        file(RELATIVE_PATH target "${folder}" "${CMAKE_INSTALL_PREFIX}/share/shearwake/analysis/shearwake")
        file(MAKE_DIRECTORY "$ENV{DESTDIR}${folder}")
        file(REMOVE "$ENV{DESTDIR}${folder}/shearwake")
        file(CREATE_LINK "${target}" "$ENV{DESTDIR}${folder}/shearwake" SYMBOLIC)
        execute_process(COMMAND python3 "${shearwake_source}/cmake/dist_info.py"
            "${shearwake_source}/analysis" "$ENV{DESTDIR}${folder}" COMMAND_ERROR_IS_FATAL ANY)
        message(STATUS "Python package: ${folder}/shearwake")
    endif()
]])

install(FILES scripts/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME shearwake)

# help2man writes the manual page from the help of the program.
if(HELP2MAN AND NOT CMAKE_CROSSCOMPILING)
    add_custom_command(OUTPUT generated/shearwake.1
        COMMAND ${CMAKE_COMMAND} -E env SHEARWAKE=$<TARGET_FILE:shearwake> ${HELP2MAN} --no-info
            --include=${CMAKE_SOURCE_DIR}/packaging/shearwake.h2m --output=generated/shearwake.1
            ${CMAKE_SOURCE_DIR}/packaging/manual-help
        DEPENDS shearwake packaging/manual-help packaging/shearwake.h2m VERBATIM)
    add_custom_target(manual_page ALL DEPENDS generated/shearwake.1)
    install(FILES ${CMAKE_BINARY_DIR}/generated/shearwake.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()
