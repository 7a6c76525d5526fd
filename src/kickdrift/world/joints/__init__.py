"""Joints: connections between bodies."""
