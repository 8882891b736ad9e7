# One case of rayloom_must_not_compile, run by ctest: -DCOMPILER= -DFLAGS= -DSOURCE= -DEXPECT=.
set(compile ${CMAKE_COMMAND} -E env LC_ALL=C ${COMPILER} @${FLAGS} -fsyntax-only)

execute_process(COMMAND ${compile} -DCASE_OK ${SOURCE} RESULT_VARIABLE failed ERROR_VARIABLE diagnostics)
if(failed)
  message(NOTICE "${diagnostics}")
  message(FATAL_ERROR "the twin does not compile")
endif()

execute_process(COMMAND ${compile} ${SOURCE} RESULT_VARIABLE failed ERROR_VARIABLE diagnostics)
if(NOT failed)
  message(FATAL_ERROR "the case compiles, but must not")
endif()
if(NOT diagnostics MATCHES "${EXPECT}")
  message(NOTICE "${diagnostics}")
  message(FATAL_ERROR "refused for another reason than \"${EXPECT}\"")
endif()
