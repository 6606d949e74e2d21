# Says what the program would say to wrong options, from its source, before it is built. Sourced by check_options of setup.sh:
#   awk -f scripts/options.awk SOURCE [HEADER...] -- [OPTION...]     leaves with 2 after one line on standard error
function refuse(text) {
    gsub(/[[:cntrl:]]/, "?", text)
    print program ": " text | "cat >&2"
    close("cat >&2")
    failed = 2
    exit 2
}

# The value of a literal or of an enumerator of the sources; "" where it is neither.
function number_of(word) {
    gsub(/^ +| +$/, "", word)
    if (word ~ /^[-+]?[0-9.]+(e[-+]?[0-9]+)?$/) return word + 0
    if (word ~ /^[A-Z_]+$/ && match(text, "[{, ]" word " = [0-9]+")) {
        word = substr(text, RSTART, RLENGTH)
        sub(/.* = /, "", word)
        return word + 0
    }
    return ""
}

function know(name, sort, from, to) {
    kind[name] = sort
    low[name] = from
    high[name] = to
}

# Rows such as option_int("case", "N", &number, 1, CASES, "help"), as CONTRIBUTING.md describes them.
function read_rows(rest, row, name, sort, argument) {
    while (match(rest, /option_(flag|int|seed|double|positive|string|choice)\( *"[a-z0-9-]+"/)) {
        row = substr(rest, RSTART, RLENGTH)
        rest = substr(rest, RSTART + RLENGTH)
        sort = name = row
        sub(/^option_/, "", sort)
        sub(/\(.*/, "", sort)
        sub(/^[^"]*"/, "", name)
        sub(/".*/, "", name)
        split(substr(rest, 1, 200), argument, ",")
        if (sort == "positive") know(name, sort, 0, number_of(argument[4]))
        else if (sort == "choice") {
            sub(/^ *"/, "", argument[3])
            sub(/".*/, "", argument[3])
            know(name, sort, argument[3], "")
        } else know(name, sort, number_of(argument[4]), number_of(argument[5]))
    }
}

function allowed(name, noun) {
    if (kind[name] == "string") return "a text that is not empty"
    if (kind[name] == "choice") return "one of " low[name]
    if (kind[name] == "seed") return "a whole number from 0 to 18446744073709551615"
    noun = kind[name] == "int" ? "a whole number" : "a number"
    if (low[name] == "" || high[name] == "") return noun
    return noun (kind[name] == "positive" ? " above 0 and at most " : " from " low[name] " to ") high[name]
}

function is_wrong(name, value, digits) {
    if (value == "") return 1
    if (kind[name] == "string") return 0
    if (kind[name] == "choice") return index("|" low[name] "|", "|" value "|") == 0 || index(value, "|") > 0
    if (kind[name] == "seed") return value !~ /^\+?[0-9]+$/ || length(value) > 20
    digits = kind[name] == "int" ? "^[-+]?[0-9]+$" : "^[-+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([eE][-+]?[0-9]+)?$"
    if (value !~ digits) return 1
    value += 0
    if (low[name] != "" && value < low[name] || high[name] != "" && value > high[name]) return 1
    return kind[name] == "positive" && !(value > 0)
}

BEGIN {
    program = ARGV[1]
    sub(/.*\//, "", program)
    sub(/\.c$/, "", program)
    for (k = 1; k < ARGC && ARGV[k] != "--"; k++) {
        first = first == "" && k > 1 ? length(text) : first
        while ((getline line < ARGV[k]) > 0) text = text " " line
    }
    read_rows(first == "" ? text : substr(text, 1, first))
    know("out", "string")
    know("json", "string")
    know("threads", "int", 1, 4096)
    know("seed", "seed")
    know("quick", "flag")
    know("quiet", "flag")
    know("help", "flag")
    know("version", "flag")
    for (k++; k < ARGC; k++) {
        word = ARGV[k]
        if (word == "-h") continue
        if (word !~ /^--./) refuse("'" word "' is not an option; --help lists them")
        name = substr(word, 3)
        equals = index(name, "=")
        value = equals ? substr(name, equals + 1) : ""
        if (equals) name = substr(name, 1, equals - 1)
        if (!(name in kind)) refuse("unknown option --" name "; --help lists all")
        if (kind[name] == "flag") {
            if (equals) refuse("--" name " " value ": takes no value")
            continue
        }
        if (!equals) {
            if (k + 1 >= ARGC || ARGV[k + 1] ~ /^--/) refuse("--" name " has no value; allowed: " allowed(name))
            value = ARGV[++k]
        }
        if (is_wrong(name, value)) refuse("--" name " " value ": allowed: " allowed(name))
    }
    exit failed
}
