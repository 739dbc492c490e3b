# What the scripts of this example share. They set `here` and `root`.

fail() {
    echo "examples/video/${0##*/}: $*" >&2
    exit 1
}

# The Verilog of boards and scenes, and the core of a scene.
declare -rA files=(
    [icebreaker]="icebreaker.v dither.v"
    [ulx3s]="ulx3s.v tmds.v"
    [tangnano20k]="tangnano20k.v tmds.v"
    [ball]="video.v ball.v root.v beam.v"
    [mesh]="mesh.v beam.v"
)
declare -rA core=([ball]=highlight [mesh]=spans)

# The tables of the mesh do not fit the UP5K.
fits() {
    [[ $1 != icebreaker || $2 != mesh ]]
}

need() {
    local tool
    for tool in "$@"; do
        command -v "$tool" > /dev/null || fail "$tool is missing; bash tools/install installs it"
    done
    if [[ -z ${GLINT:-} ]]; then
        cargo build --release --quiet --manifest-path "$root/Cargo.toml"
        GLINT=${CARGO_TARGET_DIR:-$root/target}/release/glint
    fi
    command -v "$GLINT" > /dev/null || fail "GLINT is '$GLINT', which is no program"
    # Scripts go to other directories.
    GLINT=$(realpath "$(command -v "$GLINT")")
}

# Goes to the directory for a scene on a board, with the core's contents of memories and copies of all Verilog in it. `sources` is
# the Verilog, by file names without a blank and without a directory above this one: Yosys splits its scripts at blanks, and tools
# that are WebAssembly do not see every directory.
prepare() {
    local place=$1 board=$2 scene=$3 file
    mkdir -p "$place/$board-$scene"
    cd "$place/$board-$scene"
    "$GLINT" generate "$here/${core[$scene]}.toml" --out . > generate.txt 2>&1 ||
        fail "glint generate failed; see $PWD/generate.txt"
    sources=(rtl_out/"${core[$scene]}"/*.v)
    for file in ${files[$board]} ${files[$scene]}; do
        cp "$here/$file" .
        sources+=("$file")
    done
    if [[ $scene == mesh ]]; then
        cp rtl_out/spans/*.mem .
        python3 -B "$here/mesh.py" spans spans.mem
    fi
}
