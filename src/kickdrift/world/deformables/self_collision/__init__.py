"""Collisions of cloths with themselves and each other: pairs that may touch, continuous detection, and impulses."""
