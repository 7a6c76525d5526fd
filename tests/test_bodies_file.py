"""A user's own bodies: what a file may hold, and the line of every mistake in it."""

import numpy as np
import pytest

from kickdrift.cli.bodies_file import load_bodies_file
from kickdrift.cli.help_texts import SAMPLE_CSV, SAMPLE_TOML
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
    assert (own.run.duration, own.run.step, own.run.method, own.run.save_every) == (100.0, 0.001, "stormer-verlet", 100)


def test_units_ask_for_their_constant_of_gravitation(tmp_path):
    bodies = SAMPLE_TOML[SAMPLE_TOML.index("[[bodies]]") :]
    assert load_bodies_file(write(tmp_path, bodies)).system.params[0] == 1.0
    assert "without G" in error_of(tmp_path, '[units]\nlength = "au"\ntime = "year"\n' + bodies)
    sentence = error_of(tmp_path, '[units]\nlength = "furlong"\n' + bodies)
    assert sentence.startswith("bodies.toml: units.length='furlong': the unit is unknown; known: au,")
    sentence = error_of(tmp_path, '[units]\ntime = "yaer"\n' + bodies)
    assert sentence == "bodies.toml: units.time='yaer': the unit is unknown; did you mean 'year' or 'yr' or 'years'?"


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
    "unknown key of a body": (
        TWO + "mas = 3\n",
        "bodies.toml: bodies[1].mas: in [[bodies]], key='mas' is unknown",
        "'mass'",
    ),
    "unknown key at the top": ("g = 1.0\n" + TWO, "bodies.toml: g: ", "key='g' is unknown", "softening"),
    "unknown table": (TWO + "[runn]\nstep = 1\n", "bodies.toml: runn: ", "key='runn'", "did you mean 'run'"),
    "unknown key of a table": (TWO + "[run]\n\nstpe = 1\n", "bodies.toml: run.stpe: in [run]", "'stpe'", "'step'"),
    "unknown key of a dotted table": (
        TWO.replace("[[", "run.stpe=1\n[[", 1),
        "bodies.toml: run.stpe: in [run]",
        "'stpe'",
    ),
    "unknown key of an inline table": (
        'bodies = [\n # a\n {name = "a", mass = 1, position = [0, 0, 0], velocity = [0, 0, 0], spin = 1}]',
        "bodies.toml: bodies[0].spin: in [[bodies]], key='spin'",
    ),
    "key of another table": ("[run]\nG = 1.0\n" + TWO, "bodies.toml: run.G: the key belongs to the top of the file"),
    "missing key": (TWO.replace("mass = 0.5\n", ""), "bodies.toml: bodies[1].mass is missing", "[[bodies]]"),
    "no bodies": ("G = 1.0\n", "bodies.toml: bodies is missing"),
    "empty bodies": ("\nbodies = []\n", "bodies.toml: bodies=[]"),
    "negative mass": (TWO.replace("0.5", "-0.5"), "bodies.toml: bodies[1].mass=-0.5", "greater than or equal to 0"),
    "mass in words": (TWO.replace("0.5", '"heavy"'), "bodies.toml: bodies[1].mass='heavy'", "number"),
    "mass true": (TWO.replace("0.5", "true"), "bodies.toml: bodies[1].mass=True", "number"),
    "mass not a number": (TWO.replace("0.5", "nan"), "bodies.toml: bodies[1].mass=nan", "finite"),
    "mass beyond floats": (TWO.replace("0.5", "1" + "0" * 400), "bodies.toml: bodies[1].mass=1000"),
    "two coordinates": (TWO.replace("[1, 0, 0]", "[1, 0]"), "bodies.toml: bodies[1].position=[1, 0]", "3 items"),
    "a coordinate in words": (
        TWO.replace("[1, 0, 0]", '[\n1,\n"x",\n0]'),
        "bodies.toml: bodies[1].position[1]='x'",
        "number",
    ),
    "infinite velocity": (TWO.replace("[0, 1, 0]", "[0, inf, 0]"), "bodies.toml: bodies[1].velocity[1]=inf", "finite"),
    "empty name": (TWO.replace('"b"', '""'), "bodies.toml: bodies[1].name=''"),
    "name with an escape": (
        TWO.replace('"b"', r'"\u001b[2J"'),
        "bodies.toml: bodies[1].name=",
        "unprintable characters",
    ),
    "name twice": (TWO.replace('"b"', '"a"'), "bodies.toml: bodies[1].name='a' is already in use"),
    "one place": (TWO.replace("[1, 0, 0]", "[0, 0, 0]"), "bodies.toml: x0 has two bodies at the same position"),
    "no step": (TWO + "[run]\nstep = 0.0\n", "bodies.toml: run.step=0.0", "greater than 0"),
    "step as text": (TWO + '[run]\nstep = "1 day"\n', "bodies.toml: run.step='1 day'", "number"),
    "unknown method": (TWO + '[run]\nmethod = "leapfrg"\n', "bodies.toml: run.method='leapfrg'", "'leapfrog'"),
    "save_every of half": (TWO + "[run]\nsave_every = 0.5\n", "bodies.toml: run.save_every=0.5", "integer"),
    "negative G": ("G = -1.0\n" + TWO, "bodies.toml: G=-1.0", "greater than 0"),
    "a table that is a number": ("run = 3\n" + TWO, "bodies.toml: run=3"),
    "bodies that is a number": ("bodies = 3\n", "bodies.toml: bodies=3", "list"),
    "a body that is a number": ("bodies = [\n3]\n", "bodies.toml: bodies[0]=3"),
    "not TOML": ("[[bodies\n", "bodies.toml: not a TOML file", "line 1"),
    "key twice": ("G = 1.0\nG = 2.0\n", "bodies.toml: not a TOML file", "line 2"),
    "not text": (b"PK\x03\x04\xff\xfe", "bodies.toml: byte 4 is not UTF-8"),
    "deeply nested": ("bodies = " + "[" * 100_000, "bodies.toml: not a TOML file"),
    "nothing": ("", "bodies.toml: bodies is missing"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named_with_its_place(tmp_path, mistake):
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
        (HEADER + "a,1,0,0,0,0,0,0\na,1,1,0,0,0,0,0\n", ["t.csv:3: name='a' is already in use"]),
        (HEADER + ",1,0,0,0,0,0,0\n", ["t.csv:2: name=''"]),
        (HEADER.replace("mass", "mas"), ["t.csv:1: column='mas' is unknown", "'mass'"]),
        (HEADER.replace("mass,", ""), ["t.csv:1: column='mass' is missing"]),
        (HEADER.replace("mass", "x"), ["t.csv:1: column='x' appears twice"]),
        (HEADER, ["t.csv: no bodies"]),
        ("", ["t.csv: no bodies"]),
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
    assert "bodies.toml: bodies=" in error_of(tmp_path, f'\nbodies = "{name}"\n')


@pytest.mark.parametrize("name", ["missing.csv", "folder"])
def test_a_table_that_cannot_be_read(tmp_path, name):
    (tmp_path / "folder").mkdir()
    assert error_of(tmp_path, f'bodies = "{name}"\n').startswith(f"{name}: ")
