"""Joints: what holds bodies together."""
