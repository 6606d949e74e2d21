# Sourced by the checks that are scripts, which first make $folder, their temporary folder. Counts what passes and fails, and prints
# cmocka's closing lines, so that scripts/test counts a check like any other test.
passed=0
failed=0

check() { # NAME COMMAND...: the first and the last lines of the command's output are shown if it fails. Returns 1 then.
    name=$1
    shift
    # shellcheck disable=SC2254 # a pattern is what it is
    case $name in ${RIDDLE_TEST_PATTERN:-*}) ;; *) return 0 ;; esac
    if "$@" >"$folder/said" 2>&1; then
        passed=$((passed + 1))
        echo "[       OK ] $name"
    else
        failed=$((failed + 1))
        echo "[  FAILED  ] $name"
        awk '{ line[NR] = $0 }
             END { for (k = 1; k <= NR; k++) if (k <= 12 || k > NR - 12) print line[k]; else if (k == 13) print "..." }' "$folder/said"
        return 1
    fi
}
skip() { echo "[  SKIPPED ] $1"; }

finish() { # the last command of a check
    echo "[  PASSED  ] $passed test(s)."
    [ $failed = 0 ] || echo "[  FAILED  ] $failed test(s)."
    [ $failed = 0 ]
}
