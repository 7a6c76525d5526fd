"""Cloth: particles, held together by triangles that resist being stretched, sheared and folded."""
