"""Shapes of bodies."""
