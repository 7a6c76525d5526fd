"""Impacts of free bodies: their time within a substep, and impulses of restitution and friction."""
