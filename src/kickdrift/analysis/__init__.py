"""Judging runs: order, stability, energy, symplecticity."""
