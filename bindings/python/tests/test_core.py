"""The module against the command line, formulas of NumPy, and the emitted Verilog in Verilator."""

import copy
import csv
import io
import pickle
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

import glint


def command(*arguments, stdin=None):
    """What `glint` prints; it must succeed."""
    program = [sys.executable, "-c", "import glint; glint.main()", *map(str, arguments)]
    done = subprocess.run(program, input=stdin, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout


def drawn(core, count, seed=1):
    """Raw operands at random from the domain."""
    random = np.random.default_rng(seed)
    ports = core.operands.items()
    return {name: random.integers(it.domain[0], it.domain[1], count, endpoint=True) for name, it in ports}


@pytest.mark.parametrize(
    "text",
    [
        'device = "cosine-power"\n',
        'device = "lyon"\n[colour]\nbits = 6\n',
        'device = "function"\n[function]\nformula = "sin(x)"\nfrom = -1\nto = 1\n',
        'device = "normaliser"\n',
    ],
)
def test_results_are_those_of_the_command_line(tmp_path, text):
    path = tmp_path / "core.toml"
    path.write_text(text)
    core = glint.Core(path)
    operands = drawn(core, 500)
    results = core(raw=True, **operands)
    results = results if isinstance(results, dict) else {next(iter(core.outputs)): results}
    rows = io.StringIO()
    table = csv.writer(rows)
    table.writerow(operands)
    table.writerows([f"#{raw}" for raw in row] for row in zip(*operands.values()))
    printed = list(csv.DictReader(io.StringIO(command("eval", path, "--batch", "-", stdin=rows.getvalue()))))
    assert len(printed) == 500
    for name, column in results.items():
        # A heading says so where a raw integer is not the value.
        heading = name if core.outputs[name].fraction == 0 else f"raw_{name}"
        assert column.tolist() == [int(row[heading]) for row in printed]


def test_expressions_of_several_operands_are_within_their_bounds():
    core = glint.expression(
        {"r": "sqrt(s)", "angle": {"formula": "atan2(y, x) / pi", "where": "s > 0"}},
        let={"s": "x^2 + y^2"},
        fraction=11,
        x=(-1, 1, 11),
        y={"bits": 12, "fraction": 11, "signed": True},
    )
    x, y = np.meshgrid(np.linspace(-1, 0.99, 41), np.linspace(-0.99, 0.98, 37))
    x, y = np.round(x * 2**11) / 2**11, np.round(y * 2**11) / 2**11
    found = core(x, y)
    assert np.abs(found["r_out"] - np.hypot(x, y)).max() * 2**11 <= core.bound < 1
    turns = (found["angle_out"] - np.arctan2(y, x) / np.pi + 1) % 2 - 1
    assert np.abs(turns).max() * 2**11 <= core.bound
    assert core.cosim(2000) is None
    quotient = glint.expression("x / y", x=(0, 1, 8), y=(Fraction(1, 2), 1, 8), fraction=7, keys={"architecture": "pipelined"})
    assert abs(quotient(0.5, 0.75) - 2 / 3) * 2**7 <= quotient.bound < 1
    with pytest.raises(ValueError, match="no value"):
        glint.expression("x / y", x=(0, 1, 8), y=(0, 1, 8), fraction=7)
    with pytest.raises(TypeError, match="fraction bits"):
        glint.expression("x", x=3, fraction=7)


def test_an_expression_keeps_a_relative_error():
    half = (Fraction(1, 2), 1, 12)
    core = glint.expression("x / y", x=half, y=half, fraction=14, error_relative="2^-12")
    x, y = np.meshgrid(np.arange(2048, 4096, 31) / 4096, np.arange(2048, 4096, 37) / 4096)
    exact = x / y
    assert (np.abs(core(x, y) - exact) / exact).max() < 2**-12
    # A result that states its own error does not get the relative one.
    finer = {"formula": "x / y", "error": 1}
    assert glint.expression({"r": finer}, x=half, y=half, fraction=14, error_relative="2^-12").bound < 1
    with pytest.raises(ValueError, match="near 0"):
        glint.expression("x - y", x=half, y=half, fraction=14, error_relative="2^-12")


def test_every_operand_of_a_function_is_within_its_bound():
    for formula, low, high, of in [
        ("1/sqrt(x)", 1, 4, lambda x: 1 / np.sqrt(x)),
        ("exp2(x)", 0, 1, np.exp2),
        ("sin(x)", -1, 1, np.sin),
    ]:
        core = glint.function(formula, low, high, fraction=12)
        first, last = core.operands["x"].domain
        x = np.arange(first, last + 1) / 2**12
        error = np.abs(core(x) - of(x)) * 2**12
        assert error.max() <= core.bound < 1
        assert np.allclose(core.error(x), error, atol=1e-9)
        assert np.allclose(core.exact(x), of(x), atol=1e-12)


def test_the_simulated_netlist_has_the_same_results():
    for core in [
        glint.Core(device="cosine-power"),
        glint.Core(device="rough", architecture="pipelined", **{"pipeline.interval": 3}),
        glint.Core(device="shading"),
    ]:
        operands = drawn(core, 300)
        golden, simulated = core(raw=True, **operands), core.simulate(raw=True, **operands)
        assert all((golden[name] == simulated[name]).all() for name in core.outputs)
        assert any(golden[name].any() for name in core.outputs)
        assert core.cosim(2000) is None


def test_a_line_has_a_result_for_each_point():
    core = glint.Core(device="cosine-squared")
    # From the peak down, with the largest amplitude.
    line = {name: it.domain[0] for name, it in core.operands.items()} | {core.length: 7}
    line |= {"zeta_start": 0, "delta_zeta": 2**22 // 10, "amplitude": core.operands["amplitude"].domain[1]}
    golden, simulated = core(raw=True, **line), core.simulate(raw=True, **line)
    assert golden.shape == (8,) and golden[0] > golden[-1] > 0 and (golden == simulated).all()


BENCH = """
module bench;
    reg clk = 0, rst_n = 0;
    reg [{width}:0] points [0:{last}];
    integer taken = 0, shown = 0;
    wire in_ready, out_valid;
    wire [{result}:0] result_out;
    {name} core (
        .clk(clk), .rst_n(rst_n), .in_valid(taken <= {last}), .in_ready(in_ready), .x(points[taken]),
        .out_ready(1'b1), .out_valid(out_valid), .result_out(result_out)
    );
    always #5 clk = ~clk;
    always @(posedge clk) begin
        rst_n <= 1;
        if (rst_n && in_ready && taken <= {last}) taken <= taken + 1;
        if (rst_n && out_valid) begin
            $display("%0d", result_out);
            shown = shown + 1;
            if (shown > {last}) $finish;
        end
    end
    initial $readmemh("points.hex", points);
endmodule
"""


def test_verilated_verilog_has_the_same_results(tmp_path):
    core = glint.function("1/sqrt(x)", 1, 4, fraction=16, architecture="pipelined")
    x = core.operands["x"]
    raw = np.linspace(*x.domain, 3000).astype(np.int64)
    for name, text in core.verilog().items():
        (tmp_path / name).write_text(text)
    (tmp_path / "points.hex").write_text("".join(f"{point:x}\n" for point in [*raw, 0]))
    result = core.outputs["result_out"].width - 1
    bench = BENCH.format(name=core.name, width=x.width - 1, last=len(raw) - 1, result=result)
    (tmp_path / "bench.v").write_text(bench.replace(f"[0:{len(raw) - 1}]", f"[0:{len(raw)}]"))
    sources = [name for name in core.verilog() if name.endswith(".v")]
    build = ["verilator", "--binary", "-Wno-fatal", "--top-module", "bench", "bench.v", *sources]
    subprocess.run(build, cwd=tmp_path, check=True, capture_output=True, timeout=600)
    done = subprocess.run(["obj_dir/Vbench"], cwd=tmp_path, check=True, capture_output=True, text=True, timeout=600)
    shown = [int(line) for line in done.stdout.splitlines() if line.strip().isdigit()]
    assert shown == core(raw, raw=True).tolist()


def test_shapes_follow_numpy():
    core = glint.Core(device="cosine-power")
    out = core(cos_gamma=np.linspace(0, 1, 6).reshape(3, 2), exponent=[[10], [20], [30]], red=255, green=0, blue=1)
    assert out["red_out"].shape == (3, 2) and out["green_out"].max() == 0
    assert core(1, 1, 255, 0, 0)["red_out"] == 255 and isinstance(core(1, 1, 255, 0, 0, raw=True)["red_out"], int)
    empty = core(np.empty(0), 1, 1, 1, 1)["red_out"]
    assert empty.shape == (0,)


def test_the_last_axis_of_a_list_has_its_numbers():
    formula = "v[0] + 2 * v[1] + 4 * v[2] + 8 * n.x + 16 * n.y"
    lists = {"v": {"size": 3, "bits": 8, "fraction": 4}, "n": {"axes": "xy", "bits": 8, "fraction": 4}}
    core = glint.expression(formula, operands=lists, fraction=4)
    v, n = np.arange(12).reshape(4, 3), np.array([1, 0.5])
    assert (core(v=v, n=n) == v @ [1, 2, 4] + 16).all()
    assert core(v=[1, 2, 3], nx=1, ny=0.5) == 33
    with pytest.raises(ValueError, match=r"the list has 3 numbers, and the array the shape \(4,\)"):
        core(v=[1, 2, 3, 4], n=n)
    with pytest.raises(TypeError, match="'v_1' is given twice"):
        core(v=v, v_1=0, n=n)


def test_a_list_of_results_is_an_array():
    core = glint.expression({"p": {"formula": "v / 2", "size": 3}, "s": "v[0] + v[2]"}, operands={"v": {"size": 3, "bits": 8, "fraction": 4}}, fraction=5)
    out = core(v=[[1, 2, 3], [4, 5, 6]])
    assert out["p_out"].tolist() == [[0.5, 1.0, 1.5], [2.0, 2.5, 3.0]]
    assert out["p_1_out"].tolist() == [1.0, 2.5]
    assert out["s_out"].tolist() == [4.0, 10.0]
    assert core(v=[1, 2, 3])["p_out"].tolist() == [0.5, 1.0, 1.5]
    masked = core(v=np.ma.array([[1, 2, 3], [4, 5, 6]], mask=[[False] * 3, [True] * 3]))
    assert masked["p_out"].mask.tolist() == [[False] * 3, [True] * 3]
    assert core.error(v=[1, 2, 3])["p_out"].tolist() == [0, 0, 0]
    with pytest.raises(KeyError, match="there is no output 'q'; the outputs are p_0_out, p_1_out, p_2_out, s_out"):
        out["q"]


def test_a_table_gets_another_function():
    keys = {"function.formula": "exp(-x)", "function.from": 0, "function.to": 4, "operand.fraction": 10, "result.fraction": 12}
    core = glint.Core(device="function", **keys, **{"approximation.tables": "writable", "images.squared": "exp(-x^2)"})
    image = core.image("exp(-x^2)")
    x = np.arange(4096) / 1024
    assert np.abs(image(x) - np.exp(-x * x)).max() <= image.bound / 4096
    assert image.bound < 1 and image.simulate(x).tolist() == image(x).tolist()
    assert image.table.shape == core.table.shape and (image.table != core.table).any()
    # The Verilog is the same; only the contents of the memory differ.
    own, others = core.verilog(), image.verilog()
    datapath = f"{core.name}_datapath.v"
    assert own[datapath] == others[datapath]
    again = pickle.loads(pickle.dumps(image))
    assert again(x).tolist() == image(x).tolist() and (again.table == image.table).all()
    with pytest.raises(ValueError, match="the results of this function need the format"):
        core.image("sin(x)")
    with pytest.raises(ValueError, match="has no table that can be written"):
        glint.Core(device="rough").image("x")


def test_a_core_tells_what_it_is():
    core = glint.Core(device="rough", architecture="pipelined")
    assert core.interval == 1 and core.latency == len(core.schedule())
    assert core.bound == pytest.approx(sum(units for *_, units in core.terms))
    assert f"module {core.name} #(" in core.verilog()[f"{core.name}.v"]
    assert core.estimate("ecp5")["dsps"] > 0
    assert core.render(32).shape == (32, 32, 3) and core.render((40, 30)).shape == (30, 40, 3)
    assert 'device = "rough"' in core.toml() and "lyon" in glint.devices()


@pytest.mark.parametrize(
    "call, error, words",
    [
        (lambda: glint.Core("nowhere.toml"), ValueError, "nowhere.toml"),
        (lambda: glint.Core(device="lyonn"), ValueError, 'did you mean "lyon"'),
        (lambda: glint.Core(), ValueError, "give a TOML file"),
        (lambda: glint.Core(device="lyon", power=17), ValueError, "power"),
        (lambda: glint.Core(device="lyon", power=object()), ValueError, "no value of a key"),
        (lambda: glint.function("1/x", -1, 1, fraction=8), ValueError, "a pole"),
        (lambda: glint.Core(device="cosine-power")(1, 2, 3, 4), TypeError, "give blue"),
        (lambda: glint.Core(device="cosine-power")(1, 2, 3, 4, blu=1), TypeError, "no operand 'blu'"),
        (lambda: glint.Core(device="cosine-power")(1, 2, 3, 4, 256), ValueError, "`blue` is 256"),
        (lambda: glint.Core(device="cosine-power")([0, np.nan], 2, 3, 4, 5), ValueError, "`cos_gamma` at [1]"),
        (lambda: glint.Core(device="cosine-power")(0.5, 2, 3, 4, 5, raw=True), TypeError, "raw integers"),
        (lambda: glint.Core(device="cosine-power")("a", 2, 3, 4, 5), TypeError, "numbers are wanted"),
        (lambda: glint.Core(device="cosine-squared")(*[[1, 2]] * 4), TypeError, "a line a call"),
        (lambda: glint.Core(device="cosine-squared").exact(1, 2, 3, 4), TypeError, "walks lines"),
    ],
)
def test_what_is_wrong_is_said(call, error, words):
    with pytest.raises(error) as raised:
        call()
    assert words in str(raised.value)


@pytest.mark.parametrize("dtype", ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", ">i4", ">u8", "?"])
def test_raw_integers_of_every_type_are_those_of_python(dtype):
    core = glint.Core(device="cosine-power")
    exact = core(raw=True, cos_gamma=1 << 19, exponent=1, red=1, green=1, blue=0)
    for numbers in [np.array([1], dtype), np.array([[0, 1], [1, 0]], dtype), np.dtype(dtype).type(1)]:
        results = core(raw=True, cos_gamma=1 << 19, exponent=1, red=numbers, green=1, blue=0)
        expected = core(raw=True, cos_gamma=1 << 19, exponent=1, red=np.asarray(numbers).tolist(), green=1, blue=0)
        assert np.shape(results["red_out"]) == np.shape(numbers)
        assert np.array_equal(results["red_out"], expected["red_out"])
        assert np.all(results["green_out"] == exact["green_out"])


@pytest.mark.parametrize("dtype", ["f2", "f4", "f8", ">f8", "i8"])
def test_values_of_every_type_are_those_of_python(dtype):
    core = glint.function("x * x", 0, 2, fraction=8)
    x = np.array([0, 1, 0, 1], dtype)
    for values in [x, x[1:2], x[::2], x.reshape(2, 2).T]:
        assert core(values).tolist() == core(values.tolist()).tolist()
        assert core(values).shape == values.shape


def test_raw_integers_beyond_63_bits_are_refused():
    core = glint.Core(device="cosine-power")
    rest = {"cos_gamma": 0, "exponent": 1, "green": 0, "blue": 0}
    for large in [2**63, 2**64 - 1, 2**64, -(2**63) - 1, np.array([1, 2**64 - 1], np.uint64)]:
        with pytest.raises(ValueError, match="red"):
            core(raw=True, red=large, **rest)


def test_arrays_that_lie_across_words_are_read():
    core = glint.function("x * x", 0, 2, fraction=8)
    packed = np.zeros(4, np.dtype([("tag", "i1"), ("x", "f8")]))
    packed["x"] = [0.25, 0.5, 1.0, 1.5]
    assert not packed["x"].flags.aligned
    assert core(packed["x"]).tolist() == core([0.25, 0.5, 1.0, 1.5]).tolist()


def test_masked_elements_stay_masked():
    core = glint.function("x * x", 0, 2, fraction=8)
    x = np.ma.array([0.5, 1e9, 1.5], mask=[False, True, False])
    results = core(x)
    assert results.mask.tolist() == [False, True, False]
    assert results.compressed().tolist() == core([0.5, 1.5]).tolist()
    assert core.simulate(x).mask.tolist() == [False, True, False]
    assert core.error(x).mask.tolist() == [False, True, False]
    colours = glint.Core(device="cosine-power")
    results = colours(cos_gamma=1.0, exponent=1, red=np.ma.array([1, 2], mask=[True, False]), green=[[1], [2]], blue=0)
    assert results["green_out"].mask.tolist() == [[True, False], [True, False]]


def test_cores_are_copied_and_pickled():
    core = glint.function("log2(x)", 2**-16, 1, fraction=16)
    for twin in [pickle.loads(pickle.dumps(core)), copy.copy(core), copy.deepcopy(core)]:
        assert twin.toml() == core.toml() and twin(0.25) == core(0.25) == -2
    for device in glint.devices():
        core = glint.Core(device=device)
        assert pickle.loads(pickle.dumps(core)).toml() == core.toml()


def test_numbers_of_keys_are_taken_exactly():
    for fraction in [8, np.int64(8), np.uint8(8)]:
        assert glint.function("1/x", 1, 2, fraction=fraction).operands["x"].fraction == 8
    for low in [0.25, np.float32(0.25), np.float64(0.25), Fraction(1, 4), Decimal("0.25"), Decimal("25e-2"), "1/4"]:
        assert glint.function("1/x", low, 2, fraction=8).operands["x"].domain[0] == 64
    assert glint.function("1/x", Fraction(1, 3), 2, fraction=8).operands["x"].domain[0] == 86
    assert glint.Core(device="function", **{"function.to_included": np.bool_(True)}).operands["x"].domain[1] == 4 << 16
    # The shortest digits of these floats are beside them: 2^-40 is 9.094947017729282379150390625e-13.
    for power in range(1, 41):
        core = glint.function("x", 2.0**-power, 2.0**-power * 8, fraction=power)
        assert core.operands["x"].domain == (1, 7)
    for wrong in [float("nan"), Decimal("NaN"), Decimal("Infinity"), 1 + 2j, None]:
        with pytest.raises(ValueError, match="function.from"):
            glint.function("1/x", wrong, 2)


def test_a_value_half_a_place_beyond_the_format_is_refused():
    core = glint.Core(device="cosine-power")
    rest = {"cos_gamma": 0.5, "exponent": 1, "green": 0, "blue": 0}
    assert core(red=255.4999, **rest)["red_out"] == core(red=255, **rest)["red_out"]
    # The greatest number below a half is nearer to 0.
    assert core(red=0.49999999999999994, **rest)["red_out"] == 0
    for beyond in [255.5, -0.5000001, 1e300, float("nan")]:
        with pytest.raises(ValueError, match="red"):
            core(red=beyond, **rest)


def small_unit(**keys):
    """A unit with a function of each kind: a quotient, two results, and signed operands."""
    functions = {
        "rcp": {"results": "1 / x", "x": (0.5, 1, 12), "fraction": 11},
        "turn": {
            "results": {"sine": "sin(2 * pi * a)", "cosine": "cos(2 * pi * a)"},
            "a": {"bits": 10, "fraction": 10},
            "fraction": 9,
        },
        "mean": {
            "results": {"m": {"formula": "(p + q) / 2", "fraction": 5}},
            "operands": {"p": {"bits": 8, "fraction": 4, "signed": True}, "q": {"bits": 8, "fraction": 4, "signed": True}},
        },
    }
    return glint.unit(functions, keys=keys)


@pytest.mark.parametrize("architecture", ["sequential", "pipelined"])
def test_functions_of_a_unit_compute_in_their_own_formats(architecture):
    sfu = small_unit(architecture=architecture)
    assert list(sfu.functions) == ["rcp", "turn", "mean"]
    assert [function.opcode for function in sfu.functions.values()] == [0, 1, 2]
    x = np.linspace(0.5, 0.9997, 50)
    reciprocal = sfu.rcp(x)
    nearest = np.floor(x * 4096 + 0.5) / 4096
    assert np.all(np.abs(reciprocal - 1 / nearest) * 2048 <= sfu.rcp.bound)
    assert np.array_equal(sfu.rcp.simulate(x), reciprocal)
    turns = sfu.turn(a=np.arange(8) / 8)
    assert turns["sine"].tolist()[::2] == [0.0, 1.0, 0.0, -1.0]
    assert turns["cosine"].tolist()[::2] == [1.0, 0.0, -1.0, 0.0]
    assert sfu.mean(-3.5, 1.0) == -1.25
    assert sfu.mean(p=-3.5, q=1.0, raw=False) == sfu.mean.simulate(-3.5, 1.0)
    # The same at the ports of the unit: words without a sign.
    words = sfu(opcode=2, a=-56 & 0xFF, b=16, raw=True)["r_out"]
    assert words == -40 & (1 << sfu.outputs["r_out"].width) - 1
    assert sfu.functions["mean"](-56, 16, raw=True) == -40
    assert np.all(np.abs(sfu.turn.error(a=np.arange(1024) / 1024)["sine"]) <= sfu.turn.bounds["sine"])
    assert sfu.cosim(300) is None
    assert copy.copy(sfu).rcp(0.5) == 2.0


def test_units_say_what_is_wrong(tmp_path):
    with pytest.raises(AttributeError, match="no attribute 'rsqrt'"):
        small_unit().rsqrt
    with pytest.raises(TypeError, match="function 'rcp' has no results"):
        glint.unit({"rcp": {"x": (0.5, 1, 12)}})
    with pytest.raises(ValueError, match=r"`x` is 2, and u0\.12 has"):
        small_unit().rcp(2.0)
    path = tmp_path / "mean.toml"
    path.write_text(glint.expression("(p + q) / 2", p=(-1, 1, 7), q=(-1, 1, 7), fraction=8).toml())
    assert glint.unit({"mean": path, "rcp": {"results": "1 / x", "x": (0.5, 1, 8), "fraction": 8}}).mean(0.5, 0.25) == 0.375
