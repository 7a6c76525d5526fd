"""Continuous collision detection: contacts of bodies so fast that they would pass each other within a step."""
