"""Forces on the particles of cloths, ropes and soft bodies: of their elasticity, and of the wind."""
