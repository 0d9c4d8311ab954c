# Sums up CTest's LastTest.log: GoogleTest and pytest cases one by one, any other test as one. Fails when nothing ran or something failed.
function close_test() {
    if (!open) return
    if (ok + bad + skip == 0) { if (good) ok = 1; else bad = 1 }
    if (!good && bad == 0) bad = 1  # a crash or time-out names no failed case
    passed += ok; failed += bad; skipped += skip
    open = 0
}
/^[0-9]+\/[0-9]+ Testing: / { close_test(); open = 1; ok = bad = skip = good = 0 }
/^\[       OK \] / { ok++ }
/^\[  SKIPPED \] .*\([0-9]+ ms\)/ { skip++ }
/^\[  FAILED  \] .*\([0-9]+ ms\)/ { bad++ }
# Python tests, one a line: PATH::NAME PASSED
/^[^ ]+::.* PASSED( |$)/ { ok++ }
/^[^ ]+::.* (SKIPPED|XFAIL)( |$)/ { skip++ }
/^[^ ]+::.* (FAILED|ERROR)( |$)/ { bad++ }
/^Test Passed\./ { good = 1 }
END {
    close_test()
    line = (passed + 0) " passed, " (failed + 0) " failed"
    if (skipped > 0) line = line ", " skipped " skipped"
    print line
    exit (failed > 0 || passed == 0)
}
