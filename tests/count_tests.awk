# Sums up CTest's LastTest.log: GoogleTest and pytest cases one by one, any other test as one. Names what failed, and what was skipped and why.
# Fails when nothing ran, when something failed, and, with -v may_skip=REGEX, when a reason to skip does not match.
function close_test() {
    if (!open) return
    if (ok + bad + skip == 0 && good) ok = 1
    if (!good && bad == 0) fail("it ended early")  # a crash or time-out names no failed case
    passed += ok; failed += bad; skipped += skip
    open = 0
}
function fail(name) {
    bad++
    list = list "failed: " test " " name "\n"
}
function skip_because(name, reason) {
    skip++
    list = list "skipped: " name ": " reason "\n"
    if (may_skip != "" && reason !~ may_skip) { forbidden++; list = list "    must not be skipped here\n" }
}
/^[0-9]+\/[0-9]+ Testing: / { close_test(); open = 1; ok = bad = skip = good = 0; test = $3 }
/^\[       OK \] / { ok++ }
# FILE:LINE: Skipped, and the reason on the next line
after_skipped { reason = $0; after_skipped = 0 }
/: Skipped$/ { after_skipped = 1 }
/^\[  SKIPPED \] .*\([0-9]+ ms\)/ { skip_because(test " " $4, reason); reason = "" }
/^\[  FAILED  \] .*\([0-9]+ ms\)/ { fail($4) }
# Python tests, one a line: PATH::NAME PASSED. What pytest skipped stands in its summary with the whole reason and a count:
# SKIPPED [2] PATH:LINE: REASON
/^[^ ]+::.* PASSED( |$)/ { ok++ }
/^[^ ]+::.* SKIPPED \(.*\)$/ { name = $1; sub(/^.* SKIPPED /, ""); skip_because(name, $0) }
/^SKIPPED \[[0-9]+\] [^ ]+: / {
    times = substr($2, 2) + 0; name = $3
    sub(/:$/, "", name)
    sub(/^SKIPPED \[[0-9]+\] [^ ]+: /, "")
    while (times-- > 0) skip_because(name, $0)
}
# Any other program
/^SKIPPED: / { skip_because(test, substr($0, 10)) }
/^[^ ]+::.* (FAILED|ERROR)( |$)/ { name = $1; sub(/.*\//, "", name); fail(name) }
/^Test Passed\./ { good = 1 }
/^Test Pass Reason:/ { good = 1 }  # ended with 77: skipped
END {
    close_test()
    printf "%s", list
    line = (passed + 0) " passed, " (failed + 0) " failed"
    if (skipped > 0) line = line ", " skipped " skipped"
    if (forbidden > 0) line = line ", " forbidden " of them though nothing is missing"
    print line
    exit (failed > 0 || passed == 0 || forbidden > 0)
}
