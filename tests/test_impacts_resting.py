"""What rests on surfaces or slides along them: it sticks, keeps its energy, and leaves where nothing presses it on."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import kickdrift as kd
from kickdrift.core.outcomes import Outcome

G = 9.81
VERLET = {"method": "velocity-verlet"}


def _falling(x):
    return np.array([0.0, -9.81])


def _on_a_slope(angle, friction, **options):
    across = np.array([np.sin(angle), np.cos(angle)])
    slope = kd.Impacts(lambda x: across[0] * x[0] + across[1] * x[1], restitution=0.0, friction=friction)
    start = 2.0 * np.array([np.cos(angle), -np.sin(angle)])
    return kd.solve(_falling, (0, 10.0), start, [0, 0], impacts=slope, **{"step": 0.01, **VERLET, **options})


@pytest.mark.parametrize("angle", [0.1, 0.5, 1.2])
@pytest.mark.parametrize("method", ["velocity-verlet", "semi-implicit-euler", "position-verlet", "dop853"])
def test_a_block_sticks_below_the_angle_of_friction_and_slides_beyond(angle, method):
    sticks = _on_a_slope(angle, 1.001 * np.tan(angle), method=method)
    assert np.abs(sticks.x - sticks.x[0]).max() < 1e-14
    assert np.abs(sticks.v).max() == 0.0
    between = sticks(np.linspace(0.0, 10.0, 37))
    assert np.abs(between.x - sticks.x[0]).max() < 1e-14
    slides = _on_a_slope(angle, 0.999 * np.tan(angle), method=method)
    assert np.hypot(*slides.v[-1]) == pytest.approx(10 * G * 0.001 * np.sin(angle), rel=1e-9)
    if method != "semi-implicit-euler":
        assert np.hypot(*(slides.x[-1] - slides.x[0])) == pytest.approx(50 * G * 0.001 * np.sin(angle), rel=1e-9)


def test_a_block_thrown_up_a_slope_stops_and_stays_or_comes_back():
    across, along = np.array([np.sin(0.5), np.cos(0.5)]), np.array([-np.cos(0.5), np.sin(0.5)])
    for friction in (0.2, 0.8):
        slope = kd.Impacts(lambda x: across[0] * x[0] + across[1] * x[1], restitution=0.0, friction=friction)
        sol = kd.solve(_falling, (0, 3.0), [0, 0], 4.0 * along, step=0.001, impacts=slope, **VERLET)
        up, down = G * (np.sin(0.5) + friction * np.cos(0.5)), G * (np.sin(0.5) - friction * np.cos(0.5))
        top = 4.0**2 / 2 / up
        exact = top - max(down, 0.0) / 2 * (3.0 - 4.0 / up) ** 2
        assert sol.x[-1] @ along == pytest.approx(exact, abs=1e-3)
        assert np.abs(sol.x @ across).max() < 1e-12


@pytest.mark.parametrize("method", ["velocity-verlet", "position-verlet", "blanes-moan-srkn6b"])
def test_a_bead_in_a_bowl_keeps_its_energy_to_second_order(method):
    bowl = kd.Impacts(lambda x: 1 - np.sqrt(x[0] ** 2 + x[1] ** 2), restitution=0.0)
    start = [np.sin(1.0), -np.cos(1.0)], [0, 0]
    off = []
    for step in (0.02, 0.01, 0.005):
        sol = kd.solve(_falling, (0, 20.0), *start, step=step, method=method, impacts=bowl)
        energy = (sol.v**2).sum(1) / 2 + G * sol.x[:, 1]
        off.append(np.abs(energy - energy[0]).max())
        assert np.abs(np.hypot(*sol.x.T) - 1).max() < 1e-12
        assert sol.n_rejected == 0
    assert np.log2(np.array(off[:2]) / off[1:]) == pytest.approx([2.0, 2.0], abs=0.1)
    half = sol(np.linspace(0.0, 20.0, 333)).x
    assert np.abs(np.hypot(*half.T) - 1).max() < 1e-12


def test_a_bead_leaves_a_ball_where_nothing_presses_it_on():
    ball = kd.Impacts(lambda x: np.sqrt(x[0] ** 2 + x[1] ** 2) - 1, restitution=0.0)
    start = np.array([np.sin(0.2), np.cos(0.2)])
    leaves = np.arccos(2 / 3 * np.cos(0.2))
    speed = np.sqrt(2 * G * (np.cos(0.2) - np.cos(leaves)))
    lines, off = [], []
    for step in (0.008, 0.004, 0.002, 0.001):
        sol = kd.solve(_falling, (0, 1.5), start, [0, 0], step=step, impacts=ball, **VERLET)
        gap = np.hypot(*sol.x.T) - 1
        row = int(np.flatnonzero(gap > 1e-11)[0])
        assert abs(np.arctan2(*sol.x[row]) - leaves) < 3 * step * speed
        off.append(abs(sol.v[-1, 0] - speed * np.cos(leaves)))  # which no force changes in flight
        lines.append(gap.min())
    assert min(lines) > -1e-13
    assert off[-1] < 2e-6
    assert np.log2(off[0] / off[-1]) / 3 > 1.7


def test_friction_in_a_bowl_is_of_second_order():
    bowl = kd.Impacts(lambda x: 1 - np.sqrt(x[0] ** 2 + x[1] ** 2), restitution=0.0, friction=0.1)
    ends = [
        kd.solve(_falling, (0, 0.9), [1.0, 0.0], [0, 0], step=step, impacts=bowl, **VERLET).x[-1]
        for step in (0.01, 0.005, 0.0025, 0.000625)
    ]
    off = [np.hypot(*(end - ends[-1])) for end in ends[:-1]]
    assert np.log2(off[0] / off[2]) / 2 == pytest.approx(2.0, abs=0.1)


def _shaken(push, grip, end):
    """Return where a block is, x'' = push cos(2 t) - grip sign(x'), from the zeros of its exact speed in each phase."""
    t = x = v = 0.0
    sign = 1.0
    while True:

        def speed(s, t=t, v=v, sign=sign):
            return v + push / 2 * (np.sin(2 * s) - np.sin(2 * t)) - sign * grip * (s - t)

        times = np.arange(t, end, 1e-3)[2:]
        turned = np.flatnonzero(sign * speed(times) < 0)
        stop = brentq(speed, times[turned[0] - 1], times[turned[0]], xtol=1e-14) if turned.size else end
        way = v * (stop - t) - push / 4 * (np.cos(2 * stop) - np.cos(2 * t))
        x += way - push / 2 * np.sin(2 * t) * (stop - t) - sign * grip / 2 * (stop - t) ** 2
        if stop == end:
            return x
        t, v, force = stop, 0.0, push * np.cos(2 * stop)
        if abs(force) < grip:
            before = np.arccos(grip / push)
            t = (np.pi * np.ceil((2 * t + before) / np.pi) - before) / 2
            force = push * np.cos(2 * t)
        sign = np.sign(force)


def _order(ends, exact):
    off = np.abs(np.array(ends) - exact)
    assert off[0] > 1e-9
    return np.log2(off[0] / off[-1]) / (off.size - 1)


# It sticks before it turns around, from an end of a step on: else errors depend on where in a step; and turns around at once.
@pytest.mark.parametrize("push", [np.sqrt(2.0), 6.0])
def test_a_block_on_a_table_that_is_shaken_is_of_second_order(push):
    table = kd.Impacts(lambda x: x[1], restitution=0.0, friction=0.1)

    def inertia(t, x):
        return np.array([push * np.cos(2.0 * t), -10.0])

    end = 25 * np.pi / 8
    ends = [
        kd.solve(inertia, (0, end), [0, 0], [0, 0], step=np.pi / 8 / n, impacts=table, **VERLET).x[-1, 0]
        for n in (32, 64, 128)
    ]
    assert _order(ends, _shaken(push, 1.0, end)) == pytest.approx(2.0, abs=0.1)


def test_a_block_on_a_spring_with_friction_keeps_its_order_as_it_turns_around():
    floor = kd.Impacts(lambda x: x[1], restitution=0.0, friction=0.05)

    def spring(x):
        return np.array([-x[0], -1.0])

    sols = [kd.solve(spring, (0, 9.0), [1, 0], [0, 0], step=9.0 / n, impacts=floor, **VERLET) for n in (100, 200, 400)]
    exact = 0.05 + (1 - 5 * 0.05) * np.cos(9.0 - 2 * np.pi)  # each half period takes twice 0.05 of the amplitude
    assert _order([sol.x[-1, 0] for sol in sols], exact) == pytest.approx(2.0, abs=0.1)
    times = np.linspace(0.0, 9.0, 777)
    turns = np.flatnonzero(np.diff(np.sign(sols[0](times).v[:, 0])))
    assert times[turns[1:]] == pytest.approx([np.pi, 2 * np.pi], abs=0.02)
    assert sols[0].n_rejected < 30


def test_pucks_that_are_pushed_across_their_way_stop_or_come_back():
    table = kd.Impacts(lambda x: x[:, 2], restitution=0.0, friction=0.2)

    def push(x):
        out = np.zeros_like(x)
        out[:, 2] = -10.0
        out[0, 0], out[0, 1] = -1.2, -3.2
        out[1, 0], out[1, 1] = -0.5, -1.0
        return out

    start = np.zeros((2, 3)), np.array([[0.6, 1.6, 0.0], [1.0, 0.0, 0.0]])
    ends = [
        kd.solve(push, (0, 1.1), *start, step=1.1 / n, impacts=table, **VERLET).x[-1, :, :2] for n in (100, 200, 400)
    ]
    force, speed = np.hypot(1.2, 3.2), np.hypot(0.6, 1.6)
    turn = speed / (force + 2)
    way = speed * turn / 2 - (force - 2) / 2 * (1.1 - turn) ** 2
    assert np.abs(np.array(ends)[:, 0] - way * start[1][0, :2] / speed).max() < 1e-13

    def stops(t, v):
        return np.hypot(*v[:2]) - 1e-9

    stops.terminal = True
    exact = solve_ivp(
        lambda t, y: [*np.array([-0.5, -1.0]) - 2 * y[:2] / np.hypot(*y[:2]), *y[:2]],
        (0, 1.1),
        [1, 0, 0, 0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
        events=stops,
    ).y[2:, -1]
    off = [np.hypot(*(end[1] - exact)) for end in ends]
    assert np.log2(off[0] / off[2]) / 2 == pytest.approx(2.0, abs=0.1)


def test_states_between_rows_rest_too():
    floor = kd.Impacts(lambda x: x, restitution=0.5)
    sol = kd.solve(lambda x: -9.81, (0, 5.0), 1.0, 0.0, step=0.01, impacts=floor, **VERLET)
    rests = sol(np.linspace(3.0, 5.0, 501))
    assert np.abs(rests.x).max() < 1e-15
    assert np.abs(rests.v).max() == 0.0
    assert sol(np.linspace(0.0, 3.0, 999)).x.min() > -1e-13
    picked = kd.solve(lambda x: -9.81, (0, 5.0), 1.0, 0.0, step=0.01, impacts=floor, t_eval=[3.003, 4.9999], **VERLET)
    assert np.abs(picked.x).max() < 1e-15


def test_a_ball_in_a_turning_bowl_comes_to_rest_on_its_wall():
    bowl = kd.Impacts(lambda x: 1 - np.sqrt(x[0] ** 2 + x[1] ** 2), restitution=0.5)
    sol = kd.solve(lambda x: 0 * x, (0, 10.0), [0.5, 0], [0.3, 0.8], step=0.01, impacts=bowl, **VERLET)
    assert np.abs(np.hypot(*sol.x[-200:].T) - 1).max() < 1e-12
    momentum = sol.x[:, 0] * sol.v[:, 1] - sol.x[:, 1] * sol.v[:, 0]
    assert np.abs(momentum - 0.4).max() < 1e-10  # all that is left is what nothing takes
    assert np.hypot(*sol.v[-1]) == pytest.approx(0.4, abs=1e-3)
    assert sol.n_rejected < 2000


def test_a_lift_carries_what_rests_on_it_and_throws_it_where_it_brakes_hard():
    lift = kd.Impacts(lambda t, x: x - 0.1 * (1 - np.cos(5.0 * t)), restitution=0.0)
    gentle = kd.solve(lambda x: -9.81, (0, 5.0), 0.0, 0.0, step=0.01, impacts=lift, **VERLET)
    assert np.abs(gentle.x - 0.1 * (1 - np.cos(5.0 * gentle.t))).max() < 1e-12
    hard = kd.Impacts(lambda t, x: x - 0.1 * (1 - np.cos(15.0 * t)), restitution=0.0)
    thrown = kd.solve(lambda x: -9.81, (0, 5.0), 0.0, 0.0, step=0.002, impacts=hard, **VERLET)
    gap = thrown.x - 0.1 * (1 - np.cos(15.0 * thrown.t))
    assert gap.min() > -1e-12
    first = thrown.t[np.flatnonzero(gap > 1e-11)[0]]
    assert first == pytest.approx(np.arccos(-9.81 / 22.5) / 15.0, abs=0.005)  # where the lift falls away faster than g


@pytest.mark.parametrize("steps", [60, 73, 240])
def test_what_is_lifted_leaves_at_the_time_at_which_nothing_presses_it_on(steps):
    """By a force that grows, x'' = -G + 3 t^2, from t = sqrt(G / 3) on; and from a shaken table, where that falls with g."""
    floor = kd.Impacts(lambda x: x, restitution=0.0)
    sol = kd.solve(lambda t: -G + 3 * t * t, (0, 3.0), 0.0, 0.0, step=3 / steps, method="yoshida-6", impacts=floor)
    leaves = np.sqrt(G / 3)
    assert np.abs(sol.t - leaves).min() < 1e-10
    after = sol.t[sol.t > leaves] - leaves
    assert np.abs(sol.x[sol.t > leaves] - (leaves * after**3 + after**4 / 4)).max() < 1e-12
    assert np.abs(sol.x[sol.t <= leaves + 1e-10]).max() < 1e-12

    table = kd.Impacts(lambda t, x: x - 0.05 * np.cos(20 * t), restitution=0.0)
    begin, leaves = np.pi / 20, (2 * np.pi - np.arccos(G / 20)) / 20
    end = leaves + 0.05
    sol = kd.solve(lambda x: -G, (begin, end), -0.05, 0.0, step=(end - begin) / steps, impacts=table, **VERLET)
    assert np.abs(sol.t - leaves).min() < 1e-10
    thrown = 0.05 * np.cos(20 * leaves) - np.sin(20 * leaves) * 0.05 - G / 2 * 0.05**2
    assert sol.x[-1] == pytest.approx(thrown, abs=1e-12)


def test_what_hangs_without_weight_or_is_pressed_by_others_is_cut_nowhere():
    slope = kd.Impacts(lambda x: 0.6 * x[0] + 0.8 * x[1] - 1.0, restitution=0.0)
    sol = kd.solve(lambda x: 0.0 * x, (0, 1.0), [0.6, 0.8], [0.8, -0.6], step=0.01, impacts=slope, **VERLET)
    assert (sol.n_steps, sol.n_rejected) == (100, 0)
    balls = kd.Impacts(lambda x: np.array([x[0] - 0.5, x[1] - x[0] - 1.0]), restitution=0.0)
    sol = kd.solve(lambda x: -G + 0 * x, (0, 1.0), [0.5, 1.5], [0.0, 0.0], step=0.01, impacts=balls, **VERLET)
    assert (sol.n_steps, sol.n_rejected) == (100, 0)


def test_spheres_that_are_heaped_in_a_box_come_to_rest_above_each_other():
    radius = 0.5

    def gaps(x):
        out = np.empty(13)
        for i in range(3):
            out[3 * i], out[3 * i + 1], out[3 * i + 2] = x[i, 1] - 0.5, x[i, 0] - 0.5, 1.6 - x[i, 0]
        row = 9
        for i in range(3):
            for j in range(i):
                out[row] = np.sqrt((x[i, 0] - x[j, 0]) ** 2 + (x[i, 1] - x[j, 1]) ** 2) - 2 * 0.5
                row += 1
        out[12] = 1.0
        return out

    def fall(x):
        out = np.zeros_like(x)
        out[:, 1] = -9.81
        return out

    start = [[0.6, 0.6], [1.5, 1.2], [0.7, 2.5]]
    box = kd.Impacts(gaps, restitution=0.3)
    sol = kd.solve(fall, (0, 10.0), start, np.zeros((3, 2)), step=0.01, impacts=box, **VERLET)
    assert sol.status is Outcome.COMPLETED
    assert min(gaps(x).min() for x in sol.x) > -1e-10
    energy = (sol.v**2).sum((1, 2)) / 2 + G * sol.x[:, :, 1].sum(1)
    assert (energy - np.minimum.accumulate(energy)).max() < 1e-3
    assert np.abs(sol.v[-1]).max() < 1e-10
    assert sol.x[:, :, 1].min() > radius - 1e-10


@pytest.mark.parametrize(
    ("rough", "slope", "restitution", "speed"),
    [
        (0.41420427767733514, 0.20794196369588297, 0.3041138976269706, -0.6107096782695494),
        (0.8666165802632689, 0.42595770159821505, 0.7974163820535856, -0.18250262333874545),
    ],
)
def test_a_slip_that_ends_soon_after_the_last_bounce_sticks(rough, slope, restitution, speed):
    """It was lost in the steps that were tried for its end, and the run ended there."""
    normal = np.array([-np.sin(slope), np.cos(slope)])
    sol = kd.solve(
        lambda x: np.array([0.0, -9.81]),
        (0.0, 6.0),
        [normal[0], normal[1] + 0.2],
        [speed, 0.0],
        step=0.01,
        impacts=kd.Impacts(
            lambda x, params: params[1] * x[1] - params[0] * x[0], restitution=restitution, friction=rough
        ),
        args=[np.sin(slope), np.cos(slope)],
        method="velocity-verlet",
    )
    assert sol.success
    assert abs(sol.v[-1]).max() == 0.0
