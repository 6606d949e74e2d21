# Sourced by the other scripts: finds the root of the repository, installs what is missing, configures and builds.
# Works in any folder, with blanks in the path, with standard input closed, as root or not. With --help as the first argument, prints the
# comment at the head of the script that sources it.
exec </dev/null
LC_ALL=C # numbers with points and messages as they are looked for, whatever the user's language
export LC_ALL
set -eu
if [ "${1:-}" = --help ]; then
    sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"
    exit
fi
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd -P)
cd -- "$root"

# refuse WHAT: says in one line what is wrong with the command line, and leaves with 2.
refuse() {
    echo "${0##*/}: $*; --help says more" >&2
    exit 2
}

# check_options PROGRAM [OPTION...]: leaves with 2 and the program's own line where it would refuse an option, if it is built.
check_options() {
    program=${RIDDLE_BUILD:-$root/build}/examples/$1
    shift
    [ ! -x "$program" ] || "$program" "$@" --version >/dev/null || exit 2
}

# need WHAT...: compiler, c++, meson, ninja, pkg-config, cmocka, clang-format. Leaves with 2 where it cannot be had.
need() {
    packages=
    for what in "$@"; do
        is_there "$what" || packages="$packages $(package_of "$what")"
    done
    [ -n "$packages" ] || return 0
    if command -v apt-get >/dev/null 2>&1 && as_root true 2>/dev/null; then
        echo "installing:$packages"
        said=$(as_root apt-get -q -o DPkg::Lock::Timeout=300 update 2>&1) || true # the lists at hand may do
        # shellcheck disable=SC2086 # a list of words
        said=$(as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 install --no-install-recommends $packages 2>&1) ||
            printf '%s\n' "$said" | tail -n 5 >&2
        hash -r 2>/dev/null || true
    fi
    missing=
    for what in "$@"; do
        is_there "$what" || missing="$missing $(package_of "$what")"
    done
    [ -z "$missing" ] && return 0
    echo "Missing:$missing" >&2
    echo "Install them and run this again; on Debian or Ubuntu: sudo apt-get install$missing" >&2
    exit 2
}

# wish WHAT...: the same for what a build can do without: libpng, libyaml, what the Python binding needs. Goes on where it cannot be had; the build says what is left out then.
wish() {
    for what in "$@"; do
        is_there "$what" || (need "$what") >/dev/null 2>&1 || true
    done
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo -n "$@"; fi
}

is_there() {
    case $1 in
    compiler) # a compiler without the C library's headers is none
        printf '#include <math.h>\nint main(void) { return 0; }\n' | ${CC:-cc} -x c - -o /dev/null >/dev/null 2>&1 ;;
    c++) printf '#include <cmath>\nint main() { return 0; }\n' | ${CXX:-c++} -x c++ - -o /dev/null >/dev/null 2>&1 ;;
    meson) meson --version >/dev/null 2>&1 ;;
    ninja) command -v ninja >/dev/null 2>&1 || command -v ninja-build >/dev/null 2>&1 || command -v samu >/dev/null 2>&1 ;;
    pkg-config) command -v pkg-config >/dev/null 2>&1 || command -v pkgconf >/dev/null 2>&1 ;;
    cmocka) pkg-config --exists cmocka 2>/dev/null || pkgconf --exists cmocka 2>/dev/null ;;
    liblammps) pkg-config --exists liblammps 2>/dev/null ;;
    libyaml) pkg-config --exists yaml-0.1 2>/dev/null || pkgconf --exists yaml-0.1 2>/dev/null ;;
    binding) /usr/bin/python3 -c 'import cffi, numpy' >/dev/null 2>&1 || python3 -c 'import cffi, numpy' >/dev/null 2>&1 ;;
    libpng) pkg-config --exists libpng 2>/dev/null || pkgconf --exists libpng 2>/dev/null ;;
    wasi-libc) # glibc for 32 bits has a stdio.h that this target takes, too
        printf '#include <wasi/api.h>\nint main(void) { return 0; }\n' | clang --target=wasm32-wasi -x c -c - -o /dev/null >/dev/null 2>&1 ;;
    wasm-runtime) [ -n "$(find "$(clang -print-resource-dir)/lib" -name 'libclang_rt.builtins-wasm32.a' 2>/dev/null)" ] ;;
    python3-*) /usr/bin/python3 -c "import ${1#python3-}" >/dev/null 2>&1 ;;
    *) command -v "$1" >/dev/null 2>&1 ;;
    esac
}

package_of() {
    case $1 in
    compiler) echo "gcc libc6-dev" ;;
    c++) echo g++ ;;
    ninja) echo ninja-build ;;
    cmocka) echo libcmocka-dev ;;
    nm) echo binutils ;;
    binding) echo "python3-cffi python3-numpy" ;;
    libpng) echo libpng-dev ;;
    libyaml) echo libyaml-dev ;;
    wasm-ld) echo lld ;;
    wasm-runtime) echo "libclang-rt-$(clang -dumpversion | cut -d. -f1)-dev-wasm32" ;;
    mpirun) echo "openmpi-bin libopenmpi-dev" ;;
    liblammps) echo liblammps-dev ;;
    x86_64-w64-mingw32-gcc) echo gcc-mingw-w64-x86-64 ;;
    *) echo "$1" ;;
    esac
}

# configure FOLDER [meson options]: a build folder of this clone, made anew if the clone has moved or the options are others.
configure() {
    folder=$1
    shift
    again=
    if [ -f "$folder/build.ninja" ] && [ "$(cat "$folder/configured" 2>/dev/null)" = "$root $*" ]; then
        again=--reconfigure
    else
        rm -rf -- "$folder"
    fi
    said=$(meson setup $again "$folder" "$@" 2>&1) || {
        printf '%s\n' "$said" >&2
        rm -rf -- "$folder"
        exit 1
    }
    printf '%s' "$root $*" >"$folder/configured"
}

# compile FOLDER [targets]
compile() {
    folder=$1
    shift
    echo "building in $folder/"
    ninja=$(command -v ninja || command -v ninja-build || command -v samu)
    "$ninja" -C "$folder" "$@" >"$folder/compile.log" 2>&1 || {
        cat "$folder/compile.log" >&2
        exit 1
    }
}

# libyaml_sources FOLDER: the sources of Debian's package, by apt with a list of its own, for builds for other machines.
libyaml_sources() {
    [ -f "$1/src/parser.c" ] && return 0
    apt=$(dirname -- "$1")/apt
    mkdir -p "$1" "$apt/partial" "$apt/lists/partial"
    release=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
    echo "deb-src http://deb.debian.org/debian ${release:-bookworm} main" >"$apt/sources.list"
    set -- "$1" -q -o "Dir::Etc::sourcelist=$apt/sources.list" -o Dir::Etc::sourceparts=- -o "Dir::State::lists=$apt/lists" -o "Dir::Cache=$apt"
    sources=$1
    shift
    apt-get "$@" update >"$apt/log" 2>&1 && (cd "$apt" && apt-get "$@" source --download-only libyaml >>log 2>&1) || { tail -n 5 "$apt/log" >&2; return 1; }
    tar -xzf "$apt"/libyaml_*.orig.tar.gz -C "$sources" --strip-components=1
}
