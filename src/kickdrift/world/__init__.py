"""Worlds: rigid bodies that touch, stack, hinge and walk."""
