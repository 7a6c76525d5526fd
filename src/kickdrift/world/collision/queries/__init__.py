"""Spatial queries: ray casts and overlaps."""
