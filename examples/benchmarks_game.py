"""The n-body program of the Benchmarks Game: Sun and four planets, a thousand steps of 0.01, energy before and after.

Pass another number of steps as the argument, as in the game: ``python benchmarks_game.py 5000000``.
"""

import sys

import kickdrift as kd


def main(n_steps=1000):
    game = kd.systems.benchmarks_game()
    sol = kd.solve(game, t_span=(0.0, 0.01 * n_steps), step=0.01, save_every=n_steps)
    print(f"{sol.energy[0]:.9f}")
    print(f"{sol.energy[-1]:.9f}")


if __name__ == "__main__":
    main(*(int(argument) for argument in sys.argv[1:]))
