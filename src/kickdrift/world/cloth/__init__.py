"""Cloth: particles connected by triangles that resist stretching, shearing and bending."""
