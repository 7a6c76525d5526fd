"""What notebooks show of solutions, worlds and methods, and that a notebook runs from its first cell to its last."""

import re
import sys
from pathlib import Path

import pytest

import kickdrift as kd
from kickdrift.engine import progress

EXAMPLE = Path(__file__).parent.parent / "examples" / "first_steps.ipynb"
PNG = 'src="data:image/png;base64,iVBOR'  # as every PNG begins


def test_a_solution_is_a_table_with_a_picture():
    shown = kd.solve(kd.systems.kepler(), (0.0, 2.0), step=0.01)._repr_html_()
    assert "<td" in shown
    assert "semi-implicit-euler, order 1" in shown
    assert PNG in shown


def test_text_is_escaped():
    def hostile(x):
        return -x

    hostile.__name__ = "<script>alert(1)</script>"
    sol = kd.solve(hostile, (0.0, 1.0), 1.0, 0.0, step=0.1, compile=False)
    world = kd.World()
    world.add_sphere(0.1, name="<script>")
    recording = world.run(duration=0.1, step=0.05)
    for one in (sol, world, recording, kd.SecondOrder(hostile), kd.systems.kepler(), kd.methods.get("leapfrog")):
        assert "<script" not in one._repr_html_()


def test_a_problem_tells_what_it_was_made_of():
    shown = kd.Newtonian(lambda x: -x, mass=[1.0, 2.0])._repr_html_()
    assert "[1.0, 2.0]" in shown
    assert "invariants" not in shown


def test_methods_draw_their_words_and_systems_the_bodies_at_the_start():
    corners = "0.0000,0.0000 0.0000,0.5000 1.0000,0.5000 1.0000,1.0000"
    assert f'points="{corners}"' in kd.methods.get("velocity-verlet")._repr_html_()
    assert "<svg" not in kd.methods.get("gauss-4")._repr_html_()
    assert kd.systems.solar_system()._repr_html_().count("<circle") == 11
    assert "<svg" not in kd.systems.kepler()._repr_html_()


def test_a_world_looks_as_it_is_now_and_stays_so(small_pictures):
    world = kd.World()
    world.add_plane()
    world.add_box((1, 1, 1), position=(0, 0, 5), mass=2.0)
    before = world.snapshot()
    shown = world._repr_html_()
    assert PNG in shown
    assert "98.1 J, of it 0 J kinetic" in shown
    world.advance(1 / 60, 10)
    after = world.position.copy()
    world.restore(before)
    world.advance(1 / 60, 10)
    assert (world.position == after).all()


def test_a_world_that_is_being_recorded_is_shown_without_a_picture():
    world = kd.World()
    world.add_sphere(0.1)
    with world.record():
        world.step(1 / 60)
        assert PNG not in world._repr_html_()
    assert world.recorder is None


def test_what_has_no_picture_has_its_facts(monkeypatch):
    sol = kd.solve(kd.systems.kepler(), (0.0, 2.0), step=0.01)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    shown = sol._repr_html_()
    assert PNG not in shown
    assert "kepler" in shown


def test_figures_show_themselves_without_pyplot():
    figure = kd.solve(kd.systems.pendulum(), (0.0, 2.0), step=0.1).plot()
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_a_page_is_embedded_whole():
    world = kd.World()
    world.add_box((1, 1, 1))
    embedded = world.run(duration=0.1, step=0.05).show(height=300)
    (inside,) = re.findall(r'srcdoc="([^"]*)"', embedded._repr_html_())
    assert inside.startswith("&lt;!doctype html&gt;") or inside.lower().startswith("&lt;!doctype html")
    assert 'height="300"' in embedded._repr_html_()
    assert len(repr(embedded)) < 100
    with pytest.raises(kd.ArgumentError, match="height=0"):
        world.run(duration=0.1, step=0.05).show(height=0)


def test_a_bar_is_for_terminals_and_notebooks(monkeypatch):
    class Shell:
        kernel = object()

    class Ipython:
        get_ipython = Shell

    monkeypatch.setitem(sys.modules, "IPython", Ipython)
    assert progress._in_notebook()
    assert progress.Bar(10, None)._possible
    monkeypatch.setattr(Shell, "kernel", None)
    assert not progress._in_notebook()


LONG = """
import os, signal, threading
import kickdrift as kd
threading.Timer(1.5, os.kill, (os.getpid(), signal.SIGINT)).start()
sol = kd.solve(kd.systems.kepler(), (0.0, 1e9), step=0.001, save_every=100_000)
assert sol.status.name == "INTERRUPTED" and sol.n_steps > 0, sol
"""


def test_a_notebook_runs_headless(tmp_path):
    client = pytest.importorskip("nbclient", reason="nbclient is not installed: pip install nbclient ipykernel")
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    import nbformat

    notebook = nbformat.read(EXAMPLE, as_version=4)
    notebook.cells.append(nbformat.v4.new_code_cell(LONG))
    resources = {"metadata": {"path": str(tmp_path)}}
    client.NotebookClient(notebook, timeout=300, resources=resources).execute()
    shown = [output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", [])]
    pages = [data["text/html"] for data in shown if "text/html" in data]
    assert any(PNG in page for page in pages)
    assert any("<iframe srcdoc=" in page for page in pages)
    assert any("image/png" in data for data in shown)


def test_the_example_is_kept_without_outputs():
    assert '"output_type"' not in EXAMPLE.read_text()
