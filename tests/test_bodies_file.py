"""A user's own bodies: what a file may hold, and the line of every mistake in it."""

import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kickdrift.cli.bodies_file import load_bodies_file
from kickdrift.cli.help_texts import SAMPLE_CSV, SAMPLE_TOML
from kickdrift.cli.toml_lines import key_lines, line_of
from kickdrift.core.errors import FileFormatError

TWO = """\
[[bodies]]
name = "a"
mass = 1.0
position = [0, 0, 0]
velocity = [0, 0, 0]

[[bodies]]
name = "b"
mass = 0.5
position = [1, 0, 0]
velocity = [0, 1, 0]
"""
HEADER = "name,mass,x,y,z,vx,vy,vz\n"


def write(folder, text, name="bodies.toml"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def error_of(folder, text, **beside):
    for name, content in beside.items():
        write(folder, content, f"{name}.csv")
    with pytest.raises(FileFormatError) as caught:
        load_bodies_file(write(folder, text))
    sentence = str(caught.value).replace(f"{folder}/", "")
    assert "\n" not in sentence
    return sentence


def test_the_sample_of_the_help_is_a_bodies_file(tmp_path):
    own = load_bodies_file(write(tmp_path, SAMPLE_TOML))
    assert own.system.name == "bodies"
    assert own.system.coordinates["body"] == ["Sun", "Earth"]
    assert own.system.units == {"t": "year", "x": "au", "v": "au/year"}
    assert own.system.quantities["energy"].unit == "solar mass au^2/year^2"
    assert (own.run.duration, own.run.step, own.run.method, own.run.save_every) == (
        100.0,
        0.001,
        "velocity-verlet",
        100,
    )


def test_a_table_beside_it_is_the_same_bodies(tmp_path):
    write(tmp_path, SAMPLE_CSV, "planets.csv")
    head = SAMPLE_TOML[: SAMPLE_TOML.index("[[bodies]]")]
    beside = load_bodies_file(write(tmp_path, f'bodies = "planets.csv"\n{head}')).system
    inside = load_bodies_file(write(tmp_path, SAMPLE_TOML)).system
    assert np.array_equal(beside.x0, inside.x0)
    assert np.array_equal(beside.v0, inside.v0)
    assert np.array_equal(beside.params, inside.params)
    assert beside.coordinates == inside.coordinates


def test_inline_tables_and_columns_in_any_order(tmp_path):
    inline = '[{name = "a", mass = 1, position = [0, 0, 1], velocity = [0, 0, 0]}]'
    assert load_bodies_file(write(tmp_path, f"bodies = {inline}")).system.x0.tolist() == [[0, 0, 1]]
    write(tmp_path, "\ufeffvz,vy,vx,z,y,x,mass,name\r\n6,5,4,3,2,1,7,a\r\n\r\n", "t.csv")
    system = load_bodies_file(write(tmp_path, 'bodies = "t.csv"')).system
    assert (system.x0.tolist(), system.v0.tolist()) == ([[1, 2, 3]], [[4, 5, 6]])


MISTAKES = {
    "unknown key of a body": (TWO + "mas = 3\n", "bodies.toml:12: in [[bodies]], key='mas' is not known", "'mass'"),
    "unknown key at the top": ("g = 1.0\n" + TWO, "bodies.toml:1:", "key='g' is not known", "softening"),
    "unknown table": (TWO + "[runn]\nstep = 1\n", "bodies.toml:12:", "key='runn'", "did you mean 'run'"),
    "unknown key of a table": (TWO + "[run]\n\nstpe = 1\n", "bodies.toml:14: in [run]", "'stpe'", "'step'"),
    "unknown key of a dotted table": (TWO.replace("[[", "run.stpe=1\n[[", 1), "bodies.toml:1: in [run]", "'stpe'"),
    "unknown key of an inline table": (
        'bodies = [\n # a\n {name = "a", mass = 1, position = [0, 0, 0], velocity = [0, 0, 0], spin = 1}]',
        "bodies.toml:3: in [[bodies]], key='spin'",
    ),
    "key of another table": ("[run]\nG = 1.0\n" + TWO, "bodies.toml:2:", "key='G' belongs to the top of the file"),
    "missing key": (TWO.replace("mass = 0.5\n", ""), "bodies.toml:7:", "'mass' is missing", "[[bodies]]"),
    "no bodies": ("G = 1.0\n", "bodies.toml:1:", "'bodies' is missing"),
    "empty bodies": ("\nbodies = []\n", "bodies.toml:2:", "bodies=[]"),
    "negative mass": (TWO.replace("0.5", "-0.5"), "bodies.toml:9: mass=-0.5", "greater than or equal to 0"),
    "mass in words": (TWO.replace("0.5", '"heavy"'), "bodies.toml:9: mass='heavy'", "number"),
    "mass true": (TWO.replace("0.5", "true"), "bodies.toml:9: mass=True", "number"),
    "mass not a number": (TWO.replace("0.5", "nan"), "bodies.toml:9: mass=nan", "finite"),
    "mass beyond floats": (TWO.replace("0.5", "1" + "0" * 400), "bodies.toml:9: mass=1000"),
    "two coordinates": (TWO.replace("[1, 0, 0]", "[1, 0]"), "bodies.toml:10: position=[1, 0]", "3 items"),
    "a coordinate in words": (TWO.replace("[1, 0, 0]", '[\n1,\n"x",\n0]'), "bodies.toml:12: position='x'", "number"),
    "infinite velocity": (TWO.replace("[0, 1, 0]", "[0, inf, 0]"), "bodies.toml:11: velocity=inf", "finite"),
    "empty name": (TWO.replace('"b"', '""'), "bodies.toml:8: name=''"),
    "name with an escape": (TWO.replace('"b"', r'"\u001b[2J"'), "bodies.toml:8: name=", "cannot be printed"),
    "name twice": (TWO.replace('"b"', '"a"'), "bodies.toml:8: name='a' is taken"),
    "one place": (TWO.replace("[1, 0, 0]", "[0, 0, 0]"), "bodies.toml: x0 has two bodies at the same place"),
    "no step": (TWO + "[run]\nstep = 0.0\n", "bodies.toml:13: step=0.0", "greater than 0"),
    "step as text": (TWO + '[run]\nstep = "1 day"\n', "bodies.toml:13: step='1 day'", "number"),
    "unknown method": (TWO + '[run]\nmethod = "leapfrg"\n', "bodies.toml:13: method='leapfrg'", "'leapfrog'"),
    "save_every of half": (TWO + "[run]\nsave_every = 0.5\n", "bodies.toml:13: save_every=0.5", "integer"),
    "negative G": ("G = -1.0\n" + TWO, "bodies.toml:1: G=-1.0", "greater than 0"),
    "a table that is a number": ("run = 3\n" + TWO, "bodies.toml:1: run=3"),
    "bodies that is a number": ("bodies = 3\n", "bodies.toml:1: bodies=3", "list"),
    "a body that is a number": ("bodies = [\n3]\n", "bodies.toml:2: bodies=3"),
    "not TOML": ("[[bodies\n", "bodies.toml: not a TOML file", "line 1"),
    "key twice": ("G = 1.0\nG = 2.0\n", "bodies.toml: not a TOML file", "line 2"),
    "not text": (b"PK\x03\x04\xff\xfe", "bodies.toml: byte 4 is not UTF-8"),
    "deeply nested": ("bodies = " + "[" * 100_000, "bodies.toml: not a TOML file"),
    "nothing": ("", "bodies.toml:1:", "'bodies' is missing"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named_with_its_line(tmp_path, mistake):
    text, *parts = MISTAKES[mistake]
    sentence = error_of(tmp_path, text)
    assert sentence.startswith(parts[0])
    for part in parts[1:]:
        assert part in sentence


@pytest.mark.parametrize(
    ("table", "parts"),
    [
        (HEADER + "a,1,0,0,0,0,0,0\nb,heavy,1,0,0,0,0,0\n", ["t.csv:3: mass='heavy'", "finite number"]),
        (HEADER + "a,1,0,0,nan,0,0,0\n", ["t.csv:2: z='nan'"]),
        (HEADER + "\n\na,-1,0,0,0,0,0,0\n", ["t.csv:4: mass=-1.0", "greater than or equal to 0"]),
        (HEADER + "a,1,0,0,0,0,0\n", ["t.csv:2: 7 values", "8"]),
        (HEADER + "a,1,0,0,0,0,0,0\na,1,1,0,0,0,0,0\n", ["t.csv:3: name='a' is taken"]),
        (HEADER + ",1,0,0,0,0,0,0\n", ["t.csv:2: name=''"]),
        (HEADER.replace("mass", "mas"), ["t.csv:1: column='mas' is not known", "'mass'"]),
        (HEADER.replace("mass,", ""), ["t.csv:1: column='mass' is missing"]),
        (HEADER.replace("mass", "x"), ["t.csv:1: column='x' is there twice"]),
        (HEADER, ["t.csv: there is no body"]),
        ("", ["t.csv: there is no body"]),
        (HEADER + 'a,1,"0,0,0,0,0,0\n', ["t.csv:", "not a CSV file"]),
        (b"\xff\xfe\x00", ["t.csv: byte 0 is not UTF-8"]),
    ],
)
def test_a_mistake_in_the_table_is_named_with_its_line(tmp_path, table, parts):
    sentence = error_of(tmp_path, 'bodies = "t.csv"\n', t=table)
    assert sentence.startswith(parts[0])
    for part in parts[1:]:
        assert part in sentence


@pytest.mark.parametrize("name", ["../t.csv", "/etc/passwd", "a/t.csv", "..", ".", "", "C:t", r"a\\t"])
def test_the_table_stays_beside_the_file(tmp_path, name):
    assert "bodies.toml:2: bodies=" in error_of(tmp_path, f'\nbodies = "{name}"\n')


@pytest.mark.parametrize("name", ["missing.csv", "folder"])
def test_a_table_that_cannot_be_read(tmp_path, name):
    (tmp_path / "folder").mkdir()
    assert error_of(tmp_path, f'bodies = "{name}"\n').startswith(f"{name}: ")


def test_lines_of_whatever_toml_can_write():
    source = '''# a = 1
"a b" = "x # y"  # z
c.'d'.e = """
f = 1
""" # three lines
[g.h]
i = [1, [2,
3], {j = 4, k.l = 5}]
m = 1979-05-27 07:32:00
[[n]]
[[n]]
o = 1
[[n.p]]
q = "\\"["
[n.r]
s = 0
'''
    tomllib.loads(source)
    lines = key_lines(source)
    expected = {
        ("a b",): 2,
        ("c", "d", "e"): 3,
        ("g", "h", "i"): 7,
        ("g", "h", "i", 1, 1): 8,
        ("g", "h", "i", 2, "k", "l"): 8,
        ("g", "h", "m"): 9,
        ("n", 0): 10,
        ("n", 1, "o"): 12,
        ("n", 1, "p", 0, "q"): 14,
        ("n", 1, "r", "s"): 16,
    }
    assert {path: lines[path] for path in expected} == expected
    assert ("a",) not in lines
    assert line_of(("n", 1, "missing"), lines) == 11
    assert line_of(("missing",), lines) == 1


PIECES = [
    "[a]",
    "[[b]]",
    "[b.c]",
    "d = [1, 2]",
    "e.f = {g = '#'}",
    'h = """\n[i]\n"""',
    "# j = 1",
    "[[b.k]]",
    "",
    '"l" = 1',
]


@given(st.lists(st.sampled_from(PIECES), max_size=8).map("\n".join))
def test_every_key_that_toml_reads_has_a_line(source):
    try:
        content = tomllib.loads(source)
    except ValueError:
        return
    assert set(paths_of(content)) == set(key_lines(source))


def paths_of(content, path=()):
    items = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from paths_of(value, (*path, key))
