# The release build of the project, for scripts to source. Sets $root, $target and $programs.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
case $target in /*) ;; *) target=$PWD/$target ;; esac
export CARGO_TARGET_DIR=$target
programs=$target/release

# Prints the comment at the head of the script and ends it, if the argument asks for help.
show_help() { case $1 in -h | --help) sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0" && exit ;; esac; }

# Builds what flags of cargo name, such as --bins; examples are in the package spmesh-experiments.
build() { cargo build --release --locked --quiet --manifest-path "$root/Cargo.toml" "$@"; }

# Builds an example and runs it in place of this script.
run_example() {
    build --package spmesh-experiments --example "$1"
    exec "$programs/examples/$1" "${@:2}"
}
